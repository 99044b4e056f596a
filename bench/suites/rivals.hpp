// Suite `rivals`: ours beside Qhull, and CGAL where its program is installed, over size, dimension,
// distribution, scalar type and threads.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "cullhull/options.hpp"
#include "report.hpp"
#include "workload.hpp"

namespace cullhull::bench {

/// Those that are measured if nothing else is asked for.
const std::vector<Workload>& rival_workloads();

struct RivalSettings {
  std::vector<Workload> workloads;  ///< empty: rival_workloads()
  double scale = 1;                 ///< of every size
  unsigned repeat = 5;              ///< ours: the median of so many runs, fewer where they are long
  std::vector<unsigned> threads;    ///< for ours, ascending; 0: all; empty: one, and all
  double limit = 30;                ///< seconds for one run of a rival; 0: as long as it takes
  bool with_qhull = true, with_cgal = true;
  /// Program that times CGAL (bench/rival_cgal.cpp); empty: beside this one, if it is there.
  std::string cgal;
};

/// Rivals run once, on one core, in processes of their own, on the same values as doubles (floats
/// and integers are made by rounding and given to all). Rows where extreme points differ from
/// CGAL's, or cannot be proved where Qhull's differ, do not agree and come first in a figure of
/// their own; then those where a rival is faster. Throws Error{cancelled}, and
/// Error{invalid_argument} for a family that has no points of a dimension.
Report run_rivals(const RivalSettings& settings, const Progress& progress,
                  const std::stop_token& stop);

}  // namespace cullhull::bench
