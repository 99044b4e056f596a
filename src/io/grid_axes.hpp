// From a file's integers to a common grid.
#pragma once

#include <cstddef>
#include <vector>

#include "cullhull/placement.hpp"

namespace cullhull::internal {

/// Converts a file's integers to units of a grid that contains its placement, exactly.
class GridAxes {
 public:
  /// Throws Error{invalid_argument} if the grid does not contain the placement (see common_grid).
  GridAxes(const Placement& placement, const Grid& grid);
  double at(std::size_t axis, double number) const noexcept {
    return number * step_[axis] + origin_[axis];
  }

 private:
  std::vector<double> step_, origin_;
};

}  // namespace cullhull::internal
