// The outermost point of a set in each cone of directions: a few points whose hull makes a quick
// filter in space.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/point_view.hpp"

namespace cullhull::internal::inline filter {

struct OutermostSettings {
  unsigned cells = 8;  ///< cones along an edge of the cube of directions, of which it has 6 cells^2
  /// No answer where more than this share of about a thousand points is nearly as far out as the
  /// outermost in its direction.
  double most_outside = 1;
};

/// Ascending ids of points in space, at most one for each cone. Distances are approximate: single
/// precision, from the middle of a sample's box. Empty where no answer is possible: points all
/// equal along an axis, coordinates that are not finite or span too much, most points outside.
/// count < 2^32. Time O(n).
std::vector<std::uint64_t> outermost_points(const PointView& points,
                                            const OutermostSettings& settings);

// The data that the search for the outermost points passes to its kernels.

/// The centre of the directions, and the scale that makes the points' extents alike.
struct OutermostFrame {
  double centre[3], scale[3];
};

struct OutermostBlock {
  static constexpr unsigned size = 64;
  alignas(64) double axes[3][size];
};

}  // namespace cullhull::internal::inline filter
