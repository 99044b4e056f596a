// Writes the canonical result: sorted cells with the caller's ids, groups, the facets of the hull
// or of any part of the cells, hidden points.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "cullhull/triangulation.hpp"
#include "delaunay/cell_store.hpp"
#include "exact/points/local_points.hpp"
#include "parallel/disjoint_sets.hpp"

namespace cullhull::internal {

struct Run;
/// Writes the cells, neighbours and hull of `out` from the engine's cells, and its cell_groups if
/// its statistics have ties. Overwrites the store: its vertices become the caller's ids, and
/// corners are reordered. K: as the store's.
template <unsigned K>
void write_cells(const LiftedPoints& s, CellStore<K>& store, Triangulation& out, const Run& run);

/// Joins adjacent finite cells of the store whose vertices are on one sphere. To be called before
/// the store is overwritten: its cells are in spatial order, those of the result are not.
template <unsigned K>
DisjointSets cells_of_spheres(const LiftedPoints& s, CellStore<K>& store, const Run& run);

/// Writes cell_groups from cells_of_spheres(), unless each cell is a group of its own. rank[c]: the
/// number of the store's cell c in the result; no_index if it is not finite; overwritten.
void write_groups(DisjointSets& sets, std::span<std::uint32_t> rank, Triangulation& out,
                  const Run& run);

/// Writes the facets between a kept cell and a cell that is not kept, or no cell, in the format of
/// Triangulation::hull_facets, and for each the kept cell. `kept`: a flag for each cell; null: all
/// cells are kept. Writes empty lists for k < 1.
void write_boundary(const Triangulation& t, const std::uint8_t* kept,
                    Array<std::uint32_t>& boundary, Array<std::uint32_t>& boundary_cells,
                    const Run& run);

/// The ids that are neither vertices of cells nor duplicates, ascending.
std::vector<std::uint32_t> hidden_points(const Triangulation& t);

/// Drops the cells without a flag in `kept` and numbers the others anew. Points without a cell
/// become hidden, groups are cleared; the hull is left to write_boundary().
void keep_cells(Triangulation& t, const std::uint8_t* kept);

/// For each id its place in the order of insertion; 0 for ids that were not inserted.
std::vector<std::uint32_t> places_of_ids(const LiftedPoints& s, std::uint64_t point_count);

}  // namespace cullhull::internal
