#include "parallel/crew.hpp"

#include <oneapi/tbb/task_arena.h>
#include <oneapi/tbb/task_group.h>

#include <algorithm>
#include <thread>
#include <utility>
#include <vector>

#include "parallel/parallel.hpp"
#include "parallel/thread_sanitizer.hpp"

namespace cullhull::internal {
namespace {

constexpr unsigned item_bits = 20;
constexpr std::uint64_t item_mask = (std::uint64_t{1} << item_bits) - 1;

/// Awake at first; where the machine has more threads than processors, the others must get on.
class Wait {
 public:
  void once() {
    if (++turns_ % 256 == 0) std::this_thread::yield();
#if defined(__x86_64__) || defined(__i386__)
    __builtin_ia32_pause();
#endif
  }

 private:
  unsigned turns_ = 0;
};

}  // namespace

Crew::Crew(unsigned threads) : lanes_(std::max(1U, threads)) {}

void Crew::session(const std::function<void()>& main) {
  over_ = false;
  if (lanes_ == 1) {
    main();
    return;
  }
  // Helpers leave when main is over, however it ends.
  struct Over {
    std::atomic<bool>& flag;
    ~Over() { flag = true; }
  };
#ifdef CULLHULL_THREAD_SANITIZER
  // Plain threads, whose hand-overs the sanitizer sees (parallel.cpp).
  std::vector<std::thread> helpers;
  for (unsigned lane = 1; lane < lanes_; ++lane) helpers.emplace_back([this, lane] { help(lane); });
  std::exception_ptr error;
  try {
    const Over over{over_};
    main();
  } catch (...) {
    error = std::current_exception();
  }
  for (std::thread& t : helpers) t.join();
  if (error) std::rethrow_exception(error);
#else
  // oneTBB warns on standard error about arenas wider than the machine; the library never prints.
  const int machine = std::max(1, oneapi::tbb::this_task_arena::max_concurrency());
  oneapi::tbb::task_arena arena(std::min(static_cast<int>(lanes_), machine));
  oneapi::tbb::task_group helpers;
  arena.execute([&] {
    for (unsigned lane = 1; lane < lanes_; ++lane) helpers.run([this, lane] { help(lane); });
  });
  std::exception_ptr error;
  try {
    const Over over{over_};
    main();
  } catch (...) {
    error = std::current_exception();
  }
  arena.execute([&] { helpers.wait(); });
  if (error) std::rethrow_exception(error);
#endif
}

void Crew::run(std::uint32_t count, const std::function<void(std::uint32_t, unsigned)>& body) {
  if (count == 0) return;
  body_ = &body;
  done_.store(0, std::memory_order_relaxed);
  const std::uint64_t phase = (ticket_.load(std::memory_order_relaxed) >> (2 * item_bits)) + 1;
  ticket_.store(phase << (2 * item_bits) | std::uint64_t{count} << item_bits,
                std::memory_order_release);
  while (work(0)) {
  }
  Wait wait;
  while (done_.load(std::memory_order_acquire) < count) wait.once();
  if (!failed_.load(std::memory_order_acquire)) return;
  failed_ = false;
  std::rethrow_exception(std::exchange(error_, nullptr));
}

void Crew::help(unsigned lane) {
  Wait wait;
  while (!over_.load(std::memory_order_acquire))
    if (!work(lane)) wait.once();
}

/// One item of the present phase, if there is one left.
bool Crew::work(unsigned lane) {
  std::uint64_t t = ticket_.load(std::memory_order_acquire);
  do {
    if ((t & item_mask) >= (t >> item_bits & item_mask)) return false;
  } while (!ticket_.compare_exchange_weak(t, t + 1, std::memory_order_acq_rel,
                                          std::memory_order_acquire));
  try {
    (*body_)(static_cast<std::uint32_t>(t & item_mask), lane);
  } catch (...) {
    if (!failed_.exchange(true)) error_ = std::current_exception();
  }
  done_.fetch_add(1, std::memory_order_release);
  return true;
}

}  // namespace cullhull::internal
