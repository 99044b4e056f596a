// Insertion in the engines: the time of a whole hull on one thread, per point and per facet of the
// result. Arguments: dimension, points.
#include "sets.hpp"

namespace cullhull::micro {
namespace {

void insert(benchmark::State& state, const char* shape) {
  const auto d = static_cast<unsigned>(state.range(0));
  const auto n = static_cast<std::uint64_t>(state.range(1));
  const Options options;
  const internal::Run run(options);
  const internal::LocalFrame frame(generate(shape, n, d), static_cast<std::uint32_t>(n), d, run);
  std::size_t facets = 0;
  for (auto _ : state) facets = engine_hull(frame, run).facet_count();
  if (facets <= d + 1) state.SkipWithError("no hull");
  count_items(state, n, "time a point");
  count_items(state, facets, "time a facet");
}

/// Every point becomes a vertex.
void insert_sphere(benchmark::State& state) { insert(state, "sphere"); }
/// Most points are inside.
void insert_ball(benchmark::State& state) { insert(state, "ball"); }
/// Ties everywhere, decided by exact arithmetic.
void insert_grid(benchmark::State& state) { insert(state, "grid:32"); }

BENCHMARK(insert_sphere)
    ->Unit(benchmark::kMillisecond)
    ->Args({2, 100000})
    ->Args({3, 20000})
    ->Args({4, 2000})
    ->Args({5, 500})
    ->Args({6, 200})
    ->Args({7, 60})
    ->Args({8, 30});
BENCHMARK(insert_ball)
    ->Unit(benchmark::kMillisecond)
    ->Args({2, 100000})
    ->Args({3, 50000})
    ->Args({4, 10000})
    ->Args({5, 2000})
    ->Args({6, 500});
BENCHMARK(insert_grid)->Unit(benchmark::kMillisecond)->Args({3, 20000})->Args({4, 5000});

}  // namespace
}  // namespace cullhull::micro
