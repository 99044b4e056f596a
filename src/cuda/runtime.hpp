// Wrappers of CUDA's run-time library: errors become exceptions (OutOfMemory and
// Failure of backend.hpp), and memory and streams have destructors. Only in builds with CUDA;
// the file contains no kernel, so plain C++ may include it. A failed kernel destroys the process's
// context (a "sticky" error). The library remembers that, and every later call reports it at once.
#pragma once

#include <cuda_runtime_api.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "cuda/backend.hpp"
#include "cullhull/array.hpp"
#include "cullhull/options.hpp"
#include "filter/pseudo_hull/primitives.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

/// Throws OutOfMemory or Failure unless `status` is cudaSuccess. `doing` completes the message
/// "CUDA failed ...".
void check(cudaError_t status, const char* doing);

/// Properties of a device that can be used. Sizes are in bytes.
struct Device {
  int ordinal = 0;
  std::string name;
  int capability = 0;  ///< compute capability; 90 for 9.0
  std::uint64_t memory = 0;
  unsigned multiprocessors = 1;
  std::size_t shared_per_multiprocessor = 0;
  std::size_t shared_per_block = 0;  ///< greatest size that a kernel may opt in to
  cudaMemPool_t pool = nullptr;      ///< null: the device cannot allocate in stream order
};

/// The current device. Each device is queried once. Throws Failure with the reason if it cannot be
/// used.
const Device& this_device();
/// The same for the device with this number.
const Device& device(int ordinal);
inline const Device& device_or_current(int ordinal) {
  return ordinal < 0 ? this_device() : device(ordinal);
}

/// The devices that Options::device names, the first of which throws Failure if it cannot be used;
/// of every_device the others that can.
std::vector<int> devices_for(int option);

/// What DeviceScope does about an error of the run-time library that the caller has left unread.
enum class Unread {
  reported,  ///< throws Failure; the error stays unread, and the caller can still ask for it
  ignored,
};

/// A function of the driver; null if the process has not loaded the driver.
void* driver_function(const char* name) noexcept;

/// Makes a device current, and restores the former one when destroyed if that has a context, as
/// every device has that was chosen or used. Else the device stays current: a context would take
/// some hundred MB. Memory is allocated as `options` say; without them, as by the scope around.
class DeviceScope {
 public:
  explicit DeviceScope(int ordinal, Unread unread = Unread::reported);
  DeviceScope(int ordinal, const Options& options);
  ~DeviceScope();
  DeviceScope(const DeviceScope&) = delete;
  DeviceScope& operator=(const DeviceScope&) = delete;

 private:
  int before_ = -1;  ///< to be restored, and so the allocator
  std::shared_ptr<const DeviceAllocator> allocator_before_;
};

/// Frees memory of the current device in the order of the stream; ignores errors.
struct Release {
  std::size_t bytes = 0;
  cudaStream_t stream = nullptr;
  std::shared_ptr<const DeviceAllocator> to;  ///< null: the library's pool
  void operator()(void* memory) const noexcept;
};
using DeviceBlock = std::unique_ptr<void, Release>;
/// Allocates memory of the current device in the order of the stream, as the options say that the
/// innermost DeviceScope was given. Throws OutOfMemory, Failure.
DeviceBlock allocate(std::size_t bytes, cudaStream_t stream);

/// An array in the memory of the current device, allocated and freed in the order of a stream. Its
/// values are indeterminate until written.
template <class T>
class DeviceArray {
 public:
  DeviceArray() = default;
  DeviceArray(std::size_t count, cudaStream_t stream)
      : block_(allocate(count * sizeof(T), stream)), count_(count) {}

  T* data() const noexcept { return static_cast<T*>(block_.get()); }
  std::size_t size() const noexcept { return block_ == nullptr ? 0 : count_; }

 private:
  DeviceBlock block_;
  std::size_t count_ = 0;
};

/// Device memory whose contents are lost when it grows.
template <class T>
class CudaArray {
 public:
  T* reserve(std::size_t count, cudaStream_t stream) {
    if (count > items_.size()) {
      // Facets grow round by round: a quarter more than asked for, or every round would allocate.
      const std::size_t more = items_.size() == 0 ? count : count + count / 4;
      items_ = {};  // freed first, so that the two are never held at once
      items_ = DeviceArray<T>(more, stream);
    }
    return items_.data();
  }
  T* data() const { return items_.data(); }

 private:
  DeviceArray<T> items_;
};

/// Memory of the current device that may outlive the call and the stream; at least a byte.
std::shared_ptr<std::byte> result_memory(std::size_t bytes, cudaStream_t stream);

/// Pinned memory: host memory that the device can access. The system allocates it slowly, so freed
/// blocks are kept for later calls, up to a limit. No copy from or to a block may be in flight when
/// it is released.
void* allocate_pinned(std::size_t bytes);
void release_pinned(void* memory, std::size_t bytes) noexcept;

/// Pinned memory for so many items.
template <class T>
std::shared_ptr<T> pinned(std::size_t count) {
  const std::size_t bytes = count * sizeof(T);
  return {static_cast<T*>(allocate_pinned(bytes)), [bytes](T* p) { release_pinned(p, bytes); }};
}

