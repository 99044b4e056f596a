// Vertices of a regular triangulation whose lifted points lie exactly on a face of the lower hull
// of the others.
#pragma once

#include <vector>

#include "cullhull/triangulation.hpp"
#include "exact/points/lifted_points.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

/// Their ids, ascending. `t` has its cells, hull and groups.
std::vector<std::uint32_t> redundant_vertices(const LiftedPoints& s, const Triangulation& t,
                                              const Run& run);

}  // namespace cullhull::internal
