#include "parallel/threads/crowding.hpp"

#include <algorithm>
#include <atomic>
#include <cstdint>

namespace cullhull::internal {
namespace {

using std::chrono::nanoseconds;
using namespace std::chrono_literals;

/// Shorter waits are ignored: a scheduler's slice is longer, while most interrupts are shorter.
constexpr nanoseconds noticeable = 2ms;
/// The first back-off lasts 20 ms, a few slices. Each one that follows soon after the last takes
/// twice as long, up to 640 ms, when trying helpers again loses about 1 % of the time.
constexpr nanoseconds first_rest = 20ms, longest_rest = 640ms;

/// Two long waits within this time begin a back-off. A single one may be due to a long item (a
/// merged facet of many corners); if a processor is busy, another follows within a few slices.
constexpr nanoseconds near = 30ms;

/// In nanoseconds: the end of the back-off (0: there was none), the length of the last back-off,
/// and the time of the last long wait. Times count from the clock's epoch. Concurrent callers
/// update them without synchronisation, which changes the back-off only a little.
std::atomic<std::int64_t> rest_until{0};
std::atomic<std::int64_t> last_rest{0};
std::atomic<std::int64_t> last_wait{0};

std::int64_t now() {
  return nanoseconds(std::chrono::steady_clock::now().time_since_epoch()).count();
}

void begin_rest() {
  const std::int64_t time = now(), until = rest_until.load(std::memory_order_relaxed);
  if (time < until) return;  // a back-off lasts already
  const std::int64_t last = last_rest.load(std::memory_order_relaxed);
  const bool soon = last != 0 && time - until < 2 * last;
  const std::int64_t rest =
      soon ? std::min<std::int64_t>(2 * last, longest_rest.count()) : first_rest.count();
  last_rest.store(rest, std::memory_order_relaxed);
  rest_until.store(time + rest, std::memory_order_relaxed);
}

}  // namespace

bool crowded() noexcept {
  const std::int64_t until = rest_until.load(std::memory_order_relaxed);
  return until != 0 && now() < until;
}

void note_wait(nanoseconds expected, nanoseconds waited) noexcept {
  // Items of one loop differ in cost, hence the factor of 4. With a factor of 2, the hull of points
  // on a cylinder's lateral surface was taken for a busy machine and took a fifth longer.
  if (!(waited > noticeable + 4 * expected)) return;
  const std::int64_t time = now(), last = last_wait.exchange(time, std::memory_order_relaxed);
  const std::int64_t until = rest_until.load(std::memory_order_relaxed);
  const bool again = last != 0 && time - waited.count() - last < near.count();
  const bool after_rest = until != 0 && time - waited.count() - until < near.count();
  if (again || after_rest) begin_rest();
}

void forget_crowding() noexcept {
  rest_until = 0;
  last_rest = 0;
  last_wait = 0;
}

}  // namespace cullhull::internal
