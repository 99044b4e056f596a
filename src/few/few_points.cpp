#include "few/few_points.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "few/few_in_space.hpp"
#include "few/few_nd.hpp"
#include "few/small_nd.hpp"
#include "few/small_polygon.hpp"
#include "filter/lattice/small_lattice.hpp"
#include "parallel/threads/parallel.hpp"
#include "parallel/threads/run.hpp"
#include "parallel/threads/thread_memory.hpp"

namespace cullhull::internal {
namespace {

/// Memory reused from call to call. Calls cannot be cancelled: they take microseconds, from 4D on
/// at most some milliseconds.
struct KeptPolygon {
  SmallPolygon polygon{short_run().control};
};

bool small_extreme_2d(const PointView& points, ExtremePoints& result) {
  SmallPolygon& polygon = thread_memory<KeptPolygon>().polygon;
  if (!polygon.find(points)) return false;
  result.affine_dimension = 2;
  result.ids.resize(polygon.size());
  polygon.write_vertices(result.ids.data());
  std::sort(result.ids.begin(), result.ids.end());
  polygon.rung_counts().add_to(result.statistics.rung_counts);
  return true;
}

bool small_hull_3d(const PointView& points, Hull& hull) {
  const std::vector<std::uint64_t>* ids = nullptr;
  if (ends_in_small_lattice(points, ids))
    return hull_of_few(points, ids->data(), ids->size(), hull);
  return points.count <= most_unfiltered_in_space &&
         hull_of_few(points, nullptr, points.count, hull);
}

bool small_extreme_3d(const PointView& points, ExtremePoints& result) {
  Hull hull;
  if (!small_hull_3d(points, hull)) return false;
  result.affine_dimension = hull.affine_dimension;
  result.ids = std::move(hull.vertices);
  return true;
}

bool small_hull_2d(const PointView& points, Hull& hull) {
  SmallPolygon& polygon = thread_memory<KeptPolygon>().polygon;
  if (!polygon.find(points)) return false;
  if (!polygon.write(points, hull)) return false;
  polygon.rung_counts().add_to(hull.statistics.rung_counts);
  return true;
}

/// Calls find() if size and options permit it, and fills `statistics`. False where find() is not
/// called or returns false.
template <class Find>
bool find_small(const PointView& points, const Options& options, Statistics& statistics,
                const Find& find) {
  if (points.dimension < 2 || points.dimension > small_nd_max_dimension ||
      !takes_small_sets(options, points.dimension))
    return false;
  const Clock::time_point start = Clock::now();
  const Control control(options);
  control.check();
  if (!find()) return false;
  statistics.threads = resolve_threads(options.threads);
  statistics.survivors = points.count;
  constexpr std::uint64_t few = std::uint64_t{1} << 16;
  statistics.cull_reason = points.count <= few
                               ? "few points"
                               : "an ellipse in a sample's hull, or lines, left few points";
  statistics.hull_seconds = statistics.compute_seconds = seconds_since(start);
  control.report("done", 1);
  return true;
}

}  // namespace

bool takes_small_sets(const Options& options, std::uint32_t dimension) {
  return options.backend != Backend::cuda && options.cull == CullMethod::automatic &&
         (options.memory_budget == 0 || options.memory_budget >= small_set_bytes(dimension));
}

bool small_hull(const PointView& points, const Options& options, Hull& hull) {
  return find_small(points, options, hull.statistics, [&] {
    const bool found = points.dimension == 2 ? small_hull_2d(points, hull)
                       : points.dimension == 3
                           ? small_hull_3d(points, hull)
                           : hull_of_few_nd(points, nullptr, points.count, hull);
    if (!found) return false;
    hull.dimension = points.dimension;
    hull.point_count = points.count;
    hull.scalar = points.scalar;
    return true;
  });
}

bool small_extreme(const PointView& points, const Options& options, ExtremePoints& result) {
  return points.dimension <= 3 && find_small(points, options, result.statistics, [&] {
           return points.dimension == 2 ? small_extreme_2d(points, result)
                                        : small_extreme_3d(points, result);
         });
}

}  // namespace cullhull::internal
