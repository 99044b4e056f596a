// Detects processors that are busy with other work. On such a machine a helper begins an item and
// is then descheduled, and the thread that waits for it loses one of the scheduler's time slices,
// some milliseconds, each time. After such waits callers work without helpers for a while: the
// back-off.
#pragma once

#include <chrono>

namespace cullhull::internal {

/// Whether the back-off lasts: helpers are likely to cost more than they save. Thread-safe; takes
/// about 30 ns.
bool crowded() noexcept;

/// Reports that a caller finished its own part and then waited `waited` for helpers' items, which
/// were expected to take `expected`. A wait is long if it takes more than 2 ms plus four times
/// `expected`. Two long waits within some 30 ms, or one soon after a back-off, begin a back-off:
/// the helpers had no processor. Thread-safe.
void note_wait(std::chrono::nanoseconds expected, std::chrono::nanoseconds waited) noexcept;

/// Ends the back-off and forgets all reports, as at the start of the process.
void forget_crowding() noexcept;

}  // namespace cullhull::internal
