#include "cuda/runtime.hpp"

#include <dlfcn.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cstring>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <new>
#include <utility>

#include "cuda/reason.hpp"
#include "cullhull/device_points.hpp"
#include "parallel/threads/fork_guard.hpp"

namespace cullhull::internal {
namespace {

/// The sticky error that destroyed the context. It is never cleared, since only a new process
/// recovers.
std::atomic<const std::string*> poison{nullptr};

/// Guards the list of known devices, also while a device is queried.
std::mutex& devices_mutex() {
  static std::mutex& mutex = *new std::mutex;
  return mutex;
}

/// Never destroyed, since the devices' pools must outlive every array.
std::map<int, std::unique_ptr<Device>>& known_devices() {
  static std::map<int, std::unique_ptr<Device>>& known =
      *new std::map<int, std::unique_ptr<Device>>;
  return known;
}

const ForkGuard devices_guard(
    ForkGuard::Order::outer, [] { devices_mutex().lock(); }, [] { devices_mutex().unlock(); });

/// Whether an error is sticky: the documentation of the run-time library says that it leaves "the
/// process in an inconsistent state". Querying a stream again would not be a test, since default
/// streams return other errors while a graph is recorded.
bool sticky(cudaError_t error) {
  switch (error) {
    case cudaErrorIllegalAddress:
    case cudaErrorLaunchTimeout:
    case cudaErrorAssert:
    case cudaErrorHardwareStackError:
    case cudaErrorIllegalInstruction:
    case cudaErrorMisalignedAddress:
    case cudaErrorInvalidAddressSpace:
    case cudaErrorInvalidPc:
    case cudaErrorLaunchFailure:
    case cudaErrorContextIsDestroyed:
    case cudaErrorECCUncorrectable:
    case cudaErrorNvlinkUncorrectable:
    case cudaErrorExternalDevice:
    case cudaErrorUnknown:
      return true;
    default:
      return false;
  }
}

constexpr const char* capture_refused =
    "a CUDA graph is being captured from the stream of this call, which waits for its results and "
    "cannot be captured; make the call before or after the capture";

/// Whether an error says that a stream is being captured into a graph. The caller's stream is asked
/// before work is submitted to it (refuse_capture); the default stream reports the captures of
/// others.
bool of_capture(cudaError_t error) {
  return error >= cudaErrorStreamCaptureUnsupported && error <= cudaErrorStreamCaptureWrongThread;
}

std::atomic<bool> found_one{false};

/// That of the innermost DeviceScope; null: the library's pool.
thread_local std::shared_ptr<const DeviceAllocator> allocator;

/// The library's own, so that the device's default pool, which the caller may use, keeps its
/// settings. It keeps freed memory, so that the next call does not need the driver: 512 MiB suffice
/// for the mask and the survivors of 10^9 points.
cudaMemPool_t make_pool(int ordinal) {
  cudaMemPool_t pool = nullptr;
  cudaMemPoolProps properties = {};
  properties.allocType = cudaMemAllocationTypePinned;
  properties.location.type = cudaMemLocationTypeDevice;
  properties.location.id = ordinal;
  std::uint64_t keeps = std::uint64_t{512} << 20;
  if (cudaMemPoolCreate(&pool, &properties) != cudaSuccess ||
      cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &keeps) != cudaSuccess) {
    (void)cudaGetLastError();  // a device that has no pools falls back to cudaMalloc
    if (pool != nullptr) (void)cudaMemPoolDestroy(pool);
    return nullptr;
  }
  return pool;
}

Device query(int ordinal) {
  Probe probe;
  int count = 0;
  probe.error = cudaGetDeviceCount(&count);
  (void)cudaDriverGetVersion(&probe.driver_version);
  (void)cudaRuntimeGetVersion(&probe.runtime_version);
  if (probe.error == cudaSuccess) probe.devices = count;
  if (probe.error == cudaSuccess && count > 0 && ordinal >= count)
    throw Failure("there is no CUDA device " + std::to_string(ordinal) + ", only " +
                  std::to_string(count) + " numbered from 0");
  Device d;
  if (probe.error == cudaSuccess && ordinal < count) {
    const DeviceScope scope(ordinal, Unread::ignored);
    cudaDeviceProp properties = {};
    probe.error = cudaGetDeviceProperties(&properties, ordinal);
    d.name = properties.name;
    d.memory = properties.totalGlobalMem;
    d.multiprocessors = static_cast<unsigned>(properties.multiProcessorCount);
    d.shared_per_multiprocessor = properties.sharedMemPerMultiprocessor;
    d.shared_per_block = properties.sharedMemPerBlockOptin;
    d.capability = probe.capability = 10 * properties.major + properties.minor;
    probe.name = d.name;
    if (probe.error == cudaSuccess) probe.code_error = probe_device_code();
  }
  const std::string reason = unavailable_reason(probe);
  if (!reason.empty()) {
    (void)cudaGetLastError();
    throw Failure(reason);
  }
  d.ordinal = ordinal;
  d.pool = make_pool(ordinal);
  found_one = true;
  return d;
}

}  // namespace

