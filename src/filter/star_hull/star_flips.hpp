// Flips that make a star-shaped surface of triangles convex: an edge that is certainly reflex is
// replaced by the other diagonal of its two triangles, or, where one of its ends has three
// triangles alone, that end is removed. Each flip adds volume, so the end is reached. Where reflex
// edges are left that no flip takes, vertices that are certainly inside are flipped free and
// removed (Gao, Cao and Tan, "Flip-flop", 2013).
#pragma once

#include <cstdint>

#include "filter/pseudo_hull/primitives.hpp"
#include "filter/star_hull/star_math.hpp"

namespace cullhull::internal {

/// What can be done at a side of a facet: its edge is replaced, or the edge's first or second end
/// (after the corner) removed.
enum class StarFlip : unsigned char { none, edge, first_end, second_end };

/// The surroundings of a flip: first the facets that it replaces, `own` of them, then those that
/// border on them, of each of which it changes the one side between.
struct FlipPatch {
  std::uint32_t facet[6];
  unsigned own;
};
/// By facet: the strongest flip that would replace it, and the strongest that would change one of
/// its sides.
struct alignas(16) FlipClaim {
  std::uint64_t own, beside;
};

template <class Rows>
struct StarFlips {
  Rows rows;
  double centre[3];
  StarFacet* facet;
  unsigned char* culled;  ///< by row: a vertex that a flip removes is strictly inside
  unsigned char* doomed;  ///< by row: a vertex proved to be strictly inside; null: none

  /// Claim priority: newest round first, then a permutation of the side numbers that differs from
  /// round to round.
  CULLHULL_HD static std::uint64_t key(std::uint32_t side, std::uint32_t round) {
    std::uint32_t h =
        side * 0x9E3779B1U + round * 0x85EBCA6BU;  // odd factors and shifts: one to one
    h ^= h >> 15;
    h *= 0x2C1B3C6DU;
    h ^= h >> 13;
    return std::uint64_t{round} << 32 | h;
  }

  CULLHULL_HD bool is_doomed(std::uint32_t row) const {
    return doomed != nullptr && doomed[row] != 0;
  }

  /// An edge and what is needed to decide about it: side k of a facet.
  struct Edge {
    std::uint32_t c, a, b, d;        ///< its ends a, b, and the vertices opposite to it
    int reflex;                      ///< 1: certainly; 0: the sign is not certain
    int with_first, with_second;     ///< the signs of (c, a, d) and (c, d, b); if `wanted`
    bool wanted;                     ///< it should be replaced
    bool first_has_3, second_has_3;  ///< whether a or b has three triangles alone
  };
  CULLHULL_HD Edge edge_at(std::uint32_t f, unsigned k) const {
    const StarFacet& here = facet[f];
    const StarSide beyond = here.across[k];
    const StarFacet& there = facet[beyond.facet()];
    const unsigned m = beyond.corner();
    Edge e = {here.vertex[k],
              here.vertex[next_corner(k)],
              here.vertex[last_corner(k)],
              there.vertex[m],
              0,
              0,
              0,
              false,
              false,
              false};
    double c[3], a[3], b[3], d[3];
    rows.load(e.c, c);
    rows.load(e.a, a);
    rows.load(e.b, b);
    rows.load(e.d, d);
    e.reflex = star_sign(c, a, b, d);
    e.wanted = e.reflex > 0 || is_doomed(e.a) || is_doomed(e.b);
    if (!e.wanted) return e;
    e.with_first = star_sign(centre, c, a, d);
    e.with_second = star_sign(centre, c, d, b);
    // There: d at m, b after it, a before it.
    e.first_has_3 = here.across[last_corner(k)].facet() == there.across[next_corner(m)].facet();
    e.second_has_3 = here.across[next_corner(k)].facet() == there.across[last_corner(m)].facet();
    return e;
  }
  /// The lower of two rows that is doomed; no_item if neither is.
  CULLHULL_HD std::uint32_t lowest_doomed(std::uint32_t v, std::uint32_t w) const {
    const std::uint32_t low = v < w ? v : w;
    return is_doomed(low) ? low : is_doomed(v + w - low) ? v + w - low : no_item;
  }

