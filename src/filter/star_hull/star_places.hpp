// Where the rows are on a first surface: the cones of its facets, the walk that finds a row's, what
// is checked before rows are placed, and what is kept of a surface for the next frame.
#pragma once

#include <cstdint>

#include "filter/pseudo_hull/pseudo_hull_steps.hpp"
#include "filter/star_hull/star_leaders.hpp"
#include "filter/star_hull/star_math.hpp"

namespace cullhull::internal {

/// The cone of a facet of the first surface. Plane `side[k]` goes through the centre and the other
/// vertices than k, with vertex k on its inner side; all are uncertain where one is.
struct alignas(16) StarCone {
  double base[3];
  PseudoPlane<3> side[3], plane;

  CULLHULL_HD bool certain() const {
    return plane.normal[0] != 0 || plane.normal[1] != 0 || plane.normal[2] != 0;
  }
};

CULLHULL_HD_INLINE Place star_place(std::uint32_t facet, double at, double error) {
  if (at > error) return {facet, at};
  return {at < -error ? place_inside : place_uncertain, 0};
}

template <class Rows>
struct MakeCone {
  Rows rows;
  double centre[3];
  const StarFacet* facet;
  StarCone* cone;
  CULLHULL_HD void operator()(std::uint32_t f) const {
    const StarFacet& of = facet[f];
    StarCone made;
    double at[3][3];
    bool certain = true;
    for (unsigned k = 0; k < 3; ++k) certain = certain && of.vertex[k] != no_item;
    if (certain) {
      for (unsigned k = 0; k < 3; ++k) rows.load(of.vertex[k], at[k]);
      const double* corner[3] = {at[0], at[1], at[2]};
      for (unsigned k = 0; k < 3; ++k) {
        made.base[k] = at[0][k];
        const double* through[3] = {centre, at[next_corner(k)], at[last_corner(k)]};
        certain = make_plane<3>(through, at[k], made.side[k]) && certain;
      }
      certain = make_plane<3>(corner, centre, made.plane) && certain &&
                star_sign(centre, at[0], at[1], at[2]) > 0;
    }
    if (!certain)
      for (unsigned k = 0; k < 4; ++k) set_uncertain(k < 3 ? made.side[k] : made.plane);
    cone[f] = made;
  }
};

// A walk crosses a side that the point is certainly beyond, not always the first: else it could go
// round in a ring of facets.

/// Finds the cones of points by walking over the first surface.
template <class From>
struct StarPlaces {
  From from;
  double centre[3];
  const StarFacet* facet;
  const StarCone* cone;

  CULLHULL_HD Place of(const double* x) const {
    std::uint32_t f = from(x);
    return walk(x, 64, f);
  }
  /// Begins at f, which becomes the last facet that was reached.
  CULLHULL_HD Place walk(const double* x, unsigned most_steps, std::uint32_t& f) const {
    for (unsigned step = 0; step < most_steps; ++step) {
      const StarCone& here = cone[f];
      unsigned beyond = 3;
      bool certain = true;
      for (unsigned j = 0; j < 3; ++j) {
        const unsigned k = (j + step) % 3;
        const double at = pseudo_distance<3>(here.side[k].normal, centre, x);
        if (at > here.side[k].error && beyond == 3) beyond = k;
        certain = certain && at < -here.side[k].error;
      }
      if (certain)
        return star_place(f, pseudo_distance<3>(here.plane.normal, here.base, x), here.plane.error);
      if (beyond == 3) break;
      f = facet[f].across[beyond].facet();
    }
    return {place_uncertain, 0};
  }
};

/// Of a first surface: facets without a cone, those that a ray through the first facet may meet,
/// edges that are certainly reflex, and how many of some rows are not certainly inside.
struct StarCheck {
  std::uint32_t open = 0, met = 0, reflex = 0, outside = 0;

  /// It covers each direction once (docs/exactness.md, H7).
  bool good() const { return open == 0 && met == 1; }
};
struct AddChecks {
  CULLHULL_HD StarCheck operator()(StarCheck a, const StarCheck& b) const {
    return {a.open + b.open, a.met + b.met, a.reflex + b.reflex, a.outside + b.outside};
  }
};
/// Items are the facets, then rows `stride` apart.
template <class Rows, class From>
struct CheckStart {
  Rows rows;
  StarPlaces<From> places;
  std::uint32_t facets, stride;
  CULLHULL_HD StarCheck operator()(std::uint32_t i) const {
    StarCheck found;
    double x[3];
    if (i >= facets) {
      rows.load((i - facets) * stride, x);
      found.outside = places.of(x).facet != place_inside;
      return found;
    }
    const StarCone& here = places.cone[i];
    found.open = !here.certain();
    found.met = may_meet(here);
    for (unsigned k = 0; k < 3; ++k) {
      const StarSide beyond = places.facet[i].across[k];
      const std::uint32_t opposite = places.facet[beyond.facet()].vertex[beyond.corner()];
      if (beyond.facet() < i || opposite == no_item) continue;
      rows.load(opposite, x);
      found.reflex += pseudo_distance<3>(here.plane.normal, here.base, x) > here.plane.error;
    }
    return found;
  }

