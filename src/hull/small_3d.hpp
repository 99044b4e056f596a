// The hull of a few points in space, without memory of its own: for batches of small sets.
#pragma once

#include <cstdint>

namespace cullhull::internal {

/// Simplices and facets in canonical order: simplices from their lowest vertex, counter-clockwise
/// seen from outside, and ascending. Lists are read a vector at a time, so there is room behind
/// them; the last simplex is repeated up to a multiple of eight.
struct SmallHull3D {
  static constexpr unsigned max_points = 128, max_facets = 2 * max_points;
  static constexpr unsigned room = 3 * max_facets + 64;

  double low[3], high[3];  ///< least and largest coordinates
  unsigned count = 0;      ///< of simplices
  unsigned facet_count = 0;
  unsigned vertex_count = 0;
  std::uint8_t ids[max_points];  ///< of the vertices, ascending
  std::uint8_t vertices[room];   ///< three ids a simplex
  std::uint8_t opposite[room];   ///< the simplices opposite to each of them
  std::uint8_t beside[room];     ///< the facets across the edge from each corner to the next

  bool simplicial() const { return facet_count == count; }
  /// Where they are not one simplex each: the facets' numbers of corners, their corners as in
  /// `beside`, and the facet of each simplex.
  std::uint8_t facet_size[max_facets];
  std::uint8_t corners[room];
  std::uint8_t facet_of[room];
};

/// Coordinates of up to max_points points; those beyond the last up to the next multiple of
/// sixteen are read, too: copies of one of the points.
struct SmallPoints3D {
  alignas(64) double axes[3][SmallHull3D::max_points];
};

/// False for flat sets, for coordinates of odd magnitudes or that are not finite, and where too
/// many signs take long: then another engine must look.
bool small_hull_3d(const SmallPoints3D& points, unsigned count, SmallHull3D& out);

}  // namespace cullhull::internal
