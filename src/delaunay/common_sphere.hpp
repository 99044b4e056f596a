// A sphere that most of the points are on, up to the last bits of their coordinates.
#pragma once

#include <cstdint>
#include <vector>

#include "exact/points/local_points.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

/// Sets s.powers if at least half of the points are so close to the sphere through `simplex`, the
/// places of k + 1 independent points, that in-sphere tests with squared distances would not be
/// decided in doubles. The points then have no lattice. For 2 to 6 dimensions, full-dimensional
/// points without weights, in the scaled frame.
void find_common_sphere(LiftedPoints& s, const std::vector<std::uint32_t>& simplex, const Run& run);

}  // namespace cullhull::internal
