// Hulls of small sets in the plane, from coordinates to every part of a result, on one thread, in
// memory that is reused from set to set.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/point_view.hpp"
#include "filter/plane_filter.hpp"
#include "hull/plane/polygon.hpp"
#include "parallel/threads/parallel.hpp"
#include "result/write/polygon_result.hpp"

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

  /// Number of corners, and so of edges.
  std::size_t size() const { return by_rank_.size(); }
  const RungCounts& rung_counts() const { return series_.rung_counts(); }

  /// Appends planes, measures and lists of the set found to a Hull or a HullBatch, with the same
  /// bits as write_polygon. False, with `target` unchanged, where doubles do not suffice.
  template <class Target>
  bool write(const PointView& set, Target& target);

  /// Writes size() ids.
  void write_vertices(std::uint64_t* vertices) const;

 private:
  bool measure(const PointView& set, double* planes, PlanarMeasures& measures);
  void rank(const std::vector<std::uint32_t>& corners);

  PolygonSeries series_;
  PlaneFilter filter_;
  std::vector<double> loaded_;
  // The points that may be corners; `all_`: every point of the set, whose numbers are its own.
  bool all_ = true;
  std::uint32_t count_ = 0;
  const double* rows_ = nullptr;
  std::vector<std::uint32_t> rank_;  // by row of rows_: the rank of a corner
  struct Corner {
    std::uint32_t id, row;        // its number in the set, its row of rows_
    std::uint32_t before, after;  // the ranks before and after, counter-clockwise
    PlanarPoint point;            // scaled for EdgeKernel
  };
  std::vector<Corner> by_rank_;
  std::vector<std::uint32_t> cycle_;  // ranks, counter-clockwise from the lowest
};

}  // namespace cullhull::internal
