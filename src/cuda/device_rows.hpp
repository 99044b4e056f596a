// What every flow for points in a device's memory asks of them. Only where CUDA is compiled.
#pragma once

#include <cstdint>
#include <vector>

#include "cull/planner.hpp"
#include "cullhull/device_points.hpp"
#include "parallel/control.hpp"

namespace cullhull::internal {

/// The device that holds this memory; throws Error{invalid_argument} where none does, and without
/// a device the reason.
int device_of_memory(const void* memory);

/// The device that holds the points; throws Error{invalid_argument} where the view cannot be read
/// there.
int device_of(const DevicePointView& points);

/// Where the planner would cull them.
Placement place_of_device_points(const DevicePointView& points, const Options& options,
                                 unsigned threads);

/// Packed rows of all points, exactly as they are. Throws Error{not_finite} for the first bad one,
/// Error{out_of_budget}. Packed points need no memory of the device.
Array<double> download_all(const DevicePointView& points, const Control& control, unsigned threads,
                           std::uint64_t budget);

/// Throws Error{not_finite} naming the first point that is not finite; there is one.
[[noreturn]] void refuse_first_not_finite(const DevicePointView& points, const Control& control);

}  // namespace cullhull::internal
