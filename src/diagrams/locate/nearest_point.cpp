// NearestPoint: the public face of NearestTree.
#include "cullhull/error.hpp"
#include "cullhull/triangulation_query.hpp"
#include "diagrams/locate/finite_coordinate.hpp"
#include "diagrams/locate/nearest_tree.hpp"
#include "geometry/gather.hpp"

namespace cullhull {

using namespace internal;

struct NearestPoint::State {
  NearestTree tree;
};

NearestPoint::NearestPoint(const PointView& points, const RunOptions& options) {
  const Call call(options);
  const Run& run = call.run;
  require_points(points);
  if (points.dimension > NearestTree::most_dimensions)
    refuse("nearest points are found in up to ", NearestTree::most_dimensions,
           " dimensions, not in ", points.dimension);
  if (points.count == 0) refuse("there are no points of which one could be the nearest");
  if (points.count >= no_index) refuse("there are more than 2^32 - 2 points: ", points.count);
  require_budget(run.budget, points.count * points.dimension * sizeof(double), "the coordinates");
  const Array<double> rows = gather_points(points, nullptr, points.count, run);
  state_.reset(new State{NearestTree(points.dimension, rows.data(), nullptr,
                                     static_cast<std::uint32_t>(points.count), run)});
}
NearestPoint::~NearestPoint() = default;
NearestPoint::NearestPoint(NearestPoint&&) noexcept = default;
NearestPoint& NearestPoint::operator=(NearestPoint&&) noexcept = default;

std::uint32_t NearestPoint::dimension() const noexcept { return state_->tree.dimension(); }

std::uint32_t NearestPoint::nearest(const double* query) const {
  for (unsigned j = 0; j < state_->tree.dimension(); ++j) require_finite(query[j], j);
  return state_->tree.nearest(query, NearestTree::FarQueries::answered);
}

void NearestPoint::nearest(const PointView& queries, std::uint32_t* out,
                           const RunOptions& options) const {
  const Call call(options);
  const Run& run = call.run;
  if (queries.dimension != state_->tree.dimension())
    refuse("points of dimension ", queries.dimension, " asked of points in dimension ",
           state_->tree.dimension());
  check_finite(queries, nullptr, run);
  state_->tree.nearest(queries, NearestTree::FarQueries::answered, out, run);
}

}  // namespace cullhull
