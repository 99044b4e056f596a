// What tests in Python call of the emulated device, by ctypes: memory, copies, streams, and how
// many calls of the run-time library have waited for the device, and how many of them with Python's
// interpreter lock held, while no other thread of Python can run.
#include <cuda_runtime_api.h>

#include <atomic>
#include <cstddef>

#include "emulation.hpp"

#define EXPORTED [[gnu::visibility("default")]]

extern "C" int PyGILState_Check(void);

namespace {

std::atomic<long> waits{0}, waits_with_lock{0};

}  // namespace

extern "C" {

EXPORTED void emulated_count_waits() {
  emulation::settings().at_wait = [] {
    ++waits;
    if (PyGILState_Check() != 0) ++waits_with_lock;
  };
}
EXPORTED long emulated_waits() { return waits; }
EXPORTED long emulated_waits_with_lock() { return waits_with_lock; }

EXPORTED void* emulated_allocate(std::size_t bytes) {
  void* memory = nullptr;
  return cudaMalloc(&memory, bytes) == cudaSuccess ? memory : nullptr;
}
EXPORTED void emulated_free(void* memory) { (void)cudaFree(memory); }
EXPORTED int emulated_upload(void* to, const void* from, std::size_t bytes, cudaStream_t stream) {
  return cudaMemcpyAsync(to, from, bytes, cudaMemcpyHostToDevice, stream);
}
/// Returns once the bytes are there.
EXPORTED int emulated_download(void* to, const void* from, std::size_t bytes, cudaStream_t stream) {
  const int error = cudaMemcpyAsync(to, from, bytes, cudaMemcpyDeviceToHost, stream);
  return error != cudaSuccess ? error : static_cast<int>(cudaStreamSynchronize(stream));
}
EXPORTED cudaStream_t emulated_stream() {
  cudaStream_t stream = nullptr;
  (void)cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking);
  return stream;
}
/// What is put on `stream` from now on waits for all that `other` has to do.
EXPORTED int emulated_order(cudaStream_t stream, cudaStream_t other) {
  cudaEvent_t event = nullptr;
  int error = cudaEventCreateWithFlags(&event, cudaEventDisableTiming);
  if (error == cudaSuccess) error = cudaEventRecord(event, other);
  if (error == cudaSuccess) error = cudaStreamWaitEvent(stream, event, 0);
  (void)cudaEventDestroy(event);
  return error;
}
}
