// Planes of lifted cells, many at a time. With a cell's plane, an in-sphere test is a dot product.
// docs/exactness.md, "Lifting".
#pragma once

#include <cstddef>

namespace cullhull::internal::inline delaunay {

/// The number of cells in one call.
inline constexpr std::size_t lift_block = 8;

/// Computes the planes of lift_block cells in 3 <= k <= 6 dimensions that share a corner o.
/// rows[(i (k + 1) + j) lift_block + cell]: coordinate j of the i-th of the k other corners
/// relative to o; the column of lifts, j = k, is overwritten. planes[j lift_block + cell] receives,
/// for j <= k, cofactor j of the last row of det [rows; q - o, |q - o|^2], so that the determinant
/// is a dot product; for j = k + 1 and k + 2 numbers a and b: if no coordinate of q - o exceeds m
/// in magnitude, the error of the computed dot product is less than (a + b m) m + 2^-1000.
void lift_planes(unsigned k, double* rows, double* planes);

}  // namespace cullhull::internal::inline delaunay
