// Planes of lifted cells, many at a time. With a cell's plane, an in-sphere test is a dot product.
// docs/exactness.md, "Lifting".
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "exact/determinants/minors.hpp"

namespace cullhull::internal {

/// The number of cells in one call.
inline constexpr std::size_t lift_block = 8;

/// Bounds the roundings on any path from the coordinates of a cell and a point to the dot product
/// of the cell's plane and the point, those of the bound included. docs/exactness.md, "Planes".
constexpr double plane_roundings(unsigned k) { return 4 * k + 3 + k * (k - 1) / 2; }

/// Computes the planes of lift_block cells in 2 <= k <= 6 dimensions, each relative to a corner o.
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

/// A plane's value at a point, and the bound of its error.
struct PlaneSide {
  double value, bound;
};
/// Evaluates a plane of lift_planes(), with lifts that are squared distances, at a point. `normal`:
/// its K + 1 cofactors; `linear`, `square`: a and b; `origin`: the corner; `tiny`: that of
/// LiftedPoints.
template <unsigned K>
[[gnu::always_inline]] inline PlaneSide plane_side(const double* normal, double linear,
                                                   double square, const double* origin,
                                                   const double* point, double tiny) {
  double lift = 0, value = 0, most = 0;
  for (unsigned j = 0; j < K; ++j) {
    const double v = point[j] - origin[j];
    most = std::max(most, std::abs(v));
    lift += v * v;
    value += normal[j] * v;
  }
  value += normal[K] * lift;
  return {value, linear * most + square * lift + tiny};
}
// The bound is plane_roundings u times the sum of the magnitudes of all products, so a sum of at
// most exact_limit shows as a bound of at most plane_roundings u exact_limit; 0.99 covers the
// rounding of the bound. Example, in units of a raster in space: cells of neighbours have sums of
// about 100, far below 2^53: their zeros are exact.

/// Up to this bound no product or sum of the determinant is rounded, so that the value is exact.
/// `exact_limit`: that of LiftedPoints; 0, and so is the result, if there is no lattice.
inline double exact_plane_bound(unsigned k, double exact_limit) {
  return 0.99 * plane_roundings(k) * unit_roundoff * exact_limit;
}

}  // namespace cullhull::internal
