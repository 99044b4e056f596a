// Suite `rivals`: ours beside Qhull, and CGAL where its program is installed, over size, dimension,
// distribution, scalar type and threads.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "contest.hpp"
#include "cullhull/options.hpp"

namespace cullhull::bench {

/// Those that are measured if nothing else is asked for.
const std::vector<Workload>& rival_workloads();

/// Rivals run once, on one core, in processes of their own, on the same values as doubles (floats
/// and integers are made by rounding and given to all). Rows where extreme points differ from
/// CGAL's, or cannot be proved where Qhull's differ, do not agree and come first in a figure of
/// their own; then those where a rival is faster. Throws Error{cancelled}, and
/// Error{invalid_argument} for a family that has no points of a dimension.
Report run_rivals(const ContestSettings& settings, const Progress& progress,
                  const std::stop_token& stop);

}  // namespace cullhull::bench
