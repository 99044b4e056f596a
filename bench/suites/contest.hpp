// Shared by the suites that compare cullhull with rivals.
#pragma once

#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "cullhull/options.hpp"
#include "report.hpp"
#include "workload.hpp"

namespace cullhull::bench {

/// Names of values and their seconds, in order.
using NamedSeconds = std::vector<std::pair<std::string, double>>;

/// Runs are repeated until all runs together have taken this long.
inline constexpr double most_seconds_of_runs = 10;

/// Settings of these suites.
struct ContestSettings {
  std::vector<Workload> workloads;  ///< empty: the suite's default workloads
  double scale = 1;                 ///< factor for every size
  unsigned repeat = 5;              ///< medians of this many runs, of fewer if they are long
  std::vector<unsigned> threads;    ///< for cullhull, ascending; 0: all; empty: one, and all
  double limit = 30;                ///< seconds for one run of a rival; 0: no limit
  bool with_qhull = true, with_cgal = true;
  /// Program that times CGAL (bench/rival_cgal.cpp); empty: the one in this program's folder, if
  /// any.
  std::string cgal;
};

/// The program that times CGAL; empty if it is excluded or absent.
std::string cgal_of(const ContestSettings& settings);

/// A report without figures; its command is derived from the settings.
Report begin_report(const char* suite, const ContestSettings& settings,
                    const std::vector<unsigned>& threads);

/// A row without values.
Row begin_row(const Workload& w);

/// The numbers of threads to measure: ascending, without repeats, 0 replaced by the number of
/// processors. Empty: one, and all.
std::vector<unsigned> thread_counts(std::vector<unsigned> wanted);

/// The name of a cullhull value: "cullhull, 2 threads".
std::string our_column(unsigned threads);

/// A number of points times `scale`, but at least d + 2.
std::uint64_t scaled_count(std::uint64_t count, double scale, unsigned dimension);

/// Adds a rival's value: NaN if the rival is absent; if it did not finish, its limit.
void add_rival(Row& row, const std::string& name, double seconds, bool there, bool finished);

/// Adds the cullhull values after the rivals': the ratio is the fastest rival's time over the last
/// of these, and `slower` names those that took longer than a rival.
void add_ours(Row& row, const NamedSeconds& ours);

/// Figures of the rows that differ, of those where a rival is faster, and of all; empty ones are
/// omitted.
std::vector<Figure> judged_figures(Figure all, const char* title_of_different);

/// Reports a suite's progress row by row, and checks for cancellation.
class Steps {
 public:
  Steps(const Progress& progress, std::stop_token stop)
      : progress_(progress), stop_(std::move(stop)) {}
  /// Starts row `i` of `count`.
  void row(std::size_t i, std::size_t count) {
    at_ = static_cast<double>(i) / static_cast<double>(count);
  }
  /// Reports progress. Throws Error{cancelled}.
  void step(const std::string& what) const;
  const std::stop_token& stop() const { return stop_; }

 private:
  const Progress& progress_;
  std::stop_token stop_;
  double at_ = 0;
};

}  // namespace cullhull::bench
