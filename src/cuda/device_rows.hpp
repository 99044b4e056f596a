// Queries and copies of points in a device's memory, for every flow. Only where CUDA is compiled.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/device_points.hpp"
#include "filter/planner.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline cuda {

/// The device that holds this memory; throws Error{invalid_argument} for host memory, and
/// Error{backend_unavailable} with the reason where there is no device.
int device_of_memory(const void* memory);

/// The device that holds the points; throws Error{invalid_argument} for a view that it cannot read.
int device_of(const DevicePointView& points);

/// Where the planner would cull them.
Placement place_of_device_points(const DevicePointView& points, const Run& run);

/// Packed rows of all points, bit for bit. Throws Error{not_finite} for the first bad point,
/// Error{out_of_budget}. Packed points need no extra memory of the device.
Array<double> download_all(const DevicePointView& points, const Run& run);

/// Throws Error{not_finite} naming the first point that is not finite; there must be one.
[[noreturn]] void refuse_first_not_finite(const DevicePointView& points, const Run& run);

}  // namespace cullhull::internal::inline cuda
