// The surfaces that small_3d makes, and their conversion to canonical order: coplanar facets
// merged, without comparison sorts.
#pragma once

#include <cstdint>

#include "few/small_3d.hpp"

namespace cullhull::internal {

/// Simplices, and a table of the simplex on the left of each directed edge: for few points.
struct TableSurface {
  using Hull = SmallHull3D;
  using Number = Hull::Number;
  static constexpr unsigned most_points = Hull::max_points, capacity = Hull::max_facets;
  static constexpr bool linked = false;
  static constexpr std::uint32_t none = 0xFFFFFFFFU;

  void set(unsigned f, unsigned a, unsigned b, unsigned c) {
    facets[f] = a << 16 | b << 8 | c;
    owner[a][b] = owner[b][c] = owner[c][a] = static_cast<Number>(f);
  }
  bool live(unsigned f) const { return facets[f] != none; }
  void remove(unsigned f) { facets[f] = none; }
  void corners(unsigned f, unsigned* v) const {
    v[0] = facets[f] >> 16, v[1] = facets[f] >> 8 & 0xFF, v[2] = facets[f] & 0xFF;
  }
  /// The simplex across the edge from v[j] to the next, v the corners of f.
  unsigned across(unsigned, const unsigned* v, unsigned j) const {
    return owner[v[j == 2 ? 0 : j + 1]][v[j]];
  }

  unsigned top = 0;                        ///< number of slots in use
  std::uint32_t facets[capacity];          ///< a << 16 | b << 8 | c, counter-clockwise, or none
  Number owner[most_points][most_points];  ///< on the left of edge (a, b), if it exists
};

/// Simplices with links to their neighbours: for more points than a table in the cache can hold.
struct LinkedSurface {
  using Hull = MediumHull3D;
  using Number = Hull::Number;
  static constexpr unsigned most_points = Hull::max_points, capacity = Hull::max_facets;
  static constexpr bool linked = true;
  static constexpr Number none = 0xFFFF;

  struct Facet {
    Number corner[3];     ///< counter-clockwise; the first is none in an unused slot
    Number neighbour[3];  ///< across the edge from each corner to the next
  };

  /// The caller sets the neighbours.
  void set(unsigned f, unsigned a, unsigned b, unsigned c) {
    facets[f].corner[0] = static_cast<Number>(a);
    facets[f].corner[1] = static_cast<Number>(b);
    facets[f].corner[2] = static_cast<Number>(c);
  }
  bool live(unsigned f) const { return facets[f].corner[0] != none; }
  void remove(unsigned f) { facets[f].corner[0] = none; }
  void corners(unsigned f, unsigned* v) const {
    for (unsigned j = 0; j < 3; ++j) v[j] = facets[f].corner[j];
  }
  unsigned across(unsigned f, const unsigned*, unsigned j) const { return facets[f].neighbour[j]; }
  void join(unsigned f, unsigned j, unsigned g, unsigned k) {
    facets[f].neighbour[j] = static_cast<Number>(g);
    facets[g].neighbour[k] = static_cast<Number>(f);
  }

  unsigned top = 0;  ///< number of slots in use
  Facet facets[capacity];
};

/// Two adjacent coplanar simplices.
template <class Surface>
struct CoplanarPair {
  typename Surface::Number a, b;
};

/// The facets of a surface as polygons, in any order.
template <class Surface>
struct MergedFacets {
  using Number = typename Surface::Number;
  unsigned count = 0;
  unsigned start[Surface::capacity + 1];
  Number corner[Surface::Hull::room];    ///< each from the lowest, counter-clockwise
  Number across[Surface::Hull::room];    ///< the polygon across the edge from that corner
  Number of_simplex[Surface::capacity];  ///< the polygon of each simplex
};

/// Merges coplanar simplices and triangulates the facets as fans from their lowest corner: the
/// surface becomes that of the fans. Vertices that are not extreme are removed; `names` maps the
/// others to ids.
template <class Surface>
void merge_small(Surface& surface, const CoplanarPair<Surface>* pairs, unsigned pair_count,
                 const typename Surface::Number* names, MergedFacets<Surface>& polygons);

/// Writes the surface in canonical order, without comparison sorts. `polygons`: as merge_small
/// gives them, or nullptr where every simplex is a facet. Rotates the surface's simplices.
template <class Surface>
void order_small(Surface& surface, unsigned point_count, const MergedFacets<Surface>* polygons,
                 typename Surface::Hull& out);

}  // namespace cullhull::internal
