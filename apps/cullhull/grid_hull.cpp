#include "grid_hull.hpp"

#include <vector>

#include "cullhull/cull.hpp"
#include "cullhull/hull.hpp"
#include "io/grid_axes.hpp"

namespace app {

cullhull::Hull hull_on_grid(const cullhull::PointView& numbers,
                            const cullhull::Placement& placement, const cullhull::Grid& grid,
                            const cullhull::Options& options) {
  const cullhull::Survivors survivors = cullhull::cull(numbers, options);
  const std::uint64_t count = survivors.size(numbers.count);
  const auto id = [&](std::uint64_t i) { return survivors.all ? i : survivors.ids[i]; };
  const std::uint32_t d = numbers.dimension;
  std::vector<double> rows(count * d);
  const cullhull::internal::GridAxes axes(placement, grid);
  for (std::uint64_t i = 0; i < count; ++i)
    for (std::uint32_t j = 0; j < d; ++j) rows[i * d + j] = axes.at(j, numbers.at(id(i), j));
  cullhull::Options behind = options;
  behind.cull = cullhull::CullMethod::none;
  cullhull::Hull hull =
      cullhull::convex_hull(cullhull::PointView::row_major(rows.data(), count, d), behind);
  if (!survivors.all) hull.rename(id);
  hull.point_count = numbers.count;
  cullhull::Statistics& s = hull.statistics;
  s.survivors = count;
  s.filter = survivors.filter;
  s.cull_reason.replace(0, s.cull_reason.find("; "), survivors.reason);  // "no filter, as asked"
  s.backend = survivors.backend;
  s.cull_seconds = survivors.seconds;
  s.compute_seconds += survivors.seconds;
  return hull;
}

}  // namespace app
