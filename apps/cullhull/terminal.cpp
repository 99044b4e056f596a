#include "terminal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <system_error>

#include "cullhull/error.hpp"

namespace app {
namespace {

std::string reason(int error) { return std::generic_category().message(error); }

/// 0, or the error number.
int write_all(int fd, std::string_view text) {
  while (!text.empty()) {
    const ssize_t n = ::write(fd, text.data(), text.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno;
    text.remove_prefix(static_cast<std::size_t>(n));
  }
  return 0;
}

std::int64_t milliseconds() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

}  // namespace

void keep_standard_streams() {
  for (int fd = 0; fd <= 2; ++fd)
    if (::fcntl(fd, F_GETFD) < 0 && errno == EBADF)
      // The lowest free number is `fd`. The wrong direction keeps reads and writes failing.
      (void)!::open("/dev/null", fd == 0 ? O_WRONLY : O_RDONLY);
}

void write_stdout(std::string_view text) {
  if (const int error = write_all(STDOUT_FILENO, text); error != 0)
    throw cullhull::Error(cullhull::ErrorCode::io,
                          "cannot write to standard output: " + reason(error));
}

void complain(std::string_view message) {
  std::string line = "cullhull: ";
  for (const char c : message) line += static_cast<unsigned char>(c) < 32 || c == 127 ? '?' : c;
  line += '\n';
  (void)write_all(STDERR_FILENO, line);
}

TerminalProgress::TerminalProgress(bool quiet) : active_(!quiet && ::isatty(STDERR_FILENO) == 1) {}

TerminalProgress::~TerminalProgress() {
  if (shown_) (void)write_all(STDERR_FILENO, "\r\x1b[K");
}

cullhull::Progress TerminalProgress::callback() {
  if (!active_) return {};
  return [this](const char* phase, double share) { show(phase, share); };
}

void TerminalProgress::show(const char* phase, double share) {
  const std::int64_t now = milliseconds();
  if (shown_ && now - last_ < 50) return;
  last_ = now;
  shown_ = true;
  const double percent = 100 * std::clamp(share, 0.0, 1.0);
  (void)write_all(STDERR_FILENO, fmt::format("\r\x1b[K{} {:.0f} %", phase, percent));
}

}  // namespace app
