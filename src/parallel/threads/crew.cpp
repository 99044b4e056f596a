#include "parallel/threads/crew.hpp"

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <utility>

#include "parallel/threads/crowding.hpp"
#include "parallel/threads/helpers.hpp"

namespace cullhull::internal {
namespace {

constexpr unsigned item_bits = 20;  // width of a ticket's two item fields
constexpr std::uint64_t item_mask = (std::uint64_t{1} << item_bits) - 1;

using Body = std::function<void(std::uint32_t, unsigned)>;
using Clock = std::chrono::steady_clock;

}  // namespace

/// The state that a session shares with its helpers. It may outlive the session, since the caller
/// does not wait for helpers that are between items.
class Crew::Phases : public SharedWork {
 public:
  void join(unsigned lane) noexcept override {
    Patience patience;
    while (!over_.load(std::memory_order_acquire))
      if (work(lane))
        patience = {};
      else
        patience.wait_a_little();
  }

  void run(std::uint32_t count, const Body& body) {
    if (crowded()) {  // the helpers' processors are busy with other work
      for (std::uint32_t i = 0; i < count; ++i) body(i, 0);
      return;
    }
    const Clock::time_point begin = Clock::now();
    body_ = &body;
    done_.store(0, std::memory_order_relaxed);
    const std::uint64_t phase = (ticket_.load(std::memory_order_relaxed) >> (2 * item_bits)) + 1;
    ticket_.store(phase << (2 * item_bits) | std::uint64_t{count} << item_bits,
                  std::memory_order_release);
    while (work(0)) {
    }
    const Clock::time_point end = Clock::now();
    Patience patience;
    while (done_.load(std::memory_order_acquire) < count) patience.wait_a_little();
    watch_.add(end - begin, Clock::now() - end);
    if (!failed_.load(std::memory_order_acquire)) return;
    failed_ = false;
    std::rethrow_exception(std::exchange(error_, nullptr));
  }

  void end() { over_ = true; }

 private:
  /// Takes and does one item of the current phase. Returns false if all items have been taken.
  bool work(unsigned lane) {
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

  /// From high to low bits: the phase's number, its number of items and its next item. They share
  /// one word, so that a late helper's compare-and-exchange fails once its phase is over.
  alignas(64) std::atomic<std::uint64_t> ticket_{0};
  alignas(64) std::atomic<std::uint32_t> done_{0};
  std::atomic<bool> over_{false};
  const Body* body_ = nullptr;
  std::exception_ptr error_;
  std::atomic<bool> failed_{false};
  WaitWatch watch_;  // used by the caller alone
};

Crew::Crew(unsigned threads) : lanes_(std::max(1U, threads)) {}
Crew::~Crew() = default;

void Crew::session(const std::function<void()>& main) {
  phases_ = std::make_shared<Phases>();
  // Helpers leave when main has returned or thrown.
  struct Session {
    OpenWork open;
    Phases& phases;
    ~Session() { phases.end(); }
  };
  const Session session{OpenWork(lanes_ - 1, phases_, true), *phases_};
  main();
}

void Crew::run(std::uint32_t count, const Body& body, [[maybe_unused]] spans::Where where) {
#ifdef CULLHULL_SPAN_ACCOUNT
  if (spans::counting()) {
    const auto one = [&](std::uint64_t i) {
      body(static_cast<std::uint32_t>(i), static_cast<unsigned>(i % lanes_));
    };
    if (spans::counts() && count > 1) return spans::run_counted(count, lanes_, where, one);
    for (std::uint32_t i = 0; i < count; ++i) one(i);
    return;
  }
#endif
  if (count > 0) phases_->run(count, body);
}

}  // namespace cullhull::internal
