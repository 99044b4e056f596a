#include "paper.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>

#include "contest.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/cull.hpp"
#include "cullhull/error.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/io.hpp"
#include "cullhull/track.hpp"
#include "filter/pseudo_hull/pseudo_hull.hpp"
#include "geometry/gather.hpp"
#include "machine.hpp"
#include "parallel/threads/parallel.hpp"
#include "parallel/threads/run.hpp"
#include "qhull.hpp"
#include "timing.hpp"

namespace cullhull::bench {
namespace {

constexpr double missing = std::numeric_limits<double>::quiet_NaN();

struct Set {
  std::string name, shape;
  unsigned dimension;
  std::uint64_t count;
  std::string paper;
};

/// A set of points, used by several figures.
Points make(const Set& set) {
  return points_of({set.shape, set.dimension, set.count},
                   generate(set.shape, set.count, set.dimension));
}

class PaperSuite {
 public:
  PaperSuite(const PaperSettings& settings, const Progress& progress, const std::stop_token& stop)
      : settings_(settings), steps_(progress, stop) {}

  Report run() {
    Report report = begin_report("paper");
    report.scale = settings_.scale;
    report.threads = settings_.threads;
    report.command = fmt::format("cullhull-bench paper --scale {:g} --repeat {} --limit {:g}",
                                 settings_.scale, settings_.repeat, settings_.limit);
    if (settings_.threads != 0) report.command += fmt::format(" --threads {}", settings_.threads);
    for (const std::string& f : settings_.figures) report.command += " --figure " + f;
    for (const unsigned t : thread_counts())
      report.read_bandwidth.emplace_back(t, read_bandwidth(t, steps_.stop()));
    report_ = &report;
    for (const Maker& maker : makers()) {
      if (!settings_.figures.empty() &&
          std::find(settings_.figures.begin(), settings_.figures.end(), maker.id) ==
              settings_.figures.end())
        continue;
      figure_ = maker.id;
      report.figures.push_back((this->*maker.make)());
      report.figures.back().id = maker.id;
    }
    return report;
  }

  struct Maker {
    const char* id;
    Figure (PaperSuite::*make)();
  };
  static const std::vector<Maker>& makers() {
    static const std::vector<Maker> all = {
        {"figure-12", &PaperSuite::static_sets},   {"figure-13", &PaperSuite::growing_sets},
        {"figure-14", &PaperSuite::culling},       {"figure-15", &PaperSuite::shares},
        {"figure-16", &PaperSuite::moving_shares}, {"figure-17", &PaperSuite::moving_times},
        {"all-extreme", &PaperSuite::all_extreme}, {"threads", &PaperSuite::scaling}};
    return all;
  }

 private:
  std::uint64_t scaled(std::uint64_t n) const {
    return std::max<std::uint64_t>(
        1000, static_cast<std::uint64_t>(std::llround(static_cast<double>(n) * settings_.scale)));
  }
  /// 1, 2, 4, ... and all threads.
  std::vector<unsigned> thread_counts() const {
    const unsigned cores = internal::resolve_threads(settings_.threads);
    std::vector<unsigned> counts;
    for (unsigned t = 1; t < cores; t *= 2) counts.push_back(t);
    counts.push_back(cores);
    return counts;
  }
  ChildLimits limits() const { return {settings_.limit, steps_.stop()}; }

  Set set(const char* what, const char* shape, unsigned d, std::uint64_t n,
          const char* paper = "") const {
    const std::uint64_t count = scaled(n);
    return {fmt::format("{} {}", what, short_count(count)), shape, d, count, paper};
  }
  /// The sets of Figures 12, 14 and 15. The paper's Dragon, a scanned statue, is not public at its
  /// size; a closed bumpy surface replaces it.
  std::vector<Set> paper_sets() const {
    return {set("Dragon (bumpy) 3D", "bumpy", 3, 3'600'000),
            set("3D-Sphere (ball)", "ball", 3, 8'000'000),
            set("3D-Polyhedron (octahedron)", "octahedron", 3, 15'000'000),
            set("4D-Sphere (ball)", "ball", 4, 8'000'000)};
  }

