// The order in which the insertion engine takes its points.
#pragma once

#include <cstdint>
#include <vector>

#include "points/local_points.hpp"

namespace cullhull::internal {

/// Biased randomised insertion order (Amenta, Choi, Rote 2003): rounds of geometrically growing
/// random samples, each round along a Hilbert curve: over directions from `centre` (a cube map) in
/// 3D, over positions in higher dimensions. Deterministic. The first round is small and unsorted.
/// Time O(n), a radix sort.
std::vector<std::uint32_t> insertion_order(const LocalPoints& points, const double* centre);

}  // namespace cullhull::internal
