#include "parallel/threads/helpers.hpp"

#if defined(__linux__)
#include <sched.h>
#elif defined(__MINGW32__)
#include <cxxabi.h>
#endif

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <system_error>
#include <thread>
#include <vector>

#include "parallel/threads/crowding.hpp"
#include "parallel/threads/fork_guard.hpp"
#include "parallel/windows.hpp"

namespace cullhull::internal {
namespace {

using Clock = std::chrono::steady_clock;

/// How long a helper without work spins before it sleeps. The next phase of the same call usually
/// begins soon, whereas waking a sleeping thread takes the caller some microseconds and the thread
/// some tens of microseconds.
constexpr std::chrono::microseconds attentive{50};

void pause_once() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#else
  std::this_thread::yield();
#endif
}

/// Helpers are never joined, so a DLL with their code must not be unloaded. The linker sees to that
/// elsewhere (src/shared/CMakeLists.txt).
void keep_code() {
#if defined(_WIN32)
  HMODULE ours = nullptr;
  GetModuleHandleExW(GET_MODULE_HANDLE_EX_FLAG_PIN | GET_MODULE_HANDLE_EX_FLAG_FROM_ADDRESS,
                     reinterpret_cast<LPCWSTR>(&keep_code), &ours);
#endif
}

#if defined(__MINGW32__)
/// When a thread ends, MinGW frees the memory of its thread_local variables and calls their
/// destructors in the order in which the process first needed either: the destructors would find
/// freed memory. One that does nothing, registered before any such variable is used, puts
/// destructors first.
[[gnu::constructor(101)]] void put_destructors_first() {
  abi::__cxa_thread_atexit([](void*) {}, nullptr, reinterpret_cast<void*>(&put_destructors_first));
}
#endif

/// Calls that the current thread has begun and not ended: 0 or 1.
thread_local unsigned calls_here = 0;

/// All helpers of the process, and the open work that they can join, oldest first.
class Helpers {
 public:
  static Helpers& of_process() {
    static auto* const helpers = new Helpers;  // never destroyed: helpers may still use it at exit
    return *helpers;
  }

  /// Makes `work` joinable by `wanted` helpers. Returns false if no helper is available.
  bool open(unsigned wanted, const std::shared_ptr<SharedWork>& work) {
    const unsigned calls = std::max(1U, calls_.load(std::memory_order_relaxed));
    const unsigned cores = machine_threads();
    wanted = std::min(wanted, cores > calls ? cores - calls : 0);
    if (wanted == 0 || crowded()) return false;
    unsigned wake = 0;
    {
      const std::lock_guard lock(mutex_);
      open_.push_back({work, wanted});
      add_places(wanted);
      const unsigned awake = count_ - asleep_ - at_work_;
      wake = std::min(asleep_, wanted > awake ? wanted - awake : 0);
      for (unsigned come = awake + wake; come < wanted && count_ + 1 < cores; ++come)
        if (!start_one()) break;
    }
    for (; wake > 0; --wake) work_here_.notify_one();
    return true;
  }

  void close(const SharedWork* work) {
    const std::lock_guard lock(mutex_);
    const auto it = std::find_if(open_.begin(), open_.end(),
                                 [&](const Open& o) { return o.work.get() == work; });
    if (it == open_.end()) return;
    add_places(0U - (it->wanted - it->joined));
    open_.erase(it);
  }

  void begin_call() {
    ++calls_here;
    calls_.fetch_add(1, std::memory_order_relaxed);
  }
  void end_call() {
    --calls_here;
    calls_.fetch_sub(1, std::memory_order_relaxed);
  }

  void lock() { mutex_.lock(); }
  void unlock() { mutex_.unlock(); }
  /// Resets the object in a forked child, which has none of the helpers, and unlocks it.
  void begin_anew() {
    ::new (&work_here_) std::condition_variable;  // without the threads that wait in the parent
    open_.clear();
    count_ = asleep_ = at_work_ = 0;
    places_ = 0;
    calls_ = calls_here;
    mutex_.unlock();
  }

