// Many small hulls of points in a CUDA device's memory. No CUDA header is needed.
#pragma once

#include <cstdint>
#include <memory>

#include "cullhull/batch.hpp"
#include "cullhull/device_points.hpp"
#include "cullhull/options.hpp"

#pragma GCC visibility push(default)
namespace cullhull::inline v1 {

/// The hulls of the sets [offsets[i], offsets[i + 1]) of points in a device's memory: the same
/// batch, bit for bit, as convex_hulls(PointView) of the same points gives. `offsets`: set_count +
/// 1 numbers in the host's or the device's memory. In the plane and in space sets of up to 128
/// points are hulled on the device, a warp a set; vertices' coordinates, and in space simplices,
/// are copied to the host, which computes planes and measures. Sets that arithmetic in doubles does
/// not decide (with four vertices in a plane, say), larger ones and flat ones are copied as a whole
/// and hulled by the CPU, as all are with Backend::cpu, Engine::qhull and in other dimensions. Work
/// is done in pieces of some two million points; where the device's memory is full they are
/// smaller, and then, unless Backend::cuda was given, the CPU's. Throws what
/// convex_hulls(PointView) throws, Error{backend_unavailable} without a device,
/// Error{out_of_budget} where the device's memory is full, Error{invalid_argument} for memory or
/// scalars it does not take. `vertex_coordinates`, where given, receives those of
/// HullBatch::vertices, a row each, in their order.
HullBatch convex_hulls(const DevicePointView& points, const std::uint64_t* offsets,
                       std::uint64_t set_count, const Options& options = {},
                       Array<double>* vertex_coordinates = nullptr);

/// Vertices and simplices of the hulls of many sets, in a device's memory, in the order of
/// HullBatch. Ids count from the set's first point. Copies share the memory, which is freed with
/// the last of them, behind all work that the device has then.
struct DeviceHullBatch {
  std::uint32_t dimension = 0;
  std::uint64_t sets = 0, vertex_count = 0, simplex_count = 0;  ///< in all
  int device = -1;
  const std::int64_t* vertex_offsets = nullptr;   ///< sets + 1
  const std::int32_t* vertices = nullptr;         ///< ids, vertex_count
  const std::int64_t* simplex_offsets = nullptr;  ///< sets + 1, counting simplices
  const std::int32_t* simplices = nullptr;        ///< simplex_count x dimension ids
  const std::int32_t* affine_dimensions =
      nullptr;                         ///< sets; sets below `dimension` have no simplex
  std::shared_ptr<const void> memory;  ///< holds all of these
};

/// The same hulls, left where the points are. What the device does not decide is hulled by the CPU
/// and copied back. Everything has been written when this returns. Extra device memory: 7 bytes a
/// point in space, 3 in the plane, and the result; Error{out_of_budget} where it is not available,
/// else the errors of convex_hulls. A set of more than 2^31 - 1 points is Error{invalid_argument}.
DeviceHullBatch convex_hulls_on_device(const DevicePointView& points, const std::uint64_t* offsets,
                                       std::uint64_t set_count, const Options& options = {});

}  // namespace cullhull::inline v1
#pragma GCC visibility pop
