// Many small sets on a device, for the host's code, without CUDA's headers: implemented by
// set_hulls.cpp where CUDA is compiled, by not_compiled.cpp elsewhere.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "cullhull/device_batch.hpp"
#include "cullhull/point_view.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal::inline cuda {

/// What a device found of some sets, in the host's memory, end to end.
struct FoundLists {
  std::vector<std::uint64_t> vertex_at, simplex_at;  ///< a number more than sets
  const std::uint8_t* vertices = nullptr;            ///< ids within the set, ascending
  const std::uint8_t* simplices = nullptr;           ///< in space: three ids each
  const std::byte* rows = nullptr;                   ///< of the vertices, in the points' scalar
  std::shared_ptr<const void> memory;
};

/// Rows of some sets in the host's memory: set k of them from row `starts[k]` on.
struct SetRows {
  PointView points;
  std::vector<std::uint64_t> starts;
  std::shared_ptr<const void> memory;

  PointView set(std::size_t k) const {
    PointView view = points;
    view.data += static_cast<std::ptrdiff_t>(starts[k]) * points.point_stride;
    view.count = starts[k + 1] - starts[k];
    return view;
  }
};

/// The sets of one call and the device that holds their points, which is current for the thread
/// that made this until it is destroyed. Offsets are those of the points in the host's memory.
class SetsOnDevice {
 public:
  /// Throws Failure where there is no device, Error{invalid_argument} for memory it cannot read.
  SetsOnDevice(const DevicePointView& points, const Control& control);
  ~SetsOnDevice();
  SetsOnDevice(const SetsOnDevice&) = delete;
  SetsOnDevice& operator=(const SetsOnDevice&) = delete;

  /// A copy of offsets, wherever they lie.
  std::vector<std::uint64_t> fetch_offsets(const std::uint64_t* offsets, std::uint64_t count) const;

  /// Hulls the sets [offsets[i], offsets[i + 1]), i < sets; what was found before is dropped.
  /// `offsets` must stay. Throws OutOfMemory, Failure.
  void find(const std::uint64_t* offsets, std::uint32_t sets);
  /// Nothing is found of these sets.
  void find_nothing(const std::uint64_t* offsets, std::uint32_t sets);
  /// Numbers of the sets of which nothing was found, ascending.
  std::vector<std::uint32_t> open_sets() const;
  /// Throws OutOfMemory, Failure.
  FoundLists fetch() const;
  /// The points of these sets. Packed points need no memory of the device where it is full.
  SetRows fetch_rows(const std::vector<std::uint32_t>& which) const;
  /// All sets' hulls on the device: what was found, and `rest`, the hulls of open_sets(). Throws
  /// OutOfMemory, Failure.
  DeviceHullBatch join(const HullBatch& rest) const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace cullhull::internal::inline cuda
