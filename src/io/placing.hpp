// From the whole numbers of a scan to coordinates: in the world, or on a grid.
#pragma once

#include <optional>
#include <vector>

#include "cullhull/placement.hpp"
#include "io/source.hpp"

namespace cullhull::internal::inline io {

/// Along each axis of a placement a number lies at number * step + origin on the grid, exactly.
struct Multiples {
  std::vector<double> step, origin;
};

/// None where the axes do not lie on the grid, or their numbers of 32 bits might need more than 50
/// there.
std::optional<Multiples> multiples_of(const Placement& placement, const Grid& grid);

/// Replaces the points of a file that has a placement by what `options.numbers` asks for, as
/// doubles, and sets `data.grid`.
void place(PointData& data, const ReadOptions& options);

/// The grid on which place() will put points of this placement; none for the world and for a file's
/// own numbers.
Grid grid_of(const Placement& placement, const ReadOptions& options);

}  // namespace cullhull::internal::inline io
