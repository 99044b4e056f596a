#include "few/few_points.hpp"

#include <string>
#include <utility>
#include <vector>

#include "few/few_in_space.hpp"
#include "few/small_polygon.hpp"
#include "filter/lattice/small_lattice.hpp"
#include "filter/ways.hpp"
#include "parallel/dispatch.hpp"
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
  result.ids = polygon.extreme();
  polygon.rung_counts().add_to(result.statistics.rung_counts);
  return true;
}

bool small_hull_3d(const PointView& points, Hull& hull) {
  const std::vector<std::uint64_t>* ids = nullptr;
  if (!ends_in_small_lattice(points, ids))
    return takes_few({.dimension = 3, .count = points.count}) &&
           hull_of_few(points, nullptr, points.count, hull);
  if (!hull_of_few(points, ids->data(), ids->size(), hull)) return false;
  hull.statistics.cull_reason = std::string(row_of(Way::small_lattice).name) + ", ";
  return true;
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
  if (const WayRow* filter = polygon.filtered_by())
    hull.statistics.cull_reason = std::string(filter->name) + ", ";
  polygon.rung_counts().add_to(hull.statistics.rung_counts);
  return true;
}

/// Calls find() if the options permit it, and fills `statistics`. False where find() is not called
/// or returns false.
template <class Find>
bool find_small(const PointView& points, const Options& options, Statistics& statistics,
                const Find& find) {
  if (!permits_few(way_question(points, options))) return false;
  const Clock::time_point start = Clock::now();
  const Control control(options);
  control.check();
  if (!find()) return false;
  statistics.threads = resolve_threads(options.threads);
  statistics.survivors = points.count;
  statistics.cull_reason += row_of(few_way(points.dimension)).name;
  statistics.hull_seconds = statistics.compute_seconds = seconds_since(start);
  control.report("done", 1);
  return true;
}

}  // namespace

bool small_hull(const PointView& points, const Options& options, Hull& hull) {
  return find_small(points, options, hull.statistics, [&] {
    const bool found = plane_only || points.dimension == 2 ? small_hull_2d(points, hull)
                       : points.dimension == 3             ? small_hull_3d(points, hull)
                                               : hull_of_few(points, nullptr, points.count, hull);
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
