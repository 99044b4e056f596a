// Alpha shapes: the part of a triangulation whose cells have small circumscribed spheres.
#pragma once

#include <cstdint>

#include "cullhull/array.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"
#include "cullhull/triangulation.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

/// The regularised alpha shape: cells alone, without edges and faces that bound none.
struct AlphaShape {
  /// Cells of the triangulation, ascending: those whose circumscribed sphere (of a flat: within the
  /// flat) has a radius of at most alpha, compared exactly.
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
                       const Options& options = {});

}  // namespace cullhull
#pragma GCC visibility pop
