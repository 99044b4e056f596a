// The kernels that hull many small sets, as functions that launch them on a stream. Callers handle
// memory and errors (set_hulls.cpp); each function returns the status of its launch.
#pragma once

#include <driver_types.h>

#include <cstddef>
#include <cstdint>

#include "cullhull/device_points.hpp"

namespace cullhull::internal::inline cuda {

/// Points of the largest set that a warp takes. Ids within a set and numbers of simplices then fit
/// a byte.
inline constexpr unsigned most_warp_points = 128;

/// Bytes a point of a set's lists of simplices, d ids each: fewer than n in the plane, fewer than
/// 2 n in space.
constexpr unsigned simplex_room(unsigned dimension) { return dimension == 2 ? 2 : 6; }

/// Sets and what is found of them; all pointers are the device's.
struct WarpSets {
  const std::uint64_t* starts;  ///< sets + 1; set i is points [starts[i], starts[i + 1])
  std::uint32_t sets;
  /// Vertices | simplices << 8 of each set; 0: not decided (of another size, a sign too close, not
  /// finite).
  std::uint16_t* counts;
  /// A set's lists begin at the number of its first point, times the room for one: its vertices,
  /// and d of them a simplex, in the order of a result (HullBatch).
  std::uint8_t* vertices;
  std::uint8_t* simplices;
};

/// Finds the hulls of the sets of [least, most] points; the counts of others are left unchanged.
/// Dimension 2 or 3; most <= most_warp_points.
cudaError_t find_set_hulls(const DevicePointView& points, const WarpSets& sets, unsigned least,
                           unsigned most, cudaStream_t stream);

/// Copies the lists of the decided sets, in which there is room for others, to where each set's
/// begin: vertices to vertex_at[i] and simplices to simplex_at[i] (in simplices, not ids).
struct PackedLists {
  const std::uint64_t* vertex_at;
  const std::uint64_t* simplex_at;
};
/// As bytes, the vertices ascending, with their packed rows in the points' scalar.
cudaError_t pack_set_hulls(const DevicePointView& points, const WarpSets& sets,
                           const PackedLists& at, std::uint8_t* vertices, std::uint8_t* simplices,
                           void* rows, cudaStream_t stream);
/// As 32-bit integers.
cudaError_t pack_set_hulls(const DevicePointView& points, const WarpSets& sets,
                           const PackedLists& at, std::int32_t* vertices, std::int32_t* simplices,
                           cudaStream_t stream);

/// Runs of items to copy: run i is `length[i]` items from `from[i]` to `to[i]`.
struct ItemRuns {
  const std::uint64_t* from;
  const std::uint64_t* to;
  const std::uint64_t* length;
  std::uint32_t count;
};
/// rows[to ...] = points [from ...], packed, in the points' scalar.
cudaError_t copy_point_runs(const DevicePointView& points, const ItemRuns& runs, void* rows,
                            cudaStream_t stream);
cudaError_t copy_runs(const std::int32_t* items, const ItemRuns& runs, std::int32_t* out,
                      cudaStream_t stream);

}  // namespace cullhull::internal::inline cuda
