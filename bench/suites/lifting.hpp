// Suite `lifting`: Delaunay triangulations compared with Qhull's (called as SciPy does), CGAL's if
// its program is installed, and those of other programs.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "calls.hpp"
#include "contest.hpp"
#include "cullhull/options.hpp"

namespace cullhull::bench {

/// The default workloads: uniform, clustered, on a lattice, on a sphere and on lines in 2D and 3D,
/// uniform in 4D and 5D; with a scan file, its points in 2D.
std::vector<Workload> lifting_workloads(bool with_scan);

struct LiftingSettings : ContestSettings {
  std::string scan;  ///< file with the points of the family "scan"
  /// Programs that are run with a .npy file of doubles and the word `delaunay`, and write the
  /// seconds and the number of simplices as doubles in binary.
  std::vector<RivalProgram> rivals;
};

/// Runs cullhull and rivals in turn on the same doubles, rivals in separate processes. A row agrees
/// if cullhull's results are the same for all numbers of threads, and have as many cells as CGAL's,
/// which is exact; without CGAL, or if ties allow other cells, they must be certified. Throws
/// Error{cancelled}; Error{invalid_argument} for a family that does not support a dimension, or
/// "scan" without a file; Error{io} for a program of `rivals` that gives no result.
Report run_lifting(const LiftingSettings& settings, const Progress& progress,
                   const std::stop_token& stop);

}  // namespace cullhull::bench
