// What the search for the outermost points hands to its kernels.
#pragma once

namespace cullhull::internal {

/// Where directions are seen from, and what makes the points' extents alike.
struct OutermostFrame {
  double centre[3], scale[3];
};

struct OutermostBlock {
  static constexpr unsigned size = 64;
  alignas(64) double axes[3][size];
};

}  // namespace cullhull::internal
