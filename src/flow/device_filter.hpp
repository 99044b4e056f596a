// The filter stage for points in a device's memory: what run_filter does, transferring only samples
// and survivors.
#pragma once

#include <cstdint>

#include "cullhull/device_points.hpp"
#include "flow/filter_stage.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline flow {

/// As run_filter, but `rows` always holds the exact coordinates of the survivors (of all points
/// where `all`). Throws Error{not_finite} naming the lowest id with a NaN or an infinity,
/// Error{backend_unavailable} where there is no device or the view is not in its memory.
Filtered run_device_filter(const DevicePointView& points, const Run& run);

/// Throws Error{invalid_argument} for null data, no dimension, or a scalar other than f32 and f64.
void check_arguments(const DevicePointView& points);

/// The hull of the survivors of run_device_filter, with the ids of `points` (of which only count,
/// dimension and scalar are read). Fills the statistics except the times of the filter and of the
/// whole.
Hull hull_of_rows(const Filtered& filtered, const DevicePointView& points, const Options& options);

}  // namespace cullhull::internal::inline flow
