// What the parts of the emulation share: the lock that makes one call at a time of them, streams,
// launches, errors that stay.
#pragma once

#include <cuda_runtime_api.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>

#include "emulation.hpp"

namespace emulation {

/// Held by every call of the run-time library.
using Lock = std::lock_guard<std::recursive_mutex>;
std::recursive_mutex& mutex();

int current_device();
void set_current_device(int device);

/// The error that every later call repeats, once a kernel has failed.
cudaError_t lasting_error();
void set_lasting_error(cudaError_t error);

bool may_allocate(std::size_t bytes);
/// Negative: a block was freed.
void count_allocation(std::ptrdiff_t bytes);
/// False: the test wants this allocation of pinned memory to fail.
bool count_pinned();
void count_copy(cudaStream_t stream, std::size_t bytes, cudaMemcpyKind kind);
void count_trim();
void count_wait();
void count_look();
/// What calls begin with that wait for work of a device: the test may want to know.
void about_to_wait();

// Streams. Null and cudaStreamLegacy are the current device's default stream, which waits for all
// blocking streams and they for it; cudaStreamPerThread is the calling thread's.
cudaStream_t create_stream(bool blocking);
void destroy_stream(cudaStream_t stream);
/// A violation for a stream that is not there; the error for one of another device, or the one
/// that the test wants of default streams.
cudaError_t check_stream(cudaStream_t stream);
void enqueue(cudaStream_t stream, std::function<void()> work, bool touches_memory = true);
/// Does all that is queued on the stream, and whatever must come before it.
void drain(cudaStream_t stream);
void drain_device();
bool idle(cudaStream_t stream);
/// A place in the order of a stream.
struct Mark {
  cudaStream_t stream;
  std::uint64_t work;  ///< before it
  bool reached;
};
std::shared_ptr<Mark> mark(cudaStream_t stream);
/// Whether no kernel and no long copy was submitted after it.
bool is_last(const Mark& mark);
/// Does what is queued before it.
void drain_to(const Mark& mark);

struct Launch {
  unsigned grid, block;
  std::size_t shared;
  cudaStream_t stream;
  const void* function;  ///< whose attributes hold, null: none were set
  const char* name;
};
/// As <<<...>>> does: errors are found by cudaGetLastError.
void submit(const Launch& launch, std::function<void()> body);
void allow_dynamic_shared(const void* function, std::size_t bytes);

void set_last_error(cudaError_t error);
cudaError_t take_last_error();
cudaError_t peek_last_error();

}  // namespace emulation
