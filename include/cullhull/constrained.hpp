// Constrained Delaunay triangulations of the plane.
#pragma once

#include <cstdint>
#include <span>

#include "cullhull/array.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/point_view.hpp"
#include "cullhull/triangulation.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

/// Only the first step, the Delaunay triangulation, uses threads.
struct ConstrainedOptions {
  CULLHULL_RUN_OPTIONS
  /// Keep only the cells of odd depth, those inside. Points left without a cell become `hidden`.
  bool inside_only = false;
};

/// A triangulation that contains given edges and is locally Delaunay at all others.
struct ConstrainedTriangulation {
  /// In the format of delaunay(). `cell_groups` is empty, and `statistics` are those of the
  /// triangulation without constraints. With inside_only the hull is the boundary of the kept
  /// cells. Points on one line (k < 2): the result of delaunay(). Do not pass it to
  /// TriangulationQuery, voronoi() and other functions that need a Delaunay triangulation.
  Triangulation triangulation;
  /// pieces x 2 ids, the lower one first, sorted lexicographically: the constraints, each split at
  /// the points on it.
  Array<std::uint32_t> pieces;
  /// For each piece the lowest number of a constraint that contains it.
  Array<std::uint32_t> piece_sources;
  /// For each cell of the whole triangulation the least number of constraints that a path from it
  /// to the outside crosses. Cells of odd depth are inside (even-odd rule): polygons may have
  /// holes, islands in holes and so on. Rings need no orientation; edges that bound no region have
  /// no effect. Empty for k < 2.
  Array<std::uint32_t> depths;
};

/// The exact constrained Delaunay triangulation: every unconstrained edge is locally Delaunay. Of
/// four points on a circle, the diagonal contains the lowest id. The result is unique; it does not
/// depend on the order or direction of the edges.
///
/// `edges`: edges x 2 ids. A point exactly on an edge splits it. Equal points count as one: an edge
/// between them, or from a point to itself, has no effect. Overlapping edges count once. Edges that
/// cross in their interiors are an error that names both.
///
/// Errors: those of delaunay(); invalid_argument for a dimension other than 2, an odd number of
/// ids, an id out of range, and edges that cross. Time: that of delaunay(), plus for each edge the
/// number of edges it crosses (quadratic for adversarial sets). Thread safe.
/// Source: docs/exactness.md, "Constrained triangulations".
ConstrainedTriangulation constrained_delaunay(const PointView& points,
                                              std::span<const std::uint32_t> edges,
                                              const ConstrainedOptions& options = {});

/// Verifies a result with exact predicates, independently of the code that computes it: cells,
/// neighbours, hull, every point; that the pieces are exactly the constraints; and that every
/// unconstrained edge is locally Delaunay, with the documented choice among points on a circle. So
/// a valid certificate proves that `result` is the triangulation documented above.
/// `ridges_checked` counts edges between cells.
///
/// `options`: those that `result` was computed with. With inside_only the function computes the
/// whole triangulation as a witness, verifies it including its depths, and requires that `result`
/// consists of exactly the witness's cells of odd depth. Errors: cancelled, out_of_budget.
Certificate certify(const PointView& points, std::span<const std::uint32_t> edges,
                    const ConstrainedTriangulation& result, const ConstrainedOptions& options = {});

}  // namespace cullhull
#pragma GCC visibility pop
