// The GaugeMap on a CUDA device: memory, streams and pieces around the kernels.
#pragma once

#include <cstdint>
#include <vector>

#include "cuda/runtime.hpp"
#include "cull/gauge_table.hpp"
#include "cullhull/device_points.hpp"
#include "parallel/control.hpp"

namespace cullhull::internal::cuda {

/// Ids (ascending) of the points that are not provably inside, as GaugeMap::survivors gives them;
/// the points are in the host's memory. Pieces of them are copied into pinned memory, culled on the
/// device, and one bit a point comes back; two pieces are under way at a time. Where memory is
/// short, in smaller pieces. Throws OutOfMemory, Failure, Error{cancelled}.
std::vector<std::uint64_t> survivors_of_host_points(const GaugeTable& table,
                                                    const PointView& points, unsigned threads,
                                                    const Control& control);

/// Ids on the device, ascending.
struct DeviceIds {
  DeviceArray<std::uint64_t> ids;
  std::uint64_t count = 0;
};

/// The same for points on the device; work on points.stream. Extra memory: a bit a point and the
/// survivors.
DeviceIds survivors_of_device_points(const GaugeTable& table, const DevicePointView& points);

/// The same in pieces: extra memory on the device is half a megabyte. For when that is all it has.
std::vector<std::uint64_t> survivors_by_pieces(const GaugeTable& table,
                                               const DevicePointView& points,
                                               const Control& control);

/// Packed doubles of the points `ids` (on the host; null: all `count` of the view), exactly as they
/// are, NaN and all.
Array<double> download_points(const DevicePointView& points, const std::uint64_t* ids,
                              std::uint64_t count, const Control& control);

}  // namespace cullhull::internal::cuda
