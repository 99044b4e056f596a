// The steps from an engine's simplicial boundary to the canonical result: sort the ids of each
// simplex, check the ridges, merge coplanar simplices to facets, triangulate these by pulling, and
// sort.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "cullhull/hull_fwd.hpp"
#include "cullhull/lists.hpp"
#include "hull/engine.hpp"
#include "result/build_hull.hpp"

namespace cullhull::internal {

/// Simplices in a chunk of a parallel loop: 20 to 100 microseconds of work in 4D.
inline constexpr std::uint64_t simplex_chunk = std::uint64_t{1} << 12;

/// Replaces each vertex by the lowest id among the points equal to it, sorts the ids of each
/// simplex with its neighbours, and stores the parity of that permutation in `odd`. Throws
/// Error{not_exact} if sizes or ids are impossible.
void sort_simplices(Boundary& boundary, const LocalPoints& points, const Run& run);

/// Pairs of neighbouring simplices, by index.
using CoplanarPairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// The pairs of neighbouring simplices that lie in one hyperplane, in an order that does not depend
/// on threads. Throws Error{not_exact} unless every ridge is weakly convex and shared by two
/// coherently oriented simplices, and no simplex is degenerate. Adds the number of signs decided by
/// each rung of the ladder to `rung_counts`.
CoplanarPairs coplanar_pairs(const Boundary& surface, const LocalPoints& points, const Run& run,
                             std::uint64_t* rung_counts);

/// Throws Error{not_exact}; `what` ends the message.
[[noreturn]] void fail_not_exact(const char* what);

/// Simplex g is the neighbour of f across slot i. Returns the slot of g's vertex that is off their
/// common ridge. Throws Error{not_exact} if g does not contain the ridge or is oriented
/// differently. K: surface.dimension, or 0 if that is unknown at compile time.
template <unsigned K>
inline unsigned opposite_slot(const Boundary& surface, std::uint32_t f, unsigned i,
                              std::uint32_t g) {
  const unsigned k = K ? K : surface.dimension;
  const std::uint32_t* a = surface.simplex(f);
  const std::uint32_t* b = surface.simplex(g);
  const std::uint32_t* across = surface.neighbours.data() + std::size_t{g} * k;
  unsigned first = 0;
  for (unsigned j = k; j-- > 0;) first = across[j] == f ? j : first;
  for (unsigned j = first; j < k; ++j) {
    if (across[j] != f) continue;
    bool same = true;
    for (unsigned c = 0; c + 1 < k; ++c) same &= a[c + (c >= i)] == b[c + (c >= j)];
    if (!same) continue;
    if (((i + j + surface.odd[f] + surface.odd[g]) & 1U) == 0)
      fail_not_exact("neighbouring facets are oriented differently");
    return j;
  }
  fail_not_exact("neighbouring facets do not share their ridge");
}

// Merging of coplanar simplices to facets, and the canonical triangulation of these.

/// The facets before they are sorted. Facet i < singles consists of simplex i alone. The
/// other facets were merged from several simplices: entry m of `vertices` and `neighbours`
/// describes facet singles + m.
struct Facets {
  Boundary surface;
  std::vector<std::uint32_t> facet;  ///< facet of each simplex; empty: facet i is simplex i
  std::size_t singles = 0;
  /// The vertices of each merged facet. k = 2: the two ends, counter-clockwise. k = 3: the cycle of
  /// corners, counter-clockwise seen from outside, lowest id first. Otherwise ascending.
  Lists<std::uint32_t> vertices;
  /// The facets next to each merged facet. k = 2: the facet at vertex 1, then the one at vertex 0.
  /// k = 3: entry j lies across the edge that starts at vertex j. Otherwise each neighbour once.
  Lists<std::uint32_t> neighbours;
};

/// Merges the simplices that `pairs` connect, removes vertices that are not extreme, and
/// triangulates the merged facets by pulling. Throws Error{not_exact} if the simplices do not form
/// a polytope.
Facets merge_coplanar(Boundary&& surface, const CoplanarPairs& pairs, const LocalPoints& points,
                      const Run& run);

/// As merge_coplanar, for k = 3 and at least one pair; parallel.
Facets merge_polygons(Boundary&& surface, const CoplanarPairs& pairs, const Run& run);

// Sorting into canonical order.

/// Input of the measures in addition to the hull: the ascending ids of its vertices, and for every
/// simplex the positions of its vertices in that list.
struct OrderedFacets {
  std::vector<std::uint64_t> vertices;
  std::vector<std::uint32_t> index;
};

/// Sorts the simplices, numbers the facets, and fills every list of the hull. hull.vertices is
/// ascending afterwards, which is not its final order for k = 2.
OrderedFacets order_facets(const ResultInput& input, Facets&& facets, const Run& run, Hull& hull);

// Triangulation of a polytope by pulling its vertices.

using VertexSet = std::vector<std::uint32_t>;  // ascending

/// Triangulates the polytope of dimension m >= 1 with these vertices and facets by pulling its
/// vertices in ascending order: the simplices are the cones from the lowest vertex over the
/// simplices of the facets that do not contain it, and the facets are triangulated likewise. The
/// triangulation depends only on the face lattice and the ids. Appends m + 1 ascending ids a
/// simplex to `out`.
/// Source: C. Lee, "Subdivisions and triangulations of polytopes", Handbook of Discrete and
/// Computational Geometry, section 16.2 (2017).
void pull(const VertexSet& vertices, unsigned m, const std::vector<VertexSet>& facets,
          std::vector<std::uint32_t>& out);

}  // namespace cullhull::internal
