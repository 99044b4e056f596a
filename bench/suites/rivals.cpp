#include "rivals.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>

#include "cullhull/error.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/io.hpp"
#include "machine.hpp"
#include "qhull.hpp"

namespace cullhull::bench {
namespace {

struct Workload {
  const char* name;
  const char* shape;
  unsigned dimension;
  std::uint64_t count;
  bool single = false;  // f32 for ours; rivals get the same values as doubles
};

constexpr Workload workloads[] = {
    {"ball-3d-8M", "ball", 3, 8'000'000},
    {"ball-3d-8M-f32", "ball", 3, 8'000'000, true},
    {"octahedron-3d-15M", "octahedron", 3, 15'000'000},
    {"cube-3d-10M", "cube", 3, 10'000'000},
    {"gauss-3d-10M", "gauss", 3, 10'000'000},
    {"ball-3d-10k", "ball", 3, 10'000},
    {"ball-3d-1k", "ball", 3, 1'000},
    {"sphere-3d-1M", "sphere", 3, 1'000'000},
    {"bumpy-3d-1M", "bumpy", 3, 1'000'000},
    {"grid-3d-2M", "grid", 3, 2'000'000},
    {"cube-surface-3d-1M", "cube-surface", 3, 1'000'000},
    {"cylinder-3d-1M", "cylinder", 3, 1'000'000},
    {"cone-3d-1M", "cone", 3, 1'000'000},
    {"ball-2d-10M", "ball", 2, 10'000'000},
    {"sphere-2d-2M", "sphere", 2, 2'000'000},
    {"ball-4d-8M", "ball", 4, 8'000'000},
    {"gauss-4d-1M", "gauss", 4, 1'000'000},
    {"sphere-4d-100k", "sphere", 4, 100'000},
    {"ball-5d-1M", "ball", 5, 1'000'000},
    {"sphere-5d-10k", "sphere", 5, 10'000},
    {"ball-6d-100k", "ball", 6, 100'000},
    {"ball-7d-3k", "ball", 7, 3'000},
};

/// A temporary file for a rival in another process.
struct Scratch {
  std::string path = (std::filesystem::temp_directory_path() /
                      ("cullhull-rival-" + std::to_string(::getpid()) + ".npy"))
                         .string();
  ~Scratch() {
    std::error_code ignored;
    std::filesystem::remove(path, ignored);
  }
};

struct CgalRun {
  double seconds = 0;
  std::uint64_t vertices = 0;
};

/// Runs `program FILE.npy`, which prints seconds and vertices.
std::optional<CgalRun> run_cgal(const std::string& program, const std::vector<double>& rows,
                                unsigned d) {
  if (program.empty() || d > 3) return std::nullopt;
  const Scratch file;
  write_npy_points(file.path, rows.data(), rows.size() / d, d, ScalarType::f64);
  const std::string command = "'" + program + "' '" + file.path + "' 2>/dev/null";
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(::popen(command.c_str(), "r"),
                                                             ::pclose);
  CgalRun run;
  unsigned long long vertices = 0;
  if (pipe == nullptr || std::fscanf(pipe.get(), "%lf %llu", &run.seconds, &vertices) != 2)
    return std::nullopt;
  run.vertices = vertices;
  return run;
}

std::string program_beside_ours() {
  std::error_code error;
  const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
  if (error) return "";
  const auto program = self.parent_path() / "cullhull-rival-cgal";
  return std::filesystem::exists(program, error) ? program.string() : "";
}

Row run(const Workload& w, const RivalSettings& s, const std::string& cgal,
        const std::stop_token& stop) {
  const auto n = std::max<std::uint64_t>(
      w.dimension + 2,
      static_cast<std::uint64_t>(std::llround(static_cast<double>(w.count) * s.scale)));
  std::vector<double> rows = generate(w.shape, n, w.dimension);
  std::vector<float> single;
  if (w.single) {
    single.assign(rows.begin(), rows.end());
    std::copy(single.begin(), single.end(), rows.begin());
  }
  const PointView doubles = PointView::row_major(rows.data(), n, w.dimension);
  const PointView points = w.single ? PointView::row_major(single.data(), n, w.dimension) : doubles;
  Options options;
  options.threads = s.threads;
  options.stop = stop;
  std::vector<double> times;
  Hull hull;
  for (unsigned k = 0; k < s.repeat; ++k) {
    hull = convex_hull(points, options);
    times.push_back(hull.statistics.compute_seconds);
  }
  const double ours = median(times);
  const std::optional<QhullRun> qhull = run_qhull(doubles, 1);
  const std::optional<CgalRun> other = run_cgal(cgal, rows, w.dimension);
  constexpr double missing = std::numeric_limits<double>::quiet_NaN();
  Row row{fmt::format("{}-{}d-{}{}", w.shape, w.dimension, short_count(n), w.single ? "-f32" : ""),
          n,
          w.dimension,
          {},
          0,
          "",
          "",
          true};
  row.values = {{"Qhull", qhull ? qhull->seconds : missing},
                {"CGAL", other ? other->seconds : missing},
                {"cullhull", ours}};
  double best = std::numeric_limits<double>::infinity();
  if (qhull) best = std::min(best, qhull->seconds);
  if (other) best = std::min(best, other->seconds);
  if (std::isfinite(best)) row.ratio = best / ours;
  const std::size_t v = hull.vertices.size();
  // CGAL is exact too; Qhull is not, so where both are there CGAL is the judge.
  row.check = fmt::format("{} vertices", v);
  if (other) row.agrees = other->vertices == v;
  if (qhull && qhull->vertices != v) {
    row.check += fmt::format(", Qhull {}", qhull->vertices);
    row.agrees = row.agrees && other.has_value();
  }
  if (other && other->vertices != v) row.check += fmt::format(", CGAL {}", other->vertices);
  if (!qhull && !other) row.check += ", nobody to ask";
  return row;
}

}  // namespace

std::vector<std::string> rival_workloads() {
  std::vector<std::string> names;
  for (const Workload& w : workloads) names.emplace_back(w.name);
  return names;
}

Report run_rivals(const RivalSettings& settings, const Progress& progress,
                  const std::stop_token& stop) {
  const std::vector<std::string> known = rival_workloads();
  for (const std::string& name : settings.workloads)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw Error(ErrorCode::invalid_argument, "bench rivals has no workload '" + name + "'");
  const std::string cgal = settings.cgal.empty() ? program_beside_ours() : settings.cgal;
  Report report;
  report.suite = "rivals";
  report.date = date_now();
  report.scale = settings.scale;
  report.threads = settings.threads;
  report.machine = describe_machine();
  report.command = fmt::format("cullhull bench rivals --scale {:g}", settings.scale);
  for (const std::string& name : settings.workloads) report.command += " --workload " + name;
  Figure lost{"lost", "Where a rival is faster", "s", "", false, {}};
  Figure all{"rivals",
             "Time to the hull",
             "s",
             "Ratio: the faster rival's time over ours. Rivals run on one core, as they are made.",
             false,
             {}};
  std::size_t done = 0;
  for (const Workload& w : workloads) {
    ++done;
    if (!settings.workloads.empty() &&
        std::find(settings.workloads.begin(), settings.workloads.end(), w.name) ==
            settings.workloads.end())
      continue;
    if (stop.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled");
    if (progress)
      progress(w.name, static_cast<double>(done - 1) / static_cast<double>(std::size(workloads)));
    all.rows.push_back(run(w, settings, cgal, stop));
    if (all.rows.back().ratio > 0 && all.rows.back().ratio < 1)
      lost.rows.push_back(all.rows.back());
  }
  if (!lost.rows.empty()) report.figures.push_back(std::move(lost));
  report.figures.push_back(std::move(all));
  return report;
}

}  // namespace cullhull::bench
