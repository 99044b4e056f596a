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

/// `rows`: count <= max_points rows of three finite coordinates and one that is not read. False
/// where a sign that was needed is zero or hidden by rounding (coplanar or equal points, slivers),
/// and for coordinates of odd magnitudes: then another engine must look. If true, no four of the
/// hull's vertices that decide a ridge are coplanar and no other point is on the boundary.
bool small_hull_3d(const double (*rows)[4], unsigned count, SmallHull3D& out);

}  // namespace cullhull::internal
