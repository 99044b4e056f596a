// Ctrl-C, termination and faults in mapped files.
#pragma once

#include <functional>
#include <stop_token>

namespace app {

/// Call first in main, before any thread exists: threads started later inherit the signal mask.
/// Also arranges that an exception which leaves a thread ends the program with one line. Throws
/// Error{io} where the system refuses a thread.
void install_signals();

/// Requested by the first SIGINT or SIGTERM that arrives during `cancellable`.
std::stop_token stop_token();

/// Runs `work`, which watches stop_token(): a first signal asks it to stop, a second one ends the
/// program at once, as any signal does outside of this call. Either way unfinished files are
/// removed and the exit status is 130. Throws Error{cancelled} if the request came too late to be
/// seen.
void cancellable(const std::function<void()>& work);

/// While one lives, work that has not ended 50 ms after a signal is ended as by a second one: for
/// engines of others, which do not always listen. Nothing it would still have to save may be open.
class EndDeafWork {
 public:
  EndDeafWork();
  ~EndDeafWork();
  EndDeafWork(const EndDeafWork&) = delete;
  EndDeafWork& operator=(const EndDeafWork&) = delete;
};

}  // namespace app
