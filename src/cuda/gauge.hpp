// The GaugeMap on a CUDA device: memory, streams and pieces around the kernels.
#pragma once

#include <cstdint>
#include <vector>

#include "cuda/runtime.hpp"
#include "cullhull/device_points.hpp"
#include "filter/gauge/gauge_table.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline cuda {

/// Ids (ascending) of the points that are not provably inside, as GaugeMap::survivors gives them,
/// for points in the host's memory. Pieces of them are copied into pinned memory and to the device,
/// culled there, and one bit a point comes back; two pieces are in flight at a time. Where memory
/// is short, pieces are smaller. Throws OutOfMemory, Failure, Error{cancelled}.
std::vector<std::uint64_t> survivors_of_host_points(const GaugeTable& table,
                                                    const PointView& points, const Run& run);

/// Ids on the device, ascending.
struct DeviceIds {
  DeviceArray<std::uint64_t> ids;
  std::uint64_t count = 0;
};

/// The same for points on the device; work on points.stream. Extra memory: a bit a point and the
/// survivors.
DeviceIds survivors_of_device_points(const GaugeTable& table, const DevicePointView& points);

/// The same in pieces: for a device with hardly any free memory, of which it takes half a megabyte.
std::vector<std::uint64_t> survivors_by_pieces(const GaugeTable& table,
                                               const DevicePointView& points,
                                               const Control& control);

/// Packed doubles of the points `ids` (on the host; null: all `count` of the view), not checked for
/// finiteness.
Array<double> download_points(const DevicePointView& points, const std::uint64_t* ids,
                              std::uint64_t count, const Control& control);

}  // namespace cullhull::internal::inline cuda
