// For tests that need a CUDA device: whether there is one, and points in its memory.
#pragma once

#include <cuda_runtime_api.h>
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdlib>
#include <cstring>
#include <stdexcept>
#include <string>
#include <vector>

#include "cullhull/device_points.hpp"
#include "cullhull/point_view.hpp"

namespace cullhull::testing {

/// Empty if there is a device; else why there is none.
inline std::string no_device() {
  const CudaStatus status = cuda_status();
  return status.available ? "" : status.reason;
}

/// The first line of every test of a device.
#define CULLHULL_NEEDS_DEVICE()                                             \
  if (const std::string why = cullhull::testing::no_device(); !why.empty()) \
  GTEST_SKIP() << "needs a CUDA device: " << why

/// Under a checker of memory accesses every launch takes milliseconds, on an emulated device every
/// point a microsecond: fewer and smaller cases.
inline bool short_run() {
  const char* wanted = std::getenv("CULLHULL_GPU_TESTS");
  return wanted != nullptr && std::strcmp(wanted, "short") == 0;
}

inline void check(cudaError_t error) {
  if (error != cudaSuccess) throw std::runtime_error(cudaGetErrorString(error));
}

/// A stream of its own, so that nothing is ordered by the default one by chance.
class Stream {
 public:
  Stream() { check(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking)); }
  ~Stream() { (void)cudaStreamDestroy(stream_); }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  operator cudaStream_t() const { return stream_; }

 private:
  cudaStream_t stream_ = nullptr;
};

/// A copy of some bytes in the device's memory, exactly as long, so that a checker sees every step
/// beyond.
class OnDevice {
 public:
  template <class T>
  explicit OnDevice(const std::vector<T>& host) {
    check(cudaMalloc(&data_, host.size() * sizeof(T) + (host.empty() ? 1 : 0)));
    check(cudaMemcpy(data_, host.data(), host.size() * sizeof(T), cudaMemcpyHostToDevice));
    // From pageable memory that returns once the bytes are staged, and the streams of the tests do
    // not wait for the default stream, which brings them to the device.
    check(cudaDeviceSynchronize());
    host_ = reinterpret_cast<const std::byte*>(host.data());
  }
  ~OnDevice() { (void)cudaFree(data_); }
  OnDevice(const OnDevice&) = delete;
  OnDevice& operator=(const OnDevice&) = delete;

  /// The same view, over the copy.
  DevicePointView view(const PointView& of_host, cudaStream_t stream) const {
    return {static_cast<const std::byte*>(data_) + (of_host.data - host_),
            of_host.scalar,
            of_host.dimension,
            of_host.count,
            of_host.point_stride,
            of_host.coordinate_stride,
            stream};
  }
  template <class T>
  T* data() const {
    return static_cast<T*>(data_);
  }

 private:
  void* data_ = nullptr;
  const std::byte* host_ = nullptr;
};

}  // namespace cullhull::testing
