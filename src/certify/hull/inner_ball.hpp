// The first test of a point: most are in a ball around the centre that is strictly inside the hull.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/point_view.hpp"

namespace cullhull::internal::certify {

/// An axis-parallel ellipsoid: the points x with sum ((x_j - centre_j) scale_j)^2 < square.
class InnerBall {
 public:
  static constexpr unsigned max_dimension = 6;
  static constexpr std::uint32_t block = 1024;  ///< points per call; their doubles fit L1

  struct Test {
    unsigned dimension = 0;
    double centre[max_dimension] = {}, scale[max_dimension] = {};
    double square = 0;
  };

  InnerBall() = default;  ///< an empty ball
  /// `square` 0 or a dimension above max_dimension: an empty ball.
  InnerBall(const std::vector<double>& centre, const std::vector<double>& scale, double square);
  bool usable() const { return test_.square > 0; }

  /// Writes to `out` (room for `block`) the positions (from 0, ascending) of those of the `count`
  /// <= block points from `begin`, of full dimension, that are not in the ball, including points
  /// that are not finite. Returns their number. Sums of squares are computed in doubles, fused or
  /// not.
  std::uint32_t outside(const PointView& points, std::uint64_t begin, std::uint32_t count,
                        std::uint16_t* out) const;

 private:
  Test test_;
};

}  // namespace cullhull::internal::certify
