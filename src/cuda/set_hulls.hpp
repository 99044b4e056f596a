// The hulls of many small sets of points on a device: the interface for host code, without CUDA's
// headers. Builds with CUDA implement it in set_hulls.cpp, others in not_compiled.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "cullhull/device_batch.hpp"
#include "cullhull/point_view.hpp"

namespace cullhull::internal {

struct Run;
/// The hulls that a device has found, in the host's memory, one set after another. A set whose hull
/// the device could not decide has empty lists.
struct FoundLists {
  std::vector<std::uint64_t> vertex_at, simplex_at;  ///< offsets, one more than sets
  const std::uint16_t* vertices = nullptr;           ///< numbers within the set, ascending
  const std::uint16_t* simplices = nullptr;          ///< in 3D: three numbers each
  const std::byte* rows = nullptr;                   ///< the vertices' rows, in the points' scalar
  std::shared_ptr<const void> memory;                ///< owns what the pointers refer to
};

/// The points of some sets in the host's memory. Set k has the rows [starts[k], starts[k + 1]).
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

/// Computes the hulls of the sets of one call on the device that holds their points, which is
/// current for its thread from creation to destruction.
class SetsOnDevice {
 public:
  SetsOnDevice() = default;
  virtual ~SetsOnDevice() = default;
  SetsOnDevice(const SetsOnDevice&) = delete;
  SetsOnDevice& operator=(const SetsOnDevice&) = delete;

  /// Copies offsets, from the memory of the host or of a device, to the host.
  virtual std::vector<std::uint64_t> fetch_offsets(const std::uint64_t* from,
                                                   std::uint64_t number) const = 0;

  /// Finds the hulls of the sets [offsets[i], offsets[i + 1]), i < sets, and forgets those found
  /// before. Returns when the work is queued: open_sets() and fetch() wait for it. `offsets`, in
  /// the host's memory, must stay valid until the next call of find() or find_nothing().
  /// `measured`: also measures them, for join(); sets that this leaves uncertain are open. Throws
  /// OutOfMemory, Failure.
  virtual void find(const std::uint64_t* offsets, std::uint32_t sets, bool measured) = 0;
  /// Takes these sets without computing hulls: all of them are open.
  virtual void find_nothing(const std::uint64_t* offsets, std::uint32_t sets) = 0;
  /// The numbers of the open sets, ascending: those whose hulls the device has not found.
  virtual std::vector<std::uint32_t> open_sets() = 0;
  /// Starts to copy the hulls found to the host. The lists may be read, and sets found anew, after
  /// settle(). Throws OutOfMemory, Failure.
  virtual FoundLists fetch() = 0;
  /// Waits for these copies. Throws Failure.
  virtual void settle() = 0;
  /// Copies the points of these sets to the host. If the device's memory is exhausted, packed
  /// points are copied without additional memory.
  virtual SetRows fetch_rows(const std::vector<std::uint32_t>& which) const = 0;
  /// Makes the result on the device from the hulls found and from `rest`, the hulls of open_sets().
  /// Planes and measures need hulls that are `measured`. Throws OutOfMemory, Failure,
  /// Error{invalid_argument} for a set that does not fit the padded shape.
  virtual DeviceHullBatch join(const HullBatch& rest, const DeviceBatchOptions& wanted) const = 0;
};

/// Throws Failure if there is no device, and Error{invalid_argument} for memory that the device
/// cannot read.
std::unique_ptr<SetsOnDevice> sets_on_device(const DevicePointView& points, const Run& run);

}  // namespace cullhull::internal
