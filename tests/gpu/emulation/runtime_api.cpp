// The functions of CUDA's run-time library that the project calls, over the emulated devices.
#include <cuda_runtime_api.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <vector>

#include "device.hpp"
#include "emulation.hpp"
#include "memory.hpp"

struct CUmemPoolHandle_st {
  int device;
};
struct CUevent_st {
  std::shared_ptr<emulation::Mark> mark;  ///< null: not recorded
};

namespace {

using namespace emulation;

// Of an H100.
constexpr int multiprocessors = 132, shared_per_multiprocessor = 233472, shared_per_block = 232448;
constexpr int registers = 65536, resident_threads = 2048, assumed_registers = 64;

cudaError_t answer(cudaError_t error) {
  if (error != cudaSuccess) set_last_error(error);
  return error;
}

/// What every call that works on a device begins with.
cudaError_t state() {
  if (!settings().driver) return cudaErrorInsufficientDriver;
  return lasting_error();
}

template <class Work>
cudaError_t call(const Work& work) {
  const Lock lock(mutex());
  if (const cudaError_t error = state(); error != cudaSuccess) return answer(error);
  return answer(work());
}

/// The same for work on a stream.
template <class Work>
cudaError_t call_on(cudaStream_t stream, const Work& work) {
  return call([&] {
    const cudaError_t error = check_stream(stream);
    return error != cudaSuccess ? error : work();
  });
}

/// The device whose memory this is; an address of the host: the current one.
int device_of(const void* p) {
  const auto allocation = device_allocation(p);
  return allocation ? allocation->device : current_device();
}

/// Puts a copy on the stream. Unified addressing lets it name the memory of any device, also of
/// two others than the stream's.
void enqueue_copy(cudaStream_t stream, std::size_t bytes, void* to, const void* from,
                  std::shared_ptr<std::vector<char>> staged = nullptr) {
  const int devices[] = {device_of(to), device_of(from)};
  enqueue(stream, [=, staged = std::move(staged)] {
    const DeviceAccess access_to(devices[0]), access_from(devices[1]);
    std::memcpy(to, staged != nullptr ? staged->data() : from, bytes);
  });
}

void require_host(const void* p) {
  if (device_allocation(p)) violation("a host's address is a device's");
}

cudaError_t copy(void* to, const void* from, std::size_t bytes, cudaMemcpyKind kind,
                 cudaStream_t stream) {
  if (bytes == 0) return cudaSuccess;
  count_copy(stream, bytes, kind);
  if (kind == cudaMemcpyHostToDevice) {
    require_device_range(to, bytes, "a copy to the device");
    require_host(from);
    // Pageable memory is staged before the call returns; its way to the device is not done then.
    const auto* source = static_cast<const char*>(from);
    auto staged =
        is_pinned(from) ? nullptr : std::make_shared<std::vector<char>>(source, source + bytes);
    enqueue_copy(stream, bytes, to, from, std::move(staged));
  } else if (kind == cudaMemcpyDeviceToHost) {
    require_device_range(from, bytes, "a copy from the device");
    require_host(to);
    // To pageable memory a device copies before the call returns, which nobody should rely on.
    enqueue_copy(stream, bytes, to, from);
  } else {
    require_device_range(from, bytes, "a copy on the device");
    require_device_range(to, bytes, "a copy on the device");
    enqueue_copy(stream, bytes, to, from);
  }
  return cudaSuccess;
}

}  // namespace

