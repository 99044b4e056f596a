// The centre of a largest ball inside halfspaces.
#pragma once

#include <cstddef>
#include <vector>

#include "parallel/threads/parallel.hpp"

namespace cullhull::internal {

struct Ball {
  std::vector<double> centre;
  double radius = 0;  ///< not positive: doubles found no point inside
};

/// `rows`: count x (d + 1), |a| = 1 and a . x + b <= 0 inside, b of magnitude at most 1 (or 0).
/// Radii are capped, so an unbounded intersection has an answer too. Rounding affects the answer's
/// quality only: the caller checks it.
Ball inscribed_ball(const std::vector<double>& rows, unsigned d, const Control& control);

}  // namespace cullhull::internal