  // Example: the edge a b has the opposite corners c and d; the flip takes an edge from a and from
  // b and gives one to c and to d. With doomed vertices 4 = a and 9 = c the flip is done, as the
  // lowest of them loses an edge; with 4 = c and 9 = a it is not.

  /// The flip at an edge. A vertex that is doomed gets an edge only where a lower one that is
  /// doomed loses one: the lowest of them can always lose one, so all are removed in the end.
  CULLHULL_HD StarFlip flip_of(const Edge& e) const {
    if (!e.wanted) return StarFlip::none;
    if (e.with_first > 0 && e.with_second > 0) {
      const std::uint32_t gets = lowest_doomed(e.c, e.d);
      return gets == no_item || lowest_doomed(e.a, e.b) < gets ? StarFlip::edge : StarFlip::none;
    }
    if (e.with_second > 0 && e.first_has_3 && (e.reflex > 0 || is_doomed(e.a)))
      return StarFlip::first_end;
    if (e.with_first > 0 && e.second_has_3 && (e.reflex > 0 || is_doomed(e.b)))
      return StarFlip::second_end;
    return StarFlip::none;
  }

  /// Reads the facets that the flip replaces, and no others.
  CULLHULL_HD FlipPatch patch(std::uint32_t f, unsigned k, StarFlip flip) const {
    const StarFacet& here = facet[f];
    const StarSide beyond = here.across[k];
    const StarFacet& there = facet[beyond.facet()];
    const unsigned m = beyond.corner();
    const StarSide bc = here.across[next_corner(k)], ca = here.across[last_corner(k)],
                   ad = there.across[next_corner(m)], db = there.across[last_corner(m)];
    if (flip == StarFlip::edge)
      return {{f, beyond.facet(), bc.facet(), ca.facet(), ad.facet(), db.facet()}, 2};
    const StarSide third = third_facet(f, k, flip);
    const bool first = flip == StarFlip::first_end;
    const std::uint32_t end = here.vertex[first ? next_corner(k) : last_corner(k)];
    const std::uint32_t outer = facet[third.facet()].across[corner_of(third, end)].facet();
    return first ? FlipPatch{{f, beyond.facet(), third.facet(), bc.facet(), db.facet(), outer}, 3}
                 : FlipPatch{{f, beyond.facet(), third.facet(), ca.facet(), ad.facet(), outer}, 3};
  }
  /// The third facet around an end that is removed.
  CULLHULL_HD StarSide third_facet(std::uint32_t f, unsigned k, StarFlip flip) const {
    return facet[f].across[flip == StarFlip::first_end ? last_corner(k) : next_corner(k)];
  }

  /// The corner of the facet at which `vertex` stands.
  CULLHULL_HD unsigned corner_of(StarSide third, std::uint32_t vertex) const {
    const StarFacet& t = facet[third.facet()];
    return t.vertex[0] == vertex ? 0 : t.vertex[1] == vertex ? 1 : 2;
  }

  CULLHULL_HD void join(StarSide a, StarSide b) const {
    facet[a.facet()].across[a.corner()] = b;
    facet[b.facet()].across[b.corner()] = a;
  }

