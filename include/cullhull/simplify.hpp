// Simplified hulls: fewer vertices, or fewer planes, within a stated distance of the exact hull.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/hull.hpp"
#include "cullhull/options.hpp"
#include "cullhull/point_view.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

struct Simplification {
  /// The exact, canonical hull of the kept vertices: convex_hull of them alone, with the ids,
  /// point_count and scalar of the given hull. It can be certified only against the kept points,
  /// because dropped vertices are outside.
  Hull hull;
  /// Number of dropped vertices; all other vertices of the given hull are vertices of `hull`.
  std::uint64_t dropped = 0;
  /// An upper bound, rounding included, on the distance (Euclidean, in the points' units) of points
  /// of the given hull to `hull`; at most the requested distance. 0 if no vertex was dropped.
  double distance = 0;
};

/// Drops vertices of `hull` that are within `distance` of the hull of the kept ones. `points`:
/// those the hull was computed from. The result is inside the given hull and spans the same flat
/// (same affine_dimension), for any distance. When it ends, no further vertex can be proved
/// droppable; the number of kept vertices is not minimal. Each kept vertex is farther than about
/// distance - result.distance from the hull of the others, unless dropping it would flatten the
/// hull; for k <= 3 every height of every simplex is at least that. Canonical: depends only on the
/// hull's vertices and the distance, on no option. Distance 0 returns the given hull. Errors:
/// invalid_argument for a distance that is negative or not finite, or points that are not the
/// hull's; else as convex_hull. Time: that of convex_hull over the vertices, times the number of
/// rounds, each of which drops a fraction of the droppable vertices; memory O(simplices). Thread
/// safe. Source: docs/algorithm.md, "Simplification"; the bound: docs/exactness.md.
Simplification simplify(const PointView& points, const Hull& hull, double distance,
                        const Options& options = {});

/// For each facet i a facet out[i] whose plane (row of facet_planes) can replace that of i: all
/// vertices of facet i are within `distance` of it, rounding included, and the two normals are less
/// than a right angle apart. Facets that share a plane are connected, and out[out[i]] is out[i].
/// Greedy: from the largest facet on, each takes the facets that it can. Distance 0 gives out[i] =
/// i. Canonical; errors as simplify's; time O(f log f + lengths of the lists) for f facets, serial.
std::vector<std::uint32_t> shared_planes(const PointView& points, const Hull& hull,
                                         double distance);

/// A bound on how far points of another hull may leave it when both are rotated and translated in
/// doubles a few times: 64 d^(3/2) 2^-53 times the largest coordinate of the hull's vertices. Use
/// it as distance for simplify and shared_planes if coordinates are rounded; it is a few times
/// Qhull's own tolerance for rounding.
double rounding_distance(const PointView& points, const Hull& hull);

}  // namespace cullhull
#pragma GCC visibility pop
