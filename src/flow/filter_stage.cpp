#include <algorithm>

#include "few/few_in_space.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "filter/planner.hpp"
#include "filter/pseudo_hull/pseudo_hull.hpp"
#include "flow/pipeline.hpp"
#include "geometry/gather.hpp"
#include "parallel/memory/memory.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

Array<double> pick_rows(const Array<double>& rows, unsigned d,
                        const std::vector<std::uint64_t>& kept) {
  Array<double> out(kept.size() * d);
  for (std::size_t i = 0; i < kept.size(); ++i)
    std::copy_n(rows.data() + kept[i] * d, d, out.data() + i * d);
  return out;
}

}  // namespace

void keep_of_survivors(Filtered& result, unsigned d, const std::vector<std::uint64_t>& kept,
                       Array<double>&& rows) {
  std::vector<std::uint64_t> ids(kept.size());
  for (std::size_t i = 0; i < kept.size(); ++i) ids[i] = result.survivors.ids[kept[i]];
  result.rows = rows.empty() ? pick_rows(result.rows, d, kept) : std::move(rows);
  result.survivors.ids = std::move(ids);
}

void gather_survivors(const PointView& points, Filtered& result, const Run& run) {
  const std::uint64_t left = result.survivors.ids.size();
  result.pass_survivors = left;
  require_budget(run.budget, left * (points.dimension + 2) * sizeof(double),
                 std::to_string(left) + " points that survive the filter");
  if (result.rows.empty())
    result.rows = gather_points(points, result.survivors.ids.data(), left, run);
  else
    check_rows_finite(result.rows.data(), left, points.dimension, result.survivors.ids.data(), run);
  run.report("cull", 0.8);
}

std::string why_no_filter(CullMethod method, std::uint64_t count, unsigned d) {
  if (method == CullMethod::none) return "no filter, as asked";
  if (method == CullMethod::pseudo_hull) return "the pseudo-hull is for 2D to 8D";
  if (d < GaugeMap::min_dimension || d > GaugeMap::max_dimension)
    return "the gauge map is for 2D to 6D";
  if (count <= d + 1 || (method == CullMethod::automatic && count < smallest_worth_culling(d)))
    return "too few points for the filter to pay (" + std::to_string(count) + ")";
  return "";
}

Filtered run_filter(const PointView& points, const Run& run) {
  Filtered result;
  result.survivors.all = true;
  result.pass_survivors = points.count;
  const unsigned d = points.dimension;
  if (run.options.cull == CullMethod::pseudo_hull && d >= pseudo_hull_min_dimension &&
      d <= pseudo_hull_max_dimension && points.count > d + 1)
    return run_pseudo_hull(points, run);
  if (run.options.cull == CullMethod::automatic && run.options.backend != Backend::cuda && d == 3 &&
      points.count > most_unfiltered_in_space && points.count <= most_by_outermost &&
      cull_by_outermost(points, run, result))
    return result;
  result.survivors.reason = why_no_filter(run.options.cull, points.count, d);
  if (!result.survivors.reason.empty()) return result;

  filter_by_sample(points, run, result);
  return result;
}

}  // namespace cullhull::internal
