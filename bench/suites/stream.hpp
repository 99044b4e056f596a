// Suite `stream`: files hulled in blocks beside a plain read of the same file.
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include "cullhull/options.hpp"
#include "report.hpp"

namespace cullhull::bench {

struct StreamSettings {
  double scale = 1;                  ///< of 20 million points (text: 2 million)
  unsigned repeat = 5;               ///< medians
  std::vector<std::string> formats;  ///< of stream_formats(); empty: all
  std::string folder;                ///< where the files are made, and removed; empty: the system's
  std::string memory = "1GiB";       ///< the program's --memory
  /// The program that is run; empty: the cullhull beside this one.
  std::string program;
};

/// "npy", "ply", "las", "csv", "npy.gz".
const std::vector<std::string>& stream_formats();

/// Each file holds a ball's points and is read plainly, in blocks of a mebibyte as dd reads, and
/// hulled by a process of its own with --stream on, by turns, from the page cache. A row agrees if
/// its hull has the counts and measures that the same points have in memory. The last figure has
/// the peak resident set. Throws Error{cancelled}; Error{invalid_argument} for an unknown format;
/// Error{io} where files cannot be made or the program cannot be run.
Report run_stream(const StreamSettings& settings, const Progress& progress,
                  const std::stop_token& stop);

}  // namespace cullhull::bench
