// The filter stage for points in a device's memory: what run_filter does, with only samples and
// survivors crossing the bus.
#pragma once

#include <cstdint>

#include "cullhull/device_points.hpp"
#include "flow/filter_stage.hpp"
#include "parallel/control.hpp"

namespace cullhull::internal {

/// As run_filter, but `rows` always holds the coordinates of the survivors (of all points where
/// `all`), exactly as they are. Throws Error{not_finite} naming the lowest id with a NaN or an
/// infinity, Error{backend_unavailable} where there is no device or the view is none of its memory.
Filtered run_device_filter(const DevicePointView& points, const Options& options,
                           const Control& control, unsigned threads, std::uint64_t budget);

/// Throws Error{invalid_argument} for null data, no dimension, a scalar no device takes.
void check_arguments(const DevicePointView& points);

/// The hull of what run_device_filter left of `points` (of which only count, dimension and scalar
/// are asked), under the points' own ids. Fills the statistics but for the times of the filter and
/// of the whole.
Hull hull_of_rows(const Filtered& filtered, const DevicePointView& points, const Options& options);

}  // namespace cullhull::internal
