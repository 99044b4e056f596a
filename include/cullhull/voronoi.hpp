// Voronoi and power diagrams: the dual of a triangulation, and its cells within a box, a convex
// polytope or polygons.
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

/// Stands for the end of what is unbounded, in lists of vertices.
inline constexpr std::uint32_t at_infinity = 0xffffffff;
/// What lies across a face of a region's boundary, in lists of points.
inline constexpr std::uint32_t no_point = 0xffffffff;

/// d: `dimension`; k: `affine_dimension`. The diagram of points in a flat (k < d) is the one within
/// the flat, extended orthogonally to it; its vertices are in the flat.
struct Voronoi {
  std::uint32_t dimension = 0;
  std::uint64_t point_count = 0;
  ScalarType scalar = ScalarType::f64;  ///< of the points
  int affine_dimension = -1;
  bool furthest_site = false;

  /// vertices x d: vertex i is the circumcentre (with weights the power centre) of the cells of
  /// group i of the triangulation, each coordinate the nearest double, infinite beyond their range.
  /// None for k = 0.
  Array<double> vertices;

  /// ridges x 2 points, ascending; sorted lexicographically. Between these two regions, and no
  /// others, lies a face of dimension k - 1 (d - 1 in space).
  Array<std::uint32_t> ridge_points;
  /// The vertices of each ridge. k = 1: one; k = 2: the one on the left of the way from the lower
  /// point to the other, then the one on the right; k = 3: around that way by the right hand,
  /// beginning at infinity or else at the lowest; k > 3: ascending. at_infinity is among them where
  /// the ridge is unbounded.
  Lists<std::uint32_t> ridges;

  /// The vertices of the region of each point; none for duplicates and hidden points. k = 2:
  /// counterclockwise, beginning at infinity or else at the lowest; else ascending. at_infinity is
  /// among them where the region is unbounded.
  Lists<std::uint32_t> regions;

  /// The unbounded edges, one for each facet of the triangulation's hull, in its order: the vertex
  /// where it begins, and d numbers for its direction, the facet's outward normal (inward for the
  /// furthest site). The largest component is in [0.5, 1] in magnitude, each within 2^-50 of exact,
  /// relatively, zeros exact. Facets in one plane that belong to one group have equal rays.
  Array<std::uint32_t> ray_vertices;
  Array<double> ray_directions;

  std::uint64_t vertex_count() const noexcept {
    return dimension == 0 ? 0 : vertices.size() / dimension;
  }
  std::uint64_t ridge_count() const noexcept { return ridge_points.size() / 2; }
  std::span<const std::uint32_t> ridge(std::uint64_t i) const { return ridges[i]; }
  std::span<const std::uint32_t> region(std::uint64_t point) const { return regions[point]; }

  CULLHULL_RENAMED(ridge_offsets, "use ridges.offsets, or ridges[i]");
  CULLHULL_RENAMED(ridge_vertices, "use ridges.items, or ridges[i]");
  CULLHULL_RENAMED(region_offsets, "use regions.offsets, or regions[i]");
  CULLHULL_RENAMED(region_vertices, "use regions.items, or regions[i]");
};

/// The diagram dual to a triangulation of `points` with `weights` (none, or one a point).
/// Combinatorics are exact. Time O(cells k^3 log), memory O(cells k^2). Options used: threads,
/// memory_budget, stop, progress. Errors: invalid_argument if points or weights are not those of
/// the triangulation, out_of_budget, cancelled. Thread safe.
/// Source: docs/exactness.md, "Voronoi diagrams".
Voronoi voronoi(const PointView& points, const Triangulation& triangulation,
                std::span<const double> weights = {}, const RunOptions& options = {});

/// A polygon of the plane, or several, with holes: rings of corners. Inside is what an odd number
/// of rings surrounds, so that rings need no orientation and no order. Rings may touch, and
/// polygons may share parts of their boundaries from corner to corner (inside is then what they
/// cover together); edges may not cross. The last corner of a ring may repeat the first.
struct PolygonRings {
  PointView points;  ///< corners x 2
  /// rings + 1, from 0 to the number of corners: ring i is corners [ring_offsets[i],
  /// ring_offsets[i + 1]).
  std::span<const std::uint64_t> ring_offsets;
};

