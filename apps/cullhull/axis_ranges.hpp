// AxisRanges: the least and the greatest coordinate on each axis, and which points are not finite.
#pragma once

#include <cstdint>
#include <limits>
#include <vector>

#include "cullhull/point_view.hpp"

namespace app {

struct AxisRanges {
  static constexpr std::uint64_t none = std::numeric_limits<std::uint64_t>::max();
  struct Range {
    double least = std::numeric_limits<double>::infinity();
    double greatest = -std::numeric_limits<double>::infinity();
  };
  std::vector<Range> axes;
  std::uint64_t not_finite = 0;  ///< points with a NaN or an infinity
  std::uint64_t first_not_finite = none;

  /// Adds the findings about other points.
  void add(const AxisRanges& other);
};

/// The ranges of all points, found on `threads` threads, at the speed of memory if the rows are
/// packed; a NaN is in no range. `first_id`: the id of the first point.
AxisRanges axis_ranges(const cullhull::PointView& points, unsigned threads,
                       std::uint64_t first_id = 0);

}  // namespace app
