#include <algorithm>
#include <cstddef>
#include <utility>
#include <vector>

#include "exact/orientation/orientation.hpp"
#include "hull/general/facet_estimate.hpp"
#include "hull/general/insertion_nd.hpp"
#include "parallel/dispatch.hpp"

namespace cullhull::internal {

namespace {

/// The boundary of d + 1 affinely independent points: facet i has all of them but point i.
Boundary boundary_of_simplex(const LocalPoints& points) {
  const unsigned d = points.dimension;
  std::vector<const double*> rows;
  for (std::uint32_t i = 0; i <= d; ++i) rows.push_back(points.exact_row(i));
  const bool positive = orientation_exact(d, rows.data()) == Sign::positive;
  Boundary out;
  out.dimension = d;
  for (std::uint32_t i = 0; i <= d; ++i) {
    const std::size_t begin = out.vertices.size();
    for (std::uint32_t j = 0; j <= d; ++j)
      if (j != i) out.vertices.push_back(j);
    // Point i is the last of the other order after d - i swaps.
    if (positive == ((d - i) % 2 == 0)) std::swap(out.vertices[begin], out.vertices[begin + 1]);
    out.neighbours.insert(out.neighbours.end(),
                          out.vertices.begin() + static_cast<std::ptrdiff_t>(begin),
                          out.vertices.end());
  }
  out.doubtful.assign(d + 1, 0);
  return out;
}

}  // namespace

Boundary hull_nd(const LocalPoints& points, const std::uint32_t* simplex, const Run& run,
                 bool same_facets) {
  // Peak bytes per facet: the engine's record and its copy in the Boundary, or the result if that
  // takes more.
  const std::uint64_t d = points.dimension;
  check_facets(points, std::max(2 * (12 * d + 16), result_bytes_per_facet(d, d)), run);
  // In few dimensions the insertion takes as long.
  if (d > 8 && points.count == d + 1) return boundary_of_simplex(points);
  return with_dimension<4, 8, 0>(points.dimension, [&](auto k) {
    using Engine = InsertionNd<decltype(k)::value>;
    try {
      return Engine(points, simplex, run, same_facets).run();
    } catch (typename Engine::Tied) {
      return Engine(points, simplex, run.with_threads(1), same_facets).run();
    }
  });
}

}  // namespace cullhull::internal
