// The interface of the CUDA backend for the rest of the library, without CUDA's headers:
// implemented by backend.cpp and its neighbours where CUDA is compiled, by not_compiled.cpp
// elsewhere.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/point_view.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline cuda {

/// Throws Error{backend_unavailable} with the reason unless `Backend::cuda` can be used on this
/// device; -1: the current one.
void require_cuda(int device = -1);

/// Whether a device was used in this process before, so that using it has no start-up cost.
bool cuda_started() noexcept;

/// Bytes of pinned memory that are kept between calls; and a function that frees them.
std::size_t kept_pinned_memory() noexcept;
void drop_pinned_memory() noexcept;
/// Whether this machine seems to have a device: a quick check that only affects messages.
bool cuda_in_sight() noexcept;

/// No driver, an old one, no device, a failed launch: the caller should use the CPU.
class Failure : public Error {
 public:
  explicit Failure(const std::string& message) : Error(ErrorCode::backend_unavailable, message) {}
};

/// The device (or pinned memory) is full: the caller should take smaller pieces, or the CPU.
class OutOfMemory : public Error {
 public:
  explicit OutOfMemory(const std::string& message) : Error(ErrorCode::out_of_budget, message) {}
};

/// The most nodes of a map that fit this device's shared memory (-1: the current device).
std::uint32_t most_map_nodes(int device);

/// What the map keeps of points in the host's memory, culled on the options' device. Throws
/// OutOfMemory, Failure, Error{cancelled}.
std::vector<std::uint64_t> survivors_there(const GaugeMap& map, const PointView& points,
                                           const Run& run);

}  // namespace cullhull::internal::inline cuda
