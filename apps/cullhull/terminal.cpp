#include "terminal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cmath>
#include <system_error>

#include "converted.hpp"
#include "cullhull/error.hpp"
#include "cullhull/io.hpp"
#include "system.hpp"

namespace app {
namespace {

std::string reason(int error) { return std::generic_category().message(error); }

/// 0, or the error number.
int write_all(int fd, std::string_view text) {
  while (!text.empty()) {
    const std::ptrdiff_t n = system::write_some(fd, text.data(), text.size());
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return errno;
    text.remove_prefix(static_cast<std::size_t>(n));
  }
  return 0;
}

thread_local volatile bool stderr_in_use = false;

/// The same to standard error, whose reader may have ended.
int write_all_stderr(std::string_view text) {
  const bool before = stderr_in_use;
  stderr_in_use = true;
  const int error = write_all(system::standard_error, text);
  stderr_in_use = before;
  return error;
}

/// How far the program's one line of complaint is: complain()'s, or end_with_line()'s.
enum LineState : int { silent, writing, written, ending, ended };
std::atomic<int> line_state{silent};

/// Whether a byte of a message would control a terminal instead of being shown; `before` precedes
/// it.
bool is_control(char c, char before) {
  const auto byte = static_cast<unsigned char>(c);
  return byte < 32 || byte == 127 || (before == '\xC2' && byte >= 0x80 && byte < 0xA0);
}

std::string printable(std::string_view message) {
  constexpr std::size_t most = 4000;
  std::string text;
  char before = 0;
  for (const char c : message) {
    if (is_control(c, before))
      text += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
    else
      text += c;
    before = c;
    if (text.size() > most) return text + "...";
  }
  return text;
}

std::int64_t milliseconds() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// "40 s", "3 min 20 s", "2 h 5 min".
std::string duration(double seconds) {
  if (!(seconds < 1e7)) return "very long";
  const auto whole = static_cast<std::int64_t>(std::ceil(seconds));
  if (whole < 60) return fmt::format("{} s", whole);
  if (whole < 3600) return fmt::format("{} min {} s", whole / 60, whole % 60);
  return fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

struct Scale {
  double factor;
  const char* unit;
};

/// The unit of bytes in which an amount is written.
Scale scale_of_bytes(double bytes) {
  if (bytes >= 1e9) return {1e9, "GB"};
  return bytes >= 1e6 ? Scale{1e6, "MB"} : Scale{1e3, "kB"};
}

/// "310 MB", "3.1 frames".
std::string amount(double value, const std::string& counted) {
  if (counted != "read") return fmt::format("{:.3g} {}", value, counted);
  const Scale scale = scale_of_bytes(value);
  return fmt::format("{:.3g} {}", value / scale.factor, scale.unit);
}

/// "1.20 of 4.51 GB", "12 of 40 frames".
std::string part_of(double part, double total, const std::string& counted) {
  if (counted != "read")
    return fmt::format("{} of {} {}", grouped(static_cast<std::uint64_t>(part)),
                       grouped(static_cast<std::uint64_t>(total)), counted);
  const Scale scale = scale_of_bytes(total);
  return fmt::format("{:.2f} of {:.2f} {}", part / scale.factor, total / scale.factor, scale.unit);
}

}  // namespace

void keep_standard_streams() {
  for (int fd = 0; fd <= 2; ++fd) system::open_if_closed(fd);
}

void write_stdout(std::string_view text) {
  if (const int error = write_all(system::standard_output, in_users_names(text)); error != 0)
    throw cullhull::Error(cullhull::ErrorCode::io,
                          "cannot write to standard output: " + reason(error));
}

bool writing_stderr() noexcept { return stderr_in_use; }

void write_stderr(std::string_view text) { (void)write_all_stderr(in_users_names(text)); }

void complain(std::string_view message) {
  const std::string line = "cullhull: " + printable(in_users_names(message)) + '\n';
  // Where another thread ends the program, its line is the last.
  int state = line_state;
  do {
    if (state >= ending) return;
  } while (!line_state.compare_exchange_weak(state, writing));
  (void)write_all_stderr(line);
  line_state = written;
}

// No allocation and no lock: memory may be exhausted, or the heap's lock held by the interrupted
// thread.
void end_with_line(int status, const char* first, const char* second) noexcept {
  int expected = silent;
  if (line_state.compare_exchange_strong(expected, ending)) {
    char line[1400];
    std::size_t length = 0;
    for (const char* part : {"cullhull: ", first, second})
      for (; *part != 0 && length < sizeof line - 1; ++part)
        line[length++] = is_control(*part, 0) ? '?' : *part;
    line[length++] = '\n';
    (void)write_all_stderr({line, length});
    line_state = ended;
  }
  while (line_state != written && line_state != ended) system::wait_10_ms();
  cullhull::remove_unfinished_files();
  system::end(status);
}

TerminalProgress::TerminalProgress(bool quiet) : TerminalProgress(quiet, "", 0) {}

TerminalProgress::TerminalProgress(bool quiet, std::string counted, double total)
    : counted_(std::move(counted)),
      total_(total),
      active_(!quiet && system::is_terminal(system::standard_error)) {}

TerminalProgress::~TerminalProgress() {
  if (shown_) (void)write_all_stderr("\r\x1b[K");
}

cullhull::Progress TerminalProgress::callback() {
  if (!active_) return {};
  return [this](const char* phase, double share) { show(phase, share); };
}

std::function<void(const cullhull::BlockPosition&)> TerminalProgress::bytes_callback() {
  if (!active_ || total_ > 0) return {};
  return [this](const cullhull::BlockPosition& at) { show_bytes(static_cast<double>(at.bytes)); };
}

bool TerminalProgress::begin(const std::string& phase, std::int64_t now, bool again) {
  if (phase_ != phase || again) {
    phase_ = phase;
    phase_began_ = now;
  }
  if (shown_ && now - last_ < 50) return false;
  last_ = now;
  return shown_ = true;
}

void TerminalProgress::show_bytes(double bytes) {
  const std::int64_t now = milliseconds();
  if (!begin("read", now, false)) return;
  std::string text = fmt::format("\r\x1b[K{:<10} {}", phase_, amount(bytes, "read"));
  const double seconds = static_cast<double>(now - phase_began_) / 1000;
  if (seconds >= 0.2) text += "  " + amount(bytes / seconds, "read") + "/s";
  (void)write_all_stderr(text);
}

// At the beginning of a phase the rate is not yet known.
std::string TerminalProgress::rest(double share, std::int64_t now) const {
  const bool counted = total_ > 0 && phase_ == counted_;
  std::string text = counted ? "  " + part_of(share * total_, total_, counted_) : "";
  const double seconds = static_cast<double>(now - phase_began_) / 1000;
  const double pace = (share - first_share_) / seconds;
  if (seconds < 0.2 || !(pace > 0)) return text;
  if (counted) text += "  " + amount(pace * total_, counted_) + "/s";
  return text + "  " + duration((1 - share) / pace) + " left";
}

void TerminalProgress::show(const char* phase, double share) {
  const std::int64_t now = milliseconds();
  share = std::clamp(share, 0.0, 1.0);
  const bool again = share < first_share_;
  if (phase_ != phase || again) first_share_ = share;
  if (!begin(phase, now, again)) return;
  constexpr int width = 24;
  const auto full = static_cast<int>(share * width);
  (void)write_all_stderr(fmt::format("\r\x1b[K{:<10} [{:#<{}}{:.<{}}] {:3.0f} %{}", phase, "", full,
                                     "", width - full, 100 * share, rest(share, now)));
}

}  // namespace app
