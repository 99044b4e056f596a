// An engine's boundary on its way to the canonical result: simplices with ascending ids, checked
// ridges.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "hull/engine.hpp"
#include "parallel/threads/run.hpp"

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

}  // namespace cullhull::internal::inline result
