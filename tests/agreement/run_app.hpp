// Starts the program as a user would and looks at what comes back.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <spawn.h>
#include <sys/ioctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "cullhull/generate.hpp"
#include "cullhull/point_view.hpp"
#include "sanitized.hpp"
#include "thrown.hpp"

extern char** environ;

namespace cullhull {
// Of cullhull/io.hpp, which most tests of the program do without.
void write_npy_points(const std::string& path, const double* coordinates, std::uint64_t count,
                      std::uint32_t dimension, ScalarType type);
}  // namespace cullhull

namespace cullhull::testing {

using testing_support::error_of;
using testing_support::has;

/// A folder of its own, removed with everything in it.
class Folder {
 public:
  Folder() {
    std::string pattern = std::filesystem::temp_directory_path() / "cullhull-test-XXXXXX";
    if (::mkdtemp(pattern.data()) == nullptr) std::abort();
    path_ = pattern;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string operator/(const std::string& name) const { return path_ / name; }
  std::size_t entries() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(path_), {}));
  }

 private:
  std::filesystem::path path_;
};

/// The words of command lines.
inline std::vector<std::vector<std::string>> command_lines(const std::vector<std::string>& lines) {
  std::vector<std::vector<std::string>> all;
  for (const std::string& line : lines) {
    std::istringstream in(line);
    all.emplace_back();
    for (std::string word; in >> word;) all.back().push_back(word);
  }
  return all;
}

/// The same with @ for the folder: "hull @p.txt".
inline std::vector<std::vector<std::string>> command_lines(const Folder& folder,
                                                           const std::vector<std::string>& lines) {
  std::vector<std::vector<std::string>> all = command_lines(lines);
  for (std::vector<std::string>& words : all)
    for (std::string& word : words)
      if (const std::size_t at = word.find('@'); at != std::string::npos)
        word.replace(at, 1, folder / "");
  return all;
}

inline std::vector<std::string> joined(std::vector<std::string> words,
                                       const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

inline void write_file(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary) << bytes;
}

inline std::string read_file(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  std::ostringstream out;
  out << in.rdbuf();
  return out.str();
}

/// How a program ended: its exit status, or 1000 + the signal that killed it; and what it used.
inline int wait_for(pid_t child, rusage* used = nullptr) {
  int status = 0;
  while (::wait4(child, &status, 0, used) < 0)
    if (errno != EINTR) return -1;
  return WIFEXITED(status) ? WEXITSTATUS(status) : 1000 + WTERMSIG(status);
}

/// The program that is tested, or what CULLHULL_TESTED_APP names (scripts/windows.sh).
inline std::string tested_app() {
  const char* const other = std::getenv("CULLHULL_TESTED_APP");
  return other != nullptr ? other : CULLHULL_APP;
}

/// The program and its arguments, as exec takes them. A first argument "cullhull-bench" asks for
/// that program, which lies beside the usual one.
class CommandLine {
 public:
  explicit CommandLine(const std::vector<std::string>& arguments) : words_{tested_app()} {
    words_.insert(words_.end(), arguments.begin(), arguments.end());
    if (words_.size() > 1 && words_[1] == "cullhull-bench") {
      words_[0] += "-bench";
      words_.erase(words_.begin() + 1);
    }
    for (std::string& word : words_) argv_.push_back(word.data());
    argv_.push_back(nullptr);
  }
  CommandLine(const CommandLine&) = delete;
  CommandLine& operator=(const CommandLine&) = delete;

  const char* program() const { return argv_[0]; }
  char* const* argv() const { return argv_.data(); }

 private:
  std::vector<std::string> words_;
  std::vector<char*> argv_;
};

