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

/// The surroundings of a flip: its facets and those that border on them.
struct FlipPatch {
  std::uint32_t facet[6];
};

template <class Rows>
struct StarFlips {
  Rows rows;
  double centre[3];
  StarFacet* facet;
  unsigned char* culled;  ///< by row: a vertex that a flip removes is strictly inside
  std::uint32_t round;

  /// Of a side's claims: later rounds before earlier ones, and within a round each side its own
  /// number, in an order that changes from round to round.
  CULLHULL_HD std::uint64_t key(std::uint32_t side) const {
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

  CULLHULL_HD FlipPatch patch(std::uint32_t f, unsigned k, StarFlip flip) const {
    const StarFacet& here = facet[f];
    const StarSide beyond = here.across[k];
    const StarFacet& there = facet[beyond.facet()];
    const unsigned m = beyond.corner(), k1 = next_corner(k), k2 = last_corner(k);
    const unsigned m1 = next_corner(m), m2 = last_corner(m);
    FlipPatch p = {{f, beyond.facet(), 0, 0, 0, 0}};
    p.facet[2] = here.across[k1].facet();
    p.facet[3] = here.across[k2].facet();
    p.facet[4] = there.across[m1].facet();
    p.facet[5] = there.across[m2].facet();
    if (flip == StarFlip::edge) return p;
    // The third facet around the removed end stands twice; the second time its outer neighbour.
    if (flip == StarFlip::first_end) {
      const StarSide third = here.across[k2];
      p.facet[4] = facet[third.facet()].across[corner_of(third, here.vertex[k1])].facet();
    } else {
      const StarSide third = here.across[k1];
      p.facet[5] = facet[third.facet()].across[corner_of(third, here.vertex[k2])].facet();
    }
    return p;
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

/// Item 3 f + k is side k of facet f. Finds the flip at a side and claims all facets around it. A
/// side whose surroundings have not changed since it found nothing to do is passed over.
template <class Executor, class Rows>
struct ProposeFlip {
  StarFlips<Rows> flips;
  std::uint64_t* claim;     ///< by facet
  unsigned char* proposal;  ///< by side: a StarFlip
  unsigned char* waiting;   ///< by side

  CULLHULL_HD void operator()(std::uint32_t side) const {
    proposal[side] = 0;
    if (waiting[side] == 0) return;
    const std::uint32_t f = side / 3;
    const unsigned k = side % 3;
    int reflex = 0;
    // A side is looked at from the lower of its two facets.
    const StarFlip flip = flips.facet[f].live() && flips.facet[f].across[k].facet() > f
                              ? flips.at_side(f, k, reflex)
                              : StarFlip::none;
    if (flip == StarFlip::none) {
      waiting[side] = 0;
      return;
    }
    proposal[side] = static_cast<unsigned char>(flip);
    const FlipPatch p = flips.patch(f, k, flip);
    const std::uint64_t key = flips.key(side);
    for (const std::uint32_t g : p.facet) Executor::raise(claim[g], key);
  }
};

/// Does the flips that got all of their claims, which are apart from one another; returns how many.
/// A facet is read only once its claim is seen to be this flip's: others may be changing now.
template <class Rows>
struct PerformFlip {
  StarFlips<Rows> flips;
  const std::uint64_t* claim;
  const unsigned char* proposal;
  unsigned char* waiting;

  CULLHULL_HD std::uint32_t operator()(std::uint32_t side) const {
    const auto flip = static_cast<StarFlip>(proposal[side]);
    if (flip == StarFlip::none) return 0;
    const std::uint32_t f = side / 3;
    const unsigned k = side % 3;
    const std::uint64_t key = flips.key(side);
    if (claim[f] != key) return 0;
    const StarFacet& here = flips.facet[f];
    for (unsigned j = 0; j < 3; ++j)
      if (claim[here.across[j].facet()] != key) return 0;
    const FlipPatch p = flips.patch(f, k, flip);  // reads these facets alone
    for (const std::uint32_t g : p.facet)
      if (claim[g] != key) return 0;
    flips.perform(f, k, flip);
    for (const std::uint32_t g : p.facet)
      for (unsigned j = 0; j < 3; ++j) waiting[3 * g + j] = 1;
    return 1;
  }
};

template <class Rows>
struct PerformUncounted {
  PerformFlip<Rows> flip;
  CULLHULL_HD void operator()(std::uint32_t side) const { (void)flip(side); }
};
struct AddNumbers {
  CULLHULL_HD std::uint32_t operator()(std::uint32_t a, std::uint32_t b) const { return a + b; }
};
/// Before the first round: nothing is claimed, and every facet is to be looked at.
struct StartWaiting {
  std::uint64_t* claim;
  unsigned char* waiting;
  CULLHULL_HD void operator()(std::uint32_t f) const {
    claim[f] = 0;
    for (unsigned k = 0; k < 3; ++k) waiting[3 * f + k] = 1;
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
