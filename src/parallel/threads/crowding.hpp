// Whether the processors are busy with other work. It shows when a helper begins an item and is
// then descheduled: whoever waits for it loses a scheduler's slice, some milliseconds, each time.
// So after such a wait no helper is asked for for a while.
#pragma once

#include <chrono>

namespace cullhull::internal::inline parallel {

/// Whether a helper is likely to cost more than it saves now. From any thread; about 30 ns.
bool crowded() noexcept;

/// A caller was done with its own part and waited another `waited` for helpers, for items expected
/// to take `expected`. Where it is far more, twice within some 30 ms or once soon after a back-off,
/// the helpers did not run. From any thread.
void note_wait(std::chrono::nanoseconds expected, std::chrono::nanoseconds waited) noexcept;

/// The same for a caller's many short phases, one after the other: none of them is long enough
/// alone, but where the caller waits half of the time, two threads are no faster than one. (A third
/// is usual in 6D.)
class WaitWatch {
 public:
  void add(std::chrono::nanoseconds worked, std::chrono::nanoseconds waited) noexcept;

 private:
  std::chrono::nanoseconds worked_{0}, waited_{0};
};

/// Helpers were asked for and did hardly any of the work.
void note_absence() noexcept;

/// Resets to the state at the start of the process.
void forget_crowding() noexcept;

}  // namespace cullhull::internal::inline parallel
