// Memory of a result on a device.
#pragma once

#include <cstddef>

#include "cuda/runtime.hpp"

namespace cullhull::internal {

/// Memory of the current device that may outlive the call and the stream.
class ResultMemory {
 public:
  ResultMemory(std::size_t bytes, cudaStream_t stream)
      : ordinal_(this_device().ordinal), data_(allocate(bytes, stream)) {}
  ~ResultMemory() {
    try {
      const DeviceScope scope(ordinal_, Unread::ignored);
      (void)cudaDeviceSynchronize();  // work on any stream may still read the memory
      release(data_, nullptr);
    } catch (const Error&) {
      // The context is lost, and its memory with it.
    }
  }
  ResultMemory(const ResultMemory&) = delete;
  ResultMemory& operator=(const ResultMemory&) = delete;
  std::byte* data() const { return static_cast<std::byte*>(data_); }
  int device() const { return ordinal_; }

 private:
  int ordinal_;
  void* data_;
};

}  // namespace cullhull::internal
