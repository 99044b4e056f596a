// The fast path of a batch in the plane: sets go straight from points to the lists of the batch.
#pragma once

#include <cstdint>
#include <vector>

#include "control.hpp"
#include "cullhull/batch.hpp"
#include "hull/polygon.hpp"
#include "result/polygon_result.hpp"

namespace cullhull::internal {

class PlanarSets {
 public:
  explicit PlanarSets(const Control& control);

  /// Appends the hull of a set of points of the plane to `to`: the same bits as convex_hull gives.
  /// False, with `to` as it was, where convex_hull must see to it: other dimensions, large sets,
  /// lines, extraordinary proportions, points that are not finite.
  bool append(const PointView& set, HullBatch& to);

 private:
  const double* load(const PointView& set);
  void rank(const std::vector<std::uint32_t>& corners, std::uint32_t rows);
  bool measure(const PointView& set, const EdgeKernel& kernel, double* planes, Hull& measures);
  void write(const PointView& set, const Hull& measures, HullBatch& to) const;

  PolygonSeries series_;
  std::vector<double> rows_;
  std::vector<std::uint32_t> rank_;  // of each row that is a corner
  struct Corner {
    std::uint32_t row, before, after;  // the ranks before and after, counter-clockwise
    PlanarPoint point;                 // in the kernel's units
  };
  std::vector<Corner> by_rank_;
  std::vector<std::uint32_t> cycle_;  // ranks, counter-clockwise from the lowest
};

}  // namespace cullhull::internal
