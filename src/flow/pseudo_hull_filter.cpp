#include <algorithm>

#include "filter/pseudo_hull/pseudo_hull.hpp"
#include "flow/pipeline.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

Filtered run_pseudo_hull(const PointView& points, const Run& run) {
  const unsigned d = points.dimension;
  Filtered result;
  run.report("cull", 0);
  const PseudoHullSettings by_subsets;
  result.survivors.ids = pseudo_hull_survivors(points, by_subsets, run);
  result.survivors.filter = UsedFilter::pseudo_hull;
  result.survivors.reason = "filter as asked; the pseudo-hull runs on the CPU";
  if (result.survivors.ids.size() == points.count) {
    result.survivors.ids = {};
    result.survivors.all = true;
    return result;
  }
  gather_survivors(points, result.survivors.ids, result, run);
  const std::uint64_t left = result.pass_survivors;
  // A second pseudo-hull, of all survivors as one set if it fits. A point takes 45 bytes and its
  // coordinates. On a sphere, where all points are extreme, the largest round has a fifth as many
  // facets as points; the bound allows half as many, each with d cells in each of two arrays.
  const std::uint64_t bytes = left * (8 * d + 45 + d * (12 * d + 8));
  PseudoHullSettings second;
  second.subsets = bytes <= std::min(run.budget / 2, std::uint64_t{1} << 30) ? 1 : 0;
  keep_of_survivors(result, d, pseudo_hull_survivors(view_of_rows(result, d), second, run));
  return result;
}

}  // namespace cullhull::internal
