// The 3D engine alone on the inputs that are hard for it: all points extreme, slivers, plateaus,
// lattices, thin bodies, duplicates.
//
//     engine_bench [--n N] [--threads 1,2] [--repeat K] [WORKLOAD ...]
//
// Prints the least and the median time in ms, the least processor time, simplices, decisions of
// each rung. Whether results are certified and the same for all threads says identity_bench.
#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <string>
#include <string_view>
#include <vector>

#include "cullhull/options.hpp"
#include "families.hpp"
#include "hull/engine.hpp"
#include "points/local_frame.hpp"

namespace cullhull::internal {
namespace {

using Rows = std::vector<double>;

/// Shapes of `cullhull generate` that are worth a look, and the hard families.
std::vector<std::string> all_workloads() {
  std::vector<std::string> names{"ball",     "bumpy", "cone", "cube-surface", "cyclic",
                                 "cylinder", "gauss", "grid", "grid:1048576", "sphere"};
  for (const Shape& family : bench::hard_families()) names.emplace_back(family.name);
  return names;
}

double now() {
  return std::chrono::duration<double, std::milli>(
             std::chrono::steady_clock::now().time_since_epoch())
      .count();
}

/// Of all threads: what a busy machine does not disturb as much.
double processor_ms() { return 1e3 * static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

void engine_alone(const std::string& name, const Rows& rows, unsigned threads, unsigned repeat) {
  const Options options;
  const Control control(options);
  const LocalFrame frame(cullhull::Array<double>(rows.begin(), rows.end()),
                         static_cast<std::uint32_t>(rows.size() / 3), 3, threads, control);
  std::vector<double> times, busy;
  SimplicialHull hull;
  for (unsigned k = 0; k < repeat; ++k) {
    hull = {};
    const double start = now(), busy_start = processor_ms();
    hull =
        hull_3d(frame.points(), frame.simplex().data(), std::uint64_t{8} << 30, threads, control);
    times.push_back(now() - start);
    busy.push_back(processor_ms() - busy_start);
  }
  std::sort(times.begin(), times.end());
  std::sort(busy.begin(), busy.end());
  std::printf(
      "%-22s %8zu points %u threads: %10.4f ms, median %10.4f, processor %10.4f; %zu simplices, "
      "rungs %llu %llu %llu\n",
      name.c_str(), rows.size() / 3, threads, times[0], times[times.size() / 2], busy[0],
      hull.facet_count(), static_cast<unsigned long long>(hull.rung_counts[0]),
      static_cast<unsigned long long>(hull.rung_counts[1]),
      static_cast<unsigned long long>(hull.rung_counts[2]));
  std::fflush(stdout);
}

int run(int argc, char** argv) {
  std::uint64_t n = 1000000;
  unsigned repeat = 3;
  std::vector<unsigned> threads = {1, 2};
  std::vector<std::string> names;
  for (int i = 1; i < argc; ++i) {
    const std::string_view a = argv[i];
    if (i + 1 < argc && a == "--n") {
      n = std::strtoull(argv[++i], nullptr, 10);
    } else if (i + 1 < argc && a == "--repeat") {
      repeat = static_cast<unsigned>(std::max(1, std::atoi(argv[++i])));
    } else if (i + 1 < argc && a == "--threads") {
      threads.clear();
      char* at = argv[++i];
      while (*at != 0) {
        threads.push_back(static_cast<unsigned>(std::strtoul(at, &at, 10)));
        at += *at == ',';
      }
    } else if (bench::is_family(a, 3)) {
      names.emplace_back(a);
    } else {
      std::fprintf(stderr, "engine_bench: no workload '%s'; there are:", argv[i]);
      for (const std::string& name : all_workloads()) std::fprintf(stderr, " %s", name.c_str());
      std::fprintf(stderr, "\n");
      return 2;
    }
  }
  if (names.empty()) names = all_workloads();
  for (const std::string& name : names) {
    const Rows rows =
        bench::make_family(name, name == "cyclic" ? std::min<std::uint64_t>(n, 60000) : n, 3);
    for (const unsigned t : threads) engine_alone(name, rows, t, repeat);
  }
  return 0;
}

}  // namespace
}  // namespace cullhull::internal

int main(int argc, char** argv) { return cullhull::internal::run(argc, argv); }
