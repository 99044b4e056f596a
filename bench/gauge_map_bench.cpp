// The GaugeMap's pass over the points, beside merely reading them: points/s and bytes/s.
//
//   bench/gauge_map_bench --benchmark_repetitions=5 --benchmark_report_aggregates_only=true
//
// Arguments: dimension, threads. Points are uniform in a ball; the polytope is that of a sample.
#include <benchmark/benchmark.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <map>
#include <memory>
#include <numeric>
#include <random>
#include <utility>
#include <vector>

#include "cull/gauge_map.hpp"
#include "cullhull/options.hpp"
#include "hull/engine.hpp"
#include "parallel/parallel.hpp"
#include "predicates/orientation.hpp"

namespace {

using namespace cullhull;
using namespace cullhull::internal;

constexpr std::uint64_t point_count = 4'000'000;

const std::vector<double>& ball(unsigned d) {
  static std::vector<double> rows;  // of one dimension at a time: memory
  if (rows.size() == point_count * d) return rows;
  std::mt19937_64 random(d);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> unit(0, 1);
  rows.assign(point_count * d, 0);
  for (std::size_t i = 0; i < point_count; ++i) {
    double norm = 0;
    for (unsigned j = 0; j < d; ++j) {
      rows[i * d + j] = normal(random);
      norm += rows[i * d + j] * rows[i * d + j];
    }
    const double r = std::pow(unit(random), 1.0 / d) / std::sqrt(norm);
    for (unsigned j = 0; j < d; ++j) rows[i * d + j] *= r;
  }
  return rows;
}

template <class T>
const std::vector<T>& ball_as(unsigned d) {
  if constexpr (std::is_same_v<T, double>) {
    return ball(d);
  } else {
    static std::vector<T> rows;
    if (rows.size() != point_count * d) rows.assign(ball(d).begin(), ball(d).end());
    return rows;
  }
}

/// The hull of the first points of the ball.
const InnerPolytope& polytope(unsigned d) {
  static std::map<unsigned, InnerPolytope> cache;
  InnerPolytope& p = cache[d];
  if (p.dimension) return p;
  static constexpr std::uint32_t samples[] = {0, 0, 20000, 20000, 20000, 8000, 2000};
  LocalPoints points;
  points.dimension = d;
  points.count = samples[d];
  points.coordinates = points.exact = ball(d).data();
  const Options options;
  const Control control(options);
  std::vector<std::uint32_t> simplex(d + 1);
  std::iota(simplex.begin(), simplex.end(), 0U);  // independent: the points are random
  const SimplicialHull h =
      d == 2   ? hull_2d(points, 1, control)
      : d == 3 ? hull_3d(points, simplex.data(), std::uint64_t{1} << 32, 1, control)
               : hull_nd(points, simplex.data(), std::uint64_t{1} << 32, 1, control);
  std::vector<std::uint32_t> local(points.count, ~0U);
  for (const std::uint32_t v : h.vertices) {
    if (local[v] == ~0U) {
      local[v] = static_cast<std::uint32_t>(p.vertices.size() / d);
      p.vertices.insert(p.vertices.end(), points.row(v), points.row(v) + d);
    }
    p.facets.push_back(local[v]);
  }
  p.neighbours = h.neighbours;
  p.dimension = d;
  return p;
}

void report(benchmark::State& state, std::uint64_t bytes) {
  const auto points = static_cast<double>(state.iterations()) * static_cast<double>(point_count);
  state.counters["points/s"] = benchmark::Counter(points, benchmark::Counter::kIsRate);
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(bytes));
}

template <class T>
void cull(benchmark::State& state) {
  const auto d = static_cast<unsigned>(state.range(0));
  const auto threads = static_cast<unsigned>(state.range(1));
  const auto& rows = ball_as<T>(d);
  const auto map = GaugeMap::build(polytope(d));
  const Options options;
  const Control control(options);
  std::size_t kept = 0;
  for (auto _ : state)
    kept =
        map->survivors(PointView::row_major(rows.data(), point_count, d), threads, control).size();
  report(state, rows.size() * sizeof(T));
  state.counters["kept %"] = 100.0 * static_cast<double>(kept) / static_cast<double>(point_count);
}

template <class T>
void read(benchmark::State& state) {
  const auto d = static_cast<unsigned>(state.range(0));
  const auto threads = static_cast<unsigned>(state.range(1));
  const auto& rows = ball_as<T>(d);
  for (auto _ : state) {
    std::atomic<std::uint64_t> total = 0;
    for_each_chunk(rows.size(), 65536, threads,
                   [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
                     std::uint64_t sum[8] = {};  // integers: the compiler may vectorise the sum
                     std::uint64_t words[8];
                     const T* p = rows.data() + begin;
                     for (; p + 64 / sizeof(T) <= rows.data() + end; p += 64 / sizeof(T)) {
                       std::memcpy(words, p, 64);
                       for (int k = 0; k < 8; ++k) sum[k] += words[k];
                     }
                     total += std::accumulate(sum, sum + 8, std::uint64_t{0});
                   });
    benchmark::DoNotOptimize(total.load());
  }
  report(state, rows.size() * sizeof(T));
}

void build(benchmark::State& state) {
  const auto d = static_cast<unsigned>(state.range(0));
  const InnerPolytope& p = polytope(d);
  for (auto _ : state) benchmark::DoNotOptimize(GaugeMap::build(p));
  state.counters["facets"] = static_cast<double>(p.facets.size() / d);
}

void small(benchmark::internal::Benchmark* b) {
  b->ArgsProduct({{2, 3, 4, 5, 6}, {1, 2}})->Unit(benchmark::kMillisecond)->UseRealTime();
}
BENCHMARK(cull<double>)->Apply(small);
BENCHMARK(read<double>)->Apply(small);
BENCHMARK(cull<float>)->Apply(small);
BENCHMARK(read<float>)->Apply(small);
BENCHMARK(build)->DenseRange(2, 6)->Unit(benchmark::kMillisecond);

}  // namespace

BENCHMARK_MAIN();
