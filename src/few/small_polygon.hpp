// Hulls of small sets in the plane, from coordinates to every part of a result, on one thread, in
// memory that is reused from set to set.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/point_view.hpp"
#include "few/small_hull.hpp"
#include "hull/plane/polygon.hpp"
#include "parallel/threads/parallel.hpp"
#include "result/write/polygon_result.hpp"

namespace cullhull::internal {

class SmallPolygon {
 public:
  static constexpr std::uint64_t most_points = std::uint64_t{1} << 16;
  /// The most points that may be left after thinning, so that their sums fit one chunk.
  static constexpr std::uint64_t most_kept = 4096;

  /// Holds at most about 500 KB, and 1 MB more for points that are not packed doubles.
  explicit SmallPolygon(const Control& control) : series_(control) {}

  /// Finds the corners of a set. False where the general flow must be used: other dimensions, too
  /// few or too many points, points on a line, extreme aspect ratios, points that are not finite.
  bool find(const PointView& set);

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
  bool thin_columns(std::uint32_t count);
  void keep_ends(unsigned axis, double low, std::uint32_t columns);
  void take_kept(std::uint32_t k);
  bool thin(std::uint32_t count);
  void keep_rows(std::uint32_t count, std::uint32_t step, const InnerDisc& disc);
  void rank(const std::vector<std::uint32_t>& corners);

  PolygonSeries series_;
  std::vector<double> loaded_;
  const double* rows_ = nullptr;  // all rows of the set
  // Rows that may be corners, ascending, and their coordinates; `all_`: every row of the set may be
  // one, and the lists are not used.
  bool all_ = true;
  std::uint32_t kept_count_ = 0;
  std::vector<std::uint32_t> kept_;
  std::vector<double> kept_rows_;
  // The ends of the rows with the same value on one axis: their values on the other, their numbers.
  struct Column {
    double least, most;
    std::uint32_t first, last;
  };
  std::vector<Column> columns_;
  std::vector<std::uint32_t> rank_;  // by row: the rank of a corner
  struct Corner {
    std::uint32_t row, before, after;  // the ranks before and after, counter-clockwise
    PlanarPoint point;                 // scaled for EdgeKernel
  };
  std::vector<Corner> by_rank_;
  std::vector<std::uint32_t> cycle_;  // ranks, counter-clockwise from the lowest
};

}  // namespace cullhull::internal
