// Facets in canonical order.
#pragma once

#include <cstdint>
#include <vector>

#include "parallel/control.hpp"
#include "result/build_hull.hpp"
#include "result/merge.hpp"

namespace cullhull::internal {

/// What the measures need besides the hull: its vertices' ids, ascending, and for every simplex the
/// places of its vertices among them.
struct Assembled {
  std::vector<std::uint64_t> vertices;
  std::vector<std::uint32_t> index;
};

/// Sorts the simplices, numbers the facets, and fills every list of the hull. Its vertices ascend,
/// which for k = 2 is not their final order.
Assembled assemble(const ResultInput& input, Facets&& facets, unsigned threads,
                   const Control& control, Hull& hull);

}  // namespace cullhull::internal