  CULLHULL_HD void perform(std::uint32_t f, unsigned k, StarFlip flip) const {
    const StarSide beyond = facet[f].across[k];
    const std::uint32_t g = beyond.facet();
    const unsigned m = beyond.corner();
    // Here c with the edge a b after it, there d with b a; each side by the edge that it has.
    const std::uint32_t c = facet[f].vertex[k], a = facet[f].vertex[next_corner(k)],
                        b = facet[f].vertex[last_corner(k)], d = facet[g].vertex[m];
    const StarSide bc = facet[f].across[next_corner(k)], ca = facet[f].across[last_corner(k)],
                   ad = facet[g].across[next_corner(m)], db = facet[g].across[last_corner(m)];
    if (flip == StarFlip::edge) {
      set(f, c, a, d);
      set(g, c, d, b);
      join(side_of_facet(f, 0), ad);
      join(side_of_facet(f, 1), side_of_facet(g, 2));
      join(side_of_facet(f, 2), ca);
      join(side_of_facet(g, 0), db);
      join(side_of_facet(g, 1), bc);
      return;
    }
    const std::uint32_t end = flip == StarFlip::first_end ? a : b;
    const StarSide third = flip == StarFlip::first_end ? ca : bc;
    const std::uint32_t h = third.facet();
    const StarSide cd = facet[h].across[corner_of(third, end)];
    if (flip == StarFlip::first_end) {
      set(f, c, d, b);
      join(side_of_facet(f, 0), db);
      join(side_of_facet(f, 1), bc);
      join(side_of_facet(f, 2), cd);
    } else {
      set(f, c, a, d);
      join(side_of_facet(f, 0), ad);
      join(side_of_facet(f, 1), cd);
      join(side_of_facet(f, 2), ca);
    }
    culled[end] = 1;
    facet[g].vertex[1] = facet[g].vertex[0];
    facet[h].vertex[1] = facet[h].vertex[0];
  }
  CULLHULL_HD void set(std::uint32_t f, std::uint32_t a, std::uint32_t b, std::uint32_t c) const {
    facet[f].vertex[0] = a;
    facet[f].vertex[1] = b;
    facet[f].vertex[2] = c;
  }
};

// Why flips end and lose nothing (docs/exactness.md, H4 and H5). At a proved reflex edge a b with
// the opposite corners c and d the flip replaces (a, b, c) and (b, a, d) by the triangles of the
// edge c d. If these are proved to be positive as seen from the centre, both pairs cover the same
// cone, and the tetrahedron between them is added: the volume grows, so no surface comes twice. If
// an end has three triangles, it is strictly beneath the plane of its neighbours and is removed:
// strictly inside.
//
// Flips can stall at reflex edges of which no flip is star-shaped. Then an end v of such an edge is
// strictly inside of the tetrahedron of centre and its three neighbours: it is doomed and may leave
// whatever the surface becomes. Flips at doomed vertices may take volume away, but the lowest
// doomed vertex of the four loses an edge and no lower one gets one: the list of degrees of doomed
// vertices, the lowest first, becomes lexicographically less, so these flips end, too. Example:
// degrees (5, 4) of doomed 7 and 9; a flip of an edge of 7 leaves (4, 4) or (4, 5); after (3, .)
// vertex 7 is removed.
//
// What a flip is decided by are its own two or three triangles, which no other accepted flip of the
// round changes, so it does not matter in which order the flips of a round are done.

/// Rounds of flips. In a round first every side that waits finds its flip and claims the facets
/// around; then the flips that got all of their claims are done, which touch nothing in common. A
/// flip needs the facets that it replaces: no stronger flip may replace one of them or change one
/// of its sides. So no accepted flip replaces a facet that another accepted flip borders on.
/// Several accepted flips may border on one facet: each of them changes another side of it.
///
/// Two facets share a side; the lower of them looks at it. After a flip the sides of the new facets
/// wait. A vertex of three triangles that is beneath its neighbours' has three reflex edges: two of
/// them are such sides, so the third need not wait.
///
/// A round is for all sides that wait or, with lists, for those of the facets that are listed for
/// it. The result does not depend on list order: claims know sides by their numbers.
template <class Executor, class Rows>
struct FlipRounds {
  StarFlips<Rows> flips;
  FlipClaim* claim;
  unsigned char* waiting;     ///< by side: whether it is to be looked at
  unsigned char* proposal;    ///< by side: a StarFlip, none but within a round
  std::uint32_t* listed[2];   ///< facets, for even and for odd rounds; null: no lists
  std::uint32_t* listed_for;  ///< by facet: the last round that it is listed for
  std::uint32_t* count;       ///< by round: how many facets are listed
  std::uint32_t* flipped;     ///< how many flips were done; null: nobody wants to know

  /// Rounds by lists: item 3 j + k is side k of the j-th listed facet.
  CULLHULL_HD static std::uint32_t items_of(std::uint32_t facets) { return 3 * facets; }
  CULLHULL_HD std::uint32_t items(std::uint32_t round) const { return items_of(count[round]); }
  CULLHULL_HD void first(std::uint32_t round, std::uint32_t item) const {
    const std::uint32_t side = side_of(round, item);
    if (waiting[side] != 0) propose(round, side);
  }
  CULLHULL_HD void second(std::uint32_t round, std::uint32_t item) const {
    const std::uint32_t side = side_of(round, item);
    if (proposal[side] != 0) perform(round, side);
  }

