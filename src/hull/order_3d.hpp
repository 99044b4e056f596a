// The order in which the 3D engine takes its points, and the key by which it cuts the surface into
// pieces for threads.
#pragma once

#include <cstdint>
#include <vector>

#include "parallel/big_array.hpp"
#include "points/local_points.hpp"

namespace cullhull::internal {

/// Position of a direction on a closed Hilbert-like curve over the cube of directions, after a
/// linear map that makes the points round: a thin body's directions would crowd.
class DirectionKey {
 public:
  static constexpr unsigned max_bits = 12;  // an axis of a cube face

  DirectionKey(const LocalPoints& points, const double* centre, const std::uint32_t* simplex);

  /// keys[i] of the points with the given rows; 6 * 4^bits values.
  void keys(const double* const* rows, std::uint32_t count, unsigned bits,
            std::uint32_t* keys) const;

 private:
  double centre_[3];
  double map_[3][3];
};

/// Biased randomised insertion order (Amenta, Choi, Rote 2003): rounds of geometrically growing
/// random samples, each along the curve of directions.
struct InsertionOrder3D {
  BigArray<std::uint32_t> ids;
  std::vector<std::uint32_t> round_ends;  // ascending, the last is the number of points
  unsigned key_bits = 0;
};

/// The four points of `simplex` come first, as a round of their own; the round after it is small
/// and not sorted. Deterministic, whatever the number of threads.
InsertionOrder3D insertion_order_3d(const LocalPoints& points, const DirectionKey& key,
                                    const std::uint32_t* simplex, unsigned threads);

}  // namespace cullhull::internal
