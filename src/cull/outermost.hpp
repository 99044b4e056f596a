// The points of a set that are farthest out, each in its own cone of directions: the few that a
// filter of points in space is soon made of.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/point_view.hpp"

namespace cullhull::internal {

struct OutermostSettings {
  unsigned cells = 8;  ///< cones along an edge of the cube of directions, of which it has 6 cells^2
  /// Where of some thousand points more than this share are nearly as far out as any in their
  /// direction, there is no answer.
  double most_outside = 1;
};

/// Ascending ids of points in space, at most one for each cone: what is far is told roughly, in
/// single precision, from somewhere in the middle. Empty where there is none to tell: points all
/// equal along an axis, coordinates that are not finite or span too much, most points outside.
/// count < 2^32. Time O(n).
std::vector<std::uint64_t> outermost_points(const PointView& points,
                                            const OutermostSettings& settings);

}  // namespace cullhull::internal
