// Suite `paper`: the evaluation of Tang, Zhao, Tong, Manocha, "GPU accelerated Convex Hull
// Computation", Computers & Graphics 36(5), 2012, section 5, on this machine.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "cullhull/options.hpp"
#include "report.hpp"

namespace cullhull::bench {

struct PaperSettings {
  double scale = 1;                  ///< factor for every size; sets keep at least 1000 points
  unsigned repeat = 5;               ///< cullhull: median of this many runs; Qhull runs once
  unsigned threads = 0;              ///< 0: all
  std::vector<std::string> figures;  ///< ids; empty: all
  double limit = 300;                ///< seconds for one run of Qhull; 0: no limit
};

/// The ids that run_paper knows, in its order.
const std::vector<std::string>& paper_figures();

/// Takes minutes at scale 1. Qhull runs on one core on the same points in the same run; every row
/// reports whether both found the same vertices and, if not, whether cullhull's hull is certified.
/// Throws Error{cancelled}, and Error{invalid_argument} for an unknown figure.
Report run_paper(const PaperSettings& settings, const Progress& progress,
                 const std::stop_token& stop);

}  // namespace cullhull::bench
