#include <algorithm>

#include "filter/ways.hpp"
#include "flow/pipeline.hpp"
#include "geometry/gather.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/memory/memory.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

void keep_of_survivors(Filtered& result, unsigned d, std::span<const std::uint64_t> kept) {
  std::vector<std::uint64_t> ids(kept.size());
  Array<double> rows(kept.size() * d);
  for (std::size_t i = 0; i < kept.size(); ++i) {
    ids[i] = result.survivors.ids[kept[i]];
    std::copy_n(result.rows.data() + kept[i] * d, d, rows.data() + i * d);
  }
  result.rows = std::move(rows);
  result.survivors.ids = std::move(ids);
}

void gather_survivors(const PointView& points, std::span<const std::uint64_t> ids, Filtered& result,
                      const Run& run) {
  const std::uint64_t left = ids.size();
  result.pass_survivors = left;
  require_budget(run.budget, left * (points.dimension + 2) * sizeof(double),
                 std::to_string(left) + " points that survive the filter");
  if (result.rows.empty())
    result.rows = gather_points(points, ids.data(), left, run);
  else
    check_rows_finite(result.rows.data(), left, points.dimension, ids.data(), run);
  run.report("cull", 0.8);
}

Filtered run_filter(const PointView& points, const Run& run) {
  static_assert(row_of(Way::gauge).least_dimension == GaugeMap::min_dimension &&
                row_of(Way::gauge).most_dimension == GaugeMap::max_dimension);
  Filtered result;
  result.survivors.all = true;
  result.pass_survivors = points.count;
  if (plane_only) return result;
  const WayQuestion q = way_question(points, run.options);
  if (takes(Way::pseudo_hull, q)) return run_pseudo_hull(points, run);
  if (takes(Way::outermost, q) && cull_by_outermost(points, run, result)) return result;
  result.survivors.reason = why_no_filter(q);
  if (result.survivors.reason.empty()) filter_by_sample(points, run, result);
  return result;
}

}  // namespace cullhull::internal
