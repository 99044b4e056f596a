// The interface between the CUDA backend and the rest of the library, without CUDA's headers.
// Builds with CUDA implement it in backend.cpp and the files next to it, other builds in
// not_compiled.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/point_view.hpp"
#include "filter/gauge/gauge_map.hpp"

namespace cullhull::internal {

/// Throws Error{backend_unavailable} with the reason unless `Backend::cuda` can be used on this
/// device (-1: the current device).
void require_cuda(int device = -1);

/// Whether this process has used a device before, so that using one has no start-up cost.
bool cuda_started() noexcept;

/// Bytes of unused pinned memory that are kept between calls.
std::size_t kept_pinned_memory() noexcept;
/// Frees that memory, and what the pools of the devices keep. Starts no device.
void drop_device_memory() noexcept;
/// Whether this machine seems to have a CUDA device: a quick check that affects only messages.
bool cuda_in_sight() noexcept;

/// CUDA cannot be used: there is no driver, it is too old, there is no device, or a launch failed.
/// The caller should use the CPU.
class Failure : public Error {
 public:
  explicit Failure(const std::string& message) : Error(ErrorCode::backend_unavailable, message) {}
};

/// The device's memory or pinned memory is exhausted. The caller should use smaller pieces or the
/// CPU.
class OutOfMemory : public Error {
 public:
  explicit OutOfMemory(const std::string& message) : Error(ErrorCode::out_of_budget, message) {}
};

/// The greatest number of nodes of a map with which a multiprocessor of this device (-1: the
/// current device) runs two blocks of the kernel at a time and keeps a quarter of its memory as
/// cache for the points (bench/notes/gpu.md).
std::uint32_t most_map_nodes(int device = -1);

/// The ids, ascending, of the points in the host's memory that the map does not discard. Filters on
/// the device that the options name: all points at once or, where it has not the memory, in pieces.
/// Throws OutOfMemory, Failure, Error{cancelled}.
Array<std::uint64_t> survivors_there(const GaugeTable& map, const PointView& points,
                                     const Run& run);

}  // namespace cullhull::internal
