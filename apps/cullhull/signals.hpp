// Ctrl-C, termination and faults in mapped files.
#pragma once

#include <functional>

#include "cullhull/stop_token.hpp"

namespace app {

/// Call first in main, before any thread exists: threads started later inherit the signal mask.
/// Also arranges that an exception which leaves a thread ends the program with one line. Throws
/// Error{io} where the system refuses a thread.
void install_signals();

/// Stop is requested by the first SIGINT or SIGTERM that arrives during `cancellable`.
cullhull::stop_token stop_token();

/// Runs `work`, which checks stop_token(): a first signal requests it to stop, a second one ends
/// the program at once, as any signal does outside of this call. In both cases unfinished files are
/// removed and the exit status is 130. Throws Error{cancelled} if the request came too late for
/// `work` to notice.
void cancellable(const std::function<void()>& work);

}  // namespace app
