#include "cuda/backend.hpp"

#include <unistd.h>

#include "cuda/runtime.hpp"
#include "cullhull/device_points.hpp"

namespace cullhull::internal {

void require_cuda(int device) { (void)device_or_current(device); }

// Checks for the device files of Linux, WSL and Jetson boards. Starting the driver would take
// longer than many hulls.
bool cuda_in_sight() noexcept {
  if (cuda_started()) return true;
  for (const char* file : {"/dev/nvidiactl", "/dev/dxg", "/dev/nvhost-ctrl-gpu"})
    if (::access(file, F_OK) == 0) return true;
  return false;
}

}  // namespace cullhull::internal

namespace cullhull {

int current_cuda_device() noexcept {
  int ordinal = -1;
  if (cudaGetDevice(&ordinal) == cudaSuccess) return ordinal;
  (void)cudaGetLastError();
  return -1;
}

// The run-time library's cudaGetDevice starts the driver. The driver's own functions do not, and a
// process that has not loaded it has chosen no device.
int chosen_cuda_device() noexcept {
  using GetDevice = int(int*);  // CUresult cuCtxGetDevice(CUdevice*)
  auto* const get_device =
      reinterpret_cast<GetDevice*>(internal::driver_function("cuCtxGetDevice"));
  int ordinal = -1;
  return get_device != nullptr && get_device(&ordinal) == 0 ? ordinal : -1;
}

void wait_for_cuda_stream(void* stream) {
  internal::require_cuda();
  internal::refuse_capture(static_cast<cudaStream_t>(stream));
  internal::synchronise(static_cast<cudaStream_t>(stream), "waiting for the caller's stream");
}

CudaStatus cuda_status() {
  CudaStatus status;
  status.compiled = true;
  try {
    const internal::Device& device = internal::this_device();
    status.available = true;
    status.device = device.name;
    status.compute_capability = device.capability;
    status.memory_bytes = device.memory;
  } catch (const Error& e) {
    status.reason = e.what();
  }
  (void)cudaDriverGetVersion(&status.driver_version);
  (void)cudaRuntimeGetVersion(&status.runtime_version);
  return status;
}

}  // namespace cullhull
