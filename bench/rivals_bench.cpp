// Our time beside Qhull's, from the same run on the same points: rivals_bench [--repeat K]
// [--qhull-repeat K] [--threads N] [--scale S] [--folder DIR] [WORKLOAD...]
//
// Points lie in a mapped .npy with its pages warm; ours starts with them in memory and ends with
// the complete result. Qhull gets the same doubles (options Qt, as SciPy calls it) and is timed for
// its hull alone, single-threaded as it is. Medians; a ratio above 1 means we are faster.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "cullhull/cullhull.hpp"
#include "qhull.hpp"

namespace {

struct Workload {
  const char* name;
  const char* shape;
  unsigned dimension;
  std::uint64_t count;
};

constexpr Workload workloads[] = {
    {"ball-3d-8M", "ball", 3, 8'000'000},
    {"octahedron-3d-15M", "octahedron", 3, 15'000'000},
    {"cube-3d-10M", "cube", 3, 10'000'000},
    {"gauss-3d-10M", "gauss", 3, 10'000'000},
    {"disk-2d-10M", "ball", 2, 10'000'000},
    {"circle-2d-2M", "sphere", 2, 2'000'000},
    {"sphere-3d-1M", "sphere", 3, 1'000'000},
    {"grid-3d-2M", "grid", 3, 2'000'000},
    {"cylinder-3d-1M", "cylinder", 3, 1'000'000},
    {"ball-4d-8M", "ball", 4, 8'000'000},
    {"gauss-4d-1M", "gauss", 4, 1'000'000},
    {"ball-5d-1M", "ball", 5, 1'000'000},
    {"sphere-4d-100k", "sphere", 4, 100'000},
    {"sphere-5d-10k", "sphere", 5, 10'000},
    {"ball-6d-100k", "ball", 6, 100'000},
};

struct Settings {
  int repeat = 7;
  unsigned qhull_repeat = 1, threads = 0;
  double scale = 1;
  std::string folder = "build/bench-data";
  std::vector<std::string> names;
};

void run(const Workload& w, const Settings& s) {
  const auto n = static_cast<std::uint64_t>(std::llround(static_cast<double>(w.count) * s.scale));
  std::filesystem::create_directories(s.folder);
  const std::string path = s.folder + "/" + w.name + "-" + std::to_string(n) + ".npy";
  if (!std::filesystem::exists(path)) {
    const std::vector<double> made = cullhull::generate(w.shape, n, w.dimension, 1);
    cullhull::write_npy_points(path, made.data(), n, w.dimension, cullhull::ScalarType::f64);
  }
  const cullhull::PointFile file = cullhull::open_points(path);
  const cullhull::PointView points = file.points();
  volatile double sink = 0;
  for (std::uint64_t i = 0; i < n; i += 128) sink = sink + points.at(i, 0);

  cullhull::Options options;
  options.threads = s.threads;
  std::vector<double> times;
  cullhull::Hull hull;
  for (int k = 0; k < s.repeat; ++k) {
    hull = cullhull::convex_hull(points, options);
    times.push_back(hull.statistics.compute_seconds);
  }
  const double ours = cullhull::bench::median(times);
  const auto ran = cullhull::bench::run_qhull(points, s.qhull_repeat);
  const cullhull::bench::QhullRun rival = ran ? *ran : cullhull::bench::QhullRun{};
  const char* agrees = rival.vertices == hull.vertices.size() ? "same vertices" : "VERTICES DIFFER";
  std::printf("%-18s %9.2f %10.1f %8.1fx  %8.3f%% %9zu %10llu  %s, volume %+.1e\n", w.name,
              ours * 1e3, rival.seconds * 1e3, rival.seconds / ours,
              100.0 * static_cast<double>(hull.statistics.survivors) / static_cast<double>(n),
              hull.vertices.size(), static_cast<unsigned long long>(hull.facet_count()), agrees,
              rival.volume / hull.volume - 1);
  std::fflush(stdout);
}

Settings parse(int argc, char** argv) {
  Settings s;
  for (int i = 1; i < argc; ++i) {
    const std::string a = argv[i];
    const auto value = [&]() -> const char* {
      if (i + 1 == argc) {
        std::fprintf(stderr, "rivals_bench: %s needs a value\n", a.c_str());
        std::exit(2);
      }
      return argv[++i];
    };
    if (a == "--repeat") {
      s.repeat = std::max(1, std::atoi(value()));
    } else if (a == "--qhull-repeat") {
      s.qhull_repeat = static_cast<unsigned>(std::max(1, std::atoi(value())));
    } else if (a == "--threads") {
      s.threads = static_cast<unsigned>(std::atoi(value()));
    } else if (a == "--scale") {
      s.scale = std::atof(value());
    } else if (a == "--folder") {
      s.folder = value();
    } else if (a.rfind("--", 0) == 0) {
      std::fprintf(stderr, "rivals_bench: unknown option %s\n", a.c_str());
      std::exit(2);
    } else {
      s.names.push_back(a);
    }
  }
  return s;
}

}  // namespace

int main(int argc, char** argv) {
  const Settings settings = parse(argc, argv);
  std::printf("%-18s %9s %10s %9s  %9s %9s %10s\n", "workload", "ours ms", "Qhull ms", "ratio",
              "survivors", "vertices", "facets");
  for (const Workload& w : workloads) {
    if (!settings.names.empty() &&
        std::find(settings.names.begin(), settings.names.end(), w.name) == settings.names.end())
      continue;
    try {
      run(w, settings);
    } catch (const cullhull::Error& e) {
      std::fprintf(stderr, "rivals_bench: %s: %s\n", w.name, e.what());
      return 1;
    }
  }
}
