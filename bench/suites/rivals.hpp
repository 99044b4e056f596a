// Suite `rivals`: ours beside Qhull, and CGAL where its program is installed, over size, dimension,
// distribution, scalar type and threads.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "cullhull/options.hpp"
#include "report.hpp"

namespace cullhull::bench {

struct RivalSettings {
  double scale = 1;
  unsigned repeat = 5;
  unsigned threads = 0;
  std::vector<std::string> workloads;  ///< names; empty: all
  /// Program that times CGAL (bench/rival_cgal.cpp); empty: beside this one, if it is there.
  std::string cgal;
};

/// Names of the workloads, in order.
std::vector<std::string> rival_workloads();

/// Workloads where a rival is faster are marked and come first in a figure of their own.
Report run_rivals(const RivalSettings& settings, const Progress& progress,
                  const std::stop_token& stop);

}  // namespace cullhull::bench
