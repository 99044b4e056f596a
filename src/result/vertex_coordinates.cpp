#include "result/vertex_coordinates.hpp"

#include <algorithm>
#include <numeric>

#include "cullhull/certify.hpp"
#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "geometry/gather.hpp"

namespace cullhull::internal {

void write_coordinates(const PointView& points, Hull& hull) {
  const std::uint32_t d = hull.dimension;
  hull.vertex_coordinates.resize(hull.vertices.size() * d);
  double* out = hull.vertex_coordinates.data();
  if (const double* const rows = packed_doubles(points)) {
    for (const std::uint64_t v : hull.vertices) out = std::copy_n(rows + v * d, d, out);
    return;
  }
  for (const std::uint64_t v : hull.vertices)
    for (std::uint32_t j = 0; j < d; ++j) *out++ = points.at(v, j);
}

OwnVertices::OwnVertices(const Hull& hull) : dimension(hull.dimension), ids(hull.vertices) {
  if (!hull.has_coordinates())
    throw Error(ErrorCode::invalid_argument,
                "the hull carries no coordinates: compute it with Options::with_coordinates, or "
                "pass the points");
  // Only polygons list their vertices in another order than by id.
  std::vector<std::size_t> order(ids.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return hull.vertices[a] < hull.vertices[b]; });
  rows.reserve(hull.vertex_coordinates.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    ids[i] = hull.vertices[order[i]];
    const auto row = hull.coordinates(order[i]);
    rows.insert(rows.end(), row.begin(), row.end());
  }
}

}  // namespace cullhull::internal

namespace cullhull {

Certificate certify(const Hull& hull, const Options& options) {
  const internal::OwnVertices own(hull);
  for (const auto* list : {&hull.simplices, &hull.facets.items})
    for (const std::uint64_t id : *list)
      if (!std::binary_search(own.ids.begin(), own.ids.end(), id)) {
        Certificate bad;
        bad.reason = "point " + std::to_string(id) + " of a facet is not a vertex";
        return bad;
      }
  // Ids become places among the vertices, in the same order, so all canonical orders stay.
  Hull alone = hull;
  alone.rename([&](std::uint64_t id) {
    return static_cast<std::uint64_t>(std::lower_bound(own.ids.begin(), own.ids.end(), id) -
                                      own.ids.begin());
  });
  alone.point_count = own.ids.size();
  return certify(own.points(), alone, options);
}

}  // namespace cullhull