  CULLHULL_HD void propose(std::uint32_t round, std::uint32_t side) const {
    const std::uint32_t f = side / 3;
    const unsigned k = side % 3;
    const StarFlip flip = flips.facet[f].live() && flips.facet[f].across[k].facet() > f
                              ? flips.flip_of(flips.edge_at(f, k))
                              : StarFlip::none;
    if (flip == StarFlip::none) {
      waiting[side] = 0;
      return;
    }
    proposal[side] = static_cast<unsigned char>(flip);
    const FlipPatch p = flips.patch(f, k, flip);
    const std::uint64_t key = flips.key(side, round);
    for (unsigned j = 0; j < 6; ++j) {
      FlipClaim& c = claim[p.facet[j]];
      Executor::raise(j < p.own ? c.own : c.beside, key);
    }
  }

  /// A facet is read only once it is seen to be this flip's: others may be changing now.
  CULLHULL_HD void perform(std::uint32_t round, std::uint32_t side) const {
    const std::uint32_t f = side / 3;
    const unsigned k = side % 3;
    const auto flip = static_cast<StarFlip>(proposal[side]);
    proposal[side] = 0;
    const std::uint64_t key = flips.key(side, round);
    if (!owns(f, key) || !owns(flips.facet[f].across[k].facet(), key) ||
        (flip != StarFlip::edge && !owns(flips.third_facet(f, k, flip).facet(), key))) {
      if (listed[0] != nullptr && Executor::is_first(listed_for[f], round + 1))
        listed[(round + 1) % 2][Executor::next(count[round + 1], 1)] = f;
      return;
    }
    const std::uint32_t g = flips.facet[f].across[k].facet();
    flips.perform(f, k, flip);
    const unsigned sides = flip == StarFlip::edge ? 6 : 3;
    for (unsigned j = 0; j < sides; ++j) {
      const StarSide looks = looking(f, g, j);
      waiting[3 * looks.facet() + looks.corner()] = 1;
    }
    if (listed[0] != nullptr) list_around(f, g, sides, round + 1);
    if (flipped != nullptr) (void)Executor::next(*flipped, 1);
  }

