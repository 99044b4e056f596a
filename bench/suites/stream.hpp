// Suite `stream`: hulls of files read in blocks, compared with a plain read of the same file.
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>
#include <vector>

#include "cullhull/options.hpp"
#include "report.hpp"

namespace cullhull::bench {

struct StreamSettings {
  double scale = 1;                  ///< factor for 20 million points (text: 2 million)
  unsigned repeat = 5;               ///< number of runs; medians are reported
  std::vector<std::string> formats;  ///< of stream_formats(); empty: all
  std::string folder;                ///< for the files, removed later; empty: a temporary one
  std::string memory = "1GiB";       ///< the program's --memory
  /// The program to run; empty: the cullhull program in the same folder.
  std::string program;
};

/// "npy", "ply", "las", "csv", "npy.gz".
const std::vector<std::string>& stream_formats();

/// Each file holds points of a ball. It is read plainly, in blocks of a mebibyte as dd reads, and
/// its hull is computed by a separate process with --stream on, in turn, from the page cache. A row
/// agrees if its hull has the counts and measures of the same points in memory. The last figure
/// shows the peak resident set. Throws Error{cancelled}; Error{invalid_argument} for an unknown
/// format; Error{io} if files cannot be written or the program cannot be run.
Report run_stream(const StreamSettings& settings, const Progress& progress,
                  const std::stop_token& stop);

}  // namespace cullhull::bench
