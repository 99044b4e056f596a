#include <algorithm>

#include "hull/general/facet_estimate.hpp"
#include "hull/general/insertion_nd.hpp"
#include "parallel/dispatch.hpp"

namespace cullhull::internal::inline hull {

Boundary hull_nd(const LocalPoints& points, const std::uint32_t* simplex, const Run& run,
                 bool same_facets) {
  // Peak bytes per facet: the engine's record and its copy in the Boundary, or the result if that
  // takes more.
  const std::uint64_t d = points.dimension;
  check_facets(points, std::max(2 * (12 * d + 16), result_bytes_per_facet(d, d)), run);
  return with_dimension<4, 8, 0>(points.dimension, [&](auto k) {
    return InsertionNd<decltype(k)::value>(points, simplex, run, same_facets).run();
  });
}

}  // namespace cullhull::internal::inline hull
