// The fast path of a batch in the plane: sets go straight from points to the lists of the batch.
#pragma once

#include "cullhull/batch.hpp"
#include "few/small_polygon.hpp"
#include "parallel/threads/control.hpp"

namespace cullhull::internal::inline batch {

class PlanarSets {
 public:
  explicit PlanarSets(const Control& control) : polygon_(control) {}

  /// Appends the hull of a set of points of the plane to `to`: the same bits as convex_hull gives.
  /// False, with `to` unchanged, where convex_hull must do it (see SmallPolygon::find).
  bool append(const PointView& set, HullBatch& to);

 private:
  void write(const PointView& set, const PlanarMeasures& measures, HullBatch& to) const;

  SmallPolygon polygon_;
};

}  // namespace cullhull::internal::inline batch
