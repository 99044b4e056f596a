// The filter of a frame, led by the vertices of the last one: our way, with a gauge map.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/hull.hpp"
#include "flow/filter_stage.hpp"
#include "parallel/run.hpp"
#include "tracker/frame_points.hpp"

namespace cullhull::internal {

/// Drops points strictly inside the hull of the points `leaders` (ids, ascending) at their new
/// places. False, and nothing done, where these give no map: they are too few, lie in a flat, or
/// their hull exceeds the budget. Throws Error{not_finite} for the first bad point of all.
bool filter_by_leaders(FramePoints& points, const Hull& last,
                       const std::vector<std::uint64_t>& leaders, const Run& run, Filtered& result,
                       double& scan_seconds);

}  // namespace cullhull::internal
