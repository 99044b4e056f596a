// The boundary on its way to the canonical result: simplices with ascending ids, checked ridges.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "hull/engine.hpp"
#include "parallel/control.hpp"

namespace cullhull::internal {

inline constexpr std::uint64_t simplex_chunk = std::uint64_t{1} << 14;

/// Simplices of k ascending local ids. `odd[f]` is set where the last two ids must be swapped to
/// orient simplex f outward. Entry j of a simplex's neighbours lies across the ridge without id j.
struct Surface {
  unsigned k = 0;
  Array<std::uint32_t> ids;
  Array<std::uint32_t> neighbours;
  Array<std::uint8_t> odd;

  std::size_t count() const { return odd.size(); }
  const std::uint32_t* simplex(std::size_t f) const { return ids.data() + f * k; }
  /// Id j of the outward oriented simplex.
  std::uint32_t stored(std::size_t f, unsigned j) const { return simplex(f)[stored_slot(f, j)]; }
  unsigned stored_slot(std::size_t f, unsigned j) const {
    return odd[f] && j + 2 >= k ? 2 * k - 3 - j : j;
  }
};

/// Takes the engine's simplices over: of equal points the lowest id stands in, ids ascend.
Surface make_surface(SimplicialHull&& boundary, const LocalPoints& points, unsigned threads);

using CoplanarPairs = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

/// The pairs of simplices that lie in one hyperplane, in a fixed order. Throws Error{not_exact}
/// unless every ridge is shared by two coherently oriented simplices, is weakly convex, and no
/// simplex is degenerate. Adds to `rung_counts`.
CoplanarPairs coplanar_pairs(const Surface& surface, const LocalPoints& points, unsigned threads,
                             const Control& control, std::uint64_t* rung_counts);

[[noreturn]] void fail_not_exact(const char* what);

/// The slot of g opposite to the ridge it shares with f across slot i; checks ids and orientations.
/// K: surface.k, or 0 if that is not known to the compiler.
template <unsigned K>
inline unsigned opposite_slot(const Surface& surface, std::uint32_t f, unsigned i,
                              std::uint32_t g) {
  const unsigned k = K ? K : surface.k;
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

}  // namespace cullhull::internal