/// A running program. Standard streams: the given descriptors, -1 for a closed one.
inline pid_t start_app(const std::vector<std::string>& arguments, int in, int out, int err) {
  const CommandLine line(arguments);
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  const int wanted[] = {in, out, err};
  for (int fd = 0; fd < 3; ++fd) {
    if (wanted[fd] < 0)
      posix_spawn_file_actions_addclose(&actions, fd);
    else
      posix_spawn_file_actions_adddup2(&actions, wanted[fd], fd);
  }
  pid_t child = -1;
  const int error = ::posix_spawn(&child, line.program(), &actions, nullptr, line.argv(), environ);
  posix_spawn_file_actions_destroy(&actions);
  EXPECT_EQ(error, 0) << "cannot start " << line.program();
  return child;
}

/// A program that could not be started is -1, and a signal to that one goes to every process.
inline void send(pid_t child, int number) {
  if (child > 0) ::kill(child, number);
}

/// A command line to show where a test failed.
inline std::string all_words(const std::vector<std::string>& arguments) {
  std::string line;
  for (const std::string& a : arguments) line += " " + a;
  return line;
}

struct Ran {
  int status = -1;
  std::string out, err;
  std::uint64_t peak_bytes = 0;  ///< resident; at least what this process has when it starts it
};

/// Runs to the end with standard input from a file, output and errors captured.
inline Ran run_app(const std::vector<std::string>& arguments,
                   const std::string& input = "/dev/null", const std::string& output = "") {
  const Folder folder;
  const std::string out = output.empty() ? folder / "out" : output;
  const std::string err = folder / "err";
  const int fds[] = {::open(input.c_str(), O_RDONLY | O_CLOEXEC),
                     ::open(out.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600),
                     ::open(err.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600)};
  Ran ran;
  rusage used{};
  ran.status = wait_for(start_app(arguments, fds[0], fds[1], fds[2]), &used);
  ran.peak_bytes = static_cast<std::uint64_t>(used.ru_maxrss) << 10;
  for (const int fd : fds) ::close(fd);
  if (output.empty()) ran.out = read_file(out);
  ran.err = read_file(err);
  return ran;
}

/// As run_app, of a run that must end well.
inline Ran run_well(const std::vector<std::string>& arguments,
                    const std::string& input = "/dev/null", const std::string& output = "") {
  Ran ran = run_app(arguments, input, output);
  EXPECT_EQ(ran.status, 0) << all_words(arguments) << "\n" << ran.err;
  return ran;
}

/// As run_app, under limits that `limit` sets in the process that becomes the program; it may make
/// system calls only.
template <class Limit>
Ran run_limited(const std::vector<std::string>& arguments, const Limit& limit) {
  const Folder folder;
  const std::string out = folder / "out", err = folder / "err";
  const CommandLine line(arguments);
  const int fds[] = {::open("/dev/null", O_RDONLY | O_CLOEXEC),
                     ::open(out.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600),
                     ::open(err.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0600)};
  const pid_t child = ::fork();
  if (child == 0) {
    for (int fd = 0; fd < 3; ++fd) ::dup2(fds[fd], fd);
    limit();
    ::execv(line.program(), line.argv());
    ::_exit(126);
  }
  Ran ran;
  ran.status = wait_for(child);
  for (const int fd : fds) ::close(fd);
  ran.out = read_file(out);
  ran.err = read_file(err);
  return ran;
}

/// Standard error is one line that begins with the program's name.
inline ::testing::AssertionResult one_line(const std::string& err) {
  if (err.rfind("cullhull: ", 0) == 0 && err.find('\n') + 1 == err.size())
    return ::testing::AssertionSuccess();
  return ::testing::AssertionFailure() << "not one line from cullhull: [" << err << "]";
}

/// Ends with this status, prints nothing, and says one line that holds `part`.
inline void expect_error(const std::vector<std::string>& arguments, int status,
                         const std::string& part, const std::string& input = "/dev/null") {
  const Ran ran = run_app(arguments, input);
  const std::string line = all_words(arguments);
  EXPECT_EQ(ran.status, status) << line << "\n" << ran.err;
  EXPECT_TRUE(one_line(ran.err)) << line;
  EXPECT_TRUE(has(ran.err, part)) << line << "\n" << ran.err;
  EXPECT_EQ(ran.out, "") << line;
}

