// In-sphere tests of one point with many cells by double-doubles, a cell in each lane of a vector.
// docs/exactness.md, "Lifting".
#pragma once

#include <cstddef>

namespace cullhull::internal {

/// The number of cells per call.
inline constexpr std::size_t sides_block = 8;

/// Evaluates lift_side_double_double() for sides_block cells in 3 <= k <= 6 dimensions, for
/// full-dimensional points without weights. corners[(i k + j) sides_block + cell]: coordinate j of
/// corner i. signs[cell] receives -1 if the point p is below the lifted cell, 1 if it is above, and
/// 0 if double-doubles do not decide. `tiny`: that of LiftedPoints.
void lift_sides_double_double(unsigned k, const double* corners, const double* p, double tiny,
                              double* signs);

}  // namespace cullhull::internal
