// Functions that locate points in a device's memory and copy them to the host. Only in builds with
// CUDA.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cullhull/device_points.hpp"
#include "filter/planner.hpp"

namespace cullhull::internal {

struct Run;
/// The number of the device that holds this memory. Throws Error{invalid_argument} for host memory,
/// whose message begins with `what`, and Error{backend_unavailable} with the reason if there is no
/// device.
int device_of_memory(const void* memory, const char* what = "the points are");

/// The number of the device that holds the points. Throws Error{invalid_argument} for a view that
/// the device cannot read, and Failure with the reason if the device cannot be used.
int device_of(const DevicePointView& points);

/// Whether the planner would filter these points on the device or on the host.
Placement place_of_device_points(const DevicePointView& points, const Run& run);

/// Copies all points to packed rows of doubles in the host's memory. Throws Error{not_finite} for
/// the first point that is not finite, and Error{out_of_budget}. Packed points need no additional
/// device memory.
Array<double> download_all(const DevicePointView& points, const Run& run);

/// download_points() that throws Error{not_finite} for the first row that is not finite; row i is
/// called point names[i], or i if `names` is null.
Array<double> download_finite(const DevicePointView& points, const std::uint64_t* ids,
                              std::uint64_t count, const std::uint64_t* names, const Run& run);

/// Copies these points of `view`, some of `all`, to packed rows as gather_points() does: -0 becomes
/// +0. If one of them is not finite, throws Error{not_finite} for the first such point of `all`.
Array<double> gather_from_device(const DevicePointView& view, std::span<const std::uint64_t> ids,
                                 const DevicePointView& all, const Run& run);

/// Throws Error{out_of_budget} if that many survivors exceed the budget.
void require_room_for_survivors(std::uint64_t count, unsigned dimension, const Run& run);

/// Throws Error{not_finite}, which names the first point that is not finite. There must be one.
[[noreturn]] void refuse_first_not_finite(const DevicePointView& points, const Run& run);

}  // namespace cullhull::internal
