// Voronoi and power diagrams: the dual of a triangulation, and its cells clipped to a box, a convex
// polytope or polygons.
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

/// In lists of vertices: the end at infinity of an unbounded edge or face.
inline constexpr std::uint32_t at_infinity = 0xffffffff;

/// d: `dimension`; k: `affine_dimension`. The diagram of points in a flat (k < d) is the diagram
/// within the flat, extended orthogonally to it; its vertices are in the flat.
struct Voronoi {
  std::uint32_t dimension = 0;
  std::uint64_t point_count = 0;
  ScalarType scalar = ScalarType::f64;  ///< of the points
  int affine_dimension = -1;
  bool furthest_site = false;

  /// vertices x d: vertex i is the circumcentre (with weights the power centre) of the cells of
  /// group i of the triangulation; each coordinate is rounded to the nearest double, infinite
  /// beyond their range. Empty for k = 0.
  Array<double> vertices;

  /// ridges x 2 points, ascending; sorted lexicographically. A ridge is a face of dimension k - 1
  /// (within the flat) between exactly these two regions.
  Array<std::uint32_t> ridge_points;
  /// The vertices of each ridge. k = 1: one; k = 2: seen from the lower point towards the other,
  /// the left one, then the right one; k = 3: counter-clockwise about that direction (right-hand
  /// rule), from infinity or else the lowest on; k > 3: ascending. Unbounded ridges contain
  /// at_infinity.
  Lists<std::uint32_t> ridges;

  /// The vertices of the region of each point, likewise; empty for duplicates and hidden points. k
  /// = 2: counter-clockwise, from infinity or else the lowest on; else ascending. Unbounded regions
  /// contain at_infinity.
  Lists<std::uint32_t> regions;

  /// The unbounded edges, one for each facet of the triangulation's hull, in its order: the vertex
  /// where the edge begins, and d numbers for its direction, the facet's outward normal (inward for
  /// furthest-site diagrams). The largest component has a magnitude in [0.5, 1]; each has a
  /// relative error of at most 2^-50, and zeros are exact. Coplanar facets of one group have equal
  /// rays.
  Array<std::uint32_t> ray_vertices;
  Array<double> ray_directions;

  std::uint64_t vertex_count() const noexcept {
    return dimension == 0 ? 0 : vertices.size() / dimension;
  }
  std::uint64_t ridge_count() const noexcept { return ridge_points.size() / 2; }
  std::span<const std::uint32_t> ridge(std::uint64_t i) const {
    return ridges[static_cast<std::size_t>(i)];
  }
  std::span<const std::uint32_t> region(std::uint64_t point) const {
    return regions[static_cast<std::size_t>(point)];
  }
};

/// The diagram dual to a triangulation of `points` with `weights` (empty, or one per point). Its
/// combinatorics are exact. Time O(cells k^3 log cells), memory O(cells k^2). Options used:
/// threads, memory_budget, stop, progress. Errors: invalid_argument if points or weights are not
/// those of the triangulation, out_of_budget, cancelled. Thread safe.
/// Source: docs/exactness.md, "Voronoi diagrams".
Voronoi voronoi(const PointView& points, const Triangulation& triangulation,
                std::span<const double> weights = {}, const RunOptions& options = {});

/// The cells of a diagram clipped to a bounded region, for d = 1, 2 and 3.
struct ClippedCells {
  std::uint32_t dimension = 0;
  std::uint64_t point_count = 0;
  /// Length, area or volume of each point's cell in the region, with a relative error of at most
  /// 2^-42; zero for duplicates, hidden points and cells outside the region. The exact measures add
  /// up to that of the region.
  Array<double> measures;