  void step(const std::string& what, std::size_t at, std::size_t of) {
    steps_.row(at, of);
    steps_.step(figure_ + ", " + what);
  }

  Options options(CullMethod cull = CullMethod::automatic, unsigned threads = 0) const {
    Options o;
    o.cull = cull;
    o.threads = threads != 0 ? threads : settings_.threads;
    o.stop = steps_.stop();
    return o;
  }

  static Row row_of(const Set& s) {
    Row row;
    row.name = s.name;
    row.points = s.count;
    row.dimension = s.dimension;
    row.paper = s.paper;
    return row;
  }

  /// Returns the run whose time is the median.
  Hull ours(const PointView& points, const Options& o) const {
    std::vector<Hull> runs;
    for (unsigned k = 0; k < settings_.repeat; ++k) {
      Hull hull = convex_hull(points, o);
      const auto at =
          std::lower_bound(runs.begin(), runs.end(), hull, [](const Hull& a, const Hull& b) {
            return a.statistics.compute_seconds < b.statistics.compute_seconds;
          });
      runs.insert(at, std::move(hull));
    }
    return std::move(runs[runs.size() / 2]);
  }

  void describe(Row& row, const PointView& points, const Hull& hull) const {
    row.vertices = hull.vertices.size();
    row.bandwidth = bandwidth_share(*report_, points, hull.statistics);
    row.check = fmt::format("{} vertices", hull.vertices.size());
  }

  /// If Qhull's hull differs, the certificate decides.
  void compare(Row& row, const PointView& points, const Hull& hull,
               const std::optional<QhullRun>& qhull) const {
    describe(row, points, hull);
    if (!qhull || !qhull->finished) {
      row.check += qhull ? ", Qhull stopped" : ", no Qhull";
      return;
    }
    if (qhull->vertices == hull.vertices.size()) {
      row.check += fmt::format(", volume {:+.0e}", qhull->volume / hull.volume - 1);
      return;
    }
    row.remark = "Qhull, which decides with tolerances, found other extreme points.";
    const Certificate certificate = certify(points, hull);
    row.agrees = certificate.valid;
    row.check += fmt::format(", Qhull {}; ours {}", qhull->vertices,
                             certificate.valid ? "certified" : "NOT certified");
  }

  static void add_qhull(Row& row, const char* name, const std::optional<QhullRun>& run,
                        double seconds) {
    add_rival(row, name, seconds, run.has_value(), !run || run->finished);
  }

  static void set_ratio(Row& row, const std::optional<QhullRun>& rival, double ours) {
    if (!rival) return;
    row.ratio = rival->seconds / ours;
    row.ratio_is_bound = !rival->finished;
  }

  /// Compares Qhull alone, Qhull behind the paper's filter, and cullhull.
  Row three_ways(const Set& s) {
    const Points p = make(s);
    Row row = row_of(s);
    const Hull hull = ours(p.view, options());
    const double our_seconds = hull.statistics.compute_seconds;
    const std::optional<QhullRun> alone = run_qhull(p.view, limits());
    Array<double> rows;
    const Options by_paper = options(CullMethod::pseudo_hull);
    const internal::Run run(by_paper);
    const double filter = seconds_of([&] {
      const Survivors left = cull(p.view, by_paper);
      rows =
          internal::gather_points(p.view, left.all ? nullptr : left.ids.data(), left.size(s.count),
                                  run.with_threads(internal::resolve_threads(settings_.threads)));
    });
    const std::optional<QhullRun> behind = run_qhull(
        PointView::row_major(rows.data(), rows.size() / s.dimension, s.dimension), limits());
    add_qhull(row, "Qhull alone", alone, alone ? alone->seconds : missing);
    add_qhull(row, "Qhull after the paper's filter", behind,
              behind ? filter + behind->seconds : missing);
    row.values.emplace_back("cullhull", our_seconds);
    set_ratio(row, alone, our_seconds);
    compare(row, p.view, hull, alone);
    return row;
  }

