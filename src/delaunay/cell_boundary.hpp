// The boundary of some of a triangulation's cells.
#pragma once

#include <cstdint>

#include "cullhull/array.hpp"
#include "cullhull/triangulation.hpp"

namespace cullhull::internal {

/// Facets between a cell that is kept and none, as Triangulation::hull_facets, and the cells that
/// have them. `kept`: a flag for each cell. None for k < 1.
void write_boundary(const Triangulation& t, const Array<std::uint8_t>& kept,
                    Array<std::uint32_t>& facets, Array<std::uint32_t>& facet_cells);

}  // namespace cullhull::internal