/// Owns a stream or an event.
template <class Handle, auto create, auto destroy, unsigned flags>
class CudaHandle {
 public:
  CudaHandle() { check(create(&handle_, flags), "creating a stream or an event"); }
  CudaHandle(const CudaHandle&) = delete;
  CudaHandle& operator=(const CudaHandle&) = delete;
  ~CudaHandle() { (void)destroy(handle_); }
  Handle get() const noexcept { return handle_; }

 private:
  Handle handle_ = nullptr;
};
/// A stream that does not wait for the default stream.
using CudaStream =
    CudaHandle<cudaStream_t, cudaStreamCreateWithFlags, cudaStreamDestroy, cudaStreamNonBlocking>;
using CudaEvent =
    CudaHandle<cudaEvent_t, cudaEventCreateWithFlags, cudaEventDestroy, cudaEventDisableTiming>;

/// Orders what is submitted to a stream from now on after all work of `other`.
inline void run_after(cudaStream_t stream, cudaStream_t other) {
  const CudaEvent event;
  check(cudaEventRecord(event.get(), other), "recording an event");
  check(cudaStreamWaitEvent(stream, event.get(), 0), "waiting for an event");
}

/// Throws Failure if work on this stream is being captured into a graph: a call waits for results,
/// which would end the capture. Leaves the capture intact.
void refuse_capture(cudaStream_t stream);

/// Its destructor waits for the stream, so that no copy is in flight afterwards, even after an
/// exception.
class Settled {
 public:
  explicit Settled(cudaStream_t stream) : stream_(stream) {}
  ~Settled() { (void)cudaStreamSynchronize(stream_); }
  Settled(const Settled&) = delete;
  Settled& operator=(const Settled&) = delete;

 private:
  cudaStream_t stream_;
};

/// Waits for all work of a stream, and throws if any of it failed.
inline void synchronise(cudaStream_t stream, const char* doing) {
  check(cudaStreamSynchronize(stream), doing);
}

/// Copies from the host to the device, and returns when the copy is complete.
template <class T>
void upload(T* to, const T* from, std::size_t count, cudaStream_t stream) {
  if (count == 0) return;
  check(cudaMemcpyAsync(to, from, count * sizeof(T), cudaMemcpyHostToDevice, stream),
        "copying to the device");
  synchronise(stream, "copying to the device");
}

/// A copy of these items in the device's memory.
template <class Items>
auto uploaded(const Items& items, cudaStream_t stream) {
  DeviceArray<std::remove_cv_t<std::remove_reference_t<decltype(*items.data())>>> there(
      items.size(), stream);
  upload(there.data(), items.data(), items.size(), stream);
  return there;
}

/// Sets all bytes of items in the device's memory.
template <class T>
void fill(T* to, std::size_t count, int byte, cudaStream_t stream) {
  if (count == 0) return;
  check(cudaMemsetAsync(to, byte, count * sizeof(T), stream), "filling device memory");
}

/// Starts a copy from the device to the host. `to` may be read once the stream has been waited for.
template <class T>
void begin_download(T* to, const T* from, std::size_t count, cudaStream_t stream) {
  if (count == 0) return;
  check(cudaMemcpyAsync(to, from, count * sizeof(T), cudaMemcpyDeviceToHost, stream),
        "copying from the device");
}
/// The same, and returns when the copy is complete.
template <class T>
void download(T* to, const T* from, std::size_t count, cudaStream_t stream) {
  if (count == 0) return;
  begin_download(to, from, count, stream);
  synchronise(stream, "copying from the device");
}

/// Host memory for copies from the device: pinned or, if none is available, pageable.
template <class T>
std::shared_ptr<T> landing(std::size_t count) {
  try {
    return pinned<T>(count);
  } catch (const OutOfMemory&) {
    const auto pageable = std::make_shared<Array<T>>(count);
    return {pageable, pageable->data()};
  }
}

/// Bytes on their way to the host, which may wait for them alone: what is submitted to the stream
/// meanwhile goes on.
class Look {
 public:
  /// Of several transfers the bytes come one after another; where to is not read.
  Look(const std::vector<Transfer>& of, cudaStream_t stream);
  Look(const void* from, std::size_t bytes, cudaStream_t stream)
      : Look({{from, nullptr, bytes}}, stream) {}
  ~Look() { (void)cudaEventSynchronize(event_.get()); }  // no copy is in flight afterwards
  Look(const Look&) = delete;
  Look& operator=(const Look&) = delete;

  std::size_t bytes() const { return bytes_; }
  const std::byte* wait() const {
    check(cudaEventSynchronize(event_.get()), "copying from the device");
    return here_.get();
  }

 private:
  std::shared_ptr<std::byte> here_;
  std::size_t bytes_ = 0;
  CudaEvent event_;
};

/// Copies from the device by pinned memory, from which the threads of `run` copy, as the driver
/// copies to other memory at a tenth of the link's rate. While they copy a piece of 4 MiB, the link
/// carries the next one, so the device stops once, in the end.
void download_many(const std::vector<Transfer>& transfers, cudaStream_t stream, const Run& run);

/// Returns cudaSuccess if this build has code that the current device can run, else the error of
/// looking for a kernel.
cudaError_t probe_device_code();

}  // namespace cullhull::internal
