// The bounding box of points of the plane.
#pragma once

namespace cullhull::internal {

/// Smallest and largest coordinates.
struct Box {
  double low[2], high[2];
};

}  // namespace cullhull::internal
