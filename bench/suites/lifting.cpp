#include "lifting.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <optional>

#include "cgal.hpp"
#include "contest.hpp"
#include "cullhull/error.hpp"
#include "cullhull/io.hpp"
#include "cullhull/triangulation.hpp"
#include "families.hpp"
#include "lifting_rivals.hpp"
#include "machine.hpp"
#include "qhull.hpp"
#include "timing.hpp"

namespace cullhull::bench {
namespace {

constexpr const char* scan = "scan";

/// A rival and its time.
struct Rival {
  std::string name;
  std::function<std::optional<LiftedRun>()> run;
  bool exact = false;     ///< must have as many cells as cullhull, except for ties
  bool required = false;  ///< no result is an error
  std::vector<double> seconds{};
  std::optional<LiftedRun> last{};

  bool again() const {
    double spent = 0;
    for (const double s : seconds) spent += s;
    return seconds.empty() || (last && last->finished && spent < most_seconds_of_runs);
  }
};

class LiftingSuite {
 public:
  LiftingSuite(const LiftingSettings& settings, const Progress& progress,
               const std::stop_token& stop)
      : settings_(settings),
        steps_(progress, stop),
        threads_(thread_counts(settings.threads)),
        cgal_(cgal_of(settings)) {}

  Report run() {
    const std::vector<Workload> wanted = settings_.workloads.empty()
                                             ? lifting_workloads(!settings_.scan.empty())
                                             : settings_.workloads;
    for (const Workload& w : wanted) require_points(w);
    Report report = begin_report("lifting", settings_, threads_);
    if (!settings_.scan.empty()) report.command += " --scan " + settings_.scan;
    for (const RivalProgram& r : settings_.rivals)
      report.command += " --rival " + r.name + "=" + r.path;
    Figure all{"lifting", "Time to the Delaunay triangulation", "s", "", false, {}};
    all.note = fmt::format(
        "Ratio: the time of the fastest rival over ours with {} thread{}. Medians of {} turns, of "
        "fewer where they are long. Qhull is called as SciPy calls it.",
        threads_.back(), threads_.back() == 1 ? "" : "s", settings_.repeat);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      steps_.row(i, wanted.size());
      all.rows.push_back(row_of(wanted[i]));
    }
    report.figures = judged_figures(std::move(all), "Where triangulations differ");
    return report;
  }

 private:
  struct Ours {
    unsigned threads;
    std::vector<double> seconds{};
  };

  void require_points(const Workload& w) const {
    if (w.family == scan && settings_.scan.empty())
      throw Error(ErrorCode::invalid_argument,
                  "bench lifting: points 'scan' are those of a file (--scan FILE)");
    if (w.family != scan && !is_family(w.family, w.dimension))
      throw Error(
          ErrorCode::invalid_argument,
          fmt::format("bench lifting knows no points '{}' of dimension {}", w.family, w.dimension));
  }

  /// The first coordinates of the first points of the scan file.
  std::vector<double> scanned(const Workload& w) const {
    const PointFile file = open_points(settings_.scan);
    const PointView& view = file.points();
    if (view.dimension < w.dimension)
      throw Error(ErrorCode::invalid_argument,
                  fmt::format("{}: points of dimension {}, not {}", settings_.scan, view.dimension,
                              w.dimension));
    std::vector<double> rows;
    const std::uint64_t count = std::min(w.count, view.count);
    rows.reserve(count * w.dimension);
    for (std::uint64_t i = 0; i < count; ++i)
      for (unsigned j = 0; j < w.dimension; ++j) rows.push_back(view.at(i, j));
    return rows;
  }

  Row row_of(Workload w) {
    w.count = scaled_count(w.count, settings_.scale, w.dimension);
    steps_.step(w.name() + ", points");
    const Points points =
        points_of(w, w.family == scan ? scanned(w) : make_family(w.family, w.count, w.dimension));
    w.count = points.view.count;
    Row row = begin_row(w);
    std::vector<Rival> rivals = rivals_of(points.doubles);
    std::vector<Ours> ours;
    for (const unsigned t : threads_) ours.push_back({t});
    const Triangulation cells = take_turns(w, points.view, ours, rivals, row);
    for (const Rival& r : rivals)
      add_rival(row, r.name, median(r.seconds), r.last.has_value(), !r.last || r.last->finished);
    judge(w, points.view, cells, rivals, row);
    NamedSeconds values;
    for (const Ours& o : ours) values.emplace_back(our_column(o.threads), median(o.seconds));
    add_ours(row, values);
    return row;
  }

