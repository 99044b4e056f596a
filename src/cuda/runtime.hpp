// Wrappers of CUDA's run-time library: errors as exceptions, memory with destructors, the device.
// Compiled only where CUDA is; it contains no kernel, so plain C++ may include it. Failures are
// cuda::OutOfMemory or cuda::Failure (backend.hpp). A failed kernel breaks its process's context (a
// "sticky" error). This is remembered: every later call reports it at once instead of failing
// somewhere.
#pragma once

#include <cuda_runtime_api.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>

#include "cuda/backend.hpp"

namespace cullhull::internal::inline cuda {

/// Throws OutOfMemory or Failure unless `status` is success. `doing` completes "CUDA failed ...".
void check(cudaError_t status, const char* doing);

struct Device {
  int ordinal = 0;
  std::string name;
  int capability = 0;  ///< 90 for 9.0
  std::uint64_t memory = 0;
  unsigned multiprocessors = 1;
  std::size_t shared_per_multiprocessor = 0;
  std::size_t shared_per_block = 0;  ///< the most a kernel may opt in to
  cudaMemPool_t pool = nullptr;      ///< null: no stream-ordered allocation here
};

/// The current device, queried once; throws Failure with the reason if there is none to use.
const Device& device();
/// The same for the device with this number.
const Device& device(int ordinal);
inline const Device& device_or_current(int ordinal) {
  return ordinal < 0 ? device() : device(ordinal);
}

/// Whether some device was found usable before.
bool started() noexcept;

/// Makes a device current, and restores the former one at the end. At the beginning of a call it
/// clears an error that the caller left unread, as the next launch would report it.
class DeviceScope {
 public:
  explicit DeviceScope(int ordinal);
  ~DeviceScope();
  DeviceScope(const DeviceScope&) = delete;
  DeviceScope& operator=(const DeviceScope&) = delete;

 private:
  int before_ = 0;
};

void* allocate(std::size_t bytes, cudaStream_t stream);
void release(void* memory, cudaStream_t stream) noexcept;

/// Memory of the current device, in the order of a stream; contents undefined.
template <class T>
class DeviceArray {
 public:
  DeviceArray() = default;
  DeviceArray(std::size_t count, cudaStream_t stream)
      : data_(static_cast<T*>(allocate(count * sizeof(T), stream))),
        count_(count),
        stream_(stream) {}
  DeviceArray(DeviceArray&& other) noexcept { *this = std::move(other); }
  DeviceArray& operator=(DeviceArray&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(count_, other.count_);
    std::swap(stream_, other.stream_);
    return *this;
  }
  ~DeviceArray() { release(data_, stream_); }

  T* data() const noexcept { return data_; }
  std::size_t size() const noexcept { return count_; }

 private:
  T* data_ = nullptr;
  std::size_t count_ = 0;
  cudaStream_t stream_ = nullptr;
};

/// Host memory that the device can access. Allocating it takes the system long, so freed blocks are
/// kept for the next call, up to a limit. No copy from or to a block may be in flight when it is
/// freed.
void* allocate_pinned(std::size_t bytes);
void release_pinned(void* memory, std::size_t bytes) noexcept;
/// Bytes that are kept and free.
std::size_t kept_pinned() noexcept;
/// Returns them to the system.
void drop_kept_pinned() noexcept;

template <class T>
class PinnedArray {
 public:
  PinnedArray() = default;
  explicit PinnedArray(std::size_t count)
      : data_(static_cast<T*>(allocate_pinned(count * sizeof(T)))), count_(count) {}
  PinnedArray(PinnedArray&& other) noexcept { *this = std::move(other); }
  PinnedArray& operator=(PinnedArray&& other) noexcept {
    std::swap(data_, other.data_);
    std::swap(count_, other.count_);
    return *this;
  }
  ~PinnedArray() { release_pinned(data_, count_ * sizeof(T)); }

  T* data() const noexcept { return data_; }
  std::size_t size() const noexcept { return count_; }

 private:
  T* data_ = nullptr;
  std::size_t count_ = 0;
};

/// A stream that does not wait for the default stream.
class Stream {
 public:
  Stream() {
    check(cudaStreamCreateWithFlags(&stream_, cudaStreamNonBlocking), "creating a stream");
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;
  ~Stream() {
    if (stream_ != nullptr) (void)cudaStreamDestroy(stream_);
  }
  cudaStream_t get() const noexcept { return stream_; }

 private:
  cudaStream_t stream_ = nullptr;
};

inline void synchronise(cudaStream_t stream, const char* doing) {
  check(cudaStreamSynchronize(stream), doing);
}

/// Copies to the device. The host's memory may be reused when this returns.
template <class T>
void upload(T* to, const T* from, std::size_t count, cudaStream_t stream) {
  if (count == 0) return;
  check(cudaMemcpyAsync(to, from, count * sizeof(T), cudaMemcpyHostToDevice, stream),
        "copying to the device");
  synchronise(stream, "copying to the device");
}

/// Copies from the device; returns when the values have arrived.
template <class T>
void download(T* to, const T* from, std::size_t count, cudaStream_t stream) {
  if (count == 0) return;
  check(cudaMemcpyAsync(to, from, count * sizeof(T), cudaMemcpyDeviceToHost, stream),
        "copying from the device");
  synchronise(stream, "copying from the device");
}

/// Whether this build has code that the current device can run; the status of an empty kernel.
cudaError_t probe_device_code();

}  // namespace cullhull::internal::inline cuda
