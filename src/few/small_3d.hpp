// The hull of a few points in space, without dynamic memory: for batches of small sets, and for the
// survivors of larger ones.
#pragma once

#include "result/write/few_triangles.hpp"

namespace cullhull::internal {

/// False for flat sets, for coordinates of extreme magnitude or not finite, and where too many
/// signs need exact arithmetic: the caller must then use another engine.
bool small_hull_3d(const SmallPoints3D& points, unsigned count, SmallHull3D& out);
bool small_hull_3d(const MediumPoints3D& points, unsigned count, MediumHull3D& out);

}  // namespace cullhull::internal
