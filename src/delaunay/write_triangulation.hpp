// Writes the canonical result: sorted cells with the caller's ids, groups, the hull's facets.
#pragma once

#include <vector>

#include "cullhull/triangulation.hpp"
#include "delaunay/cell_store.hpp"
#include "exact/points/lifted_points.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::inline delaunay {

/// Cells, neighbours and hull of `out` from the engine's cells, whose ids and corners are put in
/// order on the way. K: as the store's.
template <unsigned K>
void write_cells(const LiftedPoints& s, CellStore<K>& store, Triangulation& out, const Run& run);

/// Writes cell_groups: joins adjacent cells whose vertices are on one sphere.
void write_groups(const LiftedPoints& s, Triangulation& out, const Run& run);

/// The place of each inserted id in the order of insertion; 0 for other ids.
std::vector<std::uint32_t> places_of_ids(const LiftedPoints& s, std::uint64_t point_count);

}  // namespace cullhull::internal::inline delaunay
