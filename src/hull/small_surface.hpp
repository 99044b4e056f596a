// The surface that small_3d makes, and its way to canonical order: coplanar facets merged, none
// sorted.
#pragma once

#include <cstdint>

#include "hull/small_3d.hpp"

namespace cullhull::internal {

/// Simplices, and the one on the left of each directed edge.
struct SmallSurface {
  using Number = std::uint8_t;
  static constexpr unsigned most_points = SmallHull3D::max_points;
  static constexpr unsigned capacity = SmallHull3D::max_facets;
  static constexpr std::uint32_t none = 0xFFFFFFFFU;

  void set(unsigned f, unsigned a, unsigned b, unsigned c) {
    facets[f] = a << 16 | b << 8 | c;
    owner[a][b] = owner[b][c] = owner[c][a] = static_cast<Number>(f);
  }
  static void corners(std::uint32_t facet, unsigned* v) {
    v[0] = facet >> 16, v[1] = facet >> 8 & 0xFF, v[2] = facet & 0xFF;
  }

  unsigned top = 0;                        ///< beyond the last simplex
  std::uint32_t facets[capacity];          ///< a << 16 | b << 8 | c, counter-clockwise, or none
  Number owner[most_points][most_points];  ///< of edges that there are
};

/// Two simplices in one plane that share an edge.
struct CoplanarPair {
  std::uint8_t a, b;
};

/// The facets of a surface as polygons, in no particular order.
struct SmallPolygons {
  using Number = SmallSurface::Number;
  unsigned count = 0;
  unsigned start[SmallSurface::capacity + 1];
  Number corner[SmallHull3D::room];           ///< each from the lowest, counter-clockwise
  Number across[SmallHull3D::room];           ///< the polygon across the edge from that corner
  Number of_simplex[SmallSurface::capacity];  ///< the polygon of each simplex
};

/// Merges coplanar simplices and triangulates what they make from its lowest corner: the surface
/// becomes that of the fans. Vertices that are not extreme are dropped; `names` says what the
/// others are to be called.
void merge_small(SmallSurface& surface, const CoplanarPair* pairs, unsigned pair_count,
                 const std::uint8_t* names, SmallPolygons& polygons);

/// In canonical order, without sorting. `polygons`: as merge_small gives them, or nullptr where
/// every simplex is a facet. Rotates the surface's simplices.
void order_small(SmallSurface& surface, unsigned point_count, const SmallPolygons* polygons,
                 SmallHull3D& out);

}  // namespace cullhull::internal