/// The cells of a diagram within a bounded region, for d = 1, 2 and 3.
struct ClippedCells {
  std::uint32_t dimension = 0;
  std::uint64_t point_count = 0;
  /// Length, area or volume of each point's cell in the region, within 2^-42 of the exact number,
  /// relatively; zero for duplicates, hidden points and cells that do not meet it. The exact
  /// numbers add up to the region's.
  Array<double> measures;

  // Shapes; empty if they were not asked for.
  /// The vertices of the cell of point i are rows [vertex_offsets[i], vertex_offsets[i + 1]) of d
  /// numbers, each the double nearest to the exact coordinate: so cells that meet in a vertex have
  /// the same numbers for it, vertices of the diagram have those of Voronoi::vertices, and none is
  /// outside a box. d = 1: both ends; d = 2: ring by ring.
  Array<std::uint64_t> vertex_offsets;
  Array<double> vertices;
  /// d = 2: cell i is the polygons [polygon_offsets[i], polygon_offsets[i + 1]): one where the
  /// region is convex, else perhaps several. Polygon g has the rings [polygon_rings[g],
  /// polygon_rings[g + 1]): its outline, counterclockwise, then its holes, clockwise. Ring r is the
  /// rows [ring_starts[r], ring_starts[r + 1]) of `vertices`, from its lexicographically least one
  /// on. Vertices that round to one are one; rings of which less than three are left are left out.
  Array<std::uint64_t> polygon_offsets;
  Array<std::uint64_t> polygon_rings;
  Array<std::uint64_t> ring_starts;
  /// d = 3: the faces of cell i are [face_offsets[i], face_offsets[i + 1]), face f has the items
  /// [face_starts[f], face_starts[f + 1]) of face_vertices: places among the cell's own vertices,
  /// counterclockwise from outside.
  Array<std::uint64_t> face_offsets;
  Array<std::uint64_t> face_starts;
  Array<std::uint32_t> face_vertices;
  /// The point across each face (d = 2: across the edge that begins at each vertex; d = 1: across
  /// each end), or no_point at the region's boundary.
  Array<std::uint32_t> neighbours;
};

/// In the box low[j] <= x[j] <= high[j]. Exact: every decision is one about the given doubles, and
/// what is listed is rounded once, as ClippedCells says. Results are the same bits for any threads.
/// `diagram`: voronoi() of the same points, triangulation and weights, where it is known: its
/// vertices and ridges are then not computed again, a third of the time in the plane.
/// Time: some microseconds a point in the plane, some ten in space; more where cells meet the
/// region's boundary. Errors: as above; invalid_argument also for d > 3, for a box that is empty or
/// not finite, and for a diagram of another size. Thread safe.
/// Source: docs/exactness.md, "Voronoi diagrams".
ClippedCells clip_voronoi(const PointView& points, const Triangulation& triangulation,
                          std::span<const double> low, std::span<const double> high,
                          std::span<const double> weights = {}, bool shapes = true,
                          const RunOptions& options = {}, const Voronoi* diagram = nullptr);

/// For d = 1 and 3 in the convex hull of the points `region`, which must span d dimensions; for d =
/// 2 in the polygon with these corners, in their order.
ClippedCells clip_voronoi(const PointView& points, const Triangulation& triangulation,
                          const PointView& region, std::span<const double> weights = {},
                          bool shapes = true, const RunOptions& options = {},
                          const Voronoi* diagram = nullptr);

/// In polygons; d = 2. Cells may have several parts, with dents and holes. Time: some microseconds
/// for each pair of a cell and a triangle of the region's constrained Delaunay triangulation that
/// meet. Errors: also not_finite, and invalid_argument for rings of less than three corners,
/// offsets that do not ascend, edges that cross, and a region that is a line.
ClippedCells clip_voronoi(const PointView& points, const Triangulation& triangulation,
                          const PolygonRings& region, std::span<const double> weights = {},
                          bool shapes = true, const RunOptions& options = {},
                          const Voronoi* diagram = nullptr);

}  // namespace cullhull::inline v1
#pragma GCC visibility pop