  /// A row for each of these sets.
  template <class MakeRow>
  std::vector<Row> rows_of(const std::vector<Set>& sets, const MakeRow& row) {
    std::vector<Row> rows;
    for (const Set& s : sets) {
      step(s.name, rows.size(), sets.size());
      rows.push_back(row(s));
    }
    return rows;
  }

  Figure static_sets() {
    Figure f{
        "",
        "Static sets: time to the hull",
        "s",
        "The paper printed speed-ups of 10 to 27 for its sets, on a GeForce GTX 580 beside one "
        "core. Qhull runs on one core here too, in the same run.",
        false,
        {}};
    f.rows = rows_of(paper_sets(), [&](const Set& s) { return three_ways(s); });
    for (Row& row : f.rows) row.paper = "10-27x";
    return f;
  }

  Figure growing_sets() {
    Figure f{"", "The same as the set grows", "s", "", true, {}};
    std::vector<Set> sets;
    for (const std::uint64_t n : {10'000'000, 30'000'000, 50'000'000})
      sets.push_back(set("3D-Sphere (ball)", "ball", 3, n));
    f.rows = rows_of(sets, [&](const Set& s) { return three_ways(s); });
    return f;
  }

  Figure culling() {
    Figure f{"",
             "What the filters keep, and how much of that is used",
             "%",
             "Kept: survivors of all points (the paper: 1.4 to 5 %). Used: vertices of the hull "
             "among the survivors; the rest was work for the exact engine.",
             false,
             {}};
    f.rows = rows_of(paper_sets(), [&](const Set& s) {
      const Points p = make(s);
      Row row = row_of(s);
      row.paper = "kept 1.4-5 %";
      const auto share = [](std::size_t a, std::uint64_t b) {
        return 100 * static_cast<double>(a) / static_cast<double>(b);
      };
      std::size_t vertices = 0;
      for (const auto& [method, name] : {std::pair{CullMethod::pseudo_hull, "paper's filter"},
                                         {CullMethod::gauge, "gauge map"}}) {
        const Hull hull = convex_hull(p.view, options(method));
        row.values.emplace_back(fmt::format("{}: kept", name),
                                share(hull.statistics.survivors, s.count));
        row.values.emplace_back(fmt::format("{}: used", name),
                                share(hull.vertices.size(), hull.statistics.survivors));
        row.agrees = row.agrees && (vertices == 0 || vertices == hull.vertices.size());
        vertices = hull.vertices.size();
      }
      row.vertices = vertices;
      row.check = fmt::format("{} vertices either way", vertices);
      return row;
    });
    return f;
  }

  /// From file to file: .npy in, .ply or (4D) .json out, both in the page cache.
  Figure shares() {
    Figure f{"",
             "Where the time goes, from file to file",
             "s",
             "Read: opening a .npy and touching its pages, which lie in the page cache. Write: a "
             ".ply (4D: .json) of the hull.",
             false,
             {}};
    f.rows = rows_of(paper_sets(), [&](const Set& s) { return shares_of(s); });
    return f;
  }

  Row shares_of(const Set& s) const {
    // A temporary folder, removed with its files in any case.
    struct Folder {
      std::filesystem::path path =
          std::filesystem::temp_directory_path() / ("cullhull-bench-" + std::to_string(::getpid()));
      Folder() { std::filesystem::create_directories(path); }
      ~Folder() {
        std::error_code ignored;
        std::filesystem::remove_all(path, ignored);
      }
    } folder;
    const std::string in = folder.path / "in.npy";
    {
      const Points p = make(s);
      write_npy_points(in, p.rows.data(), s.count, s.dimension, ScalarType::f64);
    }
    Row row = row_of(s);
    PointFile file;
    double touched = 0;
    const double read = seconds_of([&] {
      file = open_points(in);
      const PointView& v = file.points();
      for (std::uint64_t i = 0; i < v.count; i += 128) touched += v.at(i, 0);
    });
    const Hull hull = ours(file.points(), options());
    const std::string out = folder.path / (s.dimension == 3 ? "out.ply" : "out.json");
    const double write = seconds_of([&] { write_hull(out, file.points(), hull); });
    row.values = {{"read", read},
                  {"cull", hull.statistics.cull_seconds},
                  {"hull", hull.statistics.hull_seconds},
                  {"write", write}};
    row.agrees = std::isfinite(touched);
    describe(row, file.points(), hull);
    double whole = 0;
    for (const auto& [name, seconds] : row.values) whole += seconds;
    std::string shares;
    for (const auto& [name, seconds] : row.values)
      shares +=
          fmt::format("{}{} {:.0f} %", shares.empty() ? "" : ", ", name, 100 * seconds / whole);
    row.check += "; " + shares;
    row.title = fmt::format("{} ({})", row.name, shares);
    return row;
  }

