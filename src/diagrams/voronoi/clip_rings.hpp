// Joins the convex pieces of a clipped 2D cell into polygons with holes. The region's triangles cut
// the cell into these pieces.
#pragma once

#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "cullhull/voronoi.hpp"
#include "diagrams/voronoi/clip_corners.hpp"

namespace cullhull::internal {

/// Corners of a ring, and the site across the edge that begins at each; no_index if there is none.
struct CellRing {
  std::vector<std::array<double, 2>> points;
  std::vector<std::uint32_t> across;
};
/// A polygon: the outer ring, counterclockwise, then its holes, clockwise.
using CellPolygon = std::vector<CellRing>;

/// Begins the lists that a diagram of this dimension has.
void begin_lists(ClippedCells& out);
/// Appends a cell in the plane.
void add_polygons(const std::vector<CellPolygon>& polygons, ClippedCells& out);

/// The part of a cell in one piece of the region.
struct CellPiece {
  std::uint32_t piece;
  std::vector<std::uint32_t> vertices, planes;  ///< as in ClipShape<2>
};

/// Merges equal consecutive points and rotates the ring so that it begins at its least point.
/// Returns false if fewer than three points are left.
bool tidy(CellRing& ring);
/// Adds a ring, if tidy() leaves it: the outline, if is_outer() says so, or a hole.
template <class IsOuter>
void add_ring(CellRing ring, const IsOuter& is_outer, CellPolygon& to) {
  if (!tidy(ring)) return;
  if (is_outer())
    to[0] = std::move(ring);
  else
    to.push_back(std::move(ring));
}
/// Sorts holes, and polygons by their outlines, by their first points.
void sort_rings(std::vector<CellPolygon>& polygons);

/// The union of a cell's pieces, which ascend by number. Polygons and holes are sorted by their
/// first points. Rings that rounding leaves with fewer than three corners are omitted.
std::vector<CellPolygon> join_pieces(CellCorners<2>& corners, const std::vector<CellPiece>& pieces);

}  // namespace cullhull::internal
