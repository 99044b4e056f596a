// Planes of lifted cells, many at a time. With a cell's plane, an in-sphere test is a dot product.
// docs/exactness.md, "Lifting".
#pragma once

#include <cstddef>

namespace cullhull::internal::inline delaunay {

/// The number of cells in one call.
inline constexpr std::size_t lift_block = 8;

/// Bounds the roundings on any path from the coordinates of a cell and a point to the dot product
/// of the cell's plane and the point, those of the bound included. docs/exactness.md, "Planes".
constexpr double plane_roundings(unsigned k) { return 4 * k + 3 + k * (k - 1) / 2; }

/// Computes the planes of lift_block cells in 3 <= k <= 6 dimensions that share a corner o.
/// rows[(i (k + 1) + j) lift_block + cell]: coordinate j of the i-th of the k other corners
/// relative to o, and for j = k the difference of their lifts, if `sizes` is not null; else the
/// lift is the squared distance. sizes[i lift_block + cell]: at least the magnitude of that
/// difference, and its error divided by 2^-52. planes[j lift_block + cell] receives, for j
/// <= k, cofactor j of the last row of det [rows; q - o, lift], so that the determinant is a dot
/// product; for j = k + 1 and k + 2 numbers a and b: if no coordinate of q - o exceeds m in
/// magnitude, the error of the computed dot product is less than a m + b l + 2^-1000, l the squared
/// distance or the size of q's lift, and the sum of the magnitudes of all products of the
/// determinant is less than that divided by plane_roundings(k) 2^-53.
void lift_planes(unsigned k, const double* rows, const double* sizes, double* planes);

}  // namespace cullhull::internal::inline delaunay
