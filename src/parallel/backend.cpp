#include "parallel/backend.hpp"

#include <unistd.h>

#include "cullhull/error.hpp"
#ifdef CULLHULL_HAVE_CUDA
#include "cuda/runtime.hpp"
#endif

namespace cullhull {
namespace internal {

#ifdef CULLHULL_HAVE_CUDA
void require_cuda(int device) { (void)cuda::device_or_current(device); }
bool cuda_started() noexcept { return cuda::started(); }
std::size_t kept_pinned_memory() noexcept { return cuda::kept_pinned(); }
void drop_pinned_memory() noexcept { cuda::drop_kept_pinned(); }

// Without starting the driver, which takes longer than many a hull: its device files, on Linux, in
// Windows' subsystem for it, and on boards.
bool cuda_in_sight() noexcept {
  if (cuda_started()) return true;
  for (const char* file : {"/dev/nvidiactl", "/dev/dxg", "/dev/nvhost-ctrl-gpu"})
    if (::access(file, F_OK) == 0) return true;
  return false;
}
#else
void require_cuda(int) {
  throw Error(ErrorCode::backend_unavailable,
              "this build has no CUDA backend; use the backend auto or cpu");
}
bool cuda_started() noexcept { return false; }
std::size_t kept_pinned_memory() noexcept { return 0; }
void drop_pinned_memory() noexcept {}
bool cuda_in_sight() noexcept { return false; }
#endif

}  // namespace internal

int current_cuda_device() noexcept {
#ifdef CULLHULL_HAVE_CUDA
  int ordinal = -1;
  if (cudaGetDevice(&ordinal) == cudaSuccess) return ordinal;
  (void)cudaGetLastError();
#endif
  return -1;
}

void wait_for_cuda_stream(void* stream) {
  internal::require_cuda();
#ifdef CULLHULL_HAVE_CUDA
  internal::cuda::synchronise(static_cast<cudaStream_t>(stream), "waiting for the caller's stream");
#else
  (void)stream;
#endif
}

CudaStatus cuda_status() {
  CudaStatus status;
  status.compiled = internal::cuda_compiled;
  try {
    internal::require_cuda();
#ifdef CULLHULL_HAVE_CUDA
    const internal::cuda::Device& device = internal::cuda::device();
    status.available = true;
    status.device = device.name;
    status.compute_capability = device.capability;
    status.memory_bytes = device.memory;
#endif
  } catch (const Error& e) {
    status.reason = e.what();
  }
#ifdef CULLHULL_HAVE_CUDA
  (void)cudaDriverGetVersion(&status.driver_version);
  (void)cudaRuntimeGetVersion(&status.runtime_version);
#endif
  return status;
}

}  // namespace cullhull
