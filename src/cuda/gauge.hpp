// The gauge map on a CUDA device: memory, streams, and the division into pieces. The kernels are in
// kernels/gauge_kernel.hpp.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "cuda/runtime.hpp"
#include "cullhull/device_points.hpp"
#include "filter/gauge/gauge_table.hpp"

namespace cullhull::internal {

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

/// Calls use(first, n) for all pieces of `count` points, of `piece` points each; of fewer after one
/// that found no memory.
template <class Use>
void in_pieces(std::uint64_t count, std::uint64_t piece, const Control& control, const Use& use) {
  // Copying fewer takes less time than starting the copy.
  constexpr std::uint64_t least = std::uint64_t{1} << 16;
  for (std::uint64_t first = 0; first < count;) {
    control.check();
    const std::uint64_t n = std::min(piece, count - first);
    try {
      use(first, n);
      first += n;
    } catch (const OutOfMemory&) {
      if (n <= least) throw;
      piece = std::max(least, n / 2);
    }
  }
}

/// Copies the points [first, first + count) of the host to packed rows in the current device's
/// memory, floats or doubles, which `view` then describes; work on the stream is ordered after the
/// copies. Threads pack a piece into pinned memory while the link carries the one before. Throws
/// OutOfMemory, Failure, Error{cancelled}.
DeviceArray<std::byte> uploaded_points(const PointView& points, std::uint64_t first,
                                       std::uint64_t count, cudaStream_t stream, const Run& run,
                                       DevicePointView& view);

/// Ascending ids in the device's memory.
struct DeviceIds {
  DeviceArray<std::uint64_t> ids;
  std::uint64_t count = 0;

  /// Appends them, `first` added to each, to a list of the host.
  template <class List>
  void append_to(List& list, std::uint64_t first, cudaStream_t stream) const {
    const std::size_t before = list.size();
    list.resize(before + count);
    download(list.data() + before, ids.data(), count, stream);
    for (std::size_t i = before; first != 0 && i < list.size(); ++i) list[i] += first;
  }
};

/// Replaces each number by the sum of those before it.
void sum_in_place(std::uint64_t* numbers, std::uint64_t count, cudaStream_t stream);

/// The points on the device that are not provably inside: those that GaugeMap::survivors leaves.
/// All work is on points.stream. Needs device memory for a bit a point and for the survivors' ids.
DeviceIds survivors_of_device_points(const GaugeTable& table, const DevicePointView& points);

/// The points that `map` finds outermost, one in each of the cells of directions that have points,
/// in the order of the cells, so many along an edge (filter/gauge/outermost_offers.hpp). From 4D
/// on, at most 2^28 points. Needs 16 bytes of device memory a cell.
DeviceIds outermost_there(const GaugeTable& map, unsigned cells, const DevicePointView& points);

/// The same ids in the host's memory: of all points at once or, where the device has hardly any
/// free memory, in pieces.
Array<std::uint64_t> survivors_by_pieces(const GaugeTable& table, const DevicePointView& points,
                                         const Control& control);

/// Copies points to packed rows of doubles in the host's memory, without a check for finiteness.
/// `ids`: the `count` points to copy, in the host's memory; null: the first `count` points.
Array<double> download_points(const DevicePointView& points, const std::uint64_t* ids,
                              std::uint64_t count, const Run& run);

}  // namespace cullhull::internal
