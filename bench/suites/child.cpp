#include "child.hpp"

#include <fcntl.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <system_error>

#include "cullhull/error.hpp"

namespace cullhull::bench {
namespace {

[[noreturn]] void refuse(const char* what) {
  throw Error(ErrorCode::io, std::string(what) + ": " + std::strerror(errno));
}

void write_all(int to, const std::string& text) {
  for (std::size_t at = 0; at < text.size();) {
    const ssize_t wrote = ::write(to, text.data() + at, text.size() - at);
    if (wrote < 0 && errno != EINTR) return;
    if (wrote > 0) at += static_cast<std::size_t>(wrote);
  }
}

/// A running child process; the destructor kills it unless it was waited for.
class Child {
 public:
  /// The child runs `body(fd)`, which must not return.
  template <class Body>
  explicit Child(const Body& body) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) refuse("a pipe");
    pid_ = ::fork();
    if (pid_ == 0) {
      // Ctrl-C reaches the terminal's whole process group; only the parent handles it.
      std::signal(SIGINT, SIG_DFL);
      std::signal(SIGTERM, SIG_DFL);
      body(ends[1]);
    }
    ::close(ends[1]);
    from_ = ends[0];
    if (pid_ < 0) {
      ::close(from_);
      refuse("a process for a rival");
    }
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    ::close(from_);
    if (pid_ <= 0) return;
    ::kill(pid_, SIGKILL);
    wait();
  }

  std::optional<ChildRun> result(const ChildLimits& limits) {
    ChildRun run;
    const auto start = std::chrono::steady_clock::now();
    for (;;) {
      if (limits.stop.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled");
      const std::chrono::duration<double> spent = std::chrono::steady_clock::now() - start;
      if (limits.seconds > 0 && spent.count() > limits.seconds) {
        run.timed_out = true;
        return run;
      }
      pollfd wanted{from_, POLLIN, 0};
      if (::poll(&wanted, 1, 50) <= 0) continue;
      char buffer[1 << 16];
      const ssize_t got = ::read(from_, buffer, sizeof buffer);
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) break;
      run.output.append(buffer, static_cast<std::size_t>(got));
    }
    if (wait() != 0) return std::nullopt;
    return run;
  }

 private:
  int wait() {
    int status = 0;
    while (::waitpid(pid_, &status, 0) < 0 && errno == EINTR) {
    }
    pid_ = 0;
    return status;
  }

  pid_t pid_ = 0;
  int from_ = -1;
};

}  // namespace

std::optional<ChildRun> run_forked(const std::function<std::string()>& work,
                                   const ChildLimits& limits) {
  Child child([&](int to) {
    try {
      write_all(to, work());
      ::_exit(0);
    } catch (...) {
      ::_exit(1);
    }
  });
  return child.result(limits);
}

std::string program_beside(const char* name) {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) return "";
  const auto program = self.parent_path() / name;
  return std::filesystem::exists(program, error) ? program.string() : "";
}

std::optional<ChildRun> run_program(const std::vector<std::string>& words,
                                    const ChildLimits& limits) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  Child child([&](int to) {
    ::dup2(to, STDOUT_FILENO);
    const int nowhere = ::open("/dev/null", O_WRONLY);
    if (nowhere >= 0) ::dup2(nowhere, STDERR_FILENO);
    ::execv(arguments[0], arguments.data());
    ::_exit(127);
  });
  return child.result(limits);
}

Scratch::Scratch()
    : path((std::filesystem::temp_directory_path() /
            ("cullhull-rival-" + std::to_string(::getpid()) + ".npy"))
               .string()) {}

Scratch::~Scratch() {
  std::error_code ignored;
  std::filesystem::remove(path, ignored);
}

}  // namespace cullhull::bench
