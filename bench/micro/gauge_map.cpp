// The gauge map: look-ups (per point, on one thread, for arrays that fit the cache and for larger
// ones), reading alone, and building the map. Argument: the dimension.
#include "filter/gauge/gauge_map.hpp"

#include <map>
#include <numeric>

#include "parallel/threads/parallel.hpp"
#include "sets.hpp"

namespace cullhull::micro {
namespace {

using internal::GaugeMap;
using internal::InnerPolytope;

constexpr std::uint64_t in_cache = 16'384, in_memory = 1'000'000;

/// The hull of a sample of the unit ball.
const InnerPolytope& polytope(unsigned d) {
  static std::map<unsigned, InnerPolytope> cache;
  InnerPolytope& p = cache[d];
  if (p.dimension != 0) return p;
  static constexpr std::uint32_t samples[] = {0, 0, 20000, 20000, 20000, 8000, 2000};
  const std::vector<double> rows = generate("ball", samples[d], d);
  const Options options;
  const internal::Run run(options);
  const internal::LocalFrame frame(std::vector<double>(rows), samples[d], d, run);
  const internal::Boundary hull = engine_hull(frame, run);
  std::vector<std::uint32_t> local(samples[d], ~0U);
  for (const std::uint32_t v : hull.vertices) {
    if (local[v] == ~0U) {
      local[v] = static_cast<std::uint32_t>(p.vertices.size() / d);
      const auto row = rows.begin() + static_cast<std::ptrdiff_t>(std::size_t{v} * d);
      p.vertices.insert(p.vertices.end(), row, row + d);
    }
    p.facets.push_back(local[v]);
  }
  p.neighbours.assign(hull.neighbours.begin(), hull.neighbours.end());
  p.dimension = d;
  return p;
}

template <class T, Place place, std::uint64_t count>
void look_up(benchmark::State& state) {
  const auto d = static_cast<unsigned>(state.range(0));
  const std::vector<double> doubles = placed(place, count, d);
  const std::vector<T> rows(doubles.begin(), doubles.end());
  const auto map = GaugeMap::build(polytope(d));
  const Options options;
  const internal::Run run(options);
  const PointView points = PointView::row_major(rows.data(), count, d);
  std::size_t kept = 0;
  for (auto _ : state) kept = map->survivors(points, run.with_threads(1)).size();
  const double share = static_cast<double>(kept) / static_cast<double>(count);
  if ((place == Place::outside && kept != count) || (place == Place::inside && share > 0.5))
    state.SkipWithError("points are not where they should be");
  state.counters["kept %"] = 100 * share;
  count_items(state, count);
}

template <class T>
void read(benchmark::State& state) {
  const auto d = static_cast<std::size_t>(state.range(0));
  const std::vector<T> rows(in_memory * d, T{1});
  for (auto _ : state) {
    T sum[32] = {};
    for (std::size_t i = 0; i + 32 <= rows.size(); i += 32)
      for (std::size_t k = 0; k < 32; ++k) sum[k] += rows[i + k];
    benchmark::DoNotOptimize(std::accumulate(sum, sum + 32, T{0}));
  }
  count_items(state, in_memory);
}

void build_map(benchmark::State& state) {
  const auto d = static_cast<unsigned>(state.range(0));
  const InnerPolytope& p = polytope(d);
  for (auto _ : state) benchmark::DoNotOptimize(GaugeMap::build(p));
  count_items(state, p.facets.size() / d, "time a facet");
}

BENCHMARK(look_up<double, Place::inside, in_cache>)->DenseRange(2, 6);
BENCHMARK(look_up<double, Place::near, in_cache>)->DenseRange(2, 6);
BENCHMARK(look_up<double, Place::outside, in_cache>)->DenseRange(2, 6);
BENCHMARK(look_up<double, Place::inside, in_memory>)->DenseRange(2, 6);
BENCHMARK(look_up<float, Place::inside, in_memory>)->DenseRange(2, 6);
BENCHMARK(read<double>)->DenseRange(2, 6);
BENCHMARK(read<float>)->DenseRange(2, 6);
BENCHMARK(build_map)->DenseRange(2, 6)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace cullhull::micro
