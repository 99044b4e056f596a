// Determinants by expansion over column subsets: the arithmetic that the filters, the cached planes
// and the fixed-width exact rung share.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <type_traits>
#include <utility>

#include "parallel/host_device.hpp"

namespace cullhull::internal {

/// Unit roundoff of double.
inline constexpr double unit_roundoff = 0x1p-53;

// Example: one of the six products of a 3 x 3 determinant of differences meets the roundings of
// three differences and two products, and then at most one addition on level 2 and two on level 3:
// 3 + 2 + 3 = 8. With differences of about 1 the six magnitudes add up to about 6, so the computed
// determinant is off by at most 8 u * 6 = 5e-15: a value of 1e-14 has a certain sign, one of 1e-15
// has not.

/// Bounds the roundings on any path of expand_minors over D x D differences: D differences, D - 1
/// products, k - 1 additions at each level k. docs/exactness.md, "Expansion of minors".
constexpr double minor_roundings(unsigned d) {
  return static_cast<double>(d + (d - 1) + d * (d - 1) / 2);
}

/// Computes minor `mask` of expand_minors, with unrolled loops.
template <unsigned D, bool Permanent, unsigned mask, class T, class Entry>
CULLHULL_HD_INLINE void expand_minor(const Entry (*m)[D], unsigned rows, T* det, T* perm) {
  constexpr auto size = static_cast<unsigned>(std::popcount(mask));
  if (size > rows) return;
  const Entry* row = m[size - 1];
  T sum{}, bound{};
  unsigned k = 0;  // number of the mask's columns before j
  const auto term = [&]<unsigned j>(std::integral_constant<unsigned, j>) {
    if constexpr ((mask >> j & 1U) != 0) {
      const T product = T(row[j]) * det[mask ^ (1U << j)];
      const bool negative = ((size - 1 + k) & 1U) != 0;
      sum = k == 0 ? (negative ? -product : product) : negative ? sum - product : sum + product;
      if constexpr (Permanent) {
        const T magnitude = std::abs(T(row[j])) * perm[mask ^ (1U << j)];
        bound = k == 0 ? magnitude : bound + magnitude;
      }
      ++k;
    }
  };
  [&]<unsigned... j>(std::integer_sequence<unsigned, j...>) {
    (term(std::integral_constant<unsigned, j>()), ...);
  }
  (std::make_integer_sequence<unsigned, D>());
  det[mask] = sum;
  if constexpr (Permanent) perm[mask] = bound;
}

/// Computes all minors of the first `rows` rows of a matrix with D columns, expanded along the last
/// row: det[mask] is the determinant of rows 0 .. popcount(mask)-1 on the columns in `mask`, with
/// columns ascending. `perm`, if Permanent, receives the permanents of |entries|, computed by the
/// same additions. T is double or a signed integer wide enough for the largest minor.
template <unsigned D, bool Permanent, class T, class Entry>
CULLHULL_HD void expand_minors(const Entry (*m)[D], unsigned rows, T* det, T* perm) {
  constexpr unsigned full = 1U << D;
  det[0] = T(1);
  if constexpr (Permanent) perm[0] = T(1);
#ifdef __CUDA_ARCH__
  constexpr unsigned most_unrolled = D;  // minors stay in registers, which cannot be indexed
#else
  constexpr unsigned most_unrolled = 5;
#endif
  if constexpr (D <= most_unrolled) {
    [&]<unsigned... k>(std::integer_sequence<unsigned, k...>) {
      (expand_minor<D, Permanent, k + 1>(m, rows, det, perm), ...);
    }
    (std::make_integer_sequence<unsigned, full - 1>());
  } else {
    for (unsigned mask = 1; mask < full; ++mask) {
      const unsigned size = static_cast<unsigned>(std::popcount(mask));
      if (size > rows) continue;
      const Entry* row = m[size - 1];
      T sum{}, bound{};
      bool first = true;
      bool negative = ((size - 1) & 1U) != 0;  // sign of the lowest column: (-1)^(size-1)
      for (unsigned rest = mask; rest != 0; rest &= rest - 1) {
        const unsigned j = static_cast<unsigned>(std::countr_zero(rest));
        const T product = T(row[j]) * det[mask ^ (1U << j)];
        if (first) {
          sum = negative ? -product : product;
        } else {
          sum = negative ? sum - product : sum + product;
        }
        if constexpr (Permanent) {
          const T magnitude = std::abs(T(row[j])) * perm[mask ^ (1U << j)];
          bound = first ? magnitude : bound + magnitude;
        }
        first = false;
        negative = !negative;
      }
      det[mask] = sum;
      if constexpr (Permanent) perm[mask] = bound;
    }
  }
}

/// Returns the determinant of N rows by expand_minors.
template <unsigned N, class Real>
inline Real determinant(const Real (&m)[N][N]) {
  Real det[1U << N];
  expand_minors<N, false>(m, N, det, static_cast<Real*>(nullptr));
  return det[(1U << N) - 1];
}

constexpr double factorial(unsigned n) { return n < 2 ? 1 : n * factorial(n - 1); }
/// Exponents such that n! <= 2^factorial_bits[n], n <= 8.
inline constexpr int factorial_bits[] = {0, 0, 1, 3, 5, 7, 10, 13, 16};

// Why a bound from column maxima holds: each of the N! products has one entry of each column, so
// its magnitude is at most the product of the largest entries, and the sum of all magnitudes at
// most N! times that. A path with r roundings multiplies its product by factors (1 + d_1) ... (1 +
// d_r) with |d_i| <= u. The bound costs N products where the permanent costs an expansion, and
// exceeds it by a small factor for points in general position. Example: a 3 x 3 matrix with rows
// (1, 0, 0), (0, 1, 0), (0, 0, 1e-9) has the permanent 1e-9 and the bound 6 * 1e-9.

/// Returns an error bound for a determinant of N rows whose entries in column j are at most
/// largest[j] in magnitude. Each of its N! products passes `roundings` of relative size `roundoff`,
/// those of this bound included. Underflow adds up to less than `tiny`.
template <unsigned N>
inline double determinant_bound(const double* largest, double roundings, double roundoff,
                                double tiny) {
  double product = largest[0];
  for (unsigned j = 1; j < N; ++j) product *= largest[j];
  return roundings * roundoff * factorial(N) * product + tiny;
}

/// Computes the cofactor normal of K - 1 rows, and the sums of the absolute values of its terms.
template <unsigned K>
void normal_and_spread(const double (*rows)[K], double* normal, double* spread) {
  constexpr unsigned full = (1U << K) - 1;
  double det[full + 1], perm[full + 1];
  expand_minors<K, true>(rows, K - 1, det, perm);
  for (unsigned c = 0; c < K; ++c) {
    const double minor = det[full & ~(1U << c)];
    normal[c] = ((K - 1 + c) & 1U) != 0 ? -minor : minor;
    spread[c] = perm[full & ~(1U << c)];
  }
}

}  // namespace cullhull::internal
