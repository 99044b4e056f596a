// Whether the CUDA backend can be used, for code that is compiled with and without it.
#pragma once

#include "cullhull/device_points.hpp"

namespace cullhull::internal {

#ifdef CULLHULL_HAVE_CUDA
inline constexpr bool cuda_compiled = true;
#else
inline constexpr bool cuda_compiled = false;
#endif

/// Throws Error{backend_unavailable} with the reason unless `Backend::cuda` can be used.
void require_cuda();

/// Whether a device has been used in this process already, so that asking for it costs no time.
bool cuda_started() noexcept;

/// Whether this machine looks as if it had a device: a glance, which decides nothing but what is
/// said.
bool cuda_in_sight() noexcept;

}  // namespace cullhull::internal