void check(cudaError_t status, const char* doing) {
  if (status == cudaSuccess) return;
  const std::string text = std::string(cudaGetErrorString(status));
  (void)cudaGetLastError();  // clears the error, which the next launch would report otherwise
  if (sticky(status)) {
    const std::string* none = nullptr;
    auto why = std::make_unique<const std::string>(text);
    if (poison.compare_exchange_strong(none, why.get())) (void)why.release();
    throw Failure("CUDA failed " + std::string(doing) + ": " + text);
  }
  if (of_capture(status)) throw Failure(capture_refused);
  if (status == cudaErrorMemoryAllocation)
    throw OutOfMemory("the CUDA device ran out of memory " + std::string(doing) +
                      "; use the backend auto or cpu");
  throw Failure("CUDA failed " + std::string(doing) + ": " + text);
}

const Device& device(int ordinal) {
  if (const std::string* why = poison; why != nullptr)
    throw Failure("CUDA failed earlier in this process (" + *why +
                  ") and cannot be used until it is restarted");
  const std::lock_guard lock(devices_mutex());
  std::unique_ptr<Device>& d = known_devices()[ordinal];
  if (d == nullptr) d = std::make_unique<Device>(query(ordinal));
  return *d;
}

const Device& this_device() {
  int ordinal = 0;
  if (cudaGetDevice(&ordinal) != cudaSuccess) {
    (void)cudaGetLastError();
    ordinal = 0;  // no driver or no device: the query below tells which
  }
  return device(ordinal);
}

std::vector<int> devices_for(int option) {
  std::vector<int> all{device_or_current(option).ordinal};
  int count = 0;
  if (option != Options::every_device) return all;
  check(cudaGetDeviceCount(&count), "counting the devices");
  for (int other = 0; other < count; ++other) try {
      if (other != all[0]) all.push_back(device(other).ordinal);
    } catch (const Failure&) {
      // It cannot be used: the others are.
    }
  return all;
}

bool cuda_started() noexcept { return found_one; }

void* driver_function(const char* name) noexcept {
  void* const driver = ::dlopen("libcuda.so.1", RTLD_LAZY | RTLD_NOLOAD);
  if (driver == nullptr) return nullptr;
  void* const function = ::dlsym(driver, name);
  ::dlclose(driver);
  return function;
}

namespace {

/// Whether a device has a context. Choosing one that has none would make it, which takes some
/// hundred MB of its memory.
bool has_context(int ordinal) {
  // CUresult cuDevicePrimaryCtxGetState(CUdevice, unsigned*, int*)
  using GetState = int(int, unsigned*, int*);
  auto* const state = reinterpret_cast<GetState*>(driver_function("cuDevicePrimaryCtxGetState"));
  unsigned flags = 0;
  int active = 1;
  return state == nullptr || state(ordinal, &flags, &active) != 0 || active != 0;
}

}  // namespace

DeviceScope::DeviceScope(int ordinal, Unread unread) : allocator_before_(allocator) {
  // Such an error would be taken for that of the next launch. It is not cleared: it is the
  // caller's.
  if (const cudaError_t left = cudaPeekAtLastError();
      left != cudaSuccess && unread == Unread::reported && !sticky(left))
    throw Failure("an earlier CUDA call of this thread failed and nobody read its error (" +
                  std::string(cudaGetErrorString(left)) +
                  "); read it with cudaGetLastError before this call");
  int current = ordinal;
  check(cudaGetDevice(&current), "asking for the current device");
  if (current == ordinal) return;
  if (has_context(current)) before_ = current;
  check(cudaSetDevice(ordinal), "choosing the device");
}

