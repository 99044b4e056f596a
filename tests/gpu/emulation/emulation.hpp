// An emulated CUDA device for tests: what a test sets, and what it may count. The run-time library
// (runtime_api.cpp) is linked in the place of NVIDIA's, the kernels are the project's own text
// (rewrite_kernels.py). What it shows: accesses beyond or to the wrong side, races between streams,
// races between threads of a launch
// (races.hpp), barriers that not all threads reach, launches a device would refuse, every failed
// allocation. What it cannot: CUB's own code, true concurrency, caches, a device's roundings,
// speed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>

namespace emulation {

/// When work that was put on a stream is done.
enum class Order {
  at_once,   ///< as soon as it is submitted
  late,      ///< when somebody waits for it, no earlier: what is not waited for is seen undone
  shuffled,  ///< at random moments, streams in random turns
};

struct Settings {
  bool driver = true;
  int devices = 1;
  std::size_t memory = std::size_t{16} << 30;  ///< bytes of a device
  bool pools = true;                           ///< stream-ordered allocation is there
  int unusable_device = -1;                    ///< this one is too old
  /// What everything on default streams answers, as they do while somebody records a graph.
  int default_stream_error = 0;
  Order order = Order::late;
  /// Of a launch with more blocks only so many are run, the last ones.
  unsigned most_blocks = ~0U;
  /// A stream that somebody records a graph of: waiting for it would end that.
  void* captured_stream = nullptr;
  /// The most dynamic shared memory that a kernel may be given; -1: the device's maximum.
  long most_dynamic_shared = -1;
  // The n-th from restart() on fails; 0: none does.
  long failing_allocation = 0;
  long failing_allocations_from = 0;  ///< this one and all after it
  long failing_pinned_from = 0;
  long failing_launch = 0;  ///< poisons the process, as an illegal address does
  /// Called once, when a launch has been prepared and not yet been made: what other threads do
  /// then.
  std::function<void()> before_launch;
  /// Called by every call that waits for work of a device, before it waits.
  std::function<void()> at_wait;
};

/// Changed between calls only.
Settings& settings();
/// Counts for `failing_...` and the counters begin anew; the random order of threads with `seed`.
void restart(std::uint64_t seed = 1);

struct Counters {
  std::map<std::string, std::uint64_t> launches;  ///< by the kernel's name
  std::uint64_t allocations = 0, pinned_allocations = 0, copies = 0, trims = 0;
  /// Waits for all that a stream has to do, and for a part of it.
  std::uint64_t waits = 0, looks = 0;
  std::size_t live_bytes = 0, peak_bytes = 0;  ///< of device memory
  std::uint64_t link_bytes = 0;                ///< copied between host and device
};
Counters counters();

/// Says what a device would have done wrong, with the place of the running thread, and aborts.
[[noreturn]] void violation(const std::string& what);

/// What kernels were allowed of shared memory, as in a new process.
void forget_shared_limits();

/// xorshift64*: orders of threads and streams, last bits of approximations.
std::uint64_t random64();

}  // namespace emulation
