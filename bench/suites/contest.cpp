#include "contest.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>

#include "cgal.hpp"
#include "cullhull/error.hpp"
#include "machine.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::bench {

std::string cgal_of(const ContestSettings& settings) {
  if (!settings.with_cgal) return "";
  return settings.cgal.empty() ? cgal_program() : settings.cgal;
}

Report begin_report(const char* suite, const ContestSettings& settings,
                    const std::vector<unsigned>& threads) {
  Report report = begin_report(suite);
  report.scale = settings.scale;
  report.threads = threads.back();
  std::string& text = report.command;
  text = fmt::format("cullhull-bench {} --scale {:g} --repeat {} --limit {:g}", suite,
                     settings.scale, settings.repeat, settings.limit);
  if (!settings.threads.empty()) text += fmt::format(" --threads {}", fmt::join(threads, ","));
  for (const Workload& w : settings.workloads) text += " --workload " + w.name();
  if (!settings.with_qhull) text += " --without qhull";
  if (!settings.with_cgal) text += " --without cgal";
  return report;
}

Row begin_row(const Workload& w) {
  Row row;
  row.name = w.name();
  row.title = w.title();
  row.points = w.count;
  row.dimension = w.dimension;
  row.scalar = scalar_name(w.scalar);
  return row;
}

std::vector<unsigned> thread_counts(std::vector<unsigned> wanted) {
  if (wanted.empty()) wanted = {1, 0};
  for (unsigned& t : wanted) t = internal::resolve_threads(t);
  std::sort(wanted.begin(), wanted.end());
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  return wanted;
}

std::string our_column(unsigned threads) {
  return fmt::format("cullhull, {} thread{}", threads, threads == 1 ? "" : "s");
}

std::uint64_t scaled_count(std::uint64_t count, double scale, unsigned dimension) {
  return std::max<std::uint64_t>(
      dimension + 2, static_cast<std::uint64_t>(std::llround(static_cast<double>(count) * scale)));
}

void add_rival(Row& row, const std::string& name, double seconds, bool there, bool finished) {
  row.values.emplace_back(name, there ? seconds : std::numeric_limits<double>::quiet_NaN());
  if (!finished) row.unfinished.push_back(name);
}

void add_ours(Row& row, const NamedSeconds& ours) {
  double best = std::numeric_limits<double>::infinity();
  std::string fastest;
  for (const auto& [name, seconds] : row.values)
    if (seconds < best) {
      best = seconds;
      fastest = name;
    }
  row.values.insert(row.values.end(), ours.begin(), ours.end());
  if (fastest.empty()) {
    row.check += ", nobody to compare with";
    return;
  }
  row.ratio = best / ours.back().second;
  row.ratio_is_bound =
      std::find(row.unfinished.begin(), row.unfinished.end(), fastest) != row.unfinished.end();
  std::vector<std::string> lost;
  for (const auto& [name, seconds] : ours)
    if (best < seconds) lost.push_back(name.substr(name.find(", ") + 2));
  if (lost.empty()) return;
  row.slower = "than " + fastest;
  if (lost.size() < ours.size()) row.slower += fmt::format(" with {}", fmt::join(lost, " and "));
}

std::vector<Figure> judged_figures(Figure all, const char* title_of_different) {
  std::vector<Figure> figures;
  const auto those = [&](const char* id, const char* title, const auto& test) {
    Figure some{id, title, all.unit, "", false, {}};
    std::copy_if(all.rows.begin(), all.rows.end(), std::back_inserter(some.rows), test);
    if (!some.rows.empty()) figures.push_back(std::move(some));
  };
  those("differ", title_of_different, [](const Row& r) { return !r.agrees; });
  those("lost", "Where a rival is faster", [](const Row& r) { return !r.slower.empty(); });
  figures.push_back(std::move(all));
  return figures;
}

void Steps::step(const std::string& what) const {
  if (stop_.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled");
  if (progress_) progress_(what.c_str(), at_);
}

}  // namespace cullhull::bench
