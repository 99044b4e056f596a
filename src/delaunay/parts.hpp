// Parallel Delaunay triangulation in the plane without locks: parts of the points are triangulated
// independently and joined in pairs. A cell whose circumcircle misses the other part's box is
// final. The vertices of all other cells are triangulated again, together: the seam. The region
// that the final cells leave open is filled with cells of the seam. docs/exactness.md, "Parts".
#pragma once

#include <cstdint>
#include <memory>

#include "delaunay/cell_store.hpp"
#include "exact/insphere/lift_side.hpp"

namespace cullhull::internal {

struct Prepared;
struct Run;
/// Statistics summed over several insertion engines.
struct InsertionTotals {
  LiftCounts counts;
  std::uint64_t created = 0;
  void add(const LiftCounts& more, std::uint64_t cells) {
    counts.add(more);
    created += cells;
  }
};

/// Triangulates points of the plane without weights in 2^levels parts; in one part any. Returns
/// null if the points are unsuitable for more: a join would insert more than two fifths of them
/// twice (half, in the sample), or the first points of a part are collinear.
std::unique_ptr<CellStore<2>> triangulate_in_parts(const Prepared& p, unsigned levels,
                                                   InsertionTotals& totals, const Run& run);

}  // namespace cullhull::internal
