#include "parallel/threads/crowding.hpp"

#include <algorithm>
#include <atomic>
#include <cstdint>

namespace cullhull::internal::inline parallel {
namespace {

using std::chrono::nanoseconds;
using namespace std::chrono_literals;

/// Shorter waits are ignored: a scheduler's slice is longer, most interrupts are shorter.
constexpr nanoseconds noticeable = 2ms;
/// Back-off: no helper is asked for during 20 ms, a few slices, after the first long wait; the time
/// doubles while long waits follow soon after it, up to a share of about 1 % lost to trying again.
constexpr nanoseconds first_rest = 20ms, longest_rest = 640ms;

/// A single long wait may be due to a long item (a merged facet of many corners); where a processor
/// is taken, another long wait follows within a few slices.
constexpr nanoseconds near = 30ms;

/// Since the clock's epoch. Unsynchronised updates of concurrent callers change the back-off a
/// little.
std::atomic<std::int64_t> rest_until{0};
std::atomic<std::int64_t> last_rest{0};
std::atomic<std::int64_t> last_wait{0};

std::int64_t now() {
  return nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void begin_rest() {
  const std::int64_t time = now(), until = rest_until.load(std::memory_order_relaxed);
  if (time < until) return;  // the wait began before the back-off
  const std::int64_t last = last_rest.load(std::memory_order_relaxed);
  const bool soon = last != 0 && time - until < 2 * last;
  const std::int64_t rest = soon ? std::min(2 * last, longest_rest.count()) : first_rest.count();
  last_rest.store(rest, std::memory_order_relaxed);
  rest_until.store(time + rest, std::memory_order_relaxed);
}

}  // namespace

bool crowded() noexcept {
  const std::int64_t until = rest_until.load(std::memory_order_relaxed);
  return until != 0 && now() < until;
}

void note_wait(nanoseconds expected, nanoseconds waited) noexcept {
  // A factor of 4, since items of one loop differ in cost: with 2, the mantle of a cylinder was
  // taken for a busy machine, and took a fifth longer.
  if (!(waited > noticeable + 4 * expected)) return;
  const std::int64_t time = now(), last = last_wait.exchange(time, std::memory_order_relaxed);
  const std::int64_t until = rest_until.load(std::memory_order_relaxed);
  const bool again = last != 0 && time - waited.count() - last < near.count();
  const bool after_rest = until != 0 && time - waited.count() - until < near.count();
  if (again || after_rest) begin_rest();
}

void WaitWatch::add(nanoseconds worked, nanoseconds waited) noexcept {
  constexpr nanoseconds window = 20ms;  // some slices of the scheduler
  worked_ += worked;
  waited_ += waited;
  if (worked_ + waited_ < window) return;
  if (waited_ > worked_) begin_rest();
  worked_ = waited_ = nanoseconds(0);
}

void note_absence() noexcept { begin_rest(); }

void forget_crowding() noexcept {
  rest_until = 0;
  last_rest = 0;
  last_wait = 0;
}

}  // namespace cullhull::internal::inline parallel