  /// The paper's section 5.2: its filter lost a tenth if every point is extreme.
  Figure all_extreme() {
    Figure f{"",    "Every point extreme: the filter must stay away",
             "s",   "The paper's filter cost a tenth here. Ours sees on a sample that none pays.",
             false, {}};
    const Set s = set("sphere surface 3D", "sphere", 3, 1'000'000, "0.9x");
    step(s.name, 0, 1);
    const Points p = make(s);
    Row row = row_of(s);
    // Alternates, so that disturbances affect both.
    std::vector<double> without, with;
    Hull hull;
    for (unsigned k = 0; k < settings_.repeat; ++k) {
      without.push_back(convex_hull(p.view, options(CullMethod::none)).statistics.compute_seconds);
      hull = convex_hull(p.view, options());
      with.push_back(hull.statistics.compute_seconds);
    }
    const std::optional<QhullRun> qhull = run_qhull(p.view, limits());
    add_qhull(row, "Qhull alone", qhull, qhull ? qhull->seconds : missing);
    row.values.emplace_back("no filter", median(without));
    row.values.emplace_back("planned", median(with));
    set_ratio(row, qhull, median(with));
    compare(row, p.view, hull, qhull);
    f.rows.push_back(std::move(row));
    return f;
  }

  /// The paper's remark on OpenMP: the speed-up by cores alone.
  Figure scaling() {
    Figure f{"", "Threads", "s", "Ratio: against one thread.", true, {}};
    const Set s = set("3D-Sphere (ball)", "ball", 3, 8'000'000);
    const Points p = make(s);
    const std::vector<unsigned> counts = thread_counts();
    double one = 0;
    std::size_t vertices = 0;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      step(fmt::format("{} threads", counts[i]), i, counts.size());
      const Hull hull = ours(p.view, options(CullMethod::automatic, counts[i]));
      Row row = row_of(s);
      row.name += fmt::format(", {} thread{}", counts[i], counts[i] == 1 ? "" : "s");
      row.values = {{"cullhull", hull.statistics.compute_seconds}};
      if (i == 0) one = hull.statistics.compute_seconds;
      row.ratio = one / hull.statistics.compute_seconds;
      describe(row, p.view, hull);
      row.agrees = vertices == 0 || vertices == hull.vertices.size();
      vertices = hull.vertices.size();
      f.rows.push_back(std::move(row));
    }
    return f;
  }

  /// A moving set, tracked once: means over its frames, and the shares of each frame.
  struct Tracked {
    Row times;
    std::vector<Row> shares;
  };

