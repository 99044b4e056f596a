#include "cullhull/halfspaces.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "cullhull/error.hpp"
#include "geometry/gather.hpp"
#include "parallel/threads/parallel.hpp"
#include "query/inscribed_ball.hpp"

namespace cullhull::internal {
namespace {

/// Scales rows to |a| = 1, then the offsets to a largest magnitude of 1; `unit` receives that
/// scale.
std::vector<double> normalised(const std::vector<double>& rows, unsigned d, double& unit) {
  const std::size_t width = std::size_t{d} + 1;
  std::vector<double> out(rows);
  unit = 0;
  for (std::size_t i = 0; i < rows.size(); i += width) {
    double largest = 0, square = 0;
    for (unsigned j = 0; j < d; ++j) largest = std::max(largest, std::fabs(rows[i + j]));
    if (largest == 0)
      throw Error(ErrorCode::invalid_argument, "halfspace ", i / width, " has no normal: a is 0");
    for (unsigned j = 0; j < d; ++j) square += (rows[i + j] / largest) * (rows[i + j] / largest);
    const double length = std::sqrt(square);
    for (unsigned j = 0; j < width; ++j) out[i + j] = rows[i + j] / largest / length;
    unit = std::max(unit, std::fabs(out[i + d]));
  }
  if (unit == 0 || !std::isfinite(unit)) unit = 1;
  for (std::size_t i = d; i < out.size(); i += width) out[i] /= unit;
  return out;
}

std::vector<double> find_interior(const std::vector<double>& rows, unsigned d,
                                  const Control& control) {
  double unit = 1;
  const std::vector<double> unit_rows = normalised(rows, d, unit);
  Ball ball = inscribed_ball(unit_rows, d, control);
  if (!(ball.radius > 0))
    throw Error(ErrorCode::invalid_argument,
                "the halfspaces have no interior point in common (or one too thin for doubles to "
                "find; then give one)");
  for (double& v : ball.centre) v *= unit;
  return ball.centre;
}

/// The dual points. a . x + b is summed with a rounding error bound: a point x nearer to a plane
/// than that is refused, as the dual point would have no correct digit.
std::vector<double> dualise(const std::vector<double>& rows, unsigned d, const double* x) {
  const std::size_t width = std::size_t{d} + 1;
  std::vector<double> out;
  out.reserve(rows.size() / width * d);
  for (std::size_t i = 0; i < rows.size(); i += width) {
    double sum = rows[i + d], size = std::fabs(rows[i + d]);
    for (unsigned j = 0; j < d; ++j) {
      sum += rows[i + j] * x[j];
      size += std::fabs(rows[i + j] * x[j]);
    }
    if (!(sum < -1.01 * static_cast<double>(d + 1) * 0x1p-53 * size - 0x1p-1060))
      throw Error(ErrorCode::invalid_argument,
                  "the interior point is not strictly inside halfspace ", i / width);
    for (unsigned j = 0; j < d; ++j) {
      out.push_back(rows[i + j] / -sum);
      if (!std::isfinite(out.back()))
        throw Error(ErrorCode::invalid_argument, "the interior point is too near halfspace ",
                    i / width, ": its dual point overflows");
    }
  }
  return out;
}

/// Writes x0 - n / o for every dual facet n . y + o = 0 that the origin is strictly below, else
/// NaN.
void write_vertices(HalfspaceIntersection& h) {
  const unsigned d = h.dimension;
  const std::size_t width = std::size_t{d} + 1;
  h.bounded = h.dual.affine_dimension == static_cast<int>(d);
  if (!h.bounded) {  // the dual is flat: no facet of it is a vertex
    h.vertices.assign(h.dual.facet_count() * d, std::numeric_limits<double>::quiet_NaN());
    return;
  }
  for (std::size_t f = 0; f < h.dual.facet_count(); ++f) {
    const double* plane = h.dual.facet_planes.data() + f * width;
    const bool below = plane[d] < 0;
    h.bounded = h.bounded && below;
    for (unsigned j = 0; j < d; ++j)
      h.vertices.push_back(below ? h.interior_point[j] - plane[j] / plane[d]
                                 : std::numeric_limits<double>::quiet_NaN());
  }
}

}  // namespace
}  // namespace cullhull::internal

namespace cullhull {

using namespace internal;

HalfspaceIntersection intersect_halfspaces(const PointView& halfspaces,
                                           const double* interior_point, const Options& options) {
  if (halfspaces.dimension < 2)
    throw Error(ErrorCode::invalid_argument,
                "a halfspace is a row of d coefficients and an offset");
  HalfspaceIntersection h;
  const unsigned d = halfspaces.dimension - 1;
  h.dimension = d;
  const Run run(options);
  const Array<double> gathered = gather_points(halfspaces, nullptr, halfspaces.count, run);
  const std::vector<double> rows(gathered.begin(), gathered.end());
  if (interior_point != nullptr) {
    h.interior_point.assign(interior_point, interior_point + d);
    for (const double v : h.interior_point)
      if (!std::isfinite(v))
        throw Error(ErrorCode::not_finite,
                    "the interior point has a coordinate that is not finite");
  } else {
    h.interior_point = find_interior(rows, d, run.control);
  }
  h.dual_points = dualise(rows, d, h.interior_point.data());
  h.dual = convex_hull(PointView::row_major(h.dual_points.data(), halfspaces.count, d), options);
  write_vertices(h);
  return h;
}

}  // namespace cullhull
