// An orientation filter for a dimension known at compile time: doubles, and a bound from the
// largest entries of the columns, which costs less than the permanent of orientation() and decides
// fewer signs. docs/exactness.md, "Orientation filter".
#pragma once

#include <algorithm>
#include <cmath>

#include "exact/determinants/minors.hpp"
#include "exact/orientation/orientation.hpp"

namespace cullhull::internal {

// Example in the plane: c = (0, 0), a = (1, 1), b = (1 + 2^-30, 1). l = 1 and r = 1 + 2^-30, so l -
// r = -9.3e-10; the bound is 6 u * 2 = 1.3e-15: certainly negative. With b = (1 + 2^-52, 1) the
// difference is -2.2e-16, within the bound: the next rung decides. Example in 3D: columns with
// largest entries 1, 1 and 1e-6 (a terrain's heights): the bound is (8 + 6) u * 6 * 1e-6 = 9e-21; a
// scale of 1 on all axes would lose that factor of 1e-6.

/// Computes the sign of the orientation of the K + 1 points p, K >= 2; returns false if doubles
/// cannot decide. `tiny`: more than underflow adds to the determinant. `bounded`: no product of
/// differences can overflow; else coordinates beyond 2^100 are left undecided for K > 2.
/// `exact_limit`: 2^53 units of a lattice that contains the points, in the power of the
/// determinant; up to this product of magnitudes doubles do not round. 0: no such lattice.
template <unsigned K, bool bounded>
inline bool filtered_by_columns(const double* const* p, double tiny, Sign& sign,
                                double exact_limit = 0) {
  double det = 0, bound = 0, products = 0;
  if constexpr (K == 2) {
    const double l = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]);
    const double r = (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);
    // Differences, products and the last difference: 4 roundings on each path, and those of the
    // bound. Overflow makes the bound infinite or the determinant NaN.
    det = l - r;
    products = std::abs(l) + std::abs(r);
    bound = 6 * unit_roundoff * products + tiny;
  } else {
    double m[K][K];
    double largest[K] = {};
    for (unsigned i = 0; i < K; ++i)
      for (unsigned j = 0; j < K; ++j) {
        m[i][j] = p[i + 1][j] - p[0][j];
        largest[j] = std::max(largest[j], std::abs(m[i][j]));
      }
    if (!bounded && !(*std::max_element(largest, largest + K) <= 0x1p100)) return false;
    det = determinant(m);
    // Each product has the roundings of K differences and of the expansion; then those of the
    // bound.
    bound = determinant_bound<K>(largest, minor_roundings(K) + 2 * K, unit_roundoff, tiny);
    products = factorial(K);
    for (const double v : largest) products *= v;
  }
  if (det > bound) {
    sign = Sign::positive;
    return true;
  }
  if (det < -bound) {
    sign = Sign::negative;
    return true;
  }
  if (!(exact_limit > 0 && products <= exact_limit)) return false;
  sign = sign_of(det);  // all terms were whole numbers of units below 2^53
  return true;
}

}  // namespace cullhull::internal
