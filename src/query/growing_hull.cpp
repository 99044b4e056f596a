#include "cullhull/growing_hull.hpp"

#include <algorithm>
#include <optional>
#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/query.hpp"
#include "geometry/gather.hpp"
#include "query/hull_arguments.hpp"

namespace cullhull {

struct GrowingHull::State {
  Hull hull;
  std::vector<double> rows;  // of the vertices, by ascending id
  std::optional<HullQuery> query;

  PointView view(const std::vector<double>& of) const {
    return PointView::row_major(of.data(), of.size() / hull.dimension, hull.dimension);
  }
};

GrowingHull::GrowingHull(std::uint32_t dimension) : state_(std::make_unique<State>()) {
  internal::require_dimension(dimension);
  state_->hull.dimension = dimension;
}
GrowingHull::GrowingHull(Hull hull, std::vector<double> vertex_coordinates)
    : GrowingHull(hull.dimension) {
  if (vertex_coordinates.size() != hull.vertices.size() * hull.dimension)
    throw Error(ErrorCode::invalid_argument, "a hull of ", hull.vertices.size(),
                " vertices in dimension ", hull.dimension,
                " needs a row of coordinates for each, not ", vertex_coordinates.size(),
                " numbers");
  state_->hull = std::move(hull);
  state_->rows = std::move(vertex_coordinates);
}
GrowingHull::~GrowingHull() = default;
GrowingHull::GrowingHull(GrowingHull&&) noexcept = default;
GrowingHull& GrowingHull::operator=(GrowingHull&&) noexcept = default;

const Hull& GrowingHull::hull() const noexcept { return state_->hull; }
const std::vector<double>& GrowingHull::vertex_coordinates() const noexcept { return state_->rows; }

std::uint64_t GrowingHull::add(const PointView& points, const Options& options) {
  State& s = *state_;
  const std::uint32_t d = s.hull.dimension;
  if (points.dimension != d)
    throw Error(ErrorCode::invalid_argument, "points of dimension ", points.dimension,
                " added to a hull in dimension ", d);
  if (points.count == 0) return 0;
  const std::uint64_t before = s.hull.point_count;

  // Candidates: the vertices so far, and the new points outside of their hull.
  std::vector<std::uint64_t> ids = s.hull.vertices;
  std::sort(ids.begin(), ids.end());
  std::vector<double> rows = s.rows;
  std::uint64_t outside = 0;
  Hull next;
  if (before == 0) {
    next = convex_hull(points, options);
    outside = points.count;
  } else {
    if (!s.query) s.query.emplace(s.view(s.rows), internal::by_place(s.hull, ids));
    std::vector<std::uint8_t> contained(points.count);
    s.query->contains(points, contained.data(), options);
    for (std::uint64_t i = 0; i < points.count; ++i) {
      if (contained[i]) continue;
      ++outside;
      ids.push_back(before + i);
      for (unsigned j = 0; j < d; ++j) rows.push_back(points.at(i, j));
    }
    if (outside > 0) {
      next = convex_hull(s.view(rows), options);
      next.rename([&](std::uint64_t row) { return ids[row]; });
      next.scalar = s.hull.scalar == points.scalar ? points.scalar : ScalarType::f64;
    }
  }
  if (outside == 0) {
    s.hull.point_count = before + points.count;
    if (s.hull.scalar != points.scalar) s.hull.scalar = ScalarType::f64;
    return 0;
  }
  next.point_count = before + points.count;
  std::vector<std::uint64_t> kept = next.vertices;
  std::sort(kept.begin(), kept.end());
  std::vector<std::uint64_t> places;  // of the vertices among the candidates
  for (const std::uint64_t id : kept)
    places.push_back(before == 0 ? id : internal::place_of(ids, id));
  s.rows = internal::rows_of(before == 0 ? points : s.view(rows), places);
  s.hull = std::move(next);
  s.query.reset();
  return outside;
}

}  // namespace cullhull
