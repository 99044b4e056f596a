// Flips that make a star-shaped surface of triangles convex: an edge that is certainly reflex is
// replaced by the other diagonal of its two triangles, or, where one of its ends has three
// triangles alone, that end is removed. Each flip adds volume, so the end is reached; what then is
// left may be reflex edges that no flip can take (Gao, Cao and Tan, "Flip-flop", 2013).
#pragma once

#include <cstdint>

#include "filter/pseudo_hull/primitives.hpp"
#include "filter/star_hull/star_math.hpp"

namespace cullhull::internal::inline filter {

/// What a facet would do: the side `corner`, and whether its edge is replaced or the edge's first
/// or second end (after the corner) removed.
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

  /// Of a side's claims: later rounds before earlier ones, and within a round each side its own
  /// number, in an order that changes from round to round.
  CULLHULL_HD static std::uint64_t key(std::uint32_t side, std::uint32_t round) {
    std::uint32_t h =
        side * 0x9E3779B1U + round * 0x85EBCA6BU;  // odd factors and shifts: one to one
    h ^= h >> 15;
    h *= 0x2C1B3C6DU;
    h ^= h >> 13;
    return std::uint64_t{round} << 32 | h;
  }
  CULLHULL_HD bool positive(const double* a, const double* b, const double* c) const {
    return star_sign(centre, a, b, c) > 0;
  }

  /// The flip at one side of a facet; `reflex`: 1 for a certain reflex edge, 0 for one whose sign
  /// is not certain.
  CULLHULL_HD StarFlip at_side(std::uint32_t f, unsigned k, int& reflex) const {
    const StarFacet& here = facet[f];
    const StarSide beyond = here.across[k];
    const StarFacet& there = facet[beyond.facet()];
    const unsigned m = beyond.corner();
    double c[3], a[3], b[3], d[3];
    rows.load(here.vertex[k], c);
    rows.load(here.vertex[next_corner(k)], a);
    rows.load(here.vertex[last_corner(k)], b);
    rows.load(there.vertex[m], d);
    reflex = star_sign(c, a, b, d);
    if (reflex <= 0) return StarFlip::none;
    const bool with_first = positive(c, a, d), with_second = positive(c, d, b);
    if (with_first && with_second) return StarFlip::edge;
    // There: d at m, b after it, a before it.
    if (with_second && here.across[last_corner(k)].facet() == there.across[next_corner(m)].facet())
      return StarFlip::first_end;
    if (with_first && here.across[next_corner(k)].facet() == there.across[last_corner(m)].facet())
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

/// Rounds of flips. A round looks at the sides of the facets that are listed for it: first each
/// finds its flip and claims the facets around, then the flips that got all of their claims are
/// done, which touch nothing in common. A flip needs the facets that it replaces: no stronger flip
/// may replace one of them or change one of its sides. So nobody replaces what it only borders on;
/// others may border on it, too, each of which changes another side. Listed for the next round is
/// what a flip changed or has yet to get. The order of a list shows in nothing: claims know sides
/// by their numbers.
template <class Executor, class Rows>
struct FlipRounds {
  StarFlips<Rows> flips;
  FlipClaim* claim;
  unsigned char* proposal;    ///< by item of the round: a StarFlip
  unsigned char* waiting;     ///< by side: its surroundings have changed since it was looked at
  std::uint32_t* listed[2];   ///< facets, for even and for odd rounds
  std::uint32_t* listed_for;  ///< by facet: the last round that it is listed for
  std::uint32_t* count;       ///< by round: how many facets are listed
  std::uint32_t* flipped;     ///< how many flips were done

  /// Item 3 j + k is side k of the j-th listed facet.
  CULLHULL_HD static std::uint32_t items_of(std::uint32_t facets) { return 3 * facets; }
  CULLHULL_HD std::uint32_t items(std::uint32_t round) const { return items_of(count[round]); }
  CULLHULL_HD std::uint32_t facet_of(std::uint32_t round, std::uint32_t item) const {
    return listed[round % 2][item / 3];
  }

  CULLHULL_HD void first(std::uint32_t round, std::uint32_t item) const {
    const std::uint32_t f = facet_of(round, item);
    const unsigned k = item % 3;
    const std::uint32_t side = 3 * f + k;
    proposal[item] = 0;
    if (waiting[side] == 0) return;
    int reflex = 0;
    // A side is looked at from the lower of its two facets.
    const StarFlip flip = flips.facet[f].live() && flips.facet[f].across[k].facet() > f
                              ? flips.at_side(f, k, reflex)
                              : StarFlip::none;
    if (flip == StarFlip::none) {
      waiting[side] = 0;
      return;
    }
    proposal[item] = static_cast<unsigned char>(flip);
    const FlipPatch p = flips.patch(f, k, flip);
    const std::uint64_t key = flips.key(side, round);
    for (unsigned j = 0; j < 6; ++j) {
      FlipClaim& c = claim[p.facet[j]];
      Executor::raise(j < p.own ? c.own : c.beside, key);
    }
  }

  /// A facet is read only once it is seen to be this flip's: others may be changing now.
  CULLHULL_HD void second(std::uint32_t round, std::uint32_t item) const {
    const auto flip = static_cast<StarFlip>(proposal[item]);
    if (flip == StarFlip::none) return;
    const std::uint32_t f = facet_of(round, item);
    const unsigned k = item % 3;
    const std::uint64_t key = flips.key(3 * f + k, round);
    if (!owns(f, key) || !owns(flips.facet[f].across[k].facet(), key) ||
        (flip != StarFlip::edge && !owns(flips.third_facet(f, k, flip).facet(), key))) {
      list(f, round + 1);
      return;
    }
    const FlipPatch p = flips.patch(f, k, flip);
    flips.perform(f, k, flip);
    for (const std::uint32_t g : p.facet) {
      for (unsigned j = 0; j < 3; ++j) waiting[3 * g + j] = 1;
      list(g, round + 1);
    }
    Executor::next(*flipped);
  }

 private:
  CULLHULL_HD bool owns(std::uint32_t f, std::uint64_t key) const {
    return claim[f].own == key && claim[f].beside < key;
  }
  CULLHULL_HD void list(std::uint32_t f, std::uint32_t round) const {
    if (Executor::is_first(listed_for[f], round))
      listed[round % 2][Executor::next(count[round])] = f;
  }
};

/// Before the first round: nothing is claimed, and every facet is listed for it.
template <class Executor, class Rows>
struct StartFlips {
  FlipRounds<Executor, Rows> rounds;
  std::uint32_t facets, first_round;
  CULLHULL_HD void operator()(std::uint32_t f) const {
    rounds.claim[f] = {0, 0};
    for (unsigned k = 0; k < 3; ++k) rounds.waiting[3 * f + k] = 1;
    rounds.listed[first_round % 2][f] = f;
    rounds.listed_for[f] = first_round;
    if (f == 0) rounds.count[first_round] = facets;
  }
};

/// What is left in the end.
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
      int reflex = 0;
      (void)flips.at_side(f, k, reflex);
      r.reflex += reflex > 0;
      r.uncertain += reflex == 0;
    }
    return r;
  }
};

}  // namespace cullhull::internal::inline filter
