// An affine image of a nearly flat set in which it is not flat, for filters in doubles.
//
// Shares that sum to 1 but for rounding are 2^-53 thick: no product of doubles tells which of them
// are extreme, and rationals for each pair of points take seconds. Extreme points stay extreme
// under affine maps. Relative to a simplex of the set, coordinate i is the determinant of facet i
// and the point, in units of a power of two near that of the vertex opposite.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "exact/points/local_points.hpp"
#include "geometry/local_frame.hpp"

namespace cullhull::internal {

struct Run;

class Unflattened {
 public:
  /// What a coordinate of the image is off by at most, where the largest on its axis is about 1.
  static constexpr double error = 0x1p-41;
  /// Keeps the frame's points if their simplex is wide enough for doubles, or if no image is found.
  /// O(n d^2) operations and O(n d) memory if an image is made.
  Unflattened(const LocalFrame& frame, const Run& run);
  /// The frame's, or with `coordinates` of the image, at most 1 in magnitude.
  const LocalPoints& points() const { return points_; }

 private:
  std::optional<LocalFrame> image_;
  LocalPoints points_;
};

}  // namespace cullhull::internal
