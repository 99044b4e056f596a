// Functions that locate points in a device's memory and copy them to the host. Only in builds with
// CUDA.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/device_points.hpp"
#include "filter/planner.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

/// The number of the device that holds this memory. Throws Error{invalid_argument} for host memory,
/// whose message begins with `what`, and Error{backend_unavailable} with the reason if there is no
/// device.
int device_of_memory(const void* memory, const char* what = "the points are");

/// The number of the device that holds the points. Throws Error{invalid_argument} for a view that
/// the device cannot read.
int device_of(const DevicePointView& points);

/// Whether the planner would filter these points on the device or on the host.
Placement place_of_device_points(const DevicePointView& points, const Run& run);

/// Copies all points to packed rows of doubles in the host's memory. Throws Error{not_finite} for
/// the first point that is not finite, and Error{out_of_budget}. Packed points need no additional
/// device memory.
Array<double> download_all(const DevicePointView& points, const Run& run);

/// Throws Error{not_finite}, which names the first point that is not finite. There must be one.
[[noreturn]] void refuse_first_not_finite(const DevicePointView& points, const Run& run);

}  // namespace cullhull::internal
