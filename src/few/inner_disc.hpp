// The cheapest filter in the plane: an ellipse inside the hull of a sample, one comparison a point.
#pragma once

#include <cstdint>
#include <vector>

#include "hull/plane/planar_strip.hpp"

namespace cullhull::internal::inline few {

/// Points are mapped to u = (x - cx) sx, v = (y - cy) sy: in this affine image a disc about the
/// origin lies inside the image of a polygon.
class InnerDisc {
 public:
  struct Test {
    double centre[2] = {}, scale[2] = {};
    double limit = 0;

    bool contains(double x, double y) const {
      const double u = (x - centre[0]) * scale[0], v = (y - centre[1]) * scale[1];
      return u * u + v * v < limit;
    }
  };

  InnerDisc() = default;  ///< contains nothing
  /// `corners` of `rows` (packed pairs), counter-clockwise, and their bounding box. May contain
  /// nothing.
  InnerDisc(const double* rows, const std::vector<std::uint32_t>& corners, const Box& box);

  /// True only for points strictly inside the polygon. False for what is not finite.
  bool contains(double x, double y) const { return test_.contains(x, y); }
  /// The positions, ascending, of those of `count` packed pairs that it does not contain. `out` has
  /// room for all.
  std::uint32_t outside(const double* rows, std::uint32_t count, std::uint32_t* out) const;

 private:
  Test test_;
};

}  // namespace cullhull::internal::inline few
