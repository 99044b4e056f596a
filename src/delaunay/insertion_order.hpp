// The order in which points are inserted: rounds of growing size, each along a Hilbert curve
// (Amenta, Choi, Rote 2003). Equal points meet on the way.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/triangulation.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

struct InsertionOrder {
  Array<std::uint32_t> ids;  ///< each of the points that stand in for themselves once
  std::vector<DuplicatePoint> duplicates;
};

/// Of n x d finite numbers. `weights`: null, or one a point: of equal points the largest weight
/// stands in, then the lowest id. Nothing but time depends on the order.
InsertionOrder insertion_order(const double* rows, std::uint32_t n, unsigned d,
                               const double* weights, const Run& run);

}  // namespace cullhull::internal
