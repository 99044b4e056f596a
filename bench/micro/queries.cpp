// Queries of single points to a finished hull, in a batch on one thread. Argument: the dimension.
#include <algorithm>

#include "cullhull/hull.hpp"
#include "cullhull/query.hpp"
#include "sets.hpp"

namespace cullhull::micro {
namespace {

template <Place place>
void contains(benchmark::State& state) {
  static constexpr std::uint64_t hull_points[] = {0, 0, 2000, 20000, 2000, 500, 200};
  constexpr std::uint64_t asked = 20'000;
  const auto d = static_cast<unsigned>(state.range(0));
  const std::vector<double> rows = generate("sphere", hull_points[d], d);
  const PointView view = PointView::row_major(rows.data(), hull_points[d], d);
  Options options;
  options.threads = 1;
  const Hull hull = convex_hull(view, options);
  const HullQuery query(view, hull, options);
  const std::vector<double> at = placed(place, asked, d);
  const PointView points = PointView::row_major(at.data(), asked, d);
  std::vector<std::uint8_t> in(asked);
  for (auto _ : state) query.contains(points, in.data(), options);
  const auto inside = static_cast<std::uint64_t>(std::count(in.begin(), in.end(), 1));
  if (place == Place::outside && inside != 0) state.SkipWithError("points are not outside");
  if (place == Place::inside && inside < asked / 2) state.SkipWithError("points are not inside");
  state.counters["inside %"] = 100.0 * static_cast<double>(inside) / static_cast<double>(asked);
  state.counters["facets"] = static_cast<double>(hull.facet_count());
  count_items(state, asked);
}

BENCHMARK(contains<Place::inside>)->DenseRange(2, 6);
BENCHMARK(contains<Place::near>)->DenseRange(2, 6);
BENCHMARK(contains<Place::outside>)->DenseRange(2, 6);

}  // namespace
}  // namespace cullhull::micro