 private:
  /// Whether the ray from the centre through the middle of the first facet is not certainly outside
  /// of a cone.
  CULLHULL_HD bool may_meet(const StarCone& here) const {
    double middle[3] = {0, 0, 0};
    for (const std::uint32_t v : places.facet[0].vertex) {
      double x[3];
      if (v == no_item) return false;  // which is open
      rows.load(v, x);
      for (unsigned k = 0; k < 3; ++k) middle[k] += x[k] / 3;
    }
    for (unsigned k = 0; k < 3; ++k)
      if (pseudo_distance<3>(here.side[k].normal, places.centre, middle) > here.side[k].error)
        return false;
    return true;
  }
};

/// Assigns rows to the facets in whose cones they are: item i is row i, or that of points[i].
template <class Rows, class From>
struct AssignToCones {
  Rows rows;
  StarPlaces<From> places;
  const ExteriorPoint* points;
  PlaceArrays arrays;

  CULLHULL_HD Offer operator()(std::uint32_t i) const {
    const std::uint32_t row = points == nullptr ? i : points[i].row;
    double x[3];
    rows.load(row, x);
    return arrays.settle(i, row, places.of(x));
  }
};
struct FromFirstFacet {
  CULLHULL_HD std::uint32_t operator()(const double* /*x*/) const { return 0; }
};
/// The walk of a row begins at the facet that the walk of the nearest node ended at.
struct FromNode {
  FromNearestNode nearest;
  const std::uint32_t* facet_of;  ///< by the node's first facet in the grid
  CULLHULL_HD std::uint32_t operator()(const double* x) const { return facet_of[nearest(x)]; }
};
/// Finds the facet in the direction of a node, whose first facet is f; far, in a first frame.
struct WalkNode {
  StarPlaces<FromNode> places;
  std::uint32_t* facet_of;
  CULLHULL_HD void operator()(std::uint32_t f) const {
    const FromNearestNode& nearest = places.from.nearest;
    const LeaderGrid3::Node p = nearest.grid.node_of(f);
    if (nearest.grid.first_facet(p) != f) return;
    double x[3];
    for (unsigned k = 0; k < 3; ++k)
      x[k] = nearest.frame.centre[k] + (2.0 * p.at[k] / nearest.grid.m - 1) / nearest.frame.unit[k];
    std::uint32_t at = facet_of[f];
    places.walk(x, 4096, at);
    facet_of[f] = at;
  }
};
struct FacetIsLive {
  const StarFacet* facet;
  CULLHULL_HD bool operator()(std::uint32_t f) const { return facet[f].live(); }
};
/// The facets that are left, without gaps.
struct CompactFacet {
  const StarFacet* facet;
  const std::uint32_t* number;
  StarFacet* to;
  CULLHULL_HD void operator()(std::uint32_t f) const {
    if (!facet[f].live()) return;
    StarFacet moved = facet[f];
    for (auto& side : moved.across) side = side_of_facet(number[side.facet()], side.corner());
    to[number[f]] = moved;
  }
};
struct CopyFacet {
  const StarFacet* from;
  StarFacet* to;
  CULLHULL_HD void operator()(std::uint32_t f) const { to[f] = from[f]; }
};
/// Finds a node's facet by its number. A fresh node has the facet that stands where that of the
/// leaders was, which is near.
struct RenumberNode {
  LeaderGrid3 nodes, leaders;
  bool fresh;
  const std::uint32_t* number;
  std::uint32_t facets;
  std::uint32_t* facet_of;
  CULLHULL_HD void operator()(std::uint32_t f) const {
    std::uint32_t before = fresh ? 0 : facet_of[f];
    if (fresh && leaders.m != 0) {
      LeaderGrid3::Node p = nodes.node_of(f);
      for (auto& at : p.at) at = at * leaders.m / nodes.m;
      before = leaders.first_facet(p);
    }
    const std::uint32_t n = number[before];
    facet_of[f] = n < facets ? n : facets - 1;
  }
};
struct EmitPoint {
  ExteriorPoint* points;
  CULLHULL_HD void operator()(std::uint32_t i, std::uint32_t k) const { points[k] = {i, 0}; }
};

}  // namespace cullhull::internal
