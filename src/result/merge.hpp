// Merges coplanar simplices to facets, and triangulates these canonically.
#pragma once

#include "cullhull/hull.hpp"
#include "result/boundary.hpp"

namespace cullhull::internal::inline result {

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

}  // namespace cullhull::internal::inline result
