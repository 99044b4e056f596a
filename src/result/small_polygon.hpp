// Small sets of the plane from points to everything a result holds, on one thread and without
// memory of their own but what is kept from set to set.
#pragma once

#include <cstdint>
#include <vector>

#include "control.hpp"
#include "cullhull/point_view.hpp"
#include "hull/polygon.hpp"
#include "result/polygon_result.hpp"

namespace cullhull::internal {

class SmallPolygon {
 public:
  static constexpr std::uint64_t most_points = 4096;

  explicit SmallPolygon(const Control& control) : series_(control) {}

  /// The corners of a set. False where the general way must see to it: other dimensions, few or
  /// many points, lines, extraordinary proportions, points that are not finite.
  bool find(const PointView& set);

  /// Corners, and so edges.
  std::size_t size() const { return by_rank_.size(); }
  const std::uint64_t* rung_counts() const { return series_.rung_counts(); }

  /// size() planes, and the measures; the same bits as write_polygon's. False as for find, then
  /// nothing was found.
  bool measure(const PointView& set, double* planes, PlanarMeasures& measures);

  /// size() ids.
  void write_vertices(std::uint64_t* vertices) const;
  /// 2 size() items each.
  void write_lists(std::uint64_t* simplices, std::uint32_t* simplex_neighbours,
                   std::uint64_t* facets, std::uint32_t* facet_neighbours) const;

 private:
  const double* load(const PointView& set);
  void rank(const std::vector<std::uint32_t>& corners, std::uint32_t rows);

  PolygonSeries series_;
  std::vector<double> loaded_;
  const double* rows_ = nullptr;     // of the set
  std::vector<std::uint32_t> rank_;  // of each row that is a corner
  struct Corner {
    std::uint32_t row, before, after;  // the ranks before and after, counter-clockwise
    PlanarPoint point;                 // in the kernel's units
  };
  std::vector<Corner> by_rank_;
  std::vector<std::uint32_t> cycle_;  // ranks, counter-clockwise from the lowest
};

}  // namespace cullhull::internal