extern "C" {

cudaError_t cudaGetLastError() { return take_last_error(); }
cudaError_t cudaPeekAtLastError() { return peek_last_error(); }
const char* cudaGetErrorString(cudaError_t error) {
  static thread_local char text[64];
  std::snprintf(text, sizeof text, "emulated error %d", static_cast<int>(error));
  return text;
}

cudaError_t cudaGetDeviceCount(int* count) {
  *count = settings().driver ? settings().devices : 0;
  if (!settings().driver) return answer(cudaErrorInsufficientDriver);
  return answer(*count == 0 ? cudaErrorNoDevice : cudaSuccess);
}
cudaError_t cudaDriverGetVersion(int* version) {
  *version = settings().driver ? CUDART_VERSION : 0;
  return cudaSuccess;
}
cudaError_t cudaRuntimeGetVersion(int* version) {
  *version = CUDART_VERSION;
  return cudaSuccess;
}
cudaError_t cudaGetDevice(int* device) {
  return call([&] {
    *device = current_device();
    return cudaSuccess;
  });
}
cudaError_t cudaSetDevice(int device) {
  return call([&] {
    if (device < 0 || device >= settings().devices) return cudaErrorInvalidDevice;
    set_current_device(device);
    return cudaSuccess;
  });
}
cudaError_t cudaGetDeviceProperties(cudaDeviceProp* properties, int device) {
  return call([&] {
    std::memset(properties, 0, sizeof *properties);
    std::snprintf(properties->name, sizeof properties->name, "emulated device");
    properties->totalGlobalMem = settings().memory;
    properties->multiProcessorCount = multiprocessors;
    properties->sharedMemPerMultiprocessor = shared_per_multiprocessor;
    properties->sharedMemPerBlockOptin = shared_per_block;
    properties->major = device == settings().unusable_device ? 6 : 9;
    return cudaSuccess;
  });
}
cudaError_t cudaDeviceSynchronize() {
  return call([] {
    count_wait();
    drain_device();
    return lasting_error();
  });
}

// ------------------------------------------------------------------------------- memory

cudaError_t cudaMemPoolCreate(cudaMemPool_t* pool, const cudaMemPoolProps* properties) {
  return call([&] {
    if (!settings().pools) return cudaErrorNotSupported;
    *pool = new CUmemPoolHandle_st{properties->location.id};
    return cudaSuccess;
  });
}
cudaError_t cudaMemPoolSetAttribute(cudaMemPool_t, cudaMemPoolAttr, void*) { return cudaSuccess; }
cudaError_t cudaMemPoolTrimTo(cudaMemPool_t, std::size_t) {
  count_trim();
  return cudaSuccess;
}
cudaError_t cudaMemPoolDestroy(cudaMemPool_t pool) {
  delete pool;
  return cudaSuccess;
}
cudaError_t cudaMalloc(void** memory, std::size_t bytes) {
  return call([&] {
    *memory = bytes == 0 ? nullptr : allocate_device(bytes, current_device(), true);
    return bytes == 0 || *memory != nullptr ? cudaSuccess : cudaErrorMemoryAllocation;
  });
}
cudaError_t cudaFree(void* memory) {
  return call([&] {
    if (memory == nullptr) return cudaSuccess;
    about_to_wait();
    drain_device();
    release_device(memory);
    return cudaSuccess;
  });
}
cudaError_t cudaMallocFromPoolAsync(void** memory, std::size_t bytes, cudaMemPool_t pool,
                                    cudaStream_t stream) {
  return call_on(stream, [&] {
    *memory = allocate_device(bytes, pool->device, false);
    if (*memory == nullptr) return cudaErrorMemoryAllocation;
    enqueue(
        stream, [block = *memory] { make_ready(block); }, false);
    return cudaSuccess;
  });
}
cudaError_t cudaFreeAsync(void* memory, cudaStream_t stream) {
  return call_on(stream, [&] {
    enqueue(
        stream, [memory] { release_device(memory); }, false);
    return cudaSuccess;
  });
}
cudaError_t cudaMallocHost(void** memory, std::size_t bytes) {
  return call([&] {
    *memory = nullptr;
    if (!count_pinned()) return cudaErrorMemoryAllocation;
    if (bytes == 0) return cudaErrorInvalidValue;
    *memory = allocate_pinned(bytes);
    return *memory != nullptr ? cudaSuccess : cudaErrorMemoryAllocation;
  });
}
cudaError_t cudaFreeHost(void* memory) {
  const Lock lock(mutex());
  if (memory != nullptr) release_pinned(memory);
  return cudaSuccess;
}

// ------------------------------------------------------------------------------- copies

cudaError_t cudaMemcpyAsync(void* to, const void* from, std::size_t bytes, cudaMemcpyKind kind,
                            cudaStream_t stream) {
  return call_on(stream, [&] { return copy(to, from, bytes, kind, stream); });
}
cudaError_t cudaMemcpy(void* to, const void* from, std::size_t bytes, cudaMemcpyKind kind) {
  return call_on(nullptr, [&] {
    const cudaError_t error = copy(to, from, bytes, kind, nullptr);
    // From pageable memory to a device it returns once the bytes are staged.
    if (kind != cudaMemcpyHostToDevice || is_pinned(from)) {
      about_to_wait();
      drain(nullptr);
    }
    return error;
  });
}
cudaError_t cudaMemsetAsync(void* to, int value, std::size_t bytes, cudaStream_t stream) {
  return call_on(stream, [&] {
    if (bytes == 0) return cudaSuccess;
    require_device_range(to, bytes, "clearing");
    enqueue(stream, [=, device = device_of(to)] {
      const DeviceAccess access(device);
      std::memset(to, value, bytes);
    });
    return cudaSuccess;
  });
}
cudaError_t cudaMemset(void* to, int value, std::size_t bytes) {
  return cudaMemsetAsync(to, value, bytes, nullptr);
}

// ------------------------------------------------------------------------------- streams

cudaError_t cudaStreamCreateWithFlags(cudaStream_t* stream, unsigned flags) {
  return call([&] {
    *stream = create_stream((flags & cudaStreamNonBlocking) == 0);
    return cudaSuccess;
  });
}
cudaError_t cudaStreamDestroy(cudaStream_t stream) {
  return call([&] {
    destroy_stream(stream);
    return cudaSuccess;
  });
}
cudaError_t cudaStreamSynchronize(cudaStream_t stream) {
  return call_on(stream, [&] {
    if (stream != nullptr && stream == settings().captured_stream)
      violation("a stream that is being captured is waited for");
    count_wait();
    drain(stream);
    return lasting_error();
  });
}
cudaError_t cudaStreamIsCapturing(cudaStream_t stream, cudaStreamCaptureStatus* status) {
  return call_on(stream, [&] {
    *status = stream != nullptr && stream == settings().captured_stream
                  ? cudaStreamCaptureStatusActive
                  : cudaStreamCaptureStatusNone;
    return cudaSuccess;
  });
}
cudaError_t cudaStreamQuery(cudaStream_t stream) {
  return call_on(stream, [&] { return idle(stream) ? cudaSuccess : cudaErrorNotReady; });
}

// -------------------------------------------------------------------------------- events

// Time does not pass here: an event is a place in the order of a stream, to wait for.
cudaError_t cudaEventCreate(cudaEvent_t* event) {
  *event = new CUevent_st;
  return cudaSuccess;
}
cudaError_t cudaEventCreateWithFlags(cudaEvent_t* event, unsigned) {
  return cudaEventCreate(event);
}
cudaError_t cudaEventDestroy(cudaEvent_t event) {
  delete event;
  return cudaSuccess;
}
cudaError_t cudaEventRecord(cudaEvent_t event, cudaStream_t stream) {
  return call_on(stream, [&] {
    event->mark = mark(stream);
    return cudaSuccess;
  });
}
// Where nothing was submitted after the event, the device stops.
cudaError_t cudaEventSynchronize(cudaEvent_t event) {
  return call([&] {
    if (event->mark == nullptr || event->mark->reached) return cudaSuccess;
    if (is_last(*event->mark))
      count_wait();
    else
      count_look();
    drain_to(*event->mark);
    return lasting_error();
  });
}
cudaError_t cudaStreamWaitEvent(cudaStream_t stream, cudaEvent_t event, unsigned) {
  return call_on(stream, [&] {
    if (event->mark != nullptr)
      enqueue(
          stream, [mark = event->mark] { drain_to(*mark); }, false);
    return cudaSuccess;
  });
}
cudaError_t cudaEventElapsedTime(float* milliseconds, cudaEvent_t, cudaEvent_t) {
  *milliseconds = 1;
  return cudaSuccess;
}

// --------------------------------------------------------------- pointers and functions

cudaError_t cudaPointerGetAttributes(cudaPointerAttributes* attributes, const void* p) {
  return call([&] {
    std::memset(attributes, 0, sizeof *attributes);
    const auto allocation = device_allocation(p);
    attributes->type = allocation     ? cudaMemoryTypeDevice
                       : is_pinned(p) ? cudaMemoryTypeHost
                                      : cudaMemoryTypeUnregistered;
    attributes->device = allocation ? allocation->device : -2;
    return cudaSuccess;
  });
}
cudaError_t cudaFuncGetAttributes(cudaFuncAttributes* attributes, const void*) {
  std::memset(attributes, 0, sizeof *attributes);
  return cudaSuccess;
}
cudaError_t cudaFuncSetAttribute(const void* function, cudaFuncAttribute attribute, int value) {
  return call([&] {
    if (attribute == cudaFuncAttributePreferredSharedMemoryCarveout)
      return value < -1 || value > 100 ? cudaErrorInvalidValue : cudaSuccess;
    const long most = settings().most_dynamic_shared;
    if (value < 0 || value > (most >= 0 ? most : shared_per_block)) return cudaErrorInvalidValue;
    allow_dynamic_shared(function, static_cast<std::size_t>(value));
    return cudaSuccess;
  });
}
cudaError_t cudaOccupancyMaxActiveBlocksPerMultiprocessor(int* blocks, const void*, int threads,
                                                          std::size_t shared) {
  constexpr std::size_t shared_of_system = 1024;
  const int by_shared = static_cast<int>(shared_per_multiprocessor / (shared + shared_of_system));
  *blocks =
      std::min({resident_threads / threads, registers / (assumed_registers * threads), by_shared});
  return cudaSuccess;
}
cudaError_t cudaOccupancyMaxActiveBlocksPerMultiprocessorWithFlags(int* blocks,
                                                                   const void* function,
                                                                   int threads, std::size_t shared,
                                                                   unsigned) {
  return cudaOccupancyMaxActiveBlocksPerMultiprocessor(blocks, function, threads, shared);
}

}  // extern "C"
