// Suite `lifting`: Delaunay triangulations beside Qhull's (as SciPy calls it), CGAL's where its
// program is installed, and those of other programs.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "calls.hpp"
#include "contest.hpp"
#include "cullhull/options.hpp"

namespace cullhull::bench {

/// Those that are measured if nothing else is asked for: uniform, clustered, on a lattice, on a
/// sphere and on lines in 2D and 3D, uniform in 4D and 5D; with a file its points in 2D.
std::vector<Workload> lifting_workloads(bool with_scan);

struct LiftingSettings : ContestSettings {
  std::string scan;  ///< file of the points of the family "scan"
  /// Programs that are run with a .npy of doubles and the word `delaunay`, and write the seconds
  /// and the number of simplices as doubles in binary.
  std::vector<RivalProgram> rivals;
};

/// Ours and the rivals by turns over the same doubles, rivals in processes of their own. A row
/// agrees if ours are the same for every number of threads and as many as CGAL's, which is exact;
/// where there is no CGAL, or where ties allow other cells, if ours are certified. Throws
/// Error{cancelled}; Error{invalid_argument} for a family that has no points of a dimension, or
/// "scan" without a file; Error{io} for a program of `rivals` that does not answer.
Report run_lifting(const LiftingSettings& settings, const Progress& progress,
                   const std::stop_token& stop);

}  // namespace cullhull::bench
