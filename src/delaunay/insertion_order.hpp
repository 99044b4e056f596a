// The order in which points are inserted: rounds of growing size, each along a Hilbert curve
// (Amenta, Choi, Rote 2003). Sorting along the curve also finds equal points.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/triangulation.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline delaunay {

struct InsertionOrder {
  Array<std::uint32_t> ids;  ///< all points but the duplicates, in the order of insertion
  std::vector<DuplicatePoint> duplicates;
};

/// The order for n points of d finite coordinates each. `weights`: null, or one for each point. The
/// representative of equal points is that of the largest weight, among these that of the lowest id.
/// The order affects the running time, never the triangulation.
InsertionOrder insertion_order(const double* rows, std::uint32_t n, unsigned d,
                               const double* weights, const Run& run);

}  // namespace cullhull::internal::inline delaunay
