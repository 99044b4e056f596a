// The cheapest filter in the plane: an ellipse inside the hull of a sample, one comparison per
// point.
#pragma once

#include <cstdint>
#include <vector>

#include "geometry/box.hpp"

namespace cullhull::internal {

/// An ellipse inside a polygon. The affine map u = (x - cx) sx, v = (y - cy) sy makes it a disc
/// about the origin.
class InnerEllipse {
 public:
  struct Test {
    double centre[2] = {}, scale[2] = {};
    double limit = 0;

    bool contains(double x, double y) const {
      const double u = (x - centre[0]) * scale[0], v = (y - centre[1]) * scale[1];
      return u * u + v * v < limit;
    }
  };

  /// Inside the polygon whose counter-clockwise corners are the given `corners` of `rows` (packed
  /// pairs). `box`: its bounding box. The ellipse may be empty.
  InnerEllipse(const double* rows, const std::vector<std::uint32_t>& corners, const Box& box);

  /// True only for points strictly inside the polygon. False for coordinates that are not finite.
  bool contains(double x, double y) const { return test_.contains(x, y); }
  /// Writes to `out` the positions, ascending, of those of `count` packed pairs that the ellipse
  /// does not contain; returns their number. `out` needs room for `count`.
  std::uint32_t outside(const double* rows, std::uint32_t count, std::uint32_t* out) const;

 private:
  Test test_;
};

}  // namespace cullhull::internal
