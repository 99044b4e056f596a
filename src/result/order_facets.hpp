// Facets in canonical order.
#pragma once

#include <cstdint>
#include <vector>

#include "parallel/threads/run.hpp"
#include "result/build_hull.hpp"
#include "result/merge.hpp"

namespace cullhull::internal::inline result {

/// Input of the measures besides the hull: its vertices' ids, ascending, and for every simplex the
/// positions of its vertices among them.
struct OrderedFacets {
  std::vector<std::uint64_t> vertices;
  std::vector<std::uint32_t> index;
};

/// Sorts the simplices, numbers the facets, and fills every list of the hull. Its vertices ascend,
/// which is not their final order for k = 2.
OrderedFacets order_facets(const ResultInput& input, Facets&& facets, const Run& run, Hull& hull);

}  // namespace cullhull::internal::inline result
