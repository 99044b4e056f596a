// The steps of a round as functors over plain arrays: loop bodies on the host, kernel bodies on a
// device. Each writes only to its own items, except through `lower` and offers, which the executor
// makes atomic.
//
// A point is dropped only by one simplex, conv(F, p): it was proved to be strictly outside of F, on
// p's side, and is proved to be strictly on the inner side of the other D facets, those through p.
// All D + 1 are hyperplanes of a simplex of input points, so it is strictly inside of that simplex,
// whatever the other facets of the surface do. Example in the plane: F = (0, 0)-(1, 0), p = (0.5,
// 1), a point (0.5, 0.2): outside of F (above it), inside of the edges (0, 0)-p and p-(1, 0):
// dropped. (0.1, 0.5) is outside of the first of these edges and goes to its list.
#pragma once

#include <bit>
#include <cstdint>

#include "filter/pseudo_hull/primitives.hpp"
#include "filter/pseudo_hull/pseudo_hull_math.hpp"
#include "filter/pseudo_hull/pseudo_hull_rows.hpp"

namespace cullhull::internal {

/// An exterior point: a row, and the facet it is assigned to.
struct ExteriorPoint {
  std::uint32_t row;
  std::uint32_t facet;
};

/// The state of the exterior points while they are reassigned: item i is the i-th of the list.
struct PlaceArrays {
  std::uint32_t* place;
  double* distance;
  unsigned char* culled;  ///< by row

  CULLHULL_HD Offer settle(std::uint32_t i, std::uint32_t row, const Place& found) const {
    place[i] = found.facet;
    distance[i] = found.distance;
    culled[row] = found.facet == place_inside;
    // Distances of points outside are positive, and positive doubles are ordered as their bits are.
    return {found.facet, found.facet < place_uncertain
                             ? std::bit_cast<std::uint64_t>(found.distance)
                             : std::uint64_t{0}};
  }
};
static_assert(place_inside == no_item, "so that scatter_max counts what is culled");

/// The facets of the first simplex with their planes; facet f lacks corner f.
template <unsigned D>
struct StartFacets {
  double base[D + 1][D];
  PseudoPlane<D> plane[D + 1];
};

/// Assigns every row to a facet of the simplex.
template <unsigned D, class Rows>
struct AssignFirst {
  Rows rows;
  StartFacets<D> facets;
  PlaceArrays arrays;

  CULLHULL_HD Offer operator()(std::uint32_t i) const {
    double x[D];
    rows.load(i, x);
    PlaceSearch search;
    for (unsigned f = 0; f <= D; ++f)
      search.offer(f, pseudo_distance<D>(facets.plane[f].normal, facets.base[f], x),
                   facets.plane[f].error);
    return arrays.settle(i, i, search.result());
  }
};

/// Replaces facet j by the D facets through its apex: stores their planes in the facet's fan, their
/// vertices in the cells of the facet stream. In facet i of them the apex replaces vertex i, which
/// is on the inner side.
template <unsigned D, class Rows>
struct ReplaceFacet {
  Rows rows;
  std::uint32_t facets;
  const PseudoFacet<D>* facet;
  const std::uint32_t* apex;
  PseudoFan<D>* fan;
  PseudoFacet<D>* cell;

  /// Computes all D facets of facet j, for few threads: each row is read once.
  CULLHULL_HD void operator()(std::uint32_t j) const {
    const PseudoFacet<D> parent = facet[j];
    double tip[D], at[D][D];
    rows.load(apex[j], tip);
    for (unsigned k = 0; k < D; ++k) {
      rows.load(parent.vertex[k], at[k]);
      fan[j].apex[k] = tip[k];
    }
    for (unsigned i = 0; i < D; ++i) {
      PseudoFacet<D>& child = cell[child_address<D>(facets, j, i)];
      const double* corner[D] = {tip};
      child.vertex[0] = apex[j];
      for (unsigned k = 1; k < D; ++k) {
        child.vertex[k] = parent.vertex[before(i, k)];
        corner[k] = at[before(i, k)];
      }
      make_plane<D>(corner, at[i], fan[j].plane[i]);
    }
  }

