#include <algorithm>
#include <utility>

#include "cullhull/error.hpp"
#include "cullhull/extreme_points.hpp"
#include "cullhull/hull.hpp"
#include "geometry/gather.hpp"
#include "parallel/threads/run.hpp"
#include "stream/numbered_points.hpp"

namespace cullhull::internal {

namespace {

/// extreme_points(). From 4D to 6D through a hull, which finds them faster than linear programs do,
/// if its facets fit the budget; up to 6D likewise if the hull is `wanted`, too.
std::vector<std::uint64_t> find_extreme(const PointView& points, const Options& options,
                                        Hull* wanted) {
  const unsigned d = points.dimension;
  if (d <= 6 && (d >= 4 || wanted != nullptr)) try {
      Hull hull = convex_hull(points, options);
      std::vector<std::uint64_t> ids = hull.vertices;  // may be in cyclic order
      if (wanted != nullptr) *wanted = std::move(hull);
      std::sort(ids.begin(), ids.end());
      return ids;
    } catch (const Error& e) {
      if (e.code() != ErrorCode::out_of_budget) throw;
    }
  return extreme_points(points, options).ids;
}

}  // namespace

void keep_extreme(NumberedPoints& points, const Options& options, Hull* hull) {
  const Call call(options);
  points.sort(call.run);
  if (points.size() < 2) return;
  const std::vector<std::uint64_t> places = find_extreme(points.view(), options, hull);
  if (hull != nullptr && hull->dimension > 0)
    hull->rename([&](std::uint64_t place) { return points.ids[place]; });
  if (places.size() < points.size()) points.keep(places, call.run);
}

ScalarType common_scalar(ScalarType a, std::uint64_t count_a, ScalarType b, std::uint64_t count_b) {
  if (a == b || (count_b == 0 && count_a > 0)) return a;
  return count_a == 0 && count_b > 0 ? b : ScalarType::f64;
}

void refuse_not_finite(const NumberedPoints& points, unsigned threads) {
  const Options options;
  const Run run = Run(options).with_threads(threads);
  const PointView view = points.view();
  try {
    check_finite(view, nullptr, run);
  } catch (const Error&) {
    // The message must name the id, not the position: check each row with its id.
    std::vector<double> row(view.dimension);
    for (std::uint64_t i = 0; i < view.count; ++i) {
      load_row(view, i, row.data());
      check_rows_finite(row.data(), 1, view.dimension, &points.ids[i], run);
    }
    throw;
  }
}

void check_block(const PointView& block, std::uint64_t first_id, std::uint32_t dimension) {
  require_dimension(block.dimension);
  if (dimension != 0 && block.dimension != dimension)
    throw Error(ErrorCode::invalid_argument, "points of dimension ", block.dimension,
                " among points of dimension ", dimension);
  require_points(block);
  if (block.count > 0 && first_id + (block.count - 1) < first_id)
    throw Error(ErrorCode::invalid_argument, "ids of the points exceed 2^64");
}

}  // namespace cullhull::internal
