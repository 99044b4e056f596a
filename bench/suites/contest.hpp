// Ours beside rivals: what the suites share that time both.
#pragma once

#include <stop_token>
#include <string>
#include <utility>
#include <vector>

#include "cullhull/options.hpp"
#include "report.hpp"
#include "workload.hpp"

namespace cullhull::bench {

/// Which values have names and seconds, in order.
using NamedSeconds = std::vector<std::pair<std::string, double>>;

/// One run follows another as long as all together have taken less.
inline constexpr double most_seconds_of_runs = 10;

/// What such suites are told.
struct ContestSettings {
  std::vector<Workload> workloads;  ///< empty: the suite's usual ones
  double scale = 1;                 ///< of every size
  unsigned repeat = 5;              ///< medians of so many runs, of fewer where they are long
  std::vector<unsigned> threads;    ///< for ours, ascending; 0: all; empty: one, and all
  double limit = 30;                ///< seconds for one run of a rival; 0: as long as it takes
  bool with_qhull = true, with_cgal = true;
  /// Program that times CGAL (bench/rival_cgal.cpp); empty: beside this one, if it is there.
  std::string cgal;
};

/// The program that times CGAL; empty where it is left out or not there.
std::string cgal_of(const ContestSettings& settings);

/// A report without figures; its command is that of the settings.
Report begin_report(const char* suite, const ContestSettings& settings,
                    const std::vector<unsigned>& threads);

/// A row without values.
Row begin_row(const Workload& w);

/// As they are measured: ascending, each once, 0 as what the machine has. Empty: one, and all.
std::vector<unsigned> thread_counts(std::vector<unsigned> wanted);

/// The name of our value: "cullhull, 2 threads".
std::string our_column(unsigned threads);

/// Every count of points times `scale`, but d + 2 at least.
std::uint64_t scaled_count(std::uint64_t count, double scale, unsigned dimension);

/// A rival's value; not a number where it was not there, and a limit it ran into if unfinished.
void add_rival(Row& row, const std::string& name, double seconds, bool there, bool finished);

/// Adds ours behind the rivals' values: the ratio is the fastest rival's time over the last of
/// ours, and `slower` says which of ours took longer.
void add_ours(Row& row, const NamedSeconds& ours);

/// Rows that differ, rows where a rival is faster, and all: figures without rows are left out.
std::vector<Figure> judged_figures(Figure all, const char* title_of_different);

/// Progress of a suite from row to row, and where it is cancelled.
class Steps {
 public:
  Steps(const Progress& progress, std::stop_token stop)
      : progress_(progress), stop_(std::move(stop)) {}
  /// Row `i` of `count` begins.
  void row(std::size_t i, std::size_t count) {
    at_ = static_cast<double>(i) / static_cast<double>(count);
  }
  /// Throws Error{cancelled}.
  void step(const std::string& what) const;
  const std::stop_token& stop() const { return stop_; }

 private:
  const Progress& progress_;
  std::stop_token stop_;
  double at_ = 0;
};

}  // namespace cullhull::bench
