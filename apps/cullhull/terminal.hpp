// Standard output and standard error, with checks for write errors.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "cullhull/options.hpp"
#include "cullhull/point_blocks.hpp"
#include "numbers.hpp"

namespace app {

/// Opens /dev/null for standard streams that the caller closed, so that no file opened later gets
/// their number; writing to a closed standard output still fails.
void keep_standard_streams();

/// Writes all of `text` or throws Error{io} (closed pipe, full disk).
void write_stdout(std::string_view text);

/// Whether this thread is writing to standard error. Async-signal-safe.
bool writing_stderr() noexcept;

/// Writes requested text to standard error; a failure there cannot be reported.
void write_stderr(std::string_view text);

/// One line on standard error: "cullhull: message". Control characters are escaped.
void complain(std::string_view message);

/// Ends the program at once, from any thread or signal handler: removes unfinished files and writes
/// one line, "cullhull: " and the two parts, unless another thread or complain() wrote one.
[[noreturn]] void end_with_line(int status, const char* first, const char* second = "") noexcept;

inline constexpr const char* out_of_memory =
    "out of memory; a smaller --memory makes cullhull refuse earlier";

/// Shows a line of progress on standard error if that is a terminal: phase, bar, share and time
/// left. The destructor erases the line.
class TerminalProgress {
 public:
  explicit TerminalProgress(bool quiet);
  /// Also shows the amount done and the rate of the phase named `counted`, whose total is known.
  /// "read" counts bytes, other phases what they are called ("frames").
  TerminalProgress(bool quiet, std::string counted, double total);
  ~TerminalProgress();
  TerminalProgress(const TerminalProgress&) = delete;
  TerminalProgress& operator=(const TerminalProgress&) = delete;

  /// Empty if standard error is no terminal.
  cullhull::Progress callback();
  /// For inputs whose size is unknown: shows the bytes read and their rate. Empty where the total
  /// is known, and as callback().
  std::function<void(const cullhull::BlockPosition&)> bytes_callback();

 private:
  void show(const char* phase, double share);
  void show_bytes(double bytes);
  /// Whether to write the line again; `again`: the phase of the same name is a new one.
  bool begin(const std::string& phase, std::int64_t now, bool again);
  std::string rest(double share, std::int64_t now) const;
  std::string counted_;
  double total_ = 0;
  bool active_;
  bool shown_ = false;
  std::int64_t last_ = 0;
  std::string phase_;
  std::int64_t phase_began_ = 0;
  double first_share_ = 0;  ///< of this phase
};

using cullhull::bench::grouped;

}  // namespace app
