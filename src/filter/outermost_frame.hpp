// The data that the search for the outermost points passes to its kernels.
#pragma once

namespace cullhull::internal::inline filter {

/// The centre of the directions, and the scale that makes the points' extents alike.
struct OutermostFrame {
  double centre[3], scale[3];
};

struct OutermostBlock {
  static constexpr unsigned size = 64;
  alignas(64) double axes[3][size];
};

}  // namespace cullhull::internal::inline filter
