#include "paths.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>

#include "contest.hpp"
#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "families.hpp"
#include "filter/ways.hpp"
#include "timing.hpp"

namespace cullhull::bench {
namespace {

using internal::Way;

/// A way that gains less on its best points, or costs more on others, is marked.
constexpr double least_gain = 1.10, most_cost = 1.03;

struct Path {
  Way way;
  Workload best;
  std::uint64_t others;  ///< points of the other shapes: for few points, about as many as it takes
};
// Ways that are only asked for and engines, behind which there is nothing, are left out.
const Path paths[] = {
    {Way::columns, {"grid", 2, 10'000}, 10'000},
    {Way::ellipse, {"ball", 2, 10'000}, 10'000},
    {Way::few_in_plane, {"ball", 2, 100}, 4'000},
    {Way::small_lattice, {"grid:16", 3, 10'000}, 10'000},
    {Way::few_in_space, {"ball", 3, 100}, 1'000},
    {Way::few_in_4d, {"ball", 4, 10}, 1'000},
    {Way::few_in_5d, {"ball", 5, 30}, 250},
    {Way::few_in_6d, {"ball", 6, 30}, 80},
    {Way::few_in_7d, {"ball", 7, 20}, 40},
    {Way::few_in_8d, {"ball", 8, 16}, 24},
    {Way::outermost, {"gauss", 3, 10'000}, 10'000},
    {Way::gauge, {"ball", 3, 1'000'000}, 1'000'000},
    {Way::lattice, {"grid:16", 4, 20'000}, 20'000},
};

/// The way is off while this exists.
class Without {
 public:
  explicit Without(Way way) { internal::ways_off = 1U << static_cast<unsigned>(way); }
  Without(const Without&) = delete;
  Without& operator=(const Without&) = delete;
  ~Without() { internal::ways_off = 0; }
};

double thread_seconds() {
  timespec t{};
  ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

class PathsSuite {
 public:
  PathsSuite(const PathSettings& settings, const Progress& progress, const std::stop_token& stop)
      : settings_(settings), steps_(progress, stop) {
    options_.threads = 1;
    options_.stop = stop;
  }

  Report run() {
    Report report = begin_report("paths");
    report.scale = settings_.scale;
    report.threads = 1;
    report.command = fmt::format("cullhull-bench paths --scale {:g} --seconds {:g}",
                                 settings_.scale, settings_.seconds);
    for (const std::string& way : settings_.ways) report.command += " --way '" + way + "'";
    Figure figure{"paths", "What each way gains and costs", "x", "", false, {}};
    figure.note = fmt::format(
        "Gain: time without the way over that with it, on its best points. Cost: time with it over "
        "that without it, the worst of three other shapes. Marked: a gain below {:.2f}, a cost "
        "above {:.2f}.",
        least_gain, most_cost);
    std::size_t i = 0;
    for (const Path& path : paths) {
      steps_.row(i++, std::size(paths));
      if (wanted(path)) figure.rows.push_back(row_of(path));
    }
    report.figures.push_back(std::move(figure));
    return report;
  }

 private:
  static const char* name_of(const Path& path) { return internal::row_of(path.way).name; }
  bool wanted(const Path& path) const {
    const std::vector<std::string>& ways = settings_.ways;
    return ways.empty() || std::find(ways.begin(), ways.end(), name_of(path)) != ways.end();
  }

  Row row_of(const Path& path) {
    Row row;
    row.name = fmt::format("{}, {}", name_of(path), path.best.name());
    row.dimension = path.best.dimension;
    row.points = path.best.count;
    const double gain = gain_on(path.way, path.best, row);
    double cost = 0;
    std::string where;
    unsigned others = 0;
    for (const char* shape : {"ball", "sphere", "gauss", "cube"}) {
      Workload other = path.best;
      if (other.family == shape || others++ == 3) continue;
      other.family = shape;
      other.count = path.others;
      const double here = 1 / gain_on(path.way, other, row);
      if (here > cost) where = other.name();
      cost = std::max(cost, here);
    }
    row.values = {{"gain", gain}, {"cost", cost}};
    if (row.check.empty()) row.check = "equal; cost on " + where;
    if (gain < least_gain) row.check += "; GAINS LITTLE";
    if (cost > most_cost) row.check += "; COSTS ELSEWHERE";
    return row;
  }

  /// The median of the pairs' ratios, without the way over with it.
  double gain_on(Way way, const Workload& w, Row& row) {
    steps_.step(fmt::format("{}, {}", internal::row_of(way).name, w.name()));
    const std::uint64_t count = scaled_count(w.count, settings_.scale, w.dimension);
    const std::vector<double> rows = make_family(w.family, count, w.dimension);
    const PointView points =
        PointView::row_major(rows.data(), rows.size() / w.dimension, w.dimension);
    const auto hull = [&] { return convex_hull(points, options_); };
    const auto without = [&] {
      const Without off(way);
      return hull();
    };
    const Hull one = hull(), other = without();
    if (one.vertices != other.vertices || one.volume != other.volume ||
        one.facets != other.facets) {
      row.agrees = false;
      row.check = "hulls differ on " + w.name();
    }
    std::vector<double> ratios;
    for (double spent = 0; ratios.size() < 3 || spent < settings_.seconds;) {
      double seconds[2];
      for (const bool off : {ratios.size() % 2 == 0, ratios.size() % 2 == 1}) {
        const double start = thread_seconds();
        off ? without() : hull();
        seconds[off] = thread_seconds() - start;
        spent += seconds[off];
      }
      ratios.push_back(seconds[1] / seconds[0]);
    }
    return median(std::move(ratios));
  }

  const PathSettings& settings_;
  Steps steps_;
  Options options_;
};

}  // namespace

std::vector<std::string> path_names() {
  std::vector<std::string> names;
  for (const Path& path : paths) names.emplace_back(internal::row_of(path.way).name);
  return names;
}

Report run_paths(const PathSettings& settings, const Progress& progress,
                 const std::stop_token& stop) {
  return PathsSuite(settings, progress, stop).run();
}

}  // namespace cullhull::bench
