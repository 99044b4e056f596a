// The hull of a few points in space, without memory of its own: for batches of small sets.
#pragma once

#include <cstdint>

namespace cullhull::internal {

struct SmallHull3D {
  static constexpr unsigned max_points = 128, max_facets = 2 * max_points;

  unsigned count = 0;  ///< of facets, in no particular order
  /// Counter-clockwise seen from outside; neighbour j is opposite to vertex j.
  std::uint8_t vertices[max_facets][3];
  std::uint8_t neighbours[max_facets][3];
};

/// Finite coordinates of up to max_points points; those beyond the last up to the next multiple of
/// sixteen are read, too: copies of one of the points.
struct SmallPoints3D {
  alignas(64) double axes[3][SmallHull3D::max_points];
};

/// False where a sign that was needed is zero (coplanar or equal points), and for coordinates of odd
/// magnitudes: then another engine must look. If true, no other point is on the boundary and no two
/// facets are coplanar.
bool small_hull_3d(const SmallPoints3D& points, unsigned count, SmallHull3D& out);

}  // namespace cullhull::internal
