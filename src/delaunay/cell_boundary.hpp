// The boundary of some of a triangulation's cells.
#pragma once

#include <cstdint>

#include "cullhull/array.hpp"
#include "cullhull/triangulation.hpp"

namespace cullhull::internal::inline delaunay {

/// Appends the facets between a kept cell and a cell that is not kept, or no cell, in the format of
/// Triangulation::hull_facets, and for each the kept cell. `kept`: a flag for each cell. Writes
/// nothing for k < 1.
void write_boundary(const Triangulation& t, const Array<std::uint8_t>& kept,
                    Array<std::uint32_t>& facets, Array<std::uint32_t>& facet_cells);

}  // namespace cullhull::internal::inline delaunay
