#include "signals.hpp"

#include "parallel/windows.hpp"
#if !defined(_WIN32) && !defined(__EMSCRIPTEN__)  // modules of WebAssembly get no signals
#define CULLHULL_SIGNALS
#include <pthread.h>
#include <unistd.h>
#endif

#include <algorithm>
#include <atomic>
#include <climits>
#include <csignal>
#include <exception>
#include <iterator>
#include <new>
#include <system_error>

#include "commands.hpp"
#include "cullhull/error.hpp"
#include "cullhull/io.hpp"
#include "terminal.hpp"

namespace app {
namespace {

std::atomic<bool> stoppable{false};

cullhull::stop_source& source() {
  static auto& instance = *new cullhull::stop_source;  // outlives the watcher
  return instance;
}

#if defined(_WIN32)
// Runs in a thread of its own, so it may lock and allocate.
BOOL WINAPI on_control(DWORD) {
  if (!stoppable || source().stop_requested()) end_with_line(cancelled, "cancelled");
  source().request_stop();
  return TRUE;
}
#endif

#ifdef CULLHULL_SIGNALS
// A thread may lock and allocate, which a signal handler must not.
void watch(sigset_t signals) {
  for (;;) {
    int signal = 0;
    if (sigwait(&signals, &signal) != 0) return;
    if (!stoppable || source().stop_requested()) end_with_line(cancelled, "cancelled");
    source().request_stop();
  }
}

bool ignored(int signal) {
  struct sigaction action = {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

// SIGBUS: a mapped file has been truncated. All of them: libhdf5 has crashed. Any other fault is a
// bug and keeps the effect it had.
constexpr int faults[] = {SIGBUS, SIGSEGV, SIGFPE, SIGABRT};
struct sigaction effects[std::size(faults)];

void end_on_fault(int signal, siginfo_t* info, void*) {
  if (const char* name = cullhull::describe_library_fault())
    end_with_line(bad_input, name, ": libhdf5 crashed on it, as it does on some damaged files");
  const char* name = signal == SIGBUS ? cullhull::describe_mapped_fault(info->si_addr) : nullptr;
  if (name != nullptr)
    end_with_line(bad_input, name, ": the file was cut short while it was being read");
  const auto which = std::find(std::begin(faults), std::end(faults), signal) - std::begin(faults);
  sigaction(signal, effects + which, nullptr);  // the access is repeated, and faults again
}

// The reader of the results has ended, as head does: so does this program, without a message and
// with the signal's own status. A closed standard error is no reason to end.
void end_quietly(int) {
  if (writing_stderr()) return;
  cullhull::remove_unfinished_files();
  std::signal(SIGPIPE, SIG_DFL);
  sigset_t pipe;
  sigemptyset(&pipe);
  sigaddset(&pipe, SIGPIPE);
  pthread_sigmask(SIG_UNBLOCK, &pipe, nullptr);
  (void)std::raise(SIGPIPE);
}
#endif

// An exception that left a thread of some library, mostly for lack of memory or threads, and so did
// not reach main. Any other cause of terminate keeps its default effect, a core dump.
void end_on_exception() {
  if (const std::exception_ptr error = std::current_exception()) try {
      std::rethrow_exception(error);
    } catch (const std::bad_alloc&) {
      end_with_line(over_budget, out_of_memory);
    } catch (const std::exception& e) {
      end_with_line(bad_input, e.what());
    } catch (...) {
    }
  std::abort();
}

#ifdef CULLHULL_SIGNALS
/// A thread with a small stack, which suffices, and can be created where memory is short.
void start_watcher(const sigset_t& signals) {
  static sigset_t watched;
  watched = signals;
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
  pthread_attr_setstacksize(&attributes, static_cast<std::size_t>(PTHREAD_STACK_MIN) + (64 << 10));
  pthread_t thread;
  const auto routine = [](void*) -> void* {
    watch(watched);
    return nullptr;
  };
  const int error = pthread_create(&thread, &attributes, routine, nullptr);
  pthread_attr_destroy(&attributes);
  if (error != 0)
    throw cullhull::Error(cullhull::ErrorCode::io,
                          "cannot start a thread: " + std::generic_category().message(error));
}
#endif

}  // namespace

void install_signals() {
  std::set_terminate(end_on_exception);
#if defined(_WIN32)
  source();
  SetConsoleCtrlHandler(on_control, TRUE);
#elif defined(CULLHULL_SIGNALS)
  // Writing beyond a file size limit then fails, and is reported as an error.
  std::signal(SIGXFSZ, SIG_IGN);
  // Where SIGPIPE is ignored, as under trap '' PIPE, writing to a closed pipe fails, too.
  if (!ignored(SIGPIPE)) std::signal(SIGPIPE, end_quietly);
  struct sigaction fault = {};
  fault.sa_sigaction = end_on_fault;
  fault.sa_flags = SA_SIGINFO;
  for (std::size_t i = 0; i < std::size(faults); ++i) sigaction(faults[i], &fault, effects + i);

  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM})
    if (!ignored(signal)) sigaddset(&signals, signal);  // as under nohup
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  source();
  start_watcher(signals);
#endif
}

cullhull::stop_token stop_token() { return source().get_token(); }

void cancellable(const std::function<void()>& work) {
  struct Guard {
    Guard() { stoppable = true; }
    ~Guard() { stoppable = false; }
  };
  {
    const Guard guard;
    work();
  }
  if (source().stop_requested()) throw cullhull::Error(cullhull::ErrorCode::cancelled, "cancelled");
}

}  // namespace app
