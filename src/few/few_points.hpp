// Single calls with few points: from points to the result on the calling thread, bypassing the
// general flow.
#pragma once

#include "cullhull/extreme_points.hpp"
#include "cullhull/hull_fwd.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

namespace cullhull::internal {

/// Fills all of `hull` with the same bits as the general flow. Returns false, having done nothing,
/// where the general flow is needed. `points` and `options` have been checked.
bool small_hull(const PointView& points, const Options& options, Hull& hull);

/// The same for the extreme points alone, in the plane, where nothing else is computed, and in
/// space. From 4D on linear programs find them sooner.
bool small_extreme(const PointView& points, const Options& options, ExtremePoints& result);

}  // namespace cullhull::internal
