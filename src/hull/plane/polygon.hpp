// The hull of points of the plane as a cycle: what the 2D engine finds, and all that extreme points
// alone or a result written directly need.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/array.hpp"
#include "hull/plane/planar_chains.hpp"
#include "hull/plane/planar_strip.hpp"
#include "parallel/control.hpp"

namespace cullhull::internal {

struct Polygon {
  /// Rows of the extreme points (of equal points the lowest row), counter-clockwise from the
  /// lexicographically lowest. Two if all points lie on a line, one if all are equal.
  Array<std::uint32_t> corners;
  std::uint32_t rows = 0;  ///< there were
  Box box{};               ///< of all points
  std::uint64_t rung_counts[3] = {0, 0, 0};
};

/// points.dimension == 2, 0 < count < 2^32 - 1. `lattice`: doubles compute every turn exactly.
/// Points are read where they lie, twice; memory: 24 bytes a point that is not discarded early, and
/// 8 a corner. Throws Error{not_finite} naming the lowest id with a NaN or an infinity.
Polygon polygon_of(const PointView& points, bool lattice, unsigned threads, const Control& control);

/// The same for many small sets one after another: memory is kept, and one thread does all.
class PolygonSeries {
 public:
  explicit PolygonSeries(const Control& control);
  /// `rows`: count > 0 packed pairs of finite doubles. The corners are overwritten by the next
  /// call.
  const std::vector<std::uint32_t>& corners(const double* rows, std::uint32_t count);
  /// Of the points of the last call.
  const Box& box() const { return box_; }
  const std::uint64_t* rung_counts() const { return chains_.turn().counts(); }

 private:
  Array<Entry> entries_;
  ChainBuilder chains_;
  std::vector<std::uint32_t> corners_;
  Box box_{};
};

}  // namespace cullhull::internal