  std::vector<Rival> rivals_of(const PointView& points) const {
    const ChildLimits limits{settings_.limit, steps_.stop()};
    const auto program = [&points, limits](const std::string& path, const char* word) {
      return
          [&points, limits, path, word] { return run_lifting_program(path, word, points, limits); };
    };
    std::vector<Rival> all;
    if (settings_.with_qhull && has_qhull())
      all.push_back({"Qhull", [&points, limits] { return run_qhull_delaunay(points, limits); }});
    if (!cgal_.empty() && points.dimension <= 3)
      all.push_back({"CGAL", program(cgal_, "delaunay"), true});
    if (!cgal_.empty() && points.dimension == 3)
      all.push_back({"CGAL, all threads", program(cgal_, "delaunay-parallel"), true});
    for (const RivalProgram& r : settings_.rivals)
      all.push_back({r.name, program(r.path, "delaunay"), false, true});
    return all;
  }

  /// Runs rivals first, then cullhull with the most threads, which so finds none of its own data in
  /// the caches. Returns the last triangulation by cullhull.
  Triangulation take_turns(const Workload& w, const PointView& points, std::vector<Ours>& ours,
                           std::vector<Rival>& rivals, Row& row) const {
    Triangulation first, cells;
    for (unsigned k = 0; k < settings_.repeat; ++k) {
      for (Rival& r : rivals) {
        if (!r.again()) continue;
        steps_.step(fmt::format("{}, {}", w.name(), r.name));
        r.last = r.run();
        if (!r.last && r.required)
          throw Error(ErrorCode::io,
                      r.name + ": no rival that writes its seconds and number of simplices");
        if (r.last) r.seconds.push_back(r.last->seconds);
      }
      for (auto at = ours.rbegin(); at != ours.rend(); ++at) {
        Ours& o = *at;
        steps_.step(fmt::format("{}, {}", w.name(), our_column(o.threads)));
        TriangulationOptions options;
        options.threads = o.threads;
        options.stop = steps_.stop();
        o.seconds.push_back(
            settled_seconds([&] { cells = {}; }, [&] { cells = delaunay(points, options); }));
        if (first.point_count == 0) first = cells;
        if (first.cells == cells.cells && first.neighbours == cells.neighbours) continue;
        row.agrees = false;
        row.check = fmt::format("{} threads give other cells; ", o.threads);
      }
    }
    return cells;
  }

  /// Exact rivals must have as many cells, except for ties beyond 2D; otherwise the result is
  /// certified.
  void judge(const Workload& w, const PointView& points, const Triangulation& cells,
             const std::vector<Rival>& rivals, Row& row) const {
    row.check += fmt::format("{} cells", cells.size());
    bool judged = false;
    for (const Rival& r : rivals) {
      if (!r.last || !r.last->finished) continue;
      const bool same = r.last->cells == cells.size();
      if (!same) row.check += fmt::format(", {} {}", r.name, r.last->cells);
      if (!r.exact || (points.dimension > 2 && !cells.cell_groups.empty())) continue;
      if (same && !judged) row.check += ", as many as " + r.name;
      row.agrees = row.agrees && same;
      judged = true;
    }
    if (judged) return;
    steps_.step(w.name() + ", certificate");
    TriangulationOptions options;
    options.stop = steps_.stop();
    const Certificate certificate = certify(points, cells, options);
    row.agrees = row.agrees && certificate.valid;
    row.check += certificate.valid ? ", certified" : ", NOT certified: " + certificate.reason;
  }

  const LiftingSettings& settings_;
  Steps steps_;
  std::vector<unsigned> threads_;
  std::string cgal_;
};

}  // namespace

std::vector<Workload> lifting_workloads(bool with_scan) {
  std::vector<Workload> all;
  const std::pair<unsigned, std::vector<std::uint64_t>> sizes[] = {{2, {1'000, 100'000, 1'000'000}},
                                                                   {3, {1'000, 10'000, 100'000}}};
  for (const auto& [d, counts] : sizes)
    for (const char* family : {"uniform", "clustered", "lattice", "sphere", "lines"})
      for (const std::uint64_t n : counts) all.push_back({family, d, n});
  if (with_scan)
    for (const std::uint64_t n : {100'000, 1'000'000}) all.push_back({scan, 2, n});
  all.push_back({"uniform", 4, 1'000});
  all.push_back({"uniform", 4, 10'000});
  all.push_back({"uniform", 5, 2'000});
  return all;
}

Report run_lifting(const LiftingSettings& settings, const Progress& progress,
                   const std::stop_token& stop) {
  return LiftingSuite(settings, progress, stop).run();
}

}  // namespace cullhull::bench
