// The intersection of halfspaces, computed as the hull of their dual points.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/hull.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

/// A polyhedron given by halfspaces a . x + b <= 0; row i is (a_1, ..., a_d, b).
struct HalfspaceIntersection {
  std::uint32_t dimension = 0;
  /// The centre of duality, strictly inside every halfspace.
  std::vector<double> interior_point;
  /// -a / (a . interior_point + b) for every halfspace.
  std::vector<double> dual_points;
  /// The exact hull of `dual_points`. Its vertices are the halfspaces that bound the polyhedron
  /// (if it is bounded: all others are redundant), its facets are the polyhedron's vertices.
  Hull dual;
  /// False if the polyhedron is unbounded; the interior point is then not inside `dual`.
  bool bounded = false;
  /// Row f is the vertex dual to facet f of `dual`; NaN if that vertex does not exist (only if the
  /// polyhedron is unbounded).
  std::vector<double> vertices;
};

/// `halfspaces`: a view of d + 1 columns (so of dimension d + 1), d >= 1. `interior_point`: d
/// doubles strictly inside, or null: a linear program then finds the centre of a largest inscribed
/// ball (or some interior point, if balls of every radius fit).
///
/// The dual points are rounded to doubles, by a few units in the last place; the combinatorics are
/// exact for these rounded halfspaces. Errors: not_finite; invalid_argument if the given point is
/// not strictly inside all halfspaces, if none was found (the intersection is empty, or too thin
/// for doubles), or if a row has a = 0. Time: that of convex_hull of as many points, and about O(d)
/// passes over the rows for the linear program. Source: Preparata and Shamos, Computational
/// Geometry, 1985, section 7.3 (duality); the centre by the dual simplex method.
HalfspaceIntersection intersect_halfspaces(const PointView& halfspaces,
                                           const double* interior_point = nullptr,
                                           const Options& options = {});
inline HalfspaceIntersection intersect_halfspaces(const PointView& halfspaces,
                                                  const OnePoint& interior_point,
                                                  const Options& options = {}) {
  const std::uint32_t d = halfspaces.dimension > 0 ? halfspaces.dimension - 1 : 0;
  return intersect_halfspaces(halfspaces, interior_point.of(d), options);
}

}  // namespace cullhull
#pragma GCC visibility pop
