// The fast path of a batch: small sets in general position go straight from points to the lists of
// the batch.
#pragma once

#include "batch/batch_maker.hpp"
#include "cullhull/batch.hpp"
#include "cullhull/point_view.hpp"

namespace cullhull::internal::inline batch {

/// Appends the hull of a small set of points in space to `to`: the same bits as convex_hull gives.
/// False, with `to` unchanged, for sets that are not small, not in general position (see
/// small_hull_3d), not finite, or where a measure needs more than doubles.
bool append_small_3d(const PointView& set, HullBatch& to);

/// The same for a set of which the simplices are known; with the places among its vertices in the
/// stead of ids.
bool append_simplices_3d(const FoundHull& found, HullBatch& to);

}  // namespace cullhull::internal::inline batch
