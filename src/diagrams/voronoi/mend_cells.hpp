// Makes the polygons of clipped 2D cells valid again where the rounding of corners has made rings
// cross or touch themselves. docs/exactness.md, "Clipped cells".
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/voronoi.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

/// `unsound`: the cells with invalid polygons. Changes these and the cells that share edges with
/// them; every corner stays a corner of the diagram, rounded.
void mend_cells(const std::vector<std::uint32_t>& unsound, ClippedCells& cells, const Run& run);

}  // namespace cullhull::internal
