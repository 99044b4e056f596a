// Whether the CUDA backend can be used, for code that is compiled with and without it.
#pragma once

#include "cullhull/device_points.hpp"

namespace cullhull::internal {

#ifdef CULLHULL_HAVE_CUDA
inline constexpr bool cuda_compiled = true;
#else
inline constexpr bool cuda_compiled = false;
#endif

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

}  // namespace cullhull::internal
