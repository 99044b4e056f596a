// An empty kernel, launched to learn whether this build has code for a device.
#include "cuda/runtime.hpp"

namespace cullhull::internal {
namespace {

__global__ void do_nothing() {}

}  // namespace

cudaError_t probe_device_code() {
  cudaFuncAttributes attributes;
  return cudaFuncGetAttributes(&attributes, reinterpret_cast<const void*>(&do_nothing));
}

}  // namespace cullhull::internal
