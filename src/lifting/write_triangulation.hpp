// The canonical result: ids, corners, cells in order; groups; the hull.
#pragma once

#include <vector>

#include "cullhull/triangulation.hpp"
#include "lifting/lifted_points.hpp"
#include "parallel/run.hpp"

namespace cullhull::internal {

/// Cells of the engine without dead and infinite ones: places in the order of insertion, and
/// numbers of cells, no_cell outside.
struct RawCells {
  Array<std::uint32_t> vertices, neighbours;  ///< cells x (k + 1)
};

/// Cells, neighbours and hull of `out`.
void write_cells(const LiftedPoints& s, RawCells&& raw, Triangulation& out, const Run& run);

/// cell_groups, from signs of the facets between cells.
void write_groups(const LiftedPoints& s, Triangulation& out, const Run& run);

/// The place of each id that has one; of others anything.
std::vector<std::uint32_t> places_of_ids(const LiftedPoints& s, std::uint64_t point_count);

}  // namespace cullhull::internal
