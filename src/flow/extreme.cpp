// The flow of extreme_points: like that of convex_hull, but from 4D on it computes no facets.
#include <algorithm>
#include <optional>
#include <utility>

#include "cullhull/extreme_points.hpp"
#include "extreme/extreme_ids.hpp"
#include "few/few_points.hpp"
#include "flow/pipeline.hpp"
#include "geometry/local_frame.hpp"
#include "parallel/memory/pages.hpp"
#include "parallel/threads/helpers.hpp"
#include "parallel/threads/run.hpp"
#include "result/write/write_simplices.hpp"

namespace cullhull::internal {
namespace {

void extreme_in_plane(const PointView& points, const Filtered& filtered, const Run& run,
                      ExtremePoints& result) {
  const PlanarRows rows(points, filtered);
  const Polygon polygon = rows.hull(run);
  result.affine_dimension = static_cast<int>(std::min<std::size_t>(polygon.corners.size(), 3)) - 1;
  result.ids =
      ascending_ids(polygon.corners.data(), polygon.corners.size(), polygon.rows, rows.ids, run);
  polygon.rung_counts.add_to(result.statistics.rung_counts);
}

/// Returns the extreme points' local ids, ascending.
std::vector<std::uint64_t> extreme_locals(const LocalFrame& frame, const Run& run,
                                          std::uint64_t* rung_counts) {
  const LocalPoints& points = frame.points();
  switch (points.dimension) {
    case 0:
      return {0};
    case 1: {
      const Boundary ends = ends_of_line(points);
      return ascending_ids(ends.vertices.data(), 2, points.count, nullptr, run.with_threads(1));
    }
    case 2: {
      const PointView rows = PointView::row_major(points.exact, points.count, 2);
      const Polygon polygon = polygon_of(rows, false, run);
      polygon.rung_counts.add_to(rung_counts);
      return ascending_ids(polygon.corners.data(), polygon.corners.size(), points.count, nullptr,
                           run);
    }
    case 3: {
      Boundary hull = hull_3d(points, frame.simplex().data(), run);
      hull.rung_counts.add_to(rung_counts);
      return extreme_rows(std::move(hull), points, run, rung_counts);
    }
    default: {
      const std::vector<std::uint32_t> ids = extreme_ids(frame, run);
      return {ids.begin(), ids.end()};
    }
  }
}

void extreme_in_space(const PointView& points, Filtered&& filtered, const Run& run,
                      ExtremePoints& result) {
  EngineInput input = engine_input(points, std::move(filtered), run);
  std::optional<LocalFrame> found;
  find_frame(points, input, run, found);
  const LocalFrame& frame = *found;
  result.affine_dimension = frame.affine_dimension();
  result.ids = extreme_locals(frame, run, result.statistics.rung_counts);
  if (input.all) return;
  for (std::uint64_t& v : result.ids) v = input.ids[v];
}

}  // namespace
}  // namespace cullhull::internal

namespace cullhull {

using namespace internal;

ExtremePoints extreme_points(const PointView& points, const Options& options) {
  check_arguments(points, options);
  ExtremePoints result;
  if (small_extreme(points, options, result)) return result;
  const Call call(options);
  Run run = call.run;
  const auto start = Clock::now();

  Statistics& statistics = result.statistics;
  statistics.threads = run.threads;
  run.check();
  if (points.count == 0) return result;
  Filtered filtered = filter_and_plan(points, run);
  statistics.survivors = filtered.survivors.size(points.count);
  statistics.filter = filtered.survivors.filter;
  statistics.cull_seconds = seconds_since(start);

  const auto search_start = Clock::now();
  if (points.dimension == 2)
    extreme_in_plane(points, filtered, run, result);
  else
    extreme_in_space(points, std::move(filtered), run, result);
  statistics.hull_seconds = seconds_since(search_start);
  statistics.compute_seconds = seconds_since(start);
  run.report("done", 1);
  return result;
}

}  // namespace cullhull
