// The 3D engine alone on inputs that are hard for it: all points extreme, slivers, plateaus,
// lattices, thin bodies, duplicates.
//
//     engine_bench [--n N] [--threads 1,2] [--repeat K] [WORKLOAD ...]
//
// Prints the least and the median time in ms, the least processor time in ms, simplices, and the
// number of decisions of each stage. identity_bench checks whether results are certified and the
// same for all threads.
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <string_view>
#include <vector>

#include "bench_arguments.hpp"
#include "families.hpp"
#include "geometry/local_frame.hpp"
#include "hull/engine.hpp"
#include "timing.hpp"

namespace cullhull::internal {
namespace {

using Rows = std::vector<double>;

/// Shapes of `cullhull generate`, and families that are hard for an engine.
std::vector<std::string> all_workloads() {
  std::vector<std::string> names{"ball",     "bumpy", "cone", "cube-surface", "cyclic",
                                 "cylinder", "gauss", "grid", "grid:1048576", "sphere"};
  for (const Shape& family : bench::hard_families()) names.emplace_back(family.name);
  return names;
}

void engine_alone(const std::string& name, const Rows& rows, unsigned threads, unsigned repeat) {
  const Options options;
  const Run run(options);
  const LocalFrame frame(cullhull::Array<double>(rows.begin(), rows.end()),
                         static_cast<std::uint32_t>(rows.size() / 3), 3, run.with_threads(threads));
  std::vector<double> times, busy;
  Boundary hull;
  for (unsigned k = 0; k < repeat; ++k) {
    hull = {};
    const double busy_start = bench::processor_ms();
    times.push_back(1e3 * bench::seconds_of([&] {
                      hull = hull_3d(frame.points(), frame.simplex().data(),
                                     run.with_budget(std::uint64_t{8} << 30).with_threads(threads));
                    }));
    busy.push_back(bench::processor_ms() - busy_start);
  }
  std::sort(times.begin(), times.end());
  std::sort(busy.begin(), busy.end());
  std::printf(
      "%-22s %8zu points %u threads: %10.4f ms, median %10.4f, processor %10.4f; %zu simplices, "
      "rungs %llu %llu %llu\n",
      name.c_str(), rows.size() / 3, threads, times[0], times[times.size() / 2], busy[0],
      hull.facet_count(), static_cast<unsigned long long>(hull.rung_counts.of[0]),
      static_cast<unsigned long long>(hull.rung_counts.of[1]),
      static_cast<unsigned long long>(hull.rung_counts.of[2]));
  std::fflush(stdout);
}

int run(int argc, char** argv) {
  const bench::BenchArguments given = bench::parse_arguments(
      argc, argv, {}, [](std::string_view name) { return bench::is_family(name, 3); },
      all_workloads());
  for (const std::string& name : given.workloads) {
    const std::uint64_t n = name == "cyclic" ? std::min<std::uint64_t>(given.n, 60000) : given.n;
    const Rows rows = bench::make_family(name, n, 3);
    for (const unsigned t : given.threads) engine_alone(name, rows, t, given.repeat);
  }
  return 0;
}

}  // namespace
}  // namespace cullhull::internal

int main(int argc, char** argv) { return cullhull::internal::run(argc, argv); }