void refuse_capture(cudaStream_t stream) {
  cudaStreamCaptureStatus status = cudaStreamCaptureStatusNone;
  check(cudaStreamIsCapturing(stream, &status), "asking for the state of a stream");
  if (status != cudaStreamCaptureStatusNone) throw Failure(capture_refused);
}

DeviceScope::DeviceScope(int ordinal, const Options& options) : DeviceScope(ordinal) {
  allocator = options.device_allocator;
}

DeviceScope::~DeviceScope() {
  allocator = std::move(allocator_before_);
  if (before_ >= 0) (void)cudaSetDevice(before_);
}

DeviceBlock allocate(std::size_t bytes, cudaStream_t stream) {
  if (bytes == 0) return {};
  void* memory = nullptr;
  cudaError_t status = cudaErrorMemoryAllocation;
  if (allocator == nullptr) {
    const cudaMemPool_t pool = this_device().pool;
    status = pool != nullptr ? cudaMallocFromPoolAsync(&memory, bytes, pool, stream)
                             : cudaMalloc(&memory, bytes);
  } else {
    try {
      memory = allocator->allocate(bytes, stream);
      if (memory != nullptr) status = cudaSuccess;
    } catch (const std::bad_alloc&) {
      // As if it had returned null.
    }
  }
  check(status, "allocating device memory");
  return {memory, {bytes, stream, allocator}};
}

void Release::operator()(void* memory) const noexcept {
  // Arrays are also destroyed while an exception is handled, so errors are ignored here.
  try {
    if (to != nullptr)
      to->deallocate(memory, bytes, stream);
    else
      (void)(this_device().pool != nullptr ? cudaFreeAsync(memory, stream) : cudaFree(memory));
  } catch (const Error&) {
    // The context is lost, and its memory with it.
  }
}

std::shared_ptr<std::byte> result_memory(std::size_t bytes, cudaStream_t stream) {
  DeviceBlock block = allocate(std::max<std::size_t>(bytes, 1), stream);
  Release release = block.get_deleter();
  release.stream = nullptr;  // the call's may have ended by then
  return {static_cast<std::byte*>(block.release()),
          [release, ordinal = this_device().ordinal](std::byte* memory) {
    try {
      const DeviceScope scope(ordinal, Unread::ignored);
      (void)cudaDeviceSynchronize();  // work on any stream may still read the memory
      release(memory);
    } catch (const Error&) {
      // The context is lost, and its memory with it.
    }
          }};
}

namespace {

/// The released blocks of pinned memory that are kept. Their sizes are powers of two.
class PinnedPool {
 public:
  void lock() { mutex_.lock(); }
  void unlock() { mutex_.unlock(); }
  void* take(std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    const auto block = free_.find(bytes);
    if (block == free_.end()) return nullptr;
    void* memory = block->second;
    free_.erase(block);
    kept_ -= bytes;
    return memory;
  }
  /// Keeps a block, or returns false if that would exceed the limit.
  bool keep(void* memory, std::size_t bytes) {
    const std::lock_guard lock(mutex_);
    if (kept_ + bytes > limit) return false;
    free_.emplace(bytes, memory);
    kept_ += bytes;
    return true;
  }
  std::size_t kept() {
    const std::lock_guard lock(mutex_);
    return kept_;
  }
  void drop() {
    std::multimap<std::size_t, void*> blocks;
    {
      const std::lock_guard lock(mutex_);
      blocks.swap(free_);
      kept_ = 0;
    }
    for (const auto& [bytes, memory] : blocks) (void)cudaFreeHost(memory);
  }

 private:
  /// Bytes. A call uses 16 MiB for points that it uploads, and some 40 for a batch's lists.
  static constexpr std::size_t limit = std::size_t{256} << 20;
  std::mutex mutex_;
  std::multimap<std::size_t, void*> free_;
  std::size_t kept_ = 0;
};

/// Never destroyed, since the driver may already be unloaded at the end of the process.
PinnedPool& pinned_pool() {
  static PinnedPool& pool = *new PinnedPool;
  return pool;
}

const ForkGuard pinned_guard(
    ForkGuard::Order::inner, [] { pinned_pool().lock(); }, [] { pinned_pool().unlock(); });

std::size_t pinned_block(std::size_t bytes) {
  return std::bit_ceil(std::max<std::size_t>(bytes, 4096));
}

}  // namespace

