// The order in which the engine for d >= 4 takes its points.
#pragma once

#include <cstdint>
#include <vector>

#include "control.hpp"
#include "points/local_points.hpp"

namespace cullhull::internal {

struct InsertionRounds {
  std::vector<std::uint32_t> order;
  std::vector<std::uint32_t> starts;  ///< of each round in `order`, and its end
};

/// Outermost first: by decreasing norm, the points' covariance taken as the unit, which makes few
/// facets that do not last (on a ball 3 to 4 for each that does, in random order 6 to 7). Cut into
/// rounds, each half as large as all before it together, and within a round along a Hilbert curve,
/// so that neighbours in the order are neighbours in space. Points of equal norm come in
/// pseudo-random order. Deterministic. Time O(n d^2).
InsertionRounds norm_order(const LocalPoints& points, unsigned threads, const Control& control);

}  // namespace cullhull::internal