 private:
  struct Open {
    std::shared_ptr<SharedWork> work;
    unsigned wanted, joined = 0;
  };

  bool start_one() {
#if defined(__EMSCRIPTEN__)
    return false;
#else
    try {
      keep_code();
      std::thread([this] { live(); }).detach();
    } catch (const std::system_error&) {
      return false;  // no more threads: fewer helpers
    }
    ++count_;
    return true;
#endif
  }

  /// Adds `more`, modulo 2^32, so that it can be a negative number. Needs the lock.
  void add_places(unsigned more) {
    places_.store(places_.load(std::memory_order_relaxed) + more, std::memory_order_relaxed);
  }

  /// The endless loop of a helper: waits for open work, joins it, and starts over.
  void live() {
    for (;;) {
      stay_awake();
      std::unique_lock lock(mutex_);
      while (open_.empty()) {
        ++asleep_;
        work_here_.wait(lock);
        --asleep_;
      }
      Open& first = open_.front();
      const std::shared_ptr<SharedWork> work = first.work;
      const unsigned k = ++first.joined;
      add_places(0U - 1);
      if (first.joined == first.wanted) open_.erase(open_.begin());
      ++at_work_;
      lock.unlock();
      work->join(k);
      lock.lock();
      --at_work_;
    }
  }

  /// Spins until there is open work, for at most `attentive`.
  void stay_awake() const {
    const Clock::time_point end = Clock::now() + attentive;
    do {
      for (unsigned i = 0; i < 64; ++i) {
        if (places_.load(std::memory_order_relaxed) > 0) return;
        pause_once();
      }
    } while (Clock::now() < end);
  }

  std::mutex mutex_;
  std::condition_variable work_here_;
  std::vector<Open> open_;
  unsigned count_ = 0, asleep_ = 0, at_work_ = 0;  // numbers of helpers
  std::atomic<unsigned> places_{0};                // helpers still wanted, readable without lock
  std::atomic<unsigned> calls_{0};                 // running calls of the process
};

const ForkGuard helpers_guard(
    ForkGuard::Order::inner, [] { Helpers::of_process().lock(); },
    [] { Helpers::of_process().unlock(); }, [] { Helpers::of_process().begin_anew(); });

}  // namespace

unsigned machine_threads() {
#if defined(__EMSCRIPTEN__)
  return 1;  // modules are built without threads
#else
  static const unsigned count = [] {
#if defined(__linux__)
    // The processors that this process may use. hardware_concurrency() reads a file for those that
    // the machine has, a fifth of the first call of a process.
    cpu_set_t ours;
    if (sched_getaffinity(0, sizeof ours, &ours) == 0)
      return static_cast<unsigned>(std::max(1, CPU_COUNT(&ours)));
#endif
    return std::max(1U, std::thread::hardware_concurrency());
  }();
  return count;
#endif
}

OpenWork::OpenWork(unsigned helpers, const std::shared_ptr<SharedWork>& work) {
  if (helpers > 0 && Helpers::of_process().open(helpers, work)) open_ = work.get();
}
OpenWork::~OpenWork() {
  if (open_ != nullptr) Helpers::of_process().close(open_);
}

namespace {
thread_local bool in_call = false;
}

CallScope::CallScope() : outermost_(!in_call) {
  if (!outermost_) return;
  Helpers::of_process().begin_call();
  in_call = true;
}
CallScope::~CallScope() {
  if (!outermost_) return;
  in_call = false;
  Helpers::of_process().end_call();
}

void Patience::wait_a_little() {
  // A sleep takes some 60 us, however short a time is requested. Many serial parts between two
  // phases are shorter, so spin first and then yield. The counts amount to some 50 us of spinning
  // and a few ms of yields; they were chosen by feel on two cores, not tuned.
  constexpr unsigned spins = 2000, offers = 4000;
  if (turns_ < spins)
    pause_once();
  else if (turns_ < spins + offers)
    std::this_thread::yield();
  else
    std::this_thread::sleep_for(std::chrono::microseconds(10));
  ++turns_;
}

}  // namespace cullhull::internal
