// Many small hulls of points in a CUDA device's memory. Needs no CUDA header.
#pragma once

#include <cstdint>
#include <memory>

#include "cullhull/batch.hpp"
#include "cullhull/device_points.hpp"
#include "cullhull/options.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

/// The hulls of the sets [offsets[i], offsets[i + 1]) of points in a device's memory: the same
/// batch, bit for bit, as convex_hulls(PointView) of the same points. `offsets`: set_count + 1
/// numbers in host or device memory, which the points' stream may be writing still (pinned, managed
/// and device memory). `vertex_coordinates`, if given, receives the coordinates of
/// HullBatch::vertices, one row each, in that order.
///
/// The device computes sets of up to 128 points in 2D and 16,384 in 3D, one warp per set; vertex
/// coordinates, and in 3D simplices, are copied to the host, which computes planes and measures.
/// The CPU computes larger and flat sets, those with more than some 640 vertices and those that
/// arithmetic in doubles does not decide (four vertices in a plane, say); with Backend::cpu and in
/// other dimensions it computes all. The work is done in pieces of about two million points,
/// smaller ones if the device's memory is full, and then, unless Backend::cuda was given, by the
/// CPU. Throws what convex_hulls(PointView) throws, Error{backend_unavailable} without a device,
/// Error{out_of_budget} if the device's memory is full, Error{invalid_argument} for unsupported
/// memory or scalar types.
HullBatch convex_hulls(const DevicePointView& points, const std::uint64_t* offsets,
                       std::uint64_t set_count, const Options& options = {},
                       Array<double>* vertex_coordinates = nullptr);

/// What a DeviceHullBatch contains, and its shapes; by default vertices and simplices alone, end to
/// end.
struct DeviceBatchOptions {
  bool planes = false;    ///< DeviceHullBatch::planes
  bool measures = false;  ///< DeviceHullBatch::volumes, areas, centroids
  /// Give each set a row of `most_vertices` vertices and one of `most_simplices` simplices and
  /// planes, instead of lists end to end. 0: as many as the largest hull of the batch has.
  bool padded = false;
  std::uint64_t most_vertices = 0, most_simplices = 0;
};

/// The hulls of many sets, in a device's memory, in the order of HullBatch. Ids count from the
/// set's first point. Pointers to what DeviceBatchOptions did not ask for are null. Copies share
/// the memory, which is freed with the last copy, after all work queued on the device by then.
struct DeviceHullBatch {
  std::uint32_t dimension = 0;
  std::uint64_t sets = 0, vertex_count = 0, simplex_count = 0;  ///< totals, without padding
  int device = -1;
  const std::int64_t* vertex_offsets = nullptr;   ///< sets + 1; null if padded
  const std::int32_t* vertices = nullptr;         ///< ids; vertex_count items
  const std::int64_t* simplex_offsets = nullptr;  ///< sets + 1, counting simplices; null if padded
  const std::int32_t* simplices = nullptr;        ///< simplex_count x dimension ids
  const std::int32_t* affine_dimensions =
      nullptr;                         ///< sets; sets below `dimension` have no simplex
  std::shared_ptr<const void> memory;  ///< holds all of these

  /// If padded, the lengths of rows: `vertices` is sets x vertex_width ids, `simplices` sets x
  /// simplex_width x dimension ids, both filled up with -1; `planes` is sets x simplex_width x
  /// (dimension + 1) numbers, filled up with 0. Otherwise 0.
  std::uint64_t vertex_width = 0, simplex_width = 0;
  /// If padded, how many vertices and simplices each set has; `sets` items.
  const std::int32_t *vertex_counts = nullptr, *simplex_counts = nullptr;
  /// For each simplex outward unit normal and offset of its facet, as in HullBatch::facet_planes;
  /// simplex_count x (dimension + 1).
  const double* planes = nullptr;
  const double *volumes = nullptr, *areas = nullptr;  ///< `sets` items, as in HullBatch
  const double* centroids = nullptr;                  ///< sets x dimension, as in HullBatch
};

/// The same hulls, left in the device's memory. Every number has the bits of convex_hulls. Sets
/// that the device does not decide, or whose planes or measures are not certain in doubles, if
/// these are asked for, are computed by the CPU and copied back. All data are written when the call
/// returns. Thread safe. O(points) work on the device, and on the CPU as convex_hulls for the sets
/// left to it. Extra device memory: 7 bytes per point in 3D, 3 in 2D, with planes or measures 8 d +
/// 17 bytes per set, and the result; Error{out_of_budget} if that is not available, else the errors
/// of convex_hulls. Error{invalid_argument} for a set of more than 2^31 - 1 points, and for one
/// with more vertices or simplices than most_vertices or most_simplices; it names the set.
DeviceHullBatch convex_hulls_on_device(const DevicePointView& points, const std::uint64_t* offsets,
                                       std::uint64_t set_count, const Options& options = {},
                                       const DeviceBatchOptions& content = {});

}  // namespace cullhull
#pragma GCC visibility pop
