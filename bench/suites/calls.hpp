// Suite `calls`: single calls, one after the other on different sets, as in a program that needs
// many hulls of small and middle size. Reports the median and the 99th percentile.
#pragma once

#include <stop_token>
#include <string>
#include <vector>

#include "cullhull/options.hpp"
#include "report.hpp"
#include "workload.hpp"

namespace cullhull::bench {

/// A program that reads a .npy file of doubles and a number of sets to divide it into, and writes
/// the seconds of each set's hull as doubles in binary (for example bench/rival_cgal.cpp).
struct RivalProgram {
  std::string name, path;
};

struct CallSettings {
  std::vector<Workload> workloads;      ///< `count` points per set; empty: call_workloads()
  std::vector<unsigned> threads{0, 1};  ///< 0: the default options
  std::vector<unsigned> callers{1};     ///< number of threads that call at once, on different sets
  std::vector<unsigned> busy{0, 1};     ///< processes that keep cores busy: a figure each
  double seconds = 0.5;                 ///< duration of the calls for each value
  double limit = 30;                    ///< seconds for all calls of a program; 0: no limit
  std::uint64_t seed = 1;               ///< random seed of the sets
  bool with_qhull = true, with_cgal = true;
  std::vector<RivalProgram> rivals{};
  /// The program whose first call in a process is timed; empty: the cullhull program in the same
  /// folder, if there is one.
  std::string first_call;
};

/// The default workloads: 10 to 100,000 points in 2D to 4D.
const std::vector<Workload>& call_workloads();

/// A call's time includes the creation of lists on access, and freeing the result. Kinds of calls
/// alternate, so that disturbances affect all of them; programs run separately. The first set's
/// hull is certified. Throws Error{cancelled}, Error{invalid_argument} for a shape that `generate`
/// does not support in a dimension, and Error{io} for a rival that cannot be run or reports no
/// times.
Report run_calls(const CallSettings& settings, const Progress& progress,
                 const std::stop_token& stop);

}  // namespace cullhull::bench
