// Where a direction lies on a curve over all directions: the 3D engine's order along the surface.
#pragma once

#include <cstdint>

#include "points/local_points.hpp"

namespace cullhull::internal {

/// Hilbert curves over the faces of the cube of directions, after a linear map that makes the
/// points round: a thin body's directions would crowd.
class DirectionKey {
 public:
  static constexpr unsigned max_bits = 12;   // an axis of a cube face
  static constexpr std::uint32_t block = 64;

  DirectionKey(const LocalPoints& points, const double* centre, const std::uint32_t* simplex);

  /// keys[i] in [0, 6 * 4^bits) of the positions (x[i], y[i], z[i]), i < block.
  void keys(const double* x, const double* y, const double* z, unsigned bits,
            std::uint32_t* keys) const;

  struct Map {
    double centre[3];
    double linear[3][3];
  };

 private:
  Map map_;
};

}  // namespace cullhull::internal
