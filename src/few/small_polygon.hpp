// Hulls of small sets in the plane, from coordinates to every part of a result, on one thread, in
// memory that is reused from set to set.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/point_view.hpp"
#include "filter/plane_filter.hpp"
#include "hull/plane/polygon.hpp"
#include "parallel/threads/run.hpp"
#include "result/write/write_polygon.hpp"

namespace cullhull::internal {

class SmallPolygon {
 public:
  /// Holds at most about 1 MB, and 1 MB more for points that are not packed doubles.
  explicit SmallPolygon(const Control& control) : series_(control) {}

  /// Finds the corners of a set. False where the general flow must be used: other dimensions, too
  /// few or too many points, points on a line, extreme aspect ratios, points that are not finite.
  bool find(const PointView& set);

  /// The quick filter that dropped points of the set found; null: none did.
  const WayRow* filtered_by() const { return all_ ? nullptr : &row_of(filter_.way()); }

  const RungCounts& rung_counts() const { return series_.rung_counts(); }

  /// Appends planes, measures and lists of the set found to a Hull or a HullBatch. False, with
  /// `target` unchanged, where doubles do not suffice.
  template <class Target>
  bool write(const PointView& set, Target& target) {
    return write_polygon(set, PolygonOfRows<std::uint32_t>{*corners_, count_, ids(), series_.box()},
                         short_run(), memory_, target);
  }
  /// The ids of the corners, ascending.
  std::vector<std::uint64_t> extreme() const;

 private:
  const std::uint32_t* ids() const { return all_ ? nullptr : filter_.ids(); }

  PolygonSeries series_;
  PlaneFilter filter_;
  std::vector<double> loaded_;
  // The points that may be corners; `all_`: every point of the set, whose numbers are its own.
  bool all_ = true;
  std::uint32_t count_ = 0;
  const std::vector<std::uint32_t>* corners_ = nullptr;  // among them
  PolygonMemory memory_;
};

}  // namespace cullhull::internal
