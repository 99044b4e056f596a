// Finds the outermost point of a set in each cone of directions: a few points whose hull makes a
// quick 3D filter.
//
// Any choice of points is right: the filter proves with the hull of these points that others are
// inside, however they were chosen. Distances in single precision therefore need no bound. Example:
// the cube has 6 * 8^2 = 384 cones; at most so many points are hulled, and all others are tested
// against that hull.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/point_view.hpp"

namespace cullhull::internal {

struct OutermostSettings {
  unsigned cells = 8;  ///< cones along an edge of the cube of directions, of which it has 6 cells^2
  /// The search gives up if more than this share of about a thousand points is nearly as far out as
  /// the outermost point in its direction.
  double most_outside = 1;
};

/// Returns ascending ids of 3D points, at most one for each cone. Distances are approximate: single
/// precision, from the middle of a sample's box. Returns nothing if all points are equal along an
/// axis, coordinates are not finite or span too much, or most points are outside. count < 2^32.
/// Time O(n).
std::vector<std::uint64_t> outermost_points(const PointView& points,
                                            const OutermostSettings& settings);

// The data that the search for the outermost points passes to its kernels.

/// The centre of the directions, and the scale that makes the points' extents similar.
struct OutermostFrame {
  double centre[3], scale[3];
};

struct OutermostBlock {
  static constexpr unsigned size = 64;
  alignas(64) double axes[3][size];
};

}  // namespace cullhull::internal
