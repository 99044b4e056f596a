#include "rivals.hpp"

#include <fmt/format.h>

#include <optional>

#include "cgal.hpp"
#include "contest.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "families.hpp"
#include "machine.hpp"
#include "qhull.hpp"
#include "timing.hpp"

namespace cullhull::bench {
namespace {

class RivalsSuite {
 public:
  RivalsSuite(const ContestSettings& settings, const Progress& progress,
              const std::stop_token& stop)
      : settings_(settings),
        steps_(progress, stop),
        cgal_(cgal_of(settings)),
        threads_(thread_counts(settings.threads)) {}

  Report run() {
    const std::vector<Workload>& wanted =
        settings_.workloads.empty() ? rival_workloads() : settings_.workloads;
    for (const Workload& w : wanted)
      if (!is_family(w.family, w.dimension))
        throw Error(ErrorCode::invalid_argument, "bench rivals knows no points '" + w.family +
                                                     "' of dimension " +
                                                     std::to_string(w.dimension));
    report_ = begin_report("rivals", settings_, threads_);
    for (const unsigned t : threads_)
      report_.read_bandwidth.emplace_back(t, read_bandwidth(t, steps_.stop()));
    Figure all{"rivals", "Time to the hull", "s", "", false, {}};
    all.note = fmt::format(
        "Ratio: the time of the faster rival over ours with {} thread{}. Rivals run once, on one "
        "core, as they are made; ours is the median of {} runs, of fewer where they are long.",
        threads_.back(), threads_.back() == 1 ? "" : "s", settings_.repeat);
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      steps_.row(i, wanted.size());
      all.rows.push_back(row_of(wanted[i]));
    }
    report_.figures = judged_figures(std::move(all), "Where extreme points differ");
    return std::move(report_);
  }

 private:
  Row row_of(Workload w) {
    w.count = scaled_count(w.count, settings_.scale, w.dimension);
    steps_.step(w.name() + ", points");
    const Points points = points_of(w, make_family(w.family, w.count, w.dimension));
    w.count = points.view.count;
    Row row = begin_row(w);
    const Hull hull = ours(w, points.view, row);
    const NamedSeconds ours_values = std::move(row.values);
    row.values.clear();
    rivals(w, points, hull, row);
    add_ours(row, ours_values);
    return row;
  }

  /// Adds a value for each number of threads; returns the hull for all threads.
  Hull ours(const Workload& w, const PointView& points, Row& row) const {
    Hull hull;
    row.agrees = true;
    for (const unsigned t : threads_) {
      Options options;
      options.threads = t;
      options.stop = steps_.stop();
      std::vector<double> times, shares;
      double spent = 0;
      const std::vector<std::uint64_t> before = std::move(hull.vertices);
      for (unsigned k = 0; k < settings_.repeat && (k == 0 || spent < most_seconds_of_runs); ++k) {
        steps_.step(fmt::format("{}, {}", w.name(), our_column(t)));
        hull = {};
        hull = convex_hull(points, options);
        times.push_back(hull.statistics.compute_seconds);
        shares.push_back(bandwidth_share(report_, points, hull.statistics));
        spent += times.back();
      }
      if (t != threads_.front() && before != hull.vertices) {
        row.agrees = false;
        row.check = fmt::format("{} threads give another hull; ", t);
      }
      row.values.emplace_back(our_column(t), median(times));
      row.bandwidth = median(shares);
      row.reads = reads_of(points, median(times), t);
    }
    row.vertices = hull.vertices.size();
    return hull;
  }

  /// Number of times that as many threads could have read the points in these seconds.
  double reads_of(const PointView& points, double seconds, unsigned threads) const {
    for (const auto& [count, rate] : report_.read_bandwidth)
      if (count == threads)
        return seconds * rate /
               static_cast<double>(points.count * points.dimension * scalar_size(points.scalar));
    return 0;
  }