void* allocate_pinned(std::size_t bytes) {
  if (bytes == 0) return nullptr;
  const std::size_t block = pinned_block(bytes);
  if (void* memory = pinned_pool().take(block)) return memory;
  void* memory = nullptr;
  cudaError_t status = cudaMallocHost(&memory, block);
  if (status == cudaErrorMemoryAllocation && kept_pinned_memory() > 0) {
    (void)cudaGetLastError();
    pinned_pool().drop();
    status = cudaMallocHost(&memory, block);
  }
  check(status, "allocating pinned memory");
  return memory;
}

void release_pinned(void* memory, std::size_t bytes) noexcept {
  if (memory == nullptr) return;
  try {
    if (pinned_pool().keep(memory, pinned_block(bytes))) return;
  } catch (const std::exception&) {
    // The list could not grow: free the block instead.
  }
  (void)cudaFreeHost(memory);
}

Look::Look(const std::vector<Transfer>& of, cudaStream_t stream) {
  for (const Transfer& t : of) bytes_ += t.bytes;
  here_ = landing<std::byte>(bytes_);
  std::byte* to = here_.get();
  for (const Transfer& t : of) {
    begin_download(to, static_cast<const std::byte*>(t.from), t.bytes, stream);
    to += t.bytes;
  }
  (void)cudaEventRecord(event_.get(), stream);  // what fails here fails when it is waited for
}

void download_many(const std::vector<Transfer>& transfers, cudaStream_t stream, const Run& run) {
  constexpr std::size_t piece = std::size_t{4} << 20;
  struct Sent {
    std::vector<Transfer> parts;
    std::unique_ptr<const Look> look;
  };
  std::deque<Sent> sent;
  const auto land = [&] {
    run.check();
    const std::byte* from = sent.front().look->wait();
    for (const Transfer& t : sent.front().parts) {
      run.each(t.bytes, 8 * light_grain, [&](std::uint64_t begin, std::uint64_t end) {
        std::memcpy(static_cast<std::byte*>(t.to) + begin, from + begin, end - begin);
      });
      from += t.bytes;
    }
    sent.pop_front();
  };
  std::vector<Transfer> parts;
  std::size_t room = piece;
  const auto send = [&] {
    if (sent.size() == 2) land();
    sent.push_back({parts, std::make_unique<Look>(parts, stream)});
    parts.clear();
    room = piece;
  };
  for (Transfer rest : transfers)
    while (rest.bytes != 0) {
      const std::size_t n = std::min(room, rest.bytes);
      parts.push_back({rest.from, rest.to, n});
      rest = {static_cast<const std::byte*>(rest.from) + n, static_cast<std::byte*>(rest.to) + n,
              rest.bytes - n};
      room -= n;
      if (room == 0) send();
    }
  if (!parts.empty()) send();
  while (!sent.empty()) land();
}

std::size_t kept_pinned_memory() noexcept { return pinned_pool().kept(); }
void drop_device_memory() noexcept {
  pinned_pool().drop();
  const std::lock_guard lock(devices_mutex());
  for (const auto& [ordinal, device] : known_devices())
    if (device != nullptr && device->pool != nullptr) (void)cudaMemPoolTrimTo(device->pool, 0);
}

}  // namespace cullhull::internal

std::shared_ptr<void> cullhull::device_stream(int ordinal) {
  using namespace internal;
  static auto& idle = *new std::multimap<int, cudaStream_t>;  // under the lock of the devices
  const DeviceScope scope(device(ordinal).ordinal, Unread::ignored);
  cudaStream_t stream = nullptr;
  {
    const std::lock_guard lock(devices_mutex());
    if (const auto found = idle.find(ordinal); found != idle.end()) {
      stream = found->second;
      idle.erase(found);
    }
  }
  if (stream == nullptr)
    check(cudaStreamCreateWithFlags(&stream, cudaStreamNonBlocking), "creating a stream");
  return {stream, [ordinal](void* unused) {
            try {
              const std::lock_guard lock(devices_mutex());
              idle.emplace(ordinal, static_cast<cudaStream_t>(unused));
            } catch (const std::bad_alloc&) {
              (void)cudaStreamDestroy(static_cast<cudaStream_t>(unused));
            }
          }};
}