/// `program help COMMAND` prints what `program COMMAND --help` does; program: none, or
/// cullhull-bench.
inline void expect_same_help(std::vector<std::string> program, const std::string& command) {
  const std::string name = program.empty() ? "cullhull" : program[0];
  std::vector<std::string> flag = program;
  flag.insert(flag.end(), {command, "--help"});
  program.insert(program.end(), {"help", command});
  const Ran asked = run_well(program);
  EXPECT_EQ(asked.out, run_app(flag).out) << command;
  EXPECT_TRUE(has(asked.out, "Usage: " + name + " " + command));
}

/// The program without a word prints its help.
inline void expect_help_alone(std::vector<std::string> program) {
  const Ran alone = run_well(program);
  EXPECT_EQ(alone.err, "");
  EXPECT_TRUE(has(alone.out, "Subcommands:"));
  program.emplace_back("--help");
  EXPECT_EQ(alone.out, run_app(program).out);
}

/// Starts the program, interrupts it while it works (a signal that comes sooner is heard as well),
/// and gives what it says then.
inline std::string cancelled_at_work(const std::vector<std::string>& arguments) {
  const Folder folder;
  const std::string errors = folder / "errors.txt";
  const int null = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  const int err = ::open(errors.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
  const pid_t child = start_app(arguments, null, null, err);
  ::usleep(500000);
  send(child, SIGINT);
  EXPECT_EQ(wait_for(child), 130) << arguments[0];
  for (const int fd : {null, err}) ::close(fd);
  return read_file(errors);
}

/// A file of n points of a shape.
inline void write_points(const std::string& path, const char* shape, std::uint64_t n,
                         std::uint32_t d, ScalarType type = ScalarType::f64) {
  write_npy_points(path, generate(shape, n, d, 3).data(), n, d, type);
}

/// A program whose standard error is a terminal, so that it tells when it is at work.
class OnTerminal {
 public:
  /// `in`: standard input, closed here; -1: nothing to read. `columns`: of a terminal that is
  /// standard output, too; 0: only standard error is one.
  explicit OnTerminal(const std::vector<std::string>& arguments, int in = -1,
                      unsigned short columns = 0) {
    int terminal = -1;
    winsize window{};
    window.ws_col = columns;
    if (::openpty(&master_, &terminal, nullptr, nullptr, &window) != 0)
      throw std::runtime_error("no terminal to be had: is /dev/pts mounted?");
    ::fcntl(master_, F_SETFD, FD_CLOEXEC);
    const int null = ::open("/dev/null", O_RDWR | O_CLOEXEC);
    child_ = start_app(arguments, in < 0 ? null : in, columns > 0 ? terminal : null, terminal);
    for (const int fd : {terminal, null, in}) ::close(fd);
  }
  ~OnTerminal() { ::close(master_); }
  OnTerminal(const OnTerminal&) = delete;
  OnTerminal& operator=(const OnTerminal&) = delete;

  /// Takes what is shown, without waiting.
  void look() {
    pollfd ready{master_, POLLIN, 0};
    while (::poll(&ready, 1, 0) > 0 && (ready.revents & POLLIN) != 0 && read_some()) {
    }
  }
  /// Waits for the first word of progress.
  bool at_work() { return read_some(); }
  void signal(int number) const { send(child_, number); }
  int wait() {
    while (read_some()) {
    }
    return wait_for(child_);
  }
  const std::string& shown() const { return shown_; }

 private:
  bool read_some() {
    char buffer[4096];
    const ssize_t n = ::read(master_, buffer, sizeof buffer);  // fails once the program is gone
    if (n > 0) shown_.append(buffer, static_cast<std::size_t>(n));
    return n > 0;
  }
  int master_ = -1;
  pid_t child_ = -1;
  std::string shown_;
};

}  // namespace cullhull::testing
