// The hull of a few points in space, without memory of its own: for batches of small sets, and for
// what a filter leaves of larger ones.
#pragma once

#include <cstdint>
#include <type_traits>

namespace cullhull::internal {

/// Simplices and facets in canonical order: simplices from their lowest vertex, counter-clockwise
/// seen from outside, and ascending. Lists are read a vector at a time, so there is room behind
/// them; the last simplex is repeated up to a multiple of eight.
template <unsigned most>
struct SmallHull {
  static constexpr unsigned max_points = most, max_facets = 2 * max_points;
  static constexpr unsigned room = 3 * max_facets + 64;
  /// Of a point or a facet.
  using Number = std::conditional_t<(max_facets <= 256), std::uint8_t, std::uint16_t>;

  double low[3], high[3];  ///< least and largest coordinates
  unsigned count = 0;      ///< of simplices
  unsigned facet_count = 0;
  unsigned vertex_count = 0;
  Number ids[max_points];  ///< of the vertices, ascending
  Number vertices[room];   ///< three ids a simplex
  Number opposite[room];   ///< the simplices opposite to each of them
  Number beside[room];     ///< the facets across the edge from each corner to the next

  bool simplicial() const { return facet_count == count; }
  /// Where they are not one simplex each: the facets' numbers of corners, their corners as in
  /// `beside`, and the facet of each simplex.
  Number facet_size[max_facets];
  Number corners[room];
  Number facet_of[room];
};
/// Everything in the first cache.
using SmallHull3D = SmallHull<128>;
/// As many as are held against all facets sooner than a facet that they see is searched, where few
/// of them are vertices for long.
using MediumHull3D = SmallHull<2048>;

/// Coordinates of up to `most` points; those beyond the last up to the next multiple of sixteen
/// are read, too: copies of one of the points.
template <unsigned most>
struct SmallPoints {
  alignas(64) double axes[3][most];
};
using SmallPoints3D = SmallPoints<SmallHull3D::max_points>;
using MediumPoints3D = SmallPoints<MediumHull3D::max_points>;

/// False for flat sets, for coordinates of odd magnitudes or that are not finite, and where too
/// many signs take long: then another engine must look.
bool small_hull_3d(const SmallPoints3D& points, unsigned count, SmallHull3D& out);
bool small_hull_3d(const MediumPoints3D& points, unsigned count, MediumHull3D& out);

}  // namespace cullhull::internal
