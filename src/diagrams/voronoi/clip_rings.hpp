// The cells of the plane as polygons with holes, from the convex pieces that a region's triangles
// cut them into.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "diagrams/voronoi/clip_corners.hpp"
#include "diagrams/voronoi/clip_shapes.hpp"

namespace cullhull::internal::inline diagrams {

/// Corners, and what lies across the edge that begins at each: a site's number, or no_point.
struct CellRing {
  std::vector<std::array<double, 2>> points;
  std::vector<std::uint32_t> across;
};
/// The outer ring, counterclockwise, then holes, clockwise.
using CellPolygon = std::vector<CellRing>;

/// A cell within one piece of the region.
struct CellPiece {
  std::uint32_t piece;
  std::vector<std::uint32_t> vertices, planes;  ///< as in ClipShape<2>
};

/// Equal neighbours among the points become one; the ring begins at its least point. False if less
/// than three are left.
bool tidy(CellRing& ring);

/// The union of a cell's pieces, which are ascending by number. Polygons and holes are sorted by
/// their first points; those of which rounding leaves less than three corners are left out.
std::vector<CellPolygon> join_pieces(CellCorners<2>& corners, const std::vector<CellPiece>& pieces);

}  // namespace cullhull::internal::inline diagrams
