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

struct ConstrainedOptions {
  /// Keep the cells inside alone: those of odd depth. Points that no cell is left at are `hidden`.
  bool inside_only = false;
  /// As in TriangulationOptions; threads are used by the first step alone.
  unsigned threads = 0;
  std::uint64_t memory_budget = 0;
  Progress progress;
  std::stop_token stop;
  Poll poll;
};

/// The Delaunay triangulation in which given edges are edges.
struct ConstrainedTriangulation {
  /// As delaunay() gives it, but for cell_groups, which is empty, and statistics, which are those
  /// of the triangulation without constraints. With inside_only the hull is the boundary of what is
  /// left. Points on one line (k < 2): as delaunay() gives it. TriangulationQuery, voronoi() and
  /// others want a Delaunay triangulation, which this is not.
  Triangulation triangulation;
  /// pieces x 2 ids, the lower one first, sorted lexicographically: what the constraints consist of
  /// where they are cut at points that lie on them.
  Array<std::uint32_t> pieces;
  /// The lowest constraint that each piece belongs to.
  Array<std::uint32_t> piece_sources;
  /// How many constraints one must cross, at least, from a cell of the whole triangulation to the
  /// outside. Odd: inside, as polygons with holes, islands in these and so on have it. Rings need
  /// no orientation, and edges that bound nothing count for nothing. None for k < 2.
  Array<std::uint32_t> depths;
};

/// The exact constrained Delaunay triangulation: every other edge is locally Delaunay, exactly; of
/// four points on a circle the lowest id is on the edge between them. So there is one result, which
/// does not depend on the order or direction of the edges.
///
/// `edges`: edges x 2 ids. A point exactly on an edge cuts it. Equal points are one: an edge
/// between them is no constraint, and neither is one from a point to itself. Edges that cross in
/// their interiors are refused with a line that names both; overlapping ones are one.
///
/// Errors: those of delaunay(); invalid_argument for another dimension than 2, an odd number of
/// ids, an id that is none, and edges that cross. Time that of delaunay(), and for each edge in the
/// number of edges it crosses: linear, but for sets made against it. Thread safe.
/// Source: docs/exactness.md, "Constrained triangulations".
ConstrainedTriangulation constrained_delaunay(const PointView& points,
                                              std::span<const std::uint32_t> edges,
                                              const ConstrainedOptions& options = {});

/// Checks one with exact predicates and none of the code that made it: cells, neighbours, the hull,
/// every point, the constraints as chains of pieces and no other pieces, and that every edge that
/// is none is locally Delaunay with the documented choice among points on a circle. So a valid
/// certificate proves it is the triangulation documented above. `ridges_checked` counts edges
/// between cells.
///
/// `options`: those it was made with. With inside_only a whole one is made as a witness, which is
/// checked as above, its depths among the rest, and need not be trusted; `result` must be its cells
/// of odd depth, all of them and no others, and what belongs to them. Errors: cancelled,
/// out_of_budget.
Certificate certify(const PointView& points, std::span<const std::uint32_t> edges,
                    const ConstrainedTriangulation& result, const ConstrainedOptions& options = {});

}  // namespace cullhull
#pragma GCC visibility pop
