// Many small hulls of points in a CUDA device's memory. Needs no CUDA header.
#pragma once

#include <cstdint>
#include <memory>

#include "cullhull/batch.hpp"
#include "cullhull/device_points.hpp"
#include "cullhull/options.hpp"

#pragma GCC visibility push(default)
namespace cullhull::inline v1 {

/// The hulls of the sets [offsets[i], offsets[i + 1]) of points in a device's memory: the same
/// batch, bit for bit, as convex_hulls(PointView) of the same points. `offsets`: set_count + 1
/// numbers in host or device memory, which the points' stream may be writing still (pinned, managed
/// and device memory). `vertex_coordinates`, if given, receives the coordinates of
/// HullBatch::vertices, one row each, in that order.
///
/// In 2D and 3D the device computes sets of up to 128 points, one warp per set; vertex coordinates,
/// and in 3D simplices, are copied to the host, which computes planes and measures. The CPU
/// computes larger and flat sets and those that arithmetic in doubles does not decide (four
/// vertices in a plane, say); with Backend::cpu, Engine::qhull and in other dimensions it computes
/// all. The work is done in pieces of about two million points, smaller ones if the device's memory
/// is full, and then, unless Backend::cuda was given, by the CPU. Throws what
/// convex_hulls(PointView) throws, Error{backend_unavailable} without a device,
/// Error{out_of_budget} if the device's memory is full, Error{invalid_argument} for unsupported
/// memory or scalar types.
HullBatch convex_hulls(const DevicePointView& points, const std::uint64_t* offsets,
                       std::uint64_t set_count, const Options& options = {},
                       Array<double>* vertex_coordinates = nullptr);

/// Vertices and simplices of the hulls of many sets, in a device's memory, in the order of
/// HullBatch. Ids count from the set's first point. Copies share the memory, which is freed with
/// the last copy, after all work queued on the device by then.
struct DeviceHullBatch {
  std::uint32_t dimension = 0;
  std::uint64_t sets = 0, vertex_count = 0, simplex_count = 0;  ///< totals
  int device = -1;
  const std::int64_t* vertex_offsets = nullptr;   ///< sets + 1
  const std::int32_t* vertices = nullptr;         ///< ids; vertex_count items
  const std::int64_t* simplex_offsets = nullptr;  ///< sets + 1, counting simplices
  const std::int32_t* simplices = nullptr;        ///< simplex_count x dimension ids
  const std::int32_t* affine_dimensions =
      nullptr;                         ///< sets; sets below `dimension` have no simplex
  std::shared_ptr<const void> memory;  ///< holds all of these
};

/// The same hulls, left in the device's memory. Sets that the device does not decide are computed
/// by the CPU and copied back. All data are written when the call returns. Extra device memory: 7
/// bytes per point in 3D, 3 in 2D, and the result; Error{out_of_budget} if that is not available,
/// else the errors of convex_hulls. A set of more than 2^31 - 1 points is Error{invalid_argument}.
DeviceHullBatch convex_hulls_on_device(const DevicePointView& points, const std::uint64_t* offsets,
                                       std::uint64_t set_count, const Options& options = {});

}  // namespace cullhull::inline v1
#pragma GCC visibility pop
