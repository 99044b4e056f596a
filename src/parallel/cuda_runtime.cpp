#include "parallel/cuda_runtime.hpp"

#include <atomic>
#include <map>
#include <memory>
#include <mutex>

#include "parallel/cuda_reason.hpp"

namespace cullhull::internal::cuda {
namespace {

/// What broke the context, if anything did; never cleared, as nothing but a new process helps.
class Poison {
 public:
  void set(const std::string& why) {
    const std::lock_guard lock(mutex_);
    if (why_.empty()) why_ = why;
  }
  std::string get() {
    const std::lock_guard lock(mutex_);
    return why_;
  }

 private:
  std::mutex mutex_;
  std::string why_;
};

Poison& poison() {
  static Poison p;
  return p;
}

/// An error that stays: even asking a stream repeats it. (With hardly any memory left the question
/// itself may fail for want of it.)
bool sticky() {
  (void)cudaGetLastError();
  const cudaError_t again = cudaStreamQuery(nullptr);
  (void)cudaGetLastError();
  return again != cudaSuccess && again != cudaErrorNotReady && again != cudaErrorMemoryAllocation;
}

std::atomic<bool> found_one{false};

/// A pool of ours, so that the caller's is left as it is. What was freed stays with the pool up to
/// this size: the next call need not ask the driver.
constexpr std::uint64_t pool_keeps = std::uint64_t{512} << 20;

cudaMemPool_t make_pool(int ordinal) {
  int supported = 0;
  cudaMemPool_t pool = nullptr;
  cudaMemPoolProps properties = {};
  properties.allocType = cudaMemAllocationTypePinned;
  properties.location.type = cudaMemLocationTypeDevice;
  properties.location.id = ordinal;
  std::uint64_t keeps = pool_keeps;
  if (cudaDeviceGetAttribute(&supported, cudaDevAttrMemoryPoolsSupported, ordinal) != cudaSuccess ||
      supported == 0 || cudaMemPoolCreate(&pool, &properties) != cudaSuccess ||
      cudaMemPoolSetAttribute(pool, cudaMemPoolAttrReleaseThreshold, &keeps) != cudaSuccess) {
    (void)cudaGetLastError();  // cudaMalloc will do
    if (pool != nullptr) (void)cudaMemPoolDestroy(pool);
    return nullptr;
  }
  return pool;
}

int attribute(cudaDeviceAttr which, int ordinal) {
  int value = 0;
  check(cudaDeviceGetAttribute(&value, which, ordinal), "asking the device");
  return value;
}

Device query(int ordinal) {
  Probe probe;
  int count = 0;
  probe.error = cudaGetDeviceCount(&count);
  (void)cudaDriverGetVersion(&probe.driver_version);
  (void)cudaRuntimeGetVersion(&probe.runtime_version);
  if (probe.error == cudaSuccess) probe.devices = count;
  Device d;
  if (probe.error == cudaSuccess && ordinal < count) {
    const DeviceScope scope(ordinal);
    cudaDeviceProp properties = {};
    probe.error = cudaGetDeviceProperties(&properties, ordinal);
    d.name = properties.name;
    d.memory = properties.totalGlobalMem;
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
  d.multiprocessors = static_cast<unsigned>(attribute(cudaDevAttrMultiProcessorCount, ordinal));
  d.shared_per_multiprocessor =
      static_cast<std::size_t>(attribute(cudaDevAttrMaxSharedMemoryPerMultiprocessor, ordinal));
  d.shared_per_block =
      static_cast<std::size_t>(attribute(cudaDevAttrMaxSharedMemoryPerBlockOptin, ordinal));
  d.pool = make_pool(ordinal);
  found_one = true;
  return d;
}

}  // namespace

void check(cudaError_t status, const char* doing) {
  if (status == cudaSuccess) return;
  const std::string text = std::string(cudaGetErrorString(status));
  if (sticky()) {
    poison().set(text);
    throw Failure("CUDA failed " + std::string(doing) + ": " + text);
  }
  if (status == cudaErrorMemoryAllocation)
    throw OutOfMemory("the CUDA device ran out of memory " + std::string(doing) +
                      "; use the backend auto or cpu");
  throw Failure("CUDA failed " + std::string(doing) + ": " + text);
}

const Device& device(int ordinal) {
  if (const std::string why = poison().get(); !why.empty())
    throw Failure("CUDA failed earlier in this process (" + why +
                  ") and cannot be used until it is restarted");
  // Devices stay listed to the end of the process: their pools must outlive every array.
  static std::mutex mutex;
  static std::map<int, std::unique_ptr<Device>>& known =
      *new std::map<int, std::unique_ptr<Device>>;
  const std::lock_guard lock(mutex);
  std::unique_ptr<Device>& d = known[ordinal];
  if (d == nullptr) d = std::make_unique<Device>(query(ordinal));
  return *d;
}

const Device& device() {
  int ordinal = 0;
  if (cudaGetDevice(&ordinal) != cudaSuccess) {
    (void)cudaGetLastError();
    ordinal = 0;  // no driver, no device: the query finds out which
  }
  return device(ordinal);
}

bool started() noexcept { return found_one; }

DeviceScope::DeviceScope(int ordinal) {
  check(cudaGetDevice(&before_), "asking for the current device");
  if (before_ != ordinal) check(cudaSetDevice(ordinal), "choosing the device");
}

DeviceScope::~DeviceScope() { (void)cudaSetDevice(before_); }

void* allocate(std::size_t bytes, cudaStream_t stream) {
  if (bytes == 0) return nullptr;
  void* memory = nullptr;
  const cudaMemPool_t pool = device().pool;
  check(pool != nullptr ? cudaMallocFromPoolAsync(&memory, bytes, pool, stream)
                        : cudaMalloc(&memory, bytes),
        "allocating device memory");
  return memory;
}

void release(void* memory, cudaStream_t stream) noexcept {
  if (memory == nullptr) return;
  // An array ends on the way out of an error as well: what freeing answers helps nobody.
  try {
    (void)(device().pool != nullptr ? cudaFreeAsync(memory, stream) : cudaFree(memory));
  } catch (const Error&) {
    // The context is lost, and its memory with it.
  }
}

}  // namespace cullhull::internal::cuda
