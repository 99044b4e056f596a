// Suite `paths`: what each way of src/filter/ways.hpp gains on the points that suit it best, and
// what it costs on others.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "cullhull/options.hpp"
#include "report.hpp"

namespace cullhull::bench {

struct PathSettings {
  std::vector<std::string> ways;  ///< names of ways; empty: all that can be switched off
  double scale = 1;               ///< factor on every number of points
  double seconds = 1;             ///< of calls for each set of points
};

/// The ways that can be switched off.
std::vector<std::string> path_names();

/// Calls with a way and without it alternate on one thread, whose processor time is measured; a
/// ratio is the median over the pairs. Hulls with and without a way must be equal. Throws
/// Error{cancelled}.
Report run_paths(const PathSettings& settings, const Progress& progress,
                 const std::stop_token& stop);

}  // namespace cullhull::bench
