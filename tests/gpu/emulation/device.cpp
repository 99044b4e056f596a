#include "device.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <deque>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "block.hpp"
#include "memory.hpp"
#include "races.hpp"

// The run-time library's type behind cudaStream_t.
struct CUstream_st {
  struct Work {
    std::function<void()> run;
    bool touches_memory;
  };
  bool blocking = true;
  int device = 0;
  std::uint64_t work = 0;  ///< kernels and long copies
  std::deque<Work> queue;
};

namespace emulation {
namespace {

Settings at_first() {
  Settings settings;
  if (const char* const bytes = std::getenv("CULLHULL_DEVICE_MEMORY"))
    settings.memory = std::strtoull(bytes, nullptr, 10);
  return settings;
}
Settings the_settings = at_first();
Counters the_counters;
/// A start of the random order of threads and streams. CULLHULL_DEVICE_SEED gives all others.
std::uint64_t random_start(std::uint64_t seed) {
  static const char* text = std::getenv("CULLHULL_DEVICE_SEED");
  static const std::uint64_t of_process = text == nullptr ? 0 : std::strtoull(text, nullptr, 10);
  return 0x9E3779B97F4A7C15U * (2 * (seed + 1000003 * of_process) + 1);
}
std::uint64_t random_state = random_start(0);
long allocations_since_restart = 0, launches_since_restart = 0;
cudaError_t lasting = cudaSuccess;
thread_local cudaError_t last = cudaSuccess;
thread_local int device_now = 0;

std::set<CUstream_st*>& streams() {
  static std::set<CUstream_st*> all;
  return all;
}

CUstream_st* default_stream(int device) {
  static std::map<int, std::unique_ptr<CUstream_st>> all;
  std::unique_ptr<CUstream_st>& s = all[device];
  if (s == nullptr) {
    s = std::make_unique<CUstream_st>();
    s->device = device;
  }
  return s.get();
}

/// A thread's own stream on a device; it stays when the thread ends, as what it holds does.
CUstream_st* stream_of_thread(int device) {
  thread_local std::map<int, CUstream_st*> mine;
  CUstream_st*& s = mine[device];
  if (s == nullptr) {
    s = new CUstream_st;
    s->device = device;
    streams().insert(s);
  }
  return s;
}

CUstream_st* resolve(cudaStream_t stream) {
  if (stream == nullptr || stream == cudaStreamLegacy) return default_stream(device_now);
  if (stream == cudaStreamPerThread) return stream_of_thread(device_now);
  if (!streams().contains(stream)) violation("a stream that is not there");
  return stream;
}

/// `mark`: where to stop, if not null.
void run_queue(CUstream_st* s, const Mark* mark = nullptr) {
  while (!s->queue.empty() && (mark == nullptr || !mark->reached)) {
    const CUstream_st::Work work = std::move(s->queue.front());
    s->queue.pop_front();
    if (lasting != cudaSuccess) continue;
    if (work.touches_memory) {
      const DeviceAccess access(s->device);
      work.run();
    } else {
      work.run();
    }
  }
}

/// What the default stream and the blocking ones of its device owe one another.
void run_before(CUstream_st* s) {
  CUstream_st* common = default_stream(s->device);
  if (s == common) {
    for (CUstream_st* other : streams())
      if (other->blocking && other->device == s->device) run_queue(other);
  } else if (s->blocking) {
    run_queue(common);
  }
}

void run_all(CUstream_st* s) {
  run_before(s);
  run_queue(s);
}

void run_some_stream() {
  std::vector<CUstream_st*> all(streams().begin(), streams().end());
  for (int d = 0; d < the_settings.devices; ++d) all.push_back(default_stream(d));
  run_all(all[random64() % all.size()]);
}

/// Blocks from a random one on, up or down.
void run_grid(const Launch& launch, const std::function<void()>& body) {
  block_size = {launch.block, 1, 1};
  grid_size = {launch.grid, 1, 1};
  launch_begins();
  if (launch.grid > the_settings.most_blocks) {
    for (unsigned k = 0; k < the_settings.most_blocks; ++k) {
      block_index = {launch.grid - 1 - k, 0, 0};
      run_block(body, launch.block, launch.shared);
    }
    return;
  }
  const auto start = static_cast<unsigned>(random64() % launch.grid);
  const bool down = random64() % 2 == 1;
  for (unsigned k = 0; k < launch.grid; ++k) {
    const std::uint64_t at = std::uint64_t{start} + (down ? launch.grid - k : k);
    block_index = {static_cast<unsigned>(at % launch.grid), 0, 0};
    run_block(body, launch.block, launch.shared);
  }
}

std::map<std::pair<int, const void*>, std::size_t>& dynamic_shared_limits() {
  static std::map<std::pair<int, const void*>, std::size_t> all;
  return all;
}

}  // namespace

Settings& settings() { return the_settings; }

void restart(std::uint64_t seed) {
  const Lock lock(mutex());
  random_state = random_start(seed);
  allocations_since_restart = launches_since_restart = 0;
  const std::size_t live = the_counters.live_bytes;
  the_counters = {};
  the_counters.live_bytes = the_counters.peak_bytes = live;
}

Counters counters() {
  const Lock lock(mutex());
  return the_counters;
}

void violation(const std::string& what) {
  std::fprintf(stderr, "emulated device: %s (block %u, thread %u)\n", what.c_str(), block_index.x,
               thread_index.x);
  std::abort();
}

std::uint64_t random64() {
  random_state ^= random_state >> 12;
  random_state ^= random_state << 25;
  random_state ^= random_state >> 27;
  return random_state * 0x2545F4914F6CDD1DU;
}

std::recursive_mutex& mutex() {
  static std::recursive_mutex m;
  return m;
}

int current_device() { return device_now; }
void set_current_device(int device) { device_now = device; }
cudaError_t lasting_error() { return lasting; }
void set_lasting_error(cudaError_t error) { lasting = error; }
void set_last_error(cudaError_t error) { last = error; }
cudaError_t peek_last_error() { return lasting != cudaSuccess ? lasting : last; }
cudaError_t take_last_error() {
  const cudaError_t error = peek_last_error();
  last = cudaSuccess;
  return error;
}

bool may_allocate(std::size_t bytes) {
  const long number = ++allocations_since_restart;
  const Settings& s = the_settings;
  if (number == s.failing_allocation) return false;
  if (s.failing_allocations_from != 0 && number >= s.failing_allocations_from) return false;
  return the_counters.live_bytes + bytes <= s.memory;
}

void count_allocation(std::ptrdiff_t bytes) {
  if (bytes > 0) ++the_counters.allocations;
  the_counters.live_bytes += static_cast<std::size_t>(bytes);
  the_counters.peak_bytes = std::max(the_counters.peak_bytes, the_counters.live_bytes);
}
bool count_pinned() {
  const long number = static_cast<long>(++the_counters.pinned_allocations);
  return the_settings.failing_pinned_from == 0 || number < the_settings.failing_pinned_from;
}
void count_copy(cudaStream_t stream, std::size_t bytes, cudaMemcpyKind kind) {
  ++the_counters.copies;
  if (kind != cudaMemcpyDeviceToDevice) the_counters.link_bytes += bytes;
  // Of 1 MiB: 20 us over a link of 55 GB/s, longer than the host takes to go on.
  if (bytes >= std::size_t{1} << 20) ++resolve(stream)->work;
}
void count_trim() { ++the_counters.trims; }
void count_wait() {
  ++the_counters.waits;
  about_to_wait();
}
void count_look() {
  ++the_counters.looks;
  about_to_wait();
}
void about_to_wait() {
  if (settings().at_wait) settings().at_wait();
}

cudaStream_t create_stream(bool blocking) {
  auto* s = new CUstream_st;
  s->blocking = blocking;
  s->device = device_now;
  streams().insert(s);
  return s;
}

void destroy_stream(cudaStream_t stream) {
  CUstream_st* s = resolve(stream);
  run_all(s);
  streams().erase(s);
  delete s;
}

cudaError_t check_stream(cudaStream_t stream) {
  if (the_settings.default_stream_error != 0 && resolve(stream) == default_stream(device_now))
    return static_cast<cudaError_t>(the_settings.default_stream_error);
  return resolve(stream)->device == device_now ? cudaSuccess : cudaErrorInvalidResourceHandle;
}

void enqueue(cudaStream_t stream, std::function<void()> work, bool touches_memory) {
  const Lock lock(mutex());
  CUstream_st* s = resolve(stream);
  run_before(s);
  s->queue.push_back({std::move(work), touches_memory});
  if (the_settings.order == Order::at_once) run_all(s);
  if (the_settings.order == Order::shuffled && random64() % 4 == 0) run_some_stream();
}

void drain(cudaStream_t stream) { run_all(resolve(stream)); }

void drain_device() {
  run_all(default_stream(device_now));
  for (CUstream_st* s : streams())
    if (s->device == device_now) run_queue(s);
}

std::shared_ptr<Mark> mark(cudaStream_t stream) {
  auto made = std::make_shared<Mark>(Mark{resolve(stream), resolve(stream)->work, false});
  enqueue(
      stream, [made] { made->reached = true; }, false);
  return made;
}

bool is_last(const Mark& mark) { return mark.stream->work == mark.work; }

void drain_to(const Mark& mark) {
  if (!mark.reached) run_before(mark.stream);
  run_queue(mark.stream, &mark);
}

bool idle(cudaStream_t stream) { return resolve(stream)->queue.empty(); }

void forget_shared_limits() {
  const Lock lock(mutex());
  dynamic_shared_limits().clear();
}

void allow_dynamic_shared(const void* function, std::size_t bytes) {
  dynamic_shared_limits()[{device_now, function}] = bytes;
}

void submit(const Launch& launch, std::function<void()> body) {
  if (const auto meanwhile = std::exchange(the_settings.before_launch, nullptr)) meanwhile();
  const Lock lock(mutex());
  if (lasting != cudaSuccess) return;
  constexpr std::size_t without_asking = 48 << 10;
  const auto limit = dynamic_shared_limits().find({device_now, launch.function});
  const std::size_t shared_limit =
      limit != dynamic_shared_limits().end() ? limit->second : without_asking;
  if (launch.grid == 0 || launch.grid > 0x7FFFFFFFU || launch.block == 0 || launch.block > 1024)
    return set_last_error(cudaErrorInvalidConfiguration);
  if (launch.shared > shared_limit) return set_last_error(cudaErrorInvalidValue);
  if (const cudaError_t error = check_stream(launch.stream); error != cudaSuccess)
    return set_last_error(error);
  ++the_counters.launches[launch.name];
  ++resolve(launch.stream)->work;
  if (++launches_since_restart == the_settings.failing_launch) {
    enqueue(launch.stream, [] { set_lasting_error(cudaErrorIllegalAddress); });
    return;
  }
  enqueue(launch.stream, [launch, body = std::move(body)] { run_grid(launch, body); });
}

}  // namespace emulation
