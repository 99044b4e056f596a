// Shared by the micro-benchmarks: points, an engine's input, a polytope for a map.
#pragma once

#include <benchmark/benchmark.h>

#include <cstdint>
#include <vector>

#include "cullhull/generate.hpp"
#include "cullhull/options.hpp"
#include "geometry/local_frame.hpp"
#include "hull/engine.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::micro {

/// The hull of rows that span their space, by the engine of their dimension, on one thread.
inline internal::Boundary engine_hull(const internal::LocalFrame& frame, const internal::Run& run) {
  const internal::LocalPoints& points = frame.points();
  constexpr std::uint64_t budget = std::uint64_t{8} << 30;
  return points.dimension == 2   ? internal::hull_2d(points, run.with_threads(1))
         : points.dimension == 3 ? internal::hull_3d(points, frame.simplex().data(),
                                                     run.with_budget(budget).with_threads(1))
                                 : internal::hull_nd(points, frame.simplex().data(),
                                                     run.with_budget(budget).with_threads(1));
}

/// Reports the time per item; every iteration processes `items` of them.
inline void count_items(benchmark::State& state, std::uint64_t items, const char* name = "time") {
  state.counters[name] =
      benchmark::Counter(static_cast<double>(items), benchmark::Counter::kIsIterationInvariantRate |
                                                         benchmark::Counter::kInvert);
}

/// The position of points relative to the unit ball: well inside, near its surface, well outside.
enum class Place { inside, near, outside };

/// `count` rows in uniformly distributed directions.
inline std::vector<double> placed(Place place, std::uint64_t count, unsigned d) {
  std::vector<double> rows = generate("sphere", count, d, 2);
  const std::vector<double> at = generate("cube", count, 1, 3);  // in [-1, 1)
  for (std::uint64_t i = 0; i < count; ++i) {
    const double radius = place == Place::inside ? 0.35 + 0.25 * at[i]
                          : place == Place::near ? 0.99 + 0.01 * at[i]
                                                 : 1.5 + 0.4 * at[i];
    for (unsigned j = 0; j < d; ++j) rows[i * d + j] *= radius;
  }
  return rows;
}

}  // namespace cullhull::micro
