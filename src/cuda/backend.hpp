// What the rest of the library asks of the CUDA backend, without a header of CUDA's: backend.cpp
// and its neighbours answer where it is compiled, not_compiled.cpp elsewhere.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "cull/gauge_map.hpp"
#include "cullhull/error.hpp"
#include "cullhull/point_view.hpp"
#include "parallel/control.hpp"

namespace cullhull::internal {

/// Throws Error{backend_unavailable} with the reason unless `Backend::cuda` can be used on this
/// device; -1: the current one.
void require_cuda(int device = -1);

/// Whether a device has been used in this process already, so that asking for it costs no time.
bool cuda_started() noexcept;

/// Bytes of pinned memory that are kept between calls, and giving them back.
std::size_t kept_pinned_memory() noexcept;
void drop_pinned_memory() noexcept;
/// Whether this machine looks as if it had a device: a glance, which decides nothing but what is
/// said.
bool cuda_in_sight() noexcept;

namespace cuda {

/// No driver, an old one, no device, a failed launch: use the CPU.
class Failure : public Error {
 public:
  explicit Failure(const std::string& message) : Error(ErrorCode::backend_unavailable, message) {}
};

/// The device (or pinned memory) is full: take smaller pieces, or the CPU.
class OutOfMemory : public Error {
 public:
  explicit OutOfMemory(const std::string& message) : Error(ErrorCode::out_of_budget, message) {}
};

/// Nodes of a map that this device (-1: the current one) can hold close by.
std::uint32_t most_map_nodes(int device);

/// What the map keeps of points in the host's memory, culled on this device. Throws OutOfMemory,
/// Failure, Error{cancelled}.
std::vector<std::uint64_t> survivors_there(const GaugeMap& map, const PointView& points, int device,
                                           unsigned threads, const Control& control);

}  // namespace cuda
}  // namespace cullhull::internal
