#include "query/hull_arguments.hpp"

#include <algorithm>
#include <cmath>
#include <string>

#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "geometry/gather.hpp"

namespace cullhull::internal {

void check_hull_arguments(const PointView& points, const Hull& hull, double distance) {
  const auto require = [](bool condition, const std::string& message) {
    if (!condition) throw Error(ErrorCode::invalid_argument, message);
  };
  require(distance >= 0 && std::isfinite(distance),
          "a distance must be a finite number, not negative");
  require(points.dimension == hull.dimension,
          "points of dimension " + std::to_string(points.dimension) + " with a hull in dimension " +
              std::to_string(hull.dimension));
  if (points.count > 0) require_points(points);
  for (const std::uint64_t id : hull.vertices)
    require(id < points.count, "the hull's vertex " + std::to_string(id) + " is not one of the " +
                                   std::to_string(points.count) + " points");
}

std::uint64_t place_of(const std::vector<std::uint64_t>& ids, std::uint64_t id) {
  return static_cast<std::uint64_t>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
}

std::vector<double> rows_of(const PointView& points, const std::vector<std::uint64_t>& ids) {
  std::vector<double> rows;
  rows.reserve(ids.size() * points.dimension);
  for (const std::uint64_t id : ids)
    for (std::uint32_t j = 0; j < points.dimension; ++j) rows.push_back(points.at(id, j));
  return rows;
}

Hull by_place(Hull hull, const std::vector<std::uint64_t>& ids) {
  hull.rename([&](std::uint64_t id) { return place_of(ids, id); });
  hull.point_count = ids.size();
  return hull;
}

double power_to_unit(const std::vector<double>& values) {
  double largest = 0;
  for (const double x : values) largest = std::max(largest, std::fabs(x));
  if (largest == 0) return 1;
  return std::ldexp(1.0, -std::clamp(std::ilogb(largest), -1022, 1022));
}

}  // namespace cullhull::internal
