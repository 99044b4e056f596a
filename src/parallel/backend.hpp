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

}  // namespace cullhull::internal
