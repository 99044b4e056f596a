#include "terminal.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstring>
#include <system_error>

#include "cullhull/error.hpp"
#include "cullhull/io.hpp"

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

/// Who writes the program's one line of complaint.
enum LineState : int { silent, writing, written };
std::atomic<int> line_state{silent};

/// A byte of a message that would act on a terminal instead of being shown; `before` precedes it.
bool is_control(char c, char before) {
  const auto byte = static_cast<unsigned char>(c);
  return byte < 32 || byte == 127 || (before == '\xC2' && byte >= 0x80 && byte < 0xA0);
}

std::string printable(std::string_view message) {
  std::string text;
  char before = 0;
  for (const char c : message) {
    if (is_control(c, before))
      text += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    else
      text += c;
    before = c;
  }
  return text;
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
  const std::string line = "cullhull: " + printable(message) + '\n';
  line_state = writing;
  (void)write_all(STDERR_FILENO, line);
  line_state = written;
}

// No allocation and no lock: the heap may be exhausted, or its lock held where a signal arrived.
void end_with_line(int status, const char* first, const char* second) noexcept {
  int expected = silent;
  if (line_state.compare_exchange_strong(expected, writing)) {
    char line[1400];
    std::size_t length = 0;
    for (const char* part : {"cullhull: ", first, second})
      for (; *part != 0 && length < sizeof line - 1; ++part)
        line[length++] = is_control(*part, 0) ? '?' : *part;
    line[length++] = '\n';
    (void)write_all(STDERR_FILENO, {line, length});
    line_state = written;
  }
  while (line_state != written) ::poll(nullptr, 0, 10);
  cullhull::remove_unfinished_files();
  ::_exit(status);
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
