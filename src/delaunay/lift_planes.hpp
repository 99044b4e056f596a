// Planes of lifted cells, many at a time: what an in-sphere test needs of a cell, so that a test is
// a dot product. docs/exactness.md, "Lifting".
#pragma once

#include <cstddef>

namespace cullhull::internal::inline delaunay {

/// Cells of one call.
inline constexpr std::size_t lift_block = 8;

/// Of lift_block cells in 4 <= k <= 6 dimensions that share a corner o: rows[(i (k + 1) + j)
/// lift_block + cell] is coordinate j of corner i, of the k others, seen from o; the column of
/// lifts, j = k, is filled in. planes[j lift_block + cell] becomes cofactor j of a last row, so
/// that det [rows; q - o, |q - o|^2] is the dot product; then, for j = k + 1 and k + 2, numbers a
/// and b: where no coordinate of q - o exceeds m in magnitude, the dot product as computed is off
/// by less than (a + b m) m + 2^-1000.
void lift_planes(unsigned k, double* rows, double* planes);

}  // namespace cullhull::internal::inline delaunay
