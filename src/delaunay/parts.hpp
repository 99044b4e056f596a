// Threads without locks in the plane: halves of the points are triangulated alone. A cell that the
// other half's box cannot disturb is final; the vertices of all others are triangulated once more,
// together, and what these cells leave open is cut out of that. docs/exactness.md, "Parts".
#pragma once

#include <cstdint>
#include <memory>

#include "delaunay/cell_store.hpp"
#include "exact/insphere/lift_side.hpp"
#include "exact/points/lifted_points.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

/// What insertions came to, of several engines.
struct InsertionTotals {
  LiftCounts counts;
  std::uint64_t created = 0;
  void add(const LiftCounts& more, std::uint64_t cells) {
    counts.add(more);
    created += cells;
  }
};

/// All cells of points of the plane, or null if they are no fit for parts: nearly all of them would
/// be inserted twice, or a part is flat. In 2^levels parts.
std::unique_ptr<CellStore<2>> triangulate_in_parts(const LiftedPoints& points, unsigned levels,
                                                   InsertionTotals& totals, const Run& run);

}  // namespace cullhull::internal
