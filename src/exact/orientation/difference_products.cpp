#include "exact/orientation/difference_products.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "exact/determinants/minors.hpp"
#include "exact/numbers/double_double.hpp"
#include "exact/numbers/exact_float.hpp"

namespace cullhull::internal {
namespace {

// Example: whether r is in the ball over the edge p q asks for the sign of (p - r) . (q - r), one
// list of d products. For p = (0, 0), q = (2, 0) and r = (1, 1) the terms are (-1)(1) + (-1)(-1) =
// 0: on the circle. Doubles that are whole numbers have differences and products without second
// parts, so the zero is exact and no other rung is asked.

/// Computes the sign in double-doubles, whose operations err by less than 2^-101: a term passes 1
/// product and d sums per list entry. Returns zero if undecided. Underflow is negligible in
/// products of magnitudes above 2^-900 or zero.
Sign by_double_doubles(unsigned d, std::span<const DifferenceProduct> terms) {
  DoubleDouble sum;
  double size = 0;
  for (const DifferenceProduct& t : terms)
    for (unsigned j = 0; j < d; ++j) {
      const DoubleDouble x = DoubleDouble::sum(t.a[j], -t.b[j]);
      const DoubleDouble y = DoubleDouble::sum(t.c[j], -t.e[j]);
      const DoubleDouble product = x * y;
      if (product.high == 0 && (x.high == 0 || y.high == 0)) continue;
      if (!(std::abs(product.high) >= 0x1p-900 && std::abs(product.high) <= 0x1p900))
        return Sign::zero;
      sum = t.sign > 0 ? sum + product : sum - product;
      size += std::abs(product.high);
    }
  const double bound = (2.0 * d * static_cast<double>(terms.size()) + 8) * 0x1p-101 * size;
  return sum.high > bound ? Sign::positive : sum.high < -bound ? Sign::negative : Sign::zero;
}

Sign exactly(unsigned d, std::span<const DifferenceProduct> terms) {
  ExactFloat sum;
  for (const DifferenceProduct& t : terms)
    for (unsigned j = 0; j < d; ++j) {
      const ExactFloat product =
          (ExactFloat(t.a[j]) - ExactFloat(t.b[j])) * (ExactFloat(t.c[j]) - ExactFloat(t.e[j]));
      sum = t.sign > 0 ? sum + product : sum - product;
    }
  return sum.zero() ? Sign::zero : sum > ExactFloat() ? Sign::positive : Sign::negative;
}

/// Whether both differences have the same components except for order and signs: this is how
/// lengths are equal on lattices whose coordinates are rounded.
bool same_components(unsigned d, const double* a, const double* b, const double* c,
                     const double* e) {
  using Parts = std::pair<double, double>;
  const auto parts = [](double x, double y) {
    const DoubleDouble v = DoubleDouble::sum(x, -y);
    return v.high < 0 ? Parts(-v.high, -v.low) : Parts(v.high, v.low);
  };
  constexpr unsigned most = 8;  // in higher dimensions exact arithmetic decides
  if (d > most) return false;
  Parts left[most], right[most];
  for (unsigned j = 0; j < d; ++j) {
    left[j] = parts(a[j], b[j]);
    right[j] = parts(c[j], e[j]);
    if (!std::isfinite(left[j].first) || !std::isfinite(right[j].first)) return false;
  }
  std::sort(left, left + d);
  std::sort(right, right + d);
  return std::equal(left, left + d, right);
}

}  // namespace

/// Each product passes 3 roundings and those of the sums, the bound as many.
EstimatedSum estimate_products(unsigned d, std::span<const DifferenceProduct> terms) {
  EstimatedSum sum;
  double size = 0;
  for (const DifferenceProduct& t : terms)
    for (unsigned j = 0; j < d; ++j) {
      const DoubleDouble x = DoubleDouble::sum(t.a[j], -t.b[j]);
      const DoubleDouble y = DoubleDouble::sum(t.c[j], -t.e[j]);
      const DoubleDouble product = DoubleDouble::product(x.high, t.sign * y.high);
      size += std::abs(product.high);
      const DoubleDouble next = DoubleDouble::sum(sum.value, product.high);
      sum.value = next.high;
      // Errors of products are representable in this range.
      const double magnitude = std::abs(product.high);
      const bool plain =
          x.high == 0 || y.high == 0 || (magnitude >= 0x1p-900 && magnitude <= 0x1p900);
      sum.exact =
          sum.exact && plain && x.low == 0 && y.low == 0 && product.low == 0 && next.low == 0;
    }
  const double roundings = 2.0 * d * static_cast<double>(terms.size()) + 10;
  sum.bound = sum.exact ? 0 : roundings * unit_roundoff * size + 0x1p-1000;
  return sum;
}

Sign sign_of_products(unsigned d, std::span<const DifferenceProduct> terms) {
  const EstimatedSum sum = estimate_products(d, terms);
  if (sum.exact) return sign_of(sum.value);
  if (sum.value > sum.bound) return Sign::positive;
  if (sum.value < -sum.bound) return Sign::negative;
  const Sign sign = by_double_doubles(d, terms);
  return sign != Sign::zero ? sign : exactly(d, terms);
}

Sign compare_lengths(unsigned d, const double* a, const double* b, const double* c,
                     const double* e) {
  const DifferenceProduct terms[] = {{1, a, b, a, b}, {-1, c, e, c, e}};
  const EstimatedSum sum = estimate_products(d, terms);
  if (sum.exact) return sign_of(sum.value);
  if (sum.value > sum.bound) return Sign::positive;
  if (sum.value < -sum.bound) return Sign::negative;
  if (same_components(d, a, b, c, e)) return Sign::zero;
  const Sign sign = by_double_doubles(d, terms);
  return sign != Sign::zero ? sign : exactly(d, terms);
}

}  // namespace cullhull::internal
