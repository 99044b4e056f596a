// The normal of a simplex by cofactors, with the error bound that makes its sign certain.
#pragma once

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "parallel/host_device.hpp"

namespace cullhull::internal {

#define CULLHULL_MATH CULLHULL_HD_INLINE
#include "exact/determinants/cofactors-inl.hpp"
#undef CULLHULL_MATH

/// The error bound of a K x K determinant of rounded differences, evaluated by `cofactors` and a
/// dot product: |computed - exact| <= determinant_error(K) * prod_i max|row i|, plus
/// `determinant_tiny` for underflow where |differences| <= 2. Each of the K! products includes K
/// rounded differences and, at level j = 2 ... K, one multiplication and at most j - 1 additions: K
/// + K(K+1)/2 - 1 factors (1 + u); 1.01 covers the higher powers and the rounding of the bound
/// itself.
constexpr double determinant_error(unsigned k) {
  double products = 1;
  for (unsigned i = 2; i <= k; ++i) products *= i;
  return 1.01 * (k + k * (k + 1) / 2.0 - 1) * products * 0x1p-53;
}
// Example: K = 3 gives 1.01 * (3 + 6 - 1) * 6 u = 5.4e-15. A triangle with edges of length 1
// decides the side of every point that is farther than about 5e-15 from its plane; a triangle with
// edges of 1e-3 decides from about 5e-15 as well, as its normal (area 1e-6) and its bound both
// shrink with the edges' product.

/// Covers underflow: K! 2^K products, K <= 8, each off by at most K 2^-1074: below 2^-1048.
inline constexpr double determinant_tiny = 0x1p-1000;

/// Computes the cofactor normal of the simplex with corners at(0) ... at(K - 1), K doubles each,
/// and returns its reach: the computed normal . (x - corner 0) is within reach * max|x - corner 0|
/// + determinant_tiny of exact.
template <unsigned K, class At>
double normal_and_reach(const At& at, double (&normal)[K]) {
  double edges[K > 1 ? K - 1 : 1][K];
  double reach = determinant_error(K);
  const double* origin = at(0);
  for (unsigned i = 1; i < K; ++i) {
    const double* p = at(i);
    double largest = 0;
    for (unsigned c = 0; c < K; ++c) {
      edges[i - 1][c] = p[c] - origin[c];
      largest = std::max(largest, std::fabs(edges[i - 1][c]));
    }
    reach *= largest;
  }
  cofactors<K>(edges, normal);
  return reach;
}

}  // namespace cullhull::internal
