// Times of the stages in dimensions 4 and up: engine_nd_bench [--threads N] [--repeat K]
// [SHAPE-Dd-N...]
//
// A workload is a shape of `cullhull generate`, a dimension and a count: ball-5d-1000000. For each
// it prints the survivors, the facets, and milliseconds (minimum of K runs) for the filter, the
// engine alone and the whole convex_hull call. The rest is the result stage.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <vector>

#include "cullhull/cullhull.hpp"
#include "geometry/gather.hpp"
#include "geometry/local_frame.hpp"
#include "hull/engine.hpp"

namespace {

using cullhull::internal::LocalFrame;
using cullhull::internal::Run;
using Clock = std::chrono::steady_clock;

struct Workload {
  std::string shape;
  unsigned dimension;
  std::uint64_t count;
};

constexpr const char* standard[] = {
    "ball-4d-8000000",  "gauss-4d-1000000", "ball-5d-1000000",  "ball-6d-100000",
    "sphere-4d-100000", "sphere-5d-10000",  "gauss-5d-1000000", "ball-7d-3000",
    "ball-8d-500",      "cube-4d-1000000",  "grid-4d-200000",   "cube_surface-4d-50000"};

/// Processor time of all threads; other programs disturb it least.
double processor_milliseconds() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

double milliseconds(Clock::time_point start) {
  return std::chrono::duration<double, std::milli>(Clock::now() - start).count();
}

Workload parse(const std::string& name) {
  const auto dash = name.rfind('-');
  const auto first = dash == std::string::npos || dash == 0 ? dash : name.rfind('-', dash - 1);
  if (first == std::string::npos) {
    std::fprintf(stderr, "engine_nd_bench: %s is not SHAPE-Dd-N\n", name.c_str());
    std::exit(2);
  }
  return {name.substr(0, first),
          static_cast<unsigned>(std::stoul(name.substr(first + 1, dash - first - 1))),
          std::stoull(name.substr(dash + 1))};
}

/// Random doubles on the surface of the cube: many coplanar points that are not on a lattice.
std::vector<double> cube_surface(std::uint64_t n, unsigned d) {
  std::vector<double> x(n * d);
  std::uint64_t random = 0x9E3779B97F4A7C15ULL;
  for (double& v : x) {
    random ^= random << 13;
    random ^= random >> 7;
    random ^= random << 17;
    v = static_cast<double>(random >> 11) * 0x1p-53;
  }
  for (std::uint64_t i = 0; i < n; ++i) x[i * d + i / 2 % d] = static_cast<double>(i % 2);
  return x;
}

void run(const std::string& name, unsigned threads, int repeat) {
  const Workload w = parse(name);
  std::vector<double> coordinates;
  if (w.shape == "cube_surface") {
    coordinates = cube_surface(w.count, w.dimension);
  } else {
    coordinates = cullhull::generate(w.shape, w.count, w.dimension);
  }
  const auto points = cullhull::PointView::row_major(coordinates.data(), w.count, w.dimension);
  cullhull::Options options;
  options.threads = threads;
  double whole = 1e300, filter = 1e300, engine = 1e300, work = 1e300;
  std::uint64_t survivors = 0, facets = 0, simplices = 0, rungs[3] = {};
  for (int k = 0; k < repeat; ++k) {
    const auto start = Clock::now();
    const cullhull::Hull hull = cullhull::convex_hull(points, options);
    whole = std::min(whole, milliseconds(start));
    filter = std::min(filter, 1e3 * hull.statistics.cull_seconds);
    survivors = hull.statistics.survivors;
    facets = hull.facet_count();
    simplices = hull.simplex_count();
  }
  const cullhull::Survivors kept = cullhull::cull(points, options);
  for (int k = 0; k < repeat; ++k) {
    const Run run(options);
    const LocalFrame frame(
        cullhull::internal::gather_points(points, kept.all ? nullptr : kept.ids.data(),
                                          kept.size(points.count), run.with_threads(1)),
        static_cast<std::uint32_t>(kept.size(points.count)), w.dimension,
        run.with_threads(threads));
    const auto start = Clock::now();
    const double work_start = processor_milliseconds();
    const cullhull::internal::Boundary hull =
        cullhull::internal::hull_nd(frame.points(), frame.simplex().data(),
                                    run.with_budget(std::uint64_t{16} << 30).with_threads(threads));
    engine = std::min(engine, milliseconds(start));
    work = std::min(work, processor_milliseconds() - work_start);
    std::copy_n(hull.rung_counts.of, 3, rungs);
  }
  std::printf(
      "%-24s %u thr  survivors %8llu  facets %8llu (%8llu)  filter %8.1f  engine %8.1f (cpu %8.1f) "
      " "
      "whole %8.1f ms  rungs %llu %llu %llu\n",
      name.c_str(), threads, static_cast<unsigned long long>(survivors),
      static_cast<unsigned long long>(facets), static_cast<unsigned long long>(simplices), filter,
      engine, work, whole, static_cast<unsigned long long>(rungs[0]),
      static_cast<unsigned long long>(rungs[1]), static_cast<unsigned long long>(rungs[2]));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  unsigned threads = 2;
  int repeat = 3;
  std::vector<std::string> names;
  for (int i = 1; i < argc; ++i) {
    const std::string a = argv[i];
    if (a == "--threads" && i + 1 < argc)
      threads = static_cast<unsigned>(std::atoi(argv[++i]));
    else if (a == "--repeat" && i + 1 < argc)
      repeat = std::max(1, std::atoi(argv[++i]));
    else
      names.push_back(a);
  }
  if (names.empty()) names.assign(std::begin(standard), std::end(standard));
  try {
    for (const std::string& name : names) run(name, threads, repeat);
  } catch (const cullhull::Error& e) {
    std::fprintf(stderr, "engine_nd_bench: %s\n", e.what());
    return 1;
  }
  return 0;
}
