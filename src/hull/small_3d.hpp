// The hull of a few points in space, without memory of its own: for batches of small sets.
#pragma once

#include <cstdint>

namespace cullhull::internal {

/// Facets in canonical order: each from its lowest vertex, counter-clockwise seen from outside, and
/// ascending. Lists are read a vector at a time, so there is room behind them; the last facet is
/// repeated up to a multiple of eight.
struct SmallHull3D {
  static constexpr unsigned max_points = 128, max_facets = 2 * max_points;
  static constexpr unsigned room = 3 * max_facets + 64;

  double low[3], high[3];  ///< least and largest coordinates
  unsigned count = 0;      ///< of facets
  unsigned vertex_count = 0;
  std::uint8_t ids[max_points];  ///< of the vertices, ascending
  std::uint8_t vertices[room];   ///< three ids a facet
  std::uint8_t opposite[room];   ///< the facets opposite to each of them
  std::uint8_t beside[room];     ///< the facets across the edge from each to the next
};

/// Coordinates of up to max_points points; those beyond the last up to the next multiple of
/// sixteen are read, too: copies of one of the points.
struct SmallPoints3D {
  alignas(64) double axes[3][SmallHull3D::max_points];
};

/// False where a sign that was needed is zero (coplanar or equal points), and for coordinates of
/// odd magnitudes: then another engine must look. If true, no other point is on the boundary and no
/// two facets are coplanar.
bool small_hull_3d(const SmallPoints3D& points, unsigned count, SmallHull3D& out);

}  // namespace cullhull::internal