  /// Frames are generated one by one; each is tracked, computed afresh and passed to Qhull in turn,
  /// so that disturbances affect all three.
  Tracked track(const char* what, const char* motion, std::uint64_t n, std::uint64_t frames,
                const char* kept) {
    const std::uint64_t count = scaled(n);
    const std::string name = fmt::format("{} {}, {} frames", what, short_count(count), frames);
    const MovingPoints moving("bumpy", motion, count, 3, frames);
    std::vector<double> rows(count * 3);
    const PointView view = PointView::row_major(rows.data(), count, 3);
    HullTracker tracker(options());
    Tracked t;
    double ours = 0, fresh = 0, rival = 0;
    bool rivals = true, same = true;
    unsigned lost = 0;
    for (std::uint64_t f = 0; f < frames; ++f) {
      step(name, f, frames);
      moving.frame(f, rows.data());
      const Hull& hull = tracker.update(view);
      const Hull again = convex_hull(view, options());
      const std::optional<QhullRun> qhull = run_qhull(view, limits());
      ours += tracker.report().compute_seconds;
      fresh += again.statistics.compute_seconds;
      rivals = rivals && qhull.has_value() && qhull->finished;
      if (qhull) rival += qhull->seconds;
      same = same && hull.facets.items == again.facets.items;
      lost += qhull && qhull->finished && qhull->vertices != hull.vertices.size() ? 1U : 0U;
      Row row;
      row.name = fmt::format("{}, frame {}", motion, f);
      row.points = count;
      row.dimension = 3;
      row.paper = kept;
      const auto share = [&](std::uint64_t left) {
        return 100 * static_cast<double>(left) / static_cast<double>(count);
      };
      row.values = {{"after the scan", share(tracker.report().scan_survivors)},
                    {"after growth", share(tracker.report().survivors)}};
      row.check = fmt::format("{}, {} vertices", tracker.report().method, hull.vertices.size());
      t.shares.push_back(std::move(row));
    }
    const double n_frames = static_cast<double>(frames);
    t.times.name = name;
    t.times.points = count;
    t.times.dimension = 3;
    t.times.paper = "22-46x";
    t.times.agrees = same;
    t.times.values = {{"Qhull alone", rivals ? rival / n_frames : missing},
                      {"each frame afresh", fresh / n_frames},
                      {"tracked", ours / n_frames}};
    if (rivals) t.times.ratio = rival / ours;
    t.times.check = same ? "every frame equals the one computed afresh" : "some frame differs";
    if (lost > 0)
      t.times.remark = fmt::format(
          "In {} frames Qhull, which decides with tolerances, found other extreme points.", lost);
    return t;
  }

  const std::vector<Tracked>& tracked() {
    if (tracked_.empty()) {
      tracked_.push_back(
          track("Twisting Dragon (bumpy)", "twist", 1'100'000, 30, "3.5-12.2 / 0.8-3.0 %"));
      tracked_.push_back(
          track("Breaking Lion (bumpy)", "fracture", 870'000, 27, "3.5-12.2 / 0.8-3.0 %"));
    }
    return tracked_;
  }

  Figure moving_shares() {
    Figure f{"",
             "Moving points: what is left of each frame",
             "%",
             "Frame 0 has none before it. The paper's two sets are not public; a bumpy surface, "
             "twisted and broken, stands in.",
             true,
             {}};
    for (const Tracked& t : tracked())
      f.rows.insert(f.rows.end(), t.shares.begin(), t.shares.end());
    return f;
  }

  Figure moving_times() {
    Figure f{"", "Moving points: mean time of a frame", "s", "The first frame is included.", false,
             {}};
    for (const Tracked& t : tracked()) f.rows.push_back(t.times);
    return f;
  }

  const PaperSettings& settings_;
  Steps steps_;
  const Report* report_ = nullptr;
  std::string figure_;
  std::vector<Tracked> tracked_;
};

}  // namespace

const std::vector<std::string>& paper_figures() {
  static const std::vector<std::string> ids = [] {
    std::vector<std::string> all;
    for (const PaperSuite::Maker& maker : PaperSuite::makers()) all.emplace_back(maker.id);
    return all;
  }();
  return ids;
}

Report run_paper(const PaperSettings& settings, const Progress& progress,
                 const std::stop_token& stop) {
  for (const std::string& id : settings.figures)
    if (std::find(paper_figures().begin(), paper_figures().end(), id) == paper_figures().end())
      throw Error(ErrorCode::invalid_argument, "bench paper has no figure '" + id + "'");
  return PaperSuite(settings, progress, stop).run();
}

}  // namespace cullhull::bench
