// The canonical result: ids, corners, cells in order; groups; the hull.
#pragma once

#include <vector>

#include "cullhull/triangulation.hpp"
#include "delaunay/cell_store.hpp"
#include "exact/points/lifted_points.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

/// Cells, neighbours and hull of `out` from the engine's cells, whose ids and corners are put in
/// order on the way. K: as the store's.
template <unsigned K>
void write_cells(const LiftedPoints& s, CellStore<K>& store, Triangulation& out, const Run& run);

/// cell_groups, from signs of the facets between cells.
void write_groups(const LiftedPoints& s, Triangulation& out, const Run& run);

/// The place of each id that has one; of others anything.
std::vector<std::uint32_t> places_of_ids(const LiftedPoints& s, std::uint64_t point_count);

}  // namespace cullhull::internal
