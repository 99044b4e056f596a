#include "signals.hpp"

#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstring>
#include <thread>

#include "commands.hpp"
#include "cullhull/error.hpp"
#include "cullhull/io.hpp"

namespace app {
namespace {

std::atomic<bool> stoppable{false};

std::stop_source& source() {
  static auto& instance = *new std::stop_source;  // outlives the watcher, which is never joined
  return instance;
}

void say(const char* text) { (void)!::write(STDERR_FILENO, text, std::strlen(text)); }

[[noreturn]] void end_at_once() {
  cullhull::remove_unfinished_files();
  say("cullhull: cancelled\n");
  ::_exit(cancelled);
}

// A thread of its own may lock and allocate, which a signal handler must not.
void watch(sigset_t signals) {
  for (;;) {
    int signal = 0;
    if (sigwait(&signals, &signal) != 0) return;
    if (!stoppable || source().stop_requested()) end_at_once();
    source().request_stop();
  }
}

bool ignored(int signal) {
  struct sigaction action = {};
  return sigaction(signal, nullptr, &action) == 0 && action.sa_handler == SIG_IGN;
}

// The kernel's word for a mapped file that has become shorter than it was. Any other SIGBUS is a
// bug of ours and keeps its usual effect.
void end_on_fault(int signal, siginfo_t* info, void*) {
  const char* name = cullhull::describe_mapped_fault(info->si_addr);
  if (name == nullptr) {
    std::signal(signal, SIG_DFL);
    return;  // the access is repeated
  }
  cullhull::remove_unfinished_files();
  say("cullhull: ");
  say(name);
  say(": the file was cut short while it was being read\n");
  ::_exit(bad_input);
}

}  // namespace

void install_signals() {
  std::signal(SIGPIPE, SIG_IGN);  // a closed pipe is a failed write, reported as one
  struct sigaction fault = {};
  fault.sa_sigaction = end_on_fault;
  fault.sa_flags = SA_SIGINFO;
  sigaction(SIGBUS, &fault, nullptr);

  sigset_t signals;
  sigemptyset(&signals);
  for (const int signal : {SIGINT, SIGTERM})
    if (!ignored(signal)) sigaddset(&signals, signal);  // nohup and background jobs stay immune
  pthread_sigmask(SIG_BLOCK, &signals, nullptr);
  source();
  std::thread(watch, signals).detach();
}

std::stop_token stop_token() { return source().get_token(); }

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
