// Whether the processors are taken by others: seen by helpers that begin something and then get no
// processor to end it. Whoever waits for them loses a scheduler's slice, some milliseconds, each
// time; so after such a wait nobody is asked for a while.
#pragma once

#include <chrono>

namespace cullhull::internal {

/// Whether help is likely to cost more than it saves just now. Any thread may ask: about 30 ns.
bool crowded() noexcept;

/// A caller was done after `worked` and waited for helpers for `waited` more. What helpers had
/// begun is expected to take about as long as the caller's own part; far more means that they did
/// not run. From any thread.
void note_wait(std::chrono::nanoseconds worked, std::chrono::nanoseconds waited) noexcept;

/// Forgets what was seen.
void forget_crowding() noexcept;

}  // namespace cullhull::internal
