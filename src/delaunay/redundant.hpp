// Redundant vertices of a regular triangulation: their lifted points are exactly on a face of the
// lower hull of the others.
#pragma once

#include <vector>

#include "cullhull/triangulation.hpp"
#include "exact/points/local_points.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

/// The ids of these vertices, ascending. Requires complete cells, hull and groups of `t`.
std::vector<std::uint32_t> redundant_vertices(const LiftedPoints& s, const Triangulation& t,
                                              const Run& run);

}  // namespace cullhull::internal
