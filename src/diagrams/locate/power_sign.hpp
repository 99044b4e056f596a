// Which of two points is nearer to a third one, by power distances, exactly.
#pragma once

#include <cmath>

#include "exact/determinants/minors.hpp"
#include "exact/numbers/exact_float.hpp"
#include "exact/orientation/difference_products.hpp"
#include "exact/orientation/orientation.hpp"

namespace cullhull::internal {

inline Sign power_sign_exact(unsigned d, const double* q, const double* a, const double* b) {
  ExactFloat exact;
  for (unsigned j = 0; j < d; ++j) {
    const ExactFloat x(q[j]), from_a = ExactFloat(a[j]) - x, from_b = ExactFloat(b[j]) - x;
    exact = exact + (from_a * from_a - from_b * from_b);
  }
  exact = exact - (ExactFloat(a[d]) - ExactFloat(b[d]));
  return exact.zero() ? Sign::zero : exact > ExactFloat() ? Sign::positive : Sign::negative;
}

/// The sign of (|q - a|^2 - w_a) - (|q - b|^2 - w_b), for any finite doubles. `weighted`: a[d] and
/// b[d] are the weights; otherwise there are none.
///
/// Computed as the sum of (a - b) ((a - q) + (b - q)) minus the difference of the weights. Each
/// product has at most 5 roundings, relative to the product of its factors' magnitudes; d + 1 sums
/// follow. The bound has as many roundings again. After an overflow it is not finite, and nothing
/// is above it.
inline Sign power_sign(unsigned d, bool weighted, const double* q, const double* a,
                       const double* b) {
  double sum = 0, size = 0;
  for (unsigned j = 0; j < d; ++j) {
    const double across = a[j] - b[j], from_a = a[j] - q[j], from_b = b[j] - q[j];
    sum += across * (from_a + from_b);
    size += std::abs(across) * (std::abs(from_a) + std::abs(from_b));
  }
  if (weighted) {
    sum -= a[d] - b[d];
    size += std::abs(a[d] - b[d]);
  }
  const double bound = (2.0 * d + 16) * unit_roundoff * size + 0x1p-1000;
  if (sum > bound) return Sign::positive;
  if (sum < -bound) return Sign::negative;
  return weighted ? power_sign_exact(d, q, a, b) : compare_lengths(d, a, q, b, q);
}

}  // namespace cullhull::internal
