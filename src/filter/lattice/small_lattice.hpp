// A filter for points of space on a small lattice of whole numbers.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/point_view.hpp"

namespace cullhull::internal {

/// Of the points on a line parallel to an axis only the two ends can be extreme; of equal points
/// only the first counts. Where coordinates are whole and take few values, finds the points that
/// are ends of all three lines through them, ascending; `ids` is overwritten by the thread's next
/// call. False, quickly, elsewhere, and for less than 128 or more than four million points.
bool ends_in_small_lattice(const PointView& points, const std::vector<std::uint64_t>*& ids);

}  // namespace cullhull::internal
