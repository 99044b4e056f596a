// Fewer vertices than the exact hull has, and fewer planes, within a stated distance: for programs
// that assume tolerances, and for hulls that need not be sharp.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/hull.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

#pragma GCC visibility push(default)
namespace cullhull::inline v1 {

struct Simplification {
  /// The exact, canonical hull of the vertices that were kept: that of `convex_hull` over them
  /// alone, with the ids, point_count and scalar of the hull given. So a certificate for it is
  /// against the kept points: dropped vertices are outside.
  Hull hull;
  /// Vertices of the hull given that were dropped; those of `hull` are the others.
  std::uint64_t dropped = 0;
  /// Every point of the hull given is at most this far (Euclidean, in the points' units) from
  /// `hull`: an upper bound, rounding included, and at most the distance asked for. 0: none
  /// dropped.
  double distance = 0;
};

/// Drops vertices of `hull` that lie within `distance` of the hull of those kept. `points`: those
/// the hull was computed from. The result lies in the hull given and spans the same flat
/// (affine_dimension stays), however large the distance. When it ends, no further vertex can be
/// shown to be droppable; the number left is not minimal. Each kept vertex is farther than about
/// distance - result.distance from the hull of the others, except where dropping it would flatten
/// the hull; for k <= 3 every height of every simplex is at least that. Canonical: depends on the
/// hull's vertices and the distance alone, on no option. distance 0 gives the hull given. Errors:
/// invalid_argument for a distance that is negative or not finite, or points that are not the
/// hull's; else as convex_hull. Time: that of convex_hull over the vertices, times the number of
/// rounds, each of which drops a share of the droppable vertices; memory O(simplices). Thread safe.
/// Source: docs/algorithm.md, "Simplification"; the bound: docs/exactness.md.
Simplification simplify(const PointView& points, const Hull& hull, double distance,
                        const Options& options = {});

/// For each facet one whose plane (row of facet_planes) can stand for its own: all vertices of
/// facet i are within `distance` of the plane of facet out[i], rounding included, and the normals
/// of the two are less than a right angle apart. Facets that share a plane are connected, and
/// out[out[i]] is out[i]. Greedy, from the largest facet on: each takes the facets that it can.
/// distance 0 gives out[i] = i. Canonical; errors as simplify's; time O(f log f + lengths of the
/// lists), serial.
std::vector<std::uint32_t> shared_planes(const PointView& points, const Hull& hull,
                                         double distance);

/// A bound for how far points of another hull may leave it when both are turned and shifted in
/// doubles a few times: 64 d^(3/2) 2^-53 times the largest coordinate of the hull's vertices. A
/// distance for simplify and shared_planes where coordinates are rounded; of the order of Qhull's
/// own tolerance (a few times what it allows for rounding).
double rounding_distance(const PointView& points, const Hull& hull);

}  // namespace cullhull::inline v1
#pragma GCC visibility pop
