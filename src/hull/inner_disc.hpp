// The cheapest filter in the plane: an ellipse inside the hull of a sample, one comparison a point.
#pragma once

#include <cstdint>
#include <vector>

#include "hull/planar_strip.hpp"

namespace cullhull::internal {

/// Points are seen as u = (x - cx) sx, v = (y - cy) sy: an affine image, in which a disc about the
/// origin lies inside that of a polygon.
class InnerDisc {
 public:
  InnerDisc() = default;  ///< contains nothing
  /// `corners` of `rows` (packed pairs), counter-clockwise, and their box. May contain nothing.
  InnerDisc(const double* rows, const std::vector<std::uint32_t>& corners, const Box& box);

  /// Certainly strictly inside the polygon. False for what is not finite.
  bool contains(double x, double y) const {
    const double u = (x - centre_[0]) * scale_[0], v = (y - centre_[1]) * scale_[1];
    return u * u + v * v < limit_;
  }

 private:
  double centre_[2] = {}, scale_[2] = {};
  double limit_ = 0;
};

}  // namespace cullhull::internal
