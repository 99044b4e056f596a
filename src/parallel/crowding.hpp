// Whether the processors are taken by others: seen by helpers that begin something and then get no
// processor to end it. Whoever waits for them loses a scheduler's slice, some milliseconds, each
// time; so after such a wait nobody is asked for a while.
#pragma once

#include <chrono>

namespace cullhull::internal {

/// Whether help is likely to cost more than it saves just now. Any thread may ask: about 30 ns.
bool crowded() noexcept;

/// A caller was done with its own part and waited for helpers for `waited` more. What they had
/// begun was expected to take `expected`; far more, twice within some 30 ms or once soon after a
/// rest, means that they did not run. From any thread.
void note_wait(std::chrono::nanoseconds expected, std::chrono::nanoseconds waited) noexcept;

/// The same for a caller's many short phases, one after the other: none of them shows, but where
/// the caller waits half of the time, two threads are no faster than one. (A third is usual in 6D.)
class WaitWatch {
 public:
  void add(std::chrono::nanoseconds worked, std::chrono::nanoseconds waited) noexcept;

 private:
  std::chrono::nanoseconds worked_{0}, waited_{0};
};

/// Help was asked for and did hardly any of the work.
void note_absence() noexcept;

/// Forgets what was seen.
void forget_crowding() noexcept;

}  // namespace cullhull::internal
