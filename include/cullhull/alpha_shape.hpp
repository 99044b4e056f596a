// Alpha shapes, the part of a triangulation whose cells have small circumscribed spheres, and
// concave hulls by the length of edges.
#pragma once

#include <cstdint>
#include <span>

#include "cullhull/array.hpp"
#include "cullhull/lists.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"
#include "cullhull/renamed.hpp"
#include "cullhull/triangulation.hpp"

#pragma GCC visibility push(default)
namespace cullhull::inline v1 {

/// A regularised alpha shape or a concave hull: cells alone, without edges and faces that bound
/// none.
struct AlphaShape {
  /// Cells of the triangulation, ascending: of an alpha shape those whose circumscribed sphere (of
  /// a flat: within the flat) has a radius of at most alpha, compared exactly.
  Array<std::uint32_t> cells;
  /// facets x k ids: those between a cell of the shape and none, oriented outward and ordered as
  /// Triangulation::hull_facets. None for k < 1.
  Array<std::uint32_t> facets;
  /// The cell of the shape that each of them belongs to.
  Array<std::uint32_t> facet_cells;
};

/// Of a triangulation made by delaunay() of `points`. `alpha` >= 0, infinite for all cells. Time
/// O(cells k^3). Options used: threads, stop. Errors: invalid_argument for points that are not
/// those of the triangulation, one of the furthest site, and an alpha that is negative or NaN.
/// Source: docs/exactness.md, "Voronoi diagrams".
AlphaShape alpha_shape(const PointView& points, const Triangulation& triangulation, double alpha,
                       const RunOptions& options = {});

/// For each cell the least double that is at least the radius of its circumscribed sphere, infinite
/// beyond the range of doubles: the cell is in alpha_shape(alpha) if and only if this is at most
/// alpha. Errors as above.
Array<double> alpha_radii(const PointView& points, const Triangulation& triangulation,
                          const RunOptions& options = {});

/// What a shape is wanted to be: with a cell at every vertex, or besides all of one piece, cells
/// being joined through facets.
enum class AlphaGoal { all_points, one_region };

/// The least alpha whose shape has every vertex of the triangulation, and for one_region the least
/// of these whose shape is of one piece. 0 without cells, and for k = 0. Time O(cells (k^3 + log)).
/// Errors as above.
double critical_alpha(const PointView& points, const Triangulation& triangulation, AlphaGoal goal,
                      const RunOptions& options = {});

/// The concave hull by the length of edges (the chi-shape of Duckham and others, 2008) of points of
/// a plane: from the convex hull on, the longest edge of the boundary that is longer than `length`
/// is taken away with its triangle, as long as the boundary stays one ring that has no point twice.
/// So it is of one piece without holes and leaves no point out. Lengths are compared exactly; of
/// equal edges the one of the lowest ids is first. `length` >= 0, infinite for the convex hull.
/// Points on one line (k < 2) keep all cells. Time O(cells log). Options used: stop. Errors:
/// invalid_argument for k > 2, a length that is negative or NaN, points that are not those of the
/// triangulation, weights that hide points and the furthest site.
AlphaShape concave_hull(const PointView& points, const Triangulation& triangulation, double length,
                        const RunOptions& options = {});

/// The length that is `ratio` of the way from the shortest edge of the triangulation to the longest
/// (0 to 1; 1 gives infinity, the convex hull), rounded. Errors as above, and for another ratio.
double concave_length(const PointView& points, const Triangulation& triangulation, double ratio,
                      const RunOptions& options = {});

/// Regions of the plane bounded by rings of points.
struct CellPolygons {
  /// The ids of each ring, none twice, beginning at the lowest.
  Lists<std::uint32_t> rings;
  /// Polygon i has the rings [polygon_offsets[i], polygon_offsets[i + 1]): the outer one, counter-
  /// clockwise, then holes, clockwise, by their ids. Polygons are sorted by their outer ring's ids.
  Array<std::uint64_t> polygon_offsets;

  std::uint64_t ring_count() const noexcept { return rings.size(); }
  std::uint64_t polygon_count() const noexcept { return polygon_offsets.size() - 1; }

  CULLHULL_RENAMED(ids, "use rings.items, or rings[i]");
  CULLHULL_RENAMED(ring_offsets, "use rings.offsets, or rings[i]");
};

/// The union of some cells of a triangulation of the plane (k = 2), a polygon for all that hang
/// together through edges. Rings touch each other, and themselves, in single points at most, so
/// that polygons are valid as GeoJSON and WKT have it. `cells`: ascending. Errors: invalid_argument
/// for k > 2 and for points that are not those of the triangulation.
CellPolygons cell_polygons(const PointView& points, const Triangulation& triangulation,
                           std::span<const std::uint32_t> cells, const RunOptions& options = {});

}  // namespace cullhull::inline v1
#pragma GCC visibility pop
