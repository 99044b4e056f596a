#pragma once
#include <cuda_runtime.h>
#include <cstddef>
#include <new>
#include <string>
#include <utility>
#include "cullhull/error.hpp"
namespace cullhull::internal {
inline void cuda_check(cudaError_t e, const char* what) {
  if (e != cudaSuccess) throw Error(ErrorCode::internal, std::string(what) + ": " + cudaGetErrorString(e));
}
inline unsigned cuda_processors() {
  int device = 0, n = 0;
  cuda_check(cudaGetDevice(&device), "x");
  cuda_check(cudaDeviceGetAttribute(&n, cudaDevAttrMultiProcessorCount, device), "x");
  return static_cast<unsigned>(n);
}
template <class T>
class CudaArray {
 public:
  CudaArray() = default;
  CudaArray(CudaArray&& o) noexcept { swap(o); }
  CudaArray& operator=(CudaArray&& o) noexcept { swap(o); return *this; }
  ~CudaArray() { release(); }
  T* reserve(std::size_t count, cudaStream_t stream) {
    if (count <= capacity_) return data_;
    release();
    stream_ = stream;
    void* p = nullptr;
    cuda_check(cudaMallocAsync(&p, count * sizeof(T), stream), "allocating");
    data_ = static_cast<T*>(p);
    capacity_ = count;
    return data_;
  }
  T* data() { return data_; }
  const T* data() const { return data_; }
 private:
  void swap(CudaArray& o) noexcept { std::swap(data_, o.data_); std::swap(capacity_, o.capacity_); std::swap(stream_, o.stream_); }
  void release() noexcept { if (data_) cudaFreeAsync(data_, stream_); data_ = nullptr; capacity_ = 0; }
  T* data_ = nullptr;
  std::size_t capacity_ = 0;
  cudaStream_t stream_ = nullptr;
};
}