 private:
  CULLHULL_HD std::uint32_t side_of(std::uint32_t round, std::uint32_t item) const {
    return 3 * listed[round % 2][item / 3] + item % 3;
  }
  CULLHULL_HD bool owns(std::uint32_t f, std::uint64_t key) const {
    return claim[f].own == key && claim[f].beside < key;
  }
  /// The side that stands for side j (0 to 5) of facets f and g: the one at the lower facet.
  CULLHULL_HD StarSide looking(std::uint32_t f, std::uint32_t g, unsigned j) const {
    const std::uint32_t own = j < 3 ? f : g;
    const StarSide other = flips.facet[own].across[j % 3];
    return other.facet() < own ? other : side_of_facet(own, j % 3);
  }
  /// Lists the facets that have the sides around f and g. Issues all loads before using the first.
  CULLHULL_HD void list_around(std::uint32_t f, std::uint32_t g, unsigned sides,
                               std::uint32_t round) const {
    std::uint32_t is_new = 0, count_new = 0;
    for (unsigned j = 0; j < sides; ++j) {
      const bool first = Executor::is_first(listed_for[looking(f, g, j).facet()], round);
      is_new |= std::uint32_t{first} << j;
      count_new += first;
    }
    std::uint32_t at = Executor::next(count[round], count_new);
    for (unsigned j = 0; j < sides; ++j)
      if ((is_new >> j & 1) != 0) listed[round % 2][at++] = looking(f, g, j).facet();
  }
};

/// Before the first round: nothing is claimed, and every side is to be looked at.
template <class Executor, class Rows>
struct StartFlips {
  FlipRounds<Executor, Rows> rounds;
  CULLHULL_HD void operator()(std::uint32_t f) const {
    rounds.claim[f] = {0, 0};
    for (unsigned k = 0; k < 3; ++k) {
      rounds.waiting[3 * f + k] = 1;
      rounds.proposal[3 * f + k] = 0;
    }
    rounds.listed_for[f] = 0;
  }
};
struct SideIsMarked {
  const unsigned char* mark;
  CULLHULL_HD bool operator()(std::uint32_t side) const { return mark[side] != 0; }
};
struct FacetWaits {
  const unsigned char* waiting;  ///< by side
  CULLHULL_HD bool operator()(std::uint32_t f) const {
    return (waiting[3 * f] | waiting[3 * f + 1] | waiting[3 * f + 2]) != 0;
  }
};
struct ListForRound {
  std::uint32_t* list;
  std::uint32_t* listed_for;
  std::uint32_t round;
  CULLHULL_HD void operator()(std::uint32_t f, std::uint32_t k) const {
    list[k] = f;
    listed_for[f] = round;
  }
};
/// A step of a round without lists.
template <class Rounds, bool First>
struct FlipStep {
  /// A device keeps so many blocks of 256 threads on a processor, and so hides more of their waits
  /// for memory: with the 86 registers that the first step takes unbounded there would be two. On
  /// sm_90 64 suffice without spills; the time is not measured.
  static constexpr unsigned resident_blocks = 4;
  Rounds rounds;
  std::uint32_t round;
  CULLHULL_HD void operator()(std::uint32_t side) const {
    if constexpr (First)
      rounds.propose(round, side);
    else
      rounds.perform(round, side);
  }
};

/// Run when flipping has stalled, on each certainly reflex edge a b: if one of its ends lies, seen
/// from the centre, in the triangle of the other three vertices, that end is also beneath the
/// triangle, so it is strictly inside. It is marked as doomed: later flips remove its edges, reflex
/// or not, until it has three triangles and is removed (the flop of Flip-Flop). Returns 1 where it
/// marks an end.
template <class Rows>
struct DoomEnds {
  StarFlips<Rows> flips;
  unsigned char* doomed;  ///< by row
  CULLHULL_HD std::uint32_t operator()(std::uint32_t side) const {
    const std::uint32_t f = side / 3;
    const unsigned k = side % 3;
    if (!flips.facet[f].live() || flips.facet[f].across[k].facet() < f) return 0;
    const auto e = flips.edge_at(f, k);
    if (e.reflex <= 0) return 0;
    if (e.with_first < 0 && e.with_second > 0) {
      doomed[e.a] = 1;
      return 1;
    }
    if (e.with_second < 0 && e.with_first > 0) {
      doomed[e.b] = 1;
      return 1;
    }
    return 0;
  }
};
struct AddNumbers {
  CULLHULL_HD std::uint32_t operator()(std::uint32_t a, std::uint32_t b) const { return a + b; }
};
/// All sides at a doomed vertex are to be looked at.
struct WakeDoomed {
  const StarFacet* facet;
  const unsigned char* doomed;
  unsigned char* waiting;
  CULLHULL_HD void operator()(std::uint32_t side) const {
    const StarFacet& f = facet[side / 3];
    const unsigned k = side % 3;
    if (f.live() && (doomed[f.vertex[next_corner(k)]] | doomed[f.vertex[last_corner(k)]]) != 0)
      waiting[side] = 1;
  }
};

/// Facets, and edges that are still reflex or undecided.
struct StarReport {
  std::uint32_t facets = 0, reflex = 0, uncertain = 0;
};
struct AddReports {
  CULLHULL_HD StarReport operator()(StarReport a, const StarReport& b) const {
    return {a.facets + b.facets, a.reflex + b.reflex, a.uncertain + b.uncertain};
  }
};
template <class Rows>
struct ReportFacet {
  StarFlips<Rows> flips;
  CULLHULL_HD StarReport operator()(std::uint32_t f) const {
    StarReport r;
    if (!flips.facet[f].live()) return r;
    r.facets = 1;
    for (unsigned k = 0; k < 3; ++k) {
      if (flips.facet[f].across[k].facet() < f) continue;
      const int reflex = flips.edge_at(f, k).reflex;
      r.reflex += reflex > 0;
      r.uncertain += reflex == 0;
    }
    return r;
  }
};

}  // namespace cullhull::internal