  // Shapes; empty if not requested.
  /// The vertices of the cell of point i are rows [vertex_offsets[i], vertex_offsets[i + 1]) of d
  /// numbers, each the double nearest to the exact coordinate. So cells that share a vertex have
  /// the same numbers for it, vertices of the diagram have those of Voronoi::vertices, and no
  /// vertex is outside a box. d = 1: both ends; d = 2: ring by ring.
  Array<std::uint64_t> vertex_offsets;
  Array<double> vertices;
  /// d = 2: cell i is the polygons [polygon_offsets[i], polygon_offsets[i + 1]): at most one if the
  /// region is convex. Polygon g is the rings [polygon_rings[g], polygon_rings[g + 1]): its
  /// outline, counter-clockwise, then its holes, clockwise. Ring r is the rows [ring_starts[r],
  /// ring_starts[r + 1]) of `vertices`, starting with the lexicographically least. Vertices that
  /// round to the same numbers are merged; where rounding would make a ring cross or touch itself,
  /// it and its neighbours go through the same vertices; what is left without area is omitted. So
  /// every ring is simple, rings of a polygon meet in single points only, and an edge inside the
  /// region is an edge of two cells.
  Array<std::uint64_t> polygon_offsets;
  Array<std::uint64_t> polygon_rings;
  Array<std::uint64_t> ring_starts;
  /// d = 3: cell i is the faces [face_offsets[i], face_offsets[i + 1]); a face is a list of indices
  /// into the cell's own vertices, counter-clockwise from outside.
  Array<std::uint64_t> face_offsets;
  Lists<std::uint32_t> faces;
  /// The point across each face (d = 2: across the edge that begins at each vertex; d = 1: across
  /// each end), or no_index on the region's boundary.
  Array<std::uint32_t> neighbours;
};

struct ClipOptions {
  CULLHULL_RUN_OPTIONS
  /// Compute the cells' shapes; false: their measures only.
  bool shapes = true;
  /// voronoi() of the same points, triangulation and weights, if available: its vertices and ridges
  /// are then not computed again, which saves a third of the time in 2D.
  const Voronoi* diagram = nullptr;
};

/// Clips the diagram to the box low[j] <= x[j] <= high[j]. Exact: every decision holds for the
/// given doubles, and the listed numbers are rounded once, as ClippedCells states. The result does
/// not depend on threads. Time: a few microseconds per point in 2D, some ten in 3D; more for cells
/// at the region's boundary. Errors: as above; invalid_argument also for d > 3, for a box that is
/// empty or not finite, and for a diagram of another size. Thread safe. Source: docs/exactness.md,
/// "Voronoi diagrams".
ClippedCells clip_voronoi(const PointView& points, const Triangulation& triangulation,
                          std::span<const double> low, std::span<const double> high,
                          std::span<const double> weights = {}, const ClipOptions& options = {});

/// Clips to the convex hull of the points `region`, which must span d dimensions (d = 1 and 3), or
/// to the polygon with these corners, in this order (d = 2).
ClippedCells clip_voronoi(const PointView& points, const Triangulation& triangulation,
                          const PointView& region, std::span<const double> weights = {},
                          const ClipOptions& options = {});

/// Clips to one or several polygons, with holes; d = 2. They are rings of corners: ring i is
/// corners [ring_offsets[i], ring_offsets[i + 1]), and the offsets go from 0 to the number of
/// corners. A point is inside if an odd number of rings surrounds it (even-odd rule), so rings need
/// no orientation and no order. Rings may touch, and polygons may share parts of their boundaries
/// from corner to corner (inside is then their union); edges may not cross. The last corner of a
/// ring may repeat the first. Cells may be non-convex and have several parts and holes. Time: a few
/// microseconds for each intersecting pair of a cell and a triangle of the region's constrained
/// Delaunay triangulation. Errors: also not_finite, and invalid_argument for rings of fewer than
/// three corners, offsets that do not ascend, edges that cross, and a region without area.
ClippedCells clip_voronoi(const PointView& points, const Triangulation& triangulation,
                          const PointView& corners, std::span<const std::uint64_t> ring_offsets,
                          std::span<const double> weights = {}, const ClipOptions& options = {});

}  // namespace cullhull
#pragma GCC visibility pop
