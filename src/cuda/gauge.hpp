// The gauge map on a CUDA device: memory, streams, and the division into pieces. The kernels are in
// kernels/gauge_kernel.hpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "cuda/runtime.hpp"
#include "cullhull/device_points.hpp"
#include "filter/gauge/gauge_table.hpp"

namespace cullhull::internal {

/// The ids, ascending, of the points in the host's memory that are not provably inside; the same as
/// GaugeMap::survivors. The points are copied piece by piece into pinned memory and to the device,
/// which filters them and returns one bit a point. Two pieces are in flight at a time. If memory is
/// short, the pieces are smaller. Throws OutOfMemory, Failure, Error{cancelled}.
Array<std::uint64_t> survivors_of_host_points(const GaugeTable& table, const PointView& points,
                                              const Run& run);

inline cudaStream_t cuda_stream_of(const DevicePointView& points) {
  return static_cast<cudaStream_t>(points.stream);
}
/// The points [first, first + count).
inline DevicePointView part_of(DevicePointView points, std::uint64_t first, std::uint64_t count) {
  points.data = static_cast<const std::byte*>(points.data) +
                static_cast<std::ptrdiff_t>(first) * points.point_stride;
  points.count = count;
  return points;
}

/// Ascending ids in the device's memory.
struct DeviceIds {
  DeviceArray<std::uint64_t> ids;
  std::uint64_t count = 0;
};

/// The same for points on the device; all work is on points.stream. Needs device memory for a bit a
/// point and for the survivors' ids.
DeviceIds survivors_of_device_points(const GaugeTable& table, const DevicePointView& points);

/// The same piece by piece, for a device with hardly any free memory: needs half a megabyte and the
/// table's nodes. Returns the ids in the host's memory.
Array<std::uint64_t> survivors_by_pieces(const GaugeTable& table, const DevicePointView& points,
                                         const Control& control);

/// Copies points to packed rows of doubles in the host's memory, without a check for finiteness.
/// `ids`: the `count` points to copy, in the host's memory; null: the first `count` points.
Array<double> download_points(const DevicePointView& points, const std::uint64_t* ids,
                              std::uint64_t count, const Run& run);

}  // namespace cullhull::internal
