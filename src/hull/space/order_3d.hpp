// The insertion order of the 3D engine, and positions of directions along its surface.
#pragma once

#include <cstdint>
#include <vector>

#include "exact/points/local_points.hpp"
#include "parallel/memory/raw_array.hpp"
#include "parallel/radix_sort.hpp"

namespace cullhull::internal {

// Positions of directions on a curve over all directions: the 3D engine's order along the surface.

/// Hilbert curves over the faces of the cube of directions, after a linear map that makes the
/// points' covariance round: without it the directions of a thin body would crowd.
class DirectionKey {
 public:
  static constexpr std::uint32_t block = 64;

  DirectionKey() = default;
  DirectionKey(const LocalPoints& points, const double* centre, const std::uint32_t* simplex);

  /// The same for normals of planes, which the map transforms by its inverse transpose.
  DirectionKey for_normals() const;
  /// The same curve, turned about an axis by an angle that is no fraction of a full turn.
  DirectionKey turned() const;

  /// keys[i] in [0, 6 * 4^bits) of the positions (x[i], y[i], z[i]), i < count <= block; bits
  /// <= 14. All arrays have room for a multiple of 16.
  void keys(const double* x, const double* y, const double* z, unsigned bits, std::uint32_t* keys,
            std::uint32_t count = block) const;
  /// The same with 24 bits per axis.
  static constexpr unsigned fine_bits = 2 * 24 + 3;
  void fine_keys(const double* x, const double* y, const double* z, std::uint64_t* keys) const;

  struct Map {
    double centre[3];
    double linear[3][3];
  };
  const Map& map() const { return map_; }

 private:
  Map map_{};
};

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
