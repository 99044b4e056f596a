#include <algorithm>

#include "hull/general/facet_estimate.hpp"
#include "hull/general/insertion_nd.hpp"

namespace cullhull::internal {

SimplicialHull hull_nd(const LocalPoints& points, const std::uint32_t* simplex,
                       std::uint64_t budget, unsigned threads, const Control& control,
                       bool same_facets) {
  // Records, twice while they are copied out; or what the result takes, which is more.
  const std::uint64_t d = points.dimension;
  check_facets(points, budget, std::max(2 * (12 * d + 16), result_bytes_per_facet(d, d)), threads,
               control);
  switch (points.dimension) {
    case 4:
      return InsertionNd<4>(points, simplex, budget, threads, same_facets, control).run();
    case 5:
      return InsertionNd<5>(points, simplex, budget, threads, same_facets, control).run();
    case 6:
      return InsertionNd<6>(points, simplex, budget, threads, same_facets, control).run();
    case 7:
      return InsertionNd<7>(points, simplex, budget, threads, same_facets, control).run();
    case 8:
      return InsertionNd<8>(points, simplex, budget, threads, same_facets, control).run();
    default:
      return InsertionNd<0>(points, simplex, budget, threads, same_facets, control).run();
  }
}

}  // namespace cullhull::internal
