// An engine's boundary on its way to the canonical result: simplices with ascending ids and checked
// ridges, merged to facets where coplanar, triangulated by pulling, and put in order.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "cullhull/hull.hpp"
#include "hull/engine.hpp"
#include "parallel/threads/run.hpp"
#include "result/build_hull.hpp"

namespace cullhull::internal::inline result {

inline constexpr std::uint64_t simplex_chunk = std::uint64_t{1} << 14;

/// Replaces equal points by the lowest id, and sorts the ids of each simplex.
void sort_simplices(Boundary& boundary, const LocalPoints& points, const Run& run);

using CoplanarPairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// The pairs of simplices that lie in one hyperplane, in a fixed order. Throws Error{not_exact}
/// unless every ridge is shared by two coherently oriented simplices, is weakly convex, and no
/// simplex is degenerate. Adds to `rung_counts`.
CoplanarPairs coplanar_pairs(const Boundary& surface, const LocalPoints& points, const Run& run,
                             std::uint64_t* rung_counts);

[[noreturn]] void fail_not_exact(const char* what);

/// The slot of g opposite to the ridge it shares with f across slot i; checks ids and orientations.
/// K: surface.dimension, or 0 if it is not known at compile time.
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

// Merges coplanar simplices to facets, and triangulates these canonically.

/// The facets before they are put in order. Facet i < singles is simplex i; facet singles + m is
/// merged list m.
struct Facets {
  Boundary surface;
  std::vector<std::uint32_t> facet;  ///< facet of each simplex; empty: simplex i is facet i
  std::size_t singles = 0;
  /// k = 2: the two ends, counter-clockwise. k = 3: cyclic, counter-clockwise from outside, from
  /// the lowest id. Otherwise ascending.
  Lists<std::uint32_t> vertices;
  /// k = 2: across vertex 1, across vertex 0. k = 3: across the edge that starts at that vertex.
  /// Otherwise every facet across a ridge, once.
  Lists<std::uint32_t> neighbours;
};

Facets merge_coplanar(Boundary&& surface, const CoplanarPairs& pairs, const LocalPoints& points,
                      const Run& run);

// Merging of coplanar simplices in 3D.

/// As merge_coplanar, for k = 3 and at least one pair.
Facets merge_polygons(Boundary&& surface, const CoplanarPairs& pairs, const Run& run);

// Facets in canonical order.

/// Input of the measures besides the hull: its vertices' ids, ascending, and for every simplex the
/// positions of its vertices among them.
struct OrderedFacets {
  std::vector<std::uint64_t> vertices;
  std::vector<std::uint32_t> index;
};

/// Sorts the simplices, numbers the facets, and fills every list of the hull. Its vertices ascend,
/// which is not their final order for k = 2.
OrderedFacets order_facets(const ResultInput& input, Facets&& facets, const Run& run, Hull& hull);

/// Triangulation of a polytope by pulling, from vertex sets alone.
using VertexSet = std::vector<std::uint32_t>;  // ascending

/// Appends to `out` (m + 1 ascending ids each) the triangulation of the m-dimensional polytope with
/// vertices `vertices` and facets `facets` that pulling its vertices in ascending order gives: cone
/// from the lowest vertex over the triangulated facets that do not contain it, recursively. It
/// depends on the face lattice and the ids alone. m >= 1.
/// Source: C. Lee, "Subdivisions and triangulations of polytopes", Handbook of Discrete and
/// Computational Geometry, section 16.2 (2017).
void pull(const VertexSet& vertices, unsigned m, const std::vector<VertexSet>& facets,
          std::vector<std::uint32_t>& out);

}  // namespace cullhull::internal::inline result
