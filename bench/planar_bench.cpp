// 2D points: the engine alone, the extreme points, the complete result.
//
//     planar_bench [--n N] [--threads 1,2] [--repeat K] [WORKLOAD ...]
//
// Prints the least time in ms and the least processor time (user and system) of each.
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "bench_arguments.hpp"
#include "cullhull/extreme_points.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/hull.hpp"
#include "hull/plane/polygon.hpp"
#include "timing.hpp"

namespace cullhull::internal {
namespace {

/// Coordinates and a view of them, which is not always of packed doubles.
struct Input {
  std::vector<double> doubles;
  std::vector<float> floats;
  PointView view;
};

Input rows(std::vector<double>&& values) {
  Input in;
  in.doubles = std::move(values);
  in.view = PointView::row_major(in.doubles.data(), in.doubles.size() / 2, 2);
  return in;
}

Input made(std::uint64_t n, const std::function<void(std::uint64_t, double, double*)>& point) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<double> p(2 * n);
  for (std::uint64_t i = 0; i < n; ++i) point(i, unit(random), p.data() + 2 * i);
  return rows(std::move(p));
}

Input as_floats(std::uint64_t n) {
  Input in;
  for (const double v : generate("sphere", n, 2)) in.floats.push_back(static_cast<float>(v));
  in.view = PointView::row_major(in.floats.data(), n, 2);
  return in;
}

Input split(std::uint64_t n) {
  const std::vector<double> p = generate("sphere", n, 2);
  Input in;
  for (unsigned j = 0; j < 2; ++j)
    for (std::uint64_t i = 0; i < n; ++i) in.doubles.push_back(p[2 * i + j]);
  in.view = PointView::column_major(in.doubles.data(), n, 2);
  return in;
}

using Maker = std::function<Input(std::uint64_t)>;
const std::map<std::string, Maker, std::less<>>& workloads() {
  static const std::map<std::string, Maker, std::less<>> table =
      {
          {"circle", [](auto n) { return rows(generate("sphere", n, 2)); }},
          {"circle-f32", as_floats},
          {"circle-split", split},
          {"disk", [](auto n) { return rows(generate("ball", n, 2)); }},
          {"gauss", [](auto n) { return rows(generate("gauss", n, 2)); }},
          {"grid", [](auto n) { return rows(generate("grid", n, 2)); }},
          {"line",
           [](auto n) {
    return made(n, [](auto, double t, double* p) { p[0] = t, p[1] = t / 4; });
           }},
          {"line-rounded",
           [](auto n) {
    return made(n, [](auto, double t, double* p) { p[0] = t, p[1] = t * 0.3; });
           }},
                                                         {"vertical",
                                                          [](auto n) {
    return made(n, [](auto, double t, double* p) { p[0] = 0.5, p[1] = t; });
                                                          }},
      {"parabola",
       [](auto n) { return made(n, [](auto, double t, double* p) { p[0] = t, p[1] = t * t; }); }},
      {"duplicates",
       [](auto n) {
    return made(n, [](auto i, double, double* p) {
      const double a = static_cast<double>(i % 1000);
      p[0] = std::cos(a), p[1] = std::sin(a);
    });
       }},
      {"clusters",
       [](auto n) {
    return made(n, [](auto i, double t, double* p) {
      p[0] = (i % 2 ? 0.75 : -0.75) + 0x1p-30 * t, p[1] = i % 100000 == 3 ? t : 0x1p-40 * t;
    });
       }},
      {"scallops",
       [](auto n) {
    return made(n, [](auto i, double t, double* p) {  // thirty arcs, four of them on the hull
      const double a = 3.14159265358979 * t, c = static_cast<double>(i % 30) - 15;
      p[0] = c + std::cos(a) / 2, p[1] = 0.01 * c * c + std::sin(a) / 2;
    });
       }},
      };
  return table;
}

void time_it(const char* what, unsigned repeat, const std::function<std::size_t()>& body) {
  double best = 1e300, busy = 1e300;
  std::size_t found = 0;
  for (unsigned k = 0; k < repeat; ++k) {
    const double start_busy = bench::processor_ms();
    best = std::min(best, 1e3 * bench::seconds_of([&] { found = body(); }));
    busy = std::min(busy, bench::processor_ms() - start_busy);
  }
  std::printf("  %s %8.2f (%.2f) %zu", what, best, busy, found);
}

void run(const std::string& name, const Input& in, unsigned threads, unsigned repeat) {
  Options options;
  options.threads = threads;
  std::printf("%-14s %9llu points, %u threads:", name.c_str(),
              static_cast<unsigned long long>(in.view.count), threads);
  time_it("engine", repeat, [&] {
    return polygon_of(in.view, false, Run(options).with_threads(threads)).corners.size();
  });
  time_it("extreme", repeat, [&] { return extreme_points(in.view, options).ids.size(); });
  time_it("hull", repeat, [&] { return convex_hull(in.view, options).vertices.size(); });
  std::printf("\n");
  std::fflush(stdout);
}

int main(int argc, char** argv) {
  std::vector<std::string> all;
  for (const auto& w : workloads()) all.push_back(w.first);
  const bench::BenchArguments given = bench::parse_arguments(
      argc, argv, {2'000'000, 5},
      [](std::string_view name) { return workloads().count(name) != 0; }, all);
  for (const std::string& name : given.workloads) {
    const Input in = workloads().find(name)->second(given.n);
    for (const unsigned t : given.threads) run(name, in, t, given.repeat);
  }
  return 0;
}

}  // namespace
}  // namespace cullhull::internal

int main(int argc, char** argv) { return cullhull::internal::main(argc, argv); }
