#include "cuda/reason.hpp"

#include <cuda_runtime_api.h>

namespace cullhull::internal {
namespace {

std::string version(int v) {
  return std::to_string(v / 1000) + '.' + std::to_string(v % 1000 / 10);
}

}  // namespace

std::string unavailable_reason(const Probe& p) {
  if (p.driver_version == 0)
    return "no NVIDIA driver was found; install one, or use the backend auto or cpu";
  if (p.error == cudaErrorInsufficientDriver)
    return "the NVIDIA driver knows CUDA " + version(p.driver_version) +
           " and this build needs CUDA " + version(p.runtime_version) +
           "; update the driver, or use the backend auto or cpu";
  if (p.error == cudaErrorNoDevice || (p.error == cudaSuccess && p.devices == 0))
    return "no CUDA device was found; use the backend auto or cpu";
  if (p.error != cudaSuccess)
    return std::string("CUDA cannot be used: ") + cudaGetErrorString(p.error) +
           "; use the backend auto or cpu";
  if (p.capability < oldest_capability)
    return "the CUDA device " + p.name + " has compute capability " +
           std::to_string(p.capability / 10) + '.' + std::to_string(p.capability % 10) +
           " and 7.5 is needed; use the backend auto or cpu";
  if (p.code_error == cudaErrorNoKernelImageForDevice ||
      p.code_error == cudaErrorInvalidKernelImage ||
      p.code_error == cudaErrorUnsupportedPtxVersion || p.code_error == cudaErrorInvalidPtx ||
      p.code_error == cudaErrorInvalidDeviceFunction)
    return "this build has no code for the CUDA device " + p.name +
           "; configure with CULLHULL_CUDA_ARCHITECTURES=fat, or use the backend auto or cpu";
  if (p.code_error != cudaSuccess)
    return "the CUDA device " + p.name + " cannot be used: " + cudaGetErrorString(p.code_error) +
           "; use the backend auto or cpu";
  return "";
}

}  // namespace cullhull::internal
