// The filter of a frame by a gauge map on the last frame's vertices (the leaders).
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/hull.hpp"
#include "flow/filter_stage.hpp"
#include "parallel/threads/run.hpp"
#include "tracker/frame_points.hpp"

namespace cullhull::internal::inline tracker {

/// Drops points strictly inside the hull of the points `leaders` (ids, ascending) at their new
/// positions. False, and nothing done, where they give no map: too few, in a flat, or their hull
/// exceeds the budget. Throws Error{not_finite} for the first bad point of all.
bool filter_by_leaders(FramePoints& points, const Hull& last,
                       const std::vector<std::uint64_t>& leaders, const Run& run, Filtered& result,
                       double& scan_seconds);

}  // namespace cullhull::internal::inline tracker
