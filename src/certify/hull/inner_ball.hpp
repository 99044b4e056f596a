// The first test of a point: most lie in a ball around the centre that is strictly inside.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/point_view.hpp"

namespace cullhull::internal::certify {

/// An axis-parallel ellipsoid: the points x with sum ((x_j - centre_j) scale_j)^2 < square.
class InnerBall {
 public:
  static constexpr unsigned max_dimension = 6;
  static constexpr std::uint32_t block = 1024;  ///< points of one call; their doubles fit L1

  struct Test {
    unsigned dimension = 0;
    double centre[max_dimension] = {}, scale[max_dimension] = {};
    double square = 0;
  };

  InnerBall() = default;  ///< contains nothing
  /// `square` 0 or dimensions beyond max_dimension: contains nothing.
  InnerBall(const std::vector<double>& centre, const std::vector<double>& scale, double square);
  bool usable() const { return test_.square > 0; }

  /// The positions (from 0, ascending) of those of the `count` <= block points from `begin`, of
  /// full dimension, that it does not contain; points that are not finite are always among them.
  /// `out` has room for block. Sums of squares are computed in doubles, fused or not.
  std::uint32_t outside(const PointView& points, std::uint64_t begin, std::uint32_t count,
                        std::uint16_t* out) const;

 private:
  Test test_;
};

/// Coordinates of points [begin, begin + count) as doubles: coordinate j of point i at
/// out[(i - begin) * step + j * stride].
void load_points(const PointView& points, std::uint64_t begin, std::uint64_t count, double* out,
                 std::size_t step, std::size_t stride);

}  // namespace cullhull::internal::certify
