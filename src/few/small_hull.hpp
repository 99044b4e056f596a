// Single calls with few points: from points to the result on the calling thread, bypassing the
// general flow.
#pragma once

#include "cullhull/hull.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

namespace cullhull::internal::inline few {

/// Whether the options permit it: a chosen filter, engine or device is respected.
bool takes_small_sets(const Options& options);

/// Fills all of `hull`, the same bits as the general flow gives. False, and nothing done, where the
/// general flow is needed. `points` and `options` have been checked.
bool small_hull(const PointView& points, const Options& options, Hull& hull);

}  // namespace cullhull::internal::inline few
