// Alpha shapes (the cells of a triangulation whose circumspheres are small) and concave hulls by
// edge length. All functions are thread safe. k: Triangulation::affine_dimension.
#pragma once

#include <cstdint>
#include <span>

#include "cullhull/array.hpp"
#include "cullhull/lists.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"
#include "cullhull/triangulation.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

/// A regularised alpha shape or a concave hull: full-dimensional cells only, without edges and
/// faces that bound no cell.
struct AlphaShape {
  /// Cells of the triangulation, ascending. Alpha shape: those whose circumsphere (of a flat:
  /// within the flat) has a radius of at most alpha, compared exactly.
  Array<std::uint32_t> cells;
  /// facets x k ids: the boundary facets, which belong to exactly one cell of the shape, oriented
  /// outward and ordered as Triangulation::hull_facets. Empty for k < 1.
  Array<std::uint32_t> facets;
  /// For each facet, the cell of the shape that it belongs to.
  Array<std::uint32_t> facet_cells;
};

/// The alpha shape of `points`, from their triangulation by delaunay(). `alpha` >= 0; infinity
/// keeps all cells. Time O(cells k^3). Options used: threads, memory_budget, stop. Errors:
/// out_of_budget; invalid_argument if the points are not those of the triangulation, if it is a
/// furthest-site triangulation, and if alpha is negative or NaN. Source: docs/exactness.md,
/// "Voronoi diagrams".
AlphaShape alpha_shape(const PointView& points, const Triangulation& triangulation, double alpha,
                       const RunOptions& options = {});

/// For each cell the circumradius, rounded up to a double (infinity beyond the range of doubles):
/// the cell is in alpha_shape(alpha) if and only if this number is at most alpha. Errors as above.
Array<double> alpha_radii(const PointView& points, const Triangulation& triangulation,
                          const RunOptions& options = {});

/// The least alpha for whose shape every vertex has a cell and, with `one_region`, the cells are
/// connected through facets. 0 if the triangulation has no cells, and for k = 0. Time O(cells (k^3
/// + log cells)). Errors as above.
double critical_alpha(const PointView& points, const Triangulation& triangulation, bool one_region,
                      const RunOptions& options = {});

/// The concave hull by edge length (chi-shape: Duckham and others, 2008) of 2D points. Starts from
/// the convex hull and repeatedly removes the longest boundary edge that is longer than `length`,
/// together with its triangle, if the boundary stays one ring without repeated points. So the
/// result is connected, has no holes and contains every point. Lengths are compared exactly; of
/// equal edges the one with the lowest ids is removed first. `length` >= 0; infinity gives the
/// convex hull. Collinear points (k < 2) keep all cells. Time O(cells log cells). Options used:
/// memory_budget, stop. Errors: out_of_budget; invalid_argument for k > 2, a length that is
/// negative or NaN, points that are not those of the triangulation, hidden points, and
/// furthest-site triangulations.
AlphaShape concave_hull(const PointView& points, const Triangulation& triangulation, double length,
                        const RunOptions& options = {});

/// The length at `ratio` between the shortest edge of the triangulation (0) and the longest (1),
/// rounded; a ratio of 1 gives infinity, the convex hull. Errors as above, and for a ratio outside
/// [0, 1].
double concave_length(const PointView& points, const Triangulation& triangulation, double ratio,
                      const RunOptions& options = {});

/// The triangulation without the cells that have an edge longer than `length`, compared exactly: a
/// TIN without the long triangles at its border. Its hull facets are the boundary of the cells that
/// remain, points without a cell are `hidden`, `cell_groups` is empty: do not pass it to
/// TriangulationQuery, voronoi() and other functions that need a Delaunay triangulation. `length`
/// >= 0. Options used: stop. Errors: invalid_argument for a length that is negative or NaN, and for
/// points that are not those of the triangulation.
Triangulation without_long_edges(const PointView& points, Triangulation triangulation,
                                 double length, const RunOptions& options = {});

/// Measures of a shape.
struct ShapeMeasures {
  double volume = 0;    ///< of its cells: k-dimensional, in the plane the area
  double boundary = 0;  ///< of its facets: (k-1)-dimensional, in the plane the perimeter
};

/// The measures of a shape of these points, in their units; each within a few roundings of the sum
/// of its cells' and facets'. For k = 1 the boundary is the number of ends, for k < 1 both are 0.
/// Errors: invalid_argument if the points are not those of the triangulation.
ShapeMeasures shape_measures(const PointView& points, const Triangulation& triangulation,
                             const AlphaShape& shape);

/// Regions of the plane, bounded by rings of points.
struct CellPolygons {
  /// The ids of each ring, without repeats, from the lowest id on.
  Lists<std::uint32_t> rings;
  /// Polygon i is the rings [polygon_offsets[i], polygon_offsets[i + 1]): the outer one, counter-
  /// clockwise, then its holes, clockwise, sorted by their ids. Polygons are sorted by their outer
  /// ring's ids.
  Array<std::uint64_t> polygon_offsets;

  std::uint64_t ring_count() const noexcept { return rings.size(); }
  std::uint64_t polygon_count() const noexcept { return polygon_offsets.size() - 1; }
};

/// The union of some cells of a 2D triangulation (k = 2): one polygon for each set of cells that
/// are connected through edges. Rings touch each other, and themselves, in single points at most,
/// so the polygons are valid in GeoJSON and WKT. `cells`: ascending. Errors: invalid_argument if
/// the dimension k is above 2 or the points are not those of the triangulation.
CellPolygons cell_polygons(const PointView& points, const Triangulation& triangulation,
                           std::span<const std::uint32_t> cells, const RunOptions& options = {});

}  // namespace cullhull
#pragma GCC visibility pop
