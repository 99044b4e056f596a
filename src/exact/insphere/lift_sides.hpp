// In-sphere tests of many cells, a cell in each lane of a vector.
// docs/exactness.md, "Lifting".
#pragma once

#include <cstddef>

namespace cullhull::internal::inline exact {

/// The number of cells per call.
inline constexpr std::size_t sides_block = 8;

/// Evaluates lift_side_double_double() for sides_block cells in 3 <= k <= 6 dimensions, for
/// full-dimensional points without weights. corners[(i k + j) sides_block + cell]: coordinate j of
/// corner i. signs[cell] receives -1 if the point p is below the lifted cell, 1 if it is above, and
/// 0 if double-doubles do not decide. `tiny`: that of LiftedPoints.
void lift_sides_double_double(unsigned k, const double* corners, const double* p, double tiny,
                              double* signs);

/// Computes the determinants of in-sphere tests in doubles for sides_block cells in 2 <= k <= 6
/// dimensions, each with a point of its own, for full-dimensional points without weights. corners:
/// as above; points[j sides_block + cell]: coordinate j of the cell's point. values[cell] receives
/// the determinant, negative if the point is below; products[cell] a number that is at least the
/// sum of the magnitudes of its products, so that values err by less than lift_roundings(k, k)
/// 2^-53 products + tiny, and not at all on a lattice if products is at most exact_limit.
void lift_values(unsigned k, const double* corners, const double* points, double* values,
                 double* products);

}  // namespace cullhull::internal::inline exact