  void rivals(const Workload& w, const Points& points, const Hull& hull, Row& row) const {
    const ChildLimits limits{settings_.limit, steps_.stop()};
    std::optional<QhullRun> qhull;
    std::optional<CgalRun> cgal;
    if (settings_.with_qhull) {
      steps_.step(w.name() + ", Qhull");
      qhull = run_qhull(points.doubles, limits);
      add_rival(row, "Qhull", qhull ? qhull->seconds : 0, qhull.has_value(),
                !qhull || qhull->finished);
    }
    if (settings_.with_cgal) {
      steps_.step(w.name() + ", CGAL");
      cgal = run_cgal(cgal_, points.rows, w.dimension, limits);
      add_rival(row, "CGAL", cgal ? cgal->seconds : 0, cgal.has_value(), !cgal || cgal->finished);
    }
    row.check += fmt::format("{} vertices", hull.vertices.size());
    const bool judged = cgal && cgal->finished && compare_with_cgal(points, hull, *cgal, row);
    if (qhull && qhull->finished && qhull->vertices != hull.vertices.size()) {
      row.check += fmt::format(", Qhull {}", qhull->vertices);
      row.remark = "Qhull, which decides with tolerances, found other extreme points.";
      if (!judged) prove(w, points, hull, row);
    }
  }

  /// CGAL is exact, so its extreme points must be cullhull's. Compares coordinates, because
  /// cullhull names the lowest id of equal points.
  static bool compare_with_cgal(const Points& points, const Hull& hull, const CgalRun& cgal,
                                Row& row) {
    const unsigned d = points.doubles.dimension;
    std::vector<double> rows;
    rows.reserve(hull.vertices.size() * d);
    for (const std::uint64_t v : hull.vertices)
      for (unsigned j = 0; j < d; ++j) rows.push_back(points.doubles.at(v, j));
    const Difference found = difference(rows, cgal.extreme, d);
    if (found.first == 0 && found.second == 0) {
      row.check += ", all of them CGAL's";
    } else {
      row.agrees = false;
      row.check += fmt::format(", {} not CGAL's, {} only CGAL's", found.first, found.second);
    }
    return true;
  }

  /// Certifies the hull; for rows without an exact rival.
  void prove(const Workload& w, const Points& points, const Hull& hull, Row& row) const {
    steps_.step(w.name() + ", certificate");
    const Certificate certificate = certify(points.view, hull);
    row.agrees = row.agrees && certificate.valid;
    row.check +=
        certificate.valid ? ", ours certified" : ", ours NOT certified: " + certificate.reason;
  }

  const ContestSettings& settings_;
  Steps steps_;
  std::string cgal_;
  std::vector<unsigned> threads_;
  Report report_;
};

}  // namespace

const std::vector<Workload>& rival_workloads() {
  static const std::vector<Workload> workloads = {
      {"ball", 3, 8'000'000},
      {"ball", 3, 8'000'000, ScalarType::f32},
      {"ball", 3, 8'000'000, ScalarType::i32},
      {"octahedron", 3, 15'000'000},
      {"cube", 3, 10'000'000},
      {"gauss", 3, 10'000'000},
      {"gauss", 3, 10'000'000, ScalarType::f32},
      {"ball", 3, 100'000},
      {"ball", 3, 10'000},
      {"ball", 3, 1'000},
      {"sphere", 3, 1'000'000},
      {"sphere", 3, 1'000'000, ScalarType::f32},
      {"bumpy", 3, 1'000'000},
      {"grid", 3, 2'000'000},
      {"grid", 3, 2'000'000, ScalarType::i32},
      {"cube-surface", 3, 1'000'000},
      {"turned-lattice-surface", 3, 1'000'000},
      {"cylinder", 3, 1'000'000},
      {"cone", 3, 1'000'000},
      {"two-circles", 3, 1'000'000},
      {"squashed", 3, 1'000'000},
      {"turned-squashed", 3, 1'000'000},
      {"ball", 2, 10'000'000},
      {"sphere", 2, 2'000'000},
      {"sphere", 2, 2'000'000, ScalarType::i32},
      {"ball", 4, 8'000'000},
      {"gauss", 4, 1'000'000},
      {"sphere", 4, 100'000},
      {"ball", 5, 1'000'000},
      {"sphere", 5, 10'000},
      {"ball", 6, 100'000},
      {"ball", 7, 3'000},
      {"ball", 8, 500},
  };
  return workloads;
}

Report run_rivals(const ContestSettings& settings, const Progress& progress,
                  const std::stop_token& stop) {
  return RivalsSuite(settings, progress, stop).run();
}

}  // namespace cullhull::bench
