// The hull of points of the plane as a cycle: the result of the 2D engine, for extreme points alone
// and for results written without a frame.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/array.hpp"
#include "geometry/box.hpp"
#include "hull/plane/planar_chains.hpp"

namespace cullhull::internal {

struct Polygon {
  /// Rows of the extreme points (of equal points the lowest row), counter-clockwise from the
  /// lexicographically lowest. Two if all points lie on a line, one if all are equal.
  Array<std::uint32_t> corners;
  std::uint32_t rows = 0;  ///< number of input rows
  Box box{};               ///< of all points
  RungCounts rung_counts;
};

/// points.dimension == 2, 0 < count < 2^32 - 1. `lattice`: doubles compute every turn exactly.
/// Reads the points in place, twice; memory: 24 bytes per point and 8 per corner. Throws
/// Error{not_finite} naming the lowest id with a NaN or an infinity.
Polygon polygon_of(const PointView& points, bool lattice, const Run& run);
/// The same for finite points, first thinned by what lies inside samples of them (PlaneFilter).
Polygon polygon_by_sample(const PointView& points, bool lattice, const Run& run);

/// Polygons of many small sets, one after another on one thread, in reused memory.
class PolygonSeries {
 public:
  explicit PolygonSeries(const Control& control);
  /// `rows`: count > 0 packed pairs of finite doubles; `thinned`: a filter left them. The corners
  /// are overwritten by the next call.
  const std::vector<std::uint32_t>& corners(const double* rows, std::uint32_t count,
                                            bool thinned = false);
  /// The bounding box of the last call's points.
  const Box& box() const { return box_; }
  const RungCounts& rung_counts() const { return chains_.turn().counts(); }

 private:
  Array<Entry> entries_;
  ChainBuilder chains_;
  std::vector<std::uint32_t> corners_;
  Box box_{};
};

}  // namespace cullhull::internal
