// Single calls with few points: straight from points to the result on the calling thread, without
// anything of the general flow but its results.
#pragma once

#include "cullhull/hull.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

namespace cullhull::internal {

/// Whether options leave the way to us: who chooses a filter, an engine or a device gets it.
bool takes_small_sets(const Options& options);

/// All of `hull`, the same bits as the general flow gives. False, and nothing done, where that must
/// see to it. `points` and `options` have been checked.
bool small_hull(const PointView& points, const Options& options, Hull& hull);

}  // namespace cullhull::internal
