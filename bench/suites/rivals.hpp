// Suite `rivals`: cullhull compared with Qhull, and with CGAL if its program is installed, for
// various sizes, dimensions, distributions, scalar types and threads.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "contest.hpp"
#include "cullhull/options.hpp"

namespace cullhull::bench {

/// The default workloads.
const std::vector<Workload>& rival_workloads();

/// Rivals run once, on one core, in separate processes, on the same values as doubles (floats and
/// integers result from rounding, and all get them). Rows whose extreme points differ from CGAL's,
/// or differ from Qhull's and cannot be certified, do not agree; they come first, in a figure of
/// their own, followed by rows where a rival is faster. Throws Error{cancelled}, and
/// Error{invalid_argument} for a family that does not support a dimension.
Report run_rivals(const ContestSettings& settings, const Progress& progress,
                  const std::stop_token& stop);

}  // namespace cullhull::bench
