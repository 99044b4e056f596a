// Makes the polygons of clipped 2D cells valid again where the rounding of corners has made rings
// cross or touch themselves. docs/exactness.md, "Clipped cells".
//
// * A cell's boundary is a set of directed edges with the cell on their left. A sweep with exact
//   signs looks for a corner on an edge, for edges that cross, and for points around which the
//   boundary turns other than 0 or 1 times; opposite edges cancel. Where it finds none, the edges
//   form polygons: rings touch each other in single points only. A convex ring needs no sweep.
//
// * A corner on an edge, and of two crossing edges the end nearest to the crossing, becomes a
//   corner of the (other) edge, in every cell that has the edge. With t the angle between the
//   edges, the distance of an end at r from the crossing to the other edge is r sin t: the least of
//   the four, so no more than that of the end that rounding moved across.
//
// * A part turned over by rounding has the longest edge of its ring led through one of its corners,
//   by which the part becomes thinner. Where no corner is nearer to both ends than they are to each
//   other (rings some units in the last place wide), the shortest edge is contracted.
//
// This ends: a lead replaces an edge by two that are earlier in the order by length, then ends
// (both parts at a crossing are shorter, by the triangle inequality: |ac| < |ax| + |xc| <= |ax| +
// |xb| for the end c of the other edge that is nearest to the crossing x), a contraction leaves
// fewer corners, and there are finitely many sets of edges between given corners. Since all cells
// with an edge change alike, their boundaries still add up to that of the region; with 0 or 1 turns
// around every point in each, no two overlap where the region's rounded boundary does not overlap
// itself. Corners are never moved and none is new: a ring may go through its neighbour's corner, as
// near as rounding.
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
