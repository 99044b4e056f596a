// Joins the convex pieces of a clipped 2D cell into polygons with holes. The region's triangles cut
// the cell into these pieces.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "diagrams/voronoi/clip_corners.hpp"
#include "diagrams/voronoi/clip_shapes.hpp"

namespace cullhull::internal {

/// Corners of a ring, and the site across the edge that begins at each; no_index if there is none.
struct CellRing {
  std::vector<std::array<double, 2>> points;
  std::vector<std::uint32_t> across;
};
/// A polygon: the outer ring, counterclockwise, then its holes, clockwise.
using CellPolygon = std::vector<CellRing>;

/// The order of rings and, by their outlines, of polygons.
inline bool starts_before(const CellRing& a, const CellRing& b) {
  return a.points[0] < b.points[0];
}

/// The part of a cell in one piece of the region.
struct CellPiece {
  std::uint32_t piece;
  std::vector<std::uint32_t> vertices, planes;  ///< as in ClipShape<2>
};

/// Merges equal consecutive points and rotates the ring so that it begins at its least point.
/// Returns false if fewer than three points are left.
bool tidy(CellRing& ring);

/// The union of a cell's pieces, which ascend by number. Polygons and holes are sorted by their
/// first points. Rings that rounding leaves with fewer than three corners are omitted.
std::vector<CellPolygon> join_pieces(CellCorners<2>& corners, const std::vector<CellPiece>& pieces);

}  // namespace cullhull::internal