  /// Computes only facet i of them, for many threads: no local array is indexed, so that all fit
  /// into registers.
  CULLHULL_HD void one(std::uint32_t j, unsigned i) const {
    const PseudoFacet<D>& parent = facet[j];
    PseudoFacet<D>& child = cell[child_address<D>(facets, j, i)];
    double at[D][D], inner[D];
    const double* corner[D];
    for (unsigned k = 0; k < D; ++k) {
      child.vertex[k] = k == 0 ? apex[j] : parent.vertex[before(i, k)];
      rows.load(child.vertex[k], at[k]);
      corner[k] = at[k];
    }
    rows.load(parent.vertex[i], inner);
    if (i == 0)
      for (unsigned k = 0; k < D; ++k) fan[j].apex[k] = at[0][k];
    make_plane<D>(corner, inner, fan[j].plane[i]);
  }

 private:
  /// Returns which of the parent's vertices is vertex k > 0 of facet i.
  CULLHULL_HD static unsigned before(unsigned i, unsigned k) { return k <= i ? k - 1 : k; }
};

/// Replaces facets in smaller steps: item D j + i computes facet i of facet j.
template <unsigned D, class Rows>
struct ReplaceFacetInParts {
  ReplaceFacet<D, Rows> facet;
  CULLHULL_HD void operator()(std::uint32_t item) const { facet.one(item / D, item % D); }
};

// A point that is proved to be inside of all D new facets is culled: it was outside of the old one,
// so it is in the simplex between. A point that is outside of none, but not proved to be inside of
// all, survives and is not tested again. Of several facets that it is outside of it goes to the
// nearest, the first on ties: any choice is right, and the nearest keeps sets small.

/// Reassigns each exterior point of a facet to the nearest of the new facets it is outside of.
template <unsigned D, class Rows>
struct Reassign {
  Rows rows;
  std::uint32_t facets;
  const ExteriorPoint* points;
  const PseudoFan<D>* fan;
  PlaceArrays arrays;

  CULLHULL_HD Offer operator()(std::uint32_t i) const {
    const ExteriorPoint p = points[i];
    double x[D];
    rows.load(p.row, x);
    const PseudoFan<D>& f = fan[p.facet];
    PlaceSearch search;
    for (unsigned c = 0; c < D; ++c)
      search.offer(child_address<D>(facets, p.facet, c),
                   pseudo_distance<D>(f.plane[c].normal, f.apex, x), f.plane[c].error);
    return arrays.settle(i, p.row, search.result());
  }
};

/// A cell that received a point holds a facet; the others are null.
struct CellHasPoints {
  const std::uint64_t* best;
  CULLHULL_HD bool operator()(std::uint32_t c) const { return best[c] != 0; }
};

/// Compacts the facets.
template <unsigned D>
struct MoveFacet {
  const std::uint64_t* best;
  const std::uint32_t* number;
  const PseudoFacet<D>* cell;
  PseudoFacet<D>* facet;
  std::uint32_t* apex;

  CULLHULL_HD void operator()(std::uint32_t c) const {
    if (best[c] == 0) return;
    facet[number[c]] = cell[c];
    apex[number[c]] = no_item;
  }
};

struct NotCulled {
  const unsigned char* culled;
  CULLHULL_HD bool operator()(std::uint32_t i) const { return culled[i] == 0; }
};

struct HasFacet {
  const std::uint32_t* place;
  CULLHULL_HD bool operator()(std::uint32_t i) const { return place[i] < place_uncertain; }
};

// The apex is found while points move: the point whose distance equals its cell's maximum, bit for
// bit, writes its row by an atomic minimum. So there is no pass of its own for it, and equal
// distances choose the lowest row on every executor.

/// Compacts the points that have a facet; the farthest of each facet becomes its apex, of equally
/// far ones the first row.
template <class Executor>
struct MovePoint {
  std::uint32_t cells;
  const std::uint64_t* best;
  const std::uint32_t* number;
  const std::uint32_t* place;
  const double* distance;
  const ExteriorPoint* from;  ///< null: item i is row i
  ExteriorPoint* to;
  std::uint32_t* apex;

  CULLHULL_HD void operator()(std::uint32_t i, std::uint32_t k) const {
    const bool has_facet = place[i] < place_uncertain;
    const std::uint32_t c = place[i] < cells ? place[i] : cells - 1;
    const std::uint32_t row = from == nullptr ? i : from[i].row;
    to[k] = {row, number[c]};
    if (has_facet & (std::bit_cast<std::uint64_t>(distance[i]) == best[c]))
      Executor::lower(apex[number[c]], row);
  }
};

}  // namespace cullhull::internal
