// The insertion order of the 3D engine.
#pragma once

#include <cstdint>
#include <vector>

#include "exact/points/local_points.hpp"
#include "hull/space/direction_key.hpp"
#include "parallel/memory/big_array.hpp"
#include "parallel/radix_sort.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

/// Biased randomised insertion order (Amenta, Choi, Rote 2003): rounds of geometrically growing
/// random samples, each sorted along the curve of directions.
struct InsertionOrder3D {
  BigArray<std::uint32_t> ids;
  std::vector<std::uint32_t> round_ends;  // ascending, the last is the number of points
  unsigned key_bits = 0;
};

/// The four points of `simplex` come first, as a round of their own; the round after it is small
/// and not sorted. Deterministic, whatever the number of threads.
InsertionOrder3D insertion_order_3d(const LocalPoints& points, const DirectionKey& key,
                                    const std::uint32_t* simplex, const Run& run);

}  // namespace cullhull::internal
