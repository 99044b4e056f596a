// Double-doubles that carry a bound of their error along.
#pragma once

#include <gmpxx.h>

#include <cmath>

#include "geometry/double_double.hpp"

namespace cullhull::internal {

/// The exact number is within `error` of `value`. Operations of double-doubles err by less than
/// 2^-101 relatively, and by 2^-1000 where something underflows; factors of 1 + 2^-40 cover the
/// roundings of the bounds themselves. What overflows makes a bound that is not finite.
struct Tracked {
  DoubleDouble value;
  double error = 0;

  Tracked() = default;
  Tracked(double v) : value(v) {}  // NOLINT: every double is one
  static Tracked difference(double a, double b) { return {DoubleDouble::sum(a, -b), 0}; }

  friend Tracked operator+(const Tracked& a, const Tracked& b) {
    const DoubleDouble v = a.value + b.value;
    return {v, (a.error + b.error + 0x1p-100 * std::abs(v.high)) * grow};
  }
  friend Tracked operator-(const Tracked& a) { return {-a.value, a.error}; }
  friend Tracked operator-(const Tracked& a, const Tracked& b) { return a + -b; }
  friend Tracked operator*(const Tracked& a, const Tracked& b) {
    const DoubleDouble v = a.value * b.value;
    const double x = std::abs(a.value.high), y = std::abs(b.value.high);
    return {v, (x * b.error + y * a.error + a.error * b.error + 0x1p-100 * x * y) * grow + tiny};
  }
  friend Tracked operator/(const Tracked& a, const Tracked& b) {
    const double y = std::abs(b.value.high);
    if (!(y > 2 * b.error)) return {DoubleDouble(), INFINITY};
    const DoubleDouble v = a.value / b.value;
    const double x = std::abs(v.high);
    return {v, ((a.error + x * b.error) / (y - b.error) + 0x1p-97 * x) * grow + tiny};
  }

 private:
  static constexpr double grow = 1 + 0x1p-40, tiny = 0x1p-1000;
  Tracked(DoubleDouble v, double e) : value(v), error(e) {}
};

/// a - b as a number of either kind.
template <class Real>
Real exact_difference(double a, double b);
template <>
inline Tracked exact_difference<Tracked>(double a, double b) {
  return Tracked::difference(a, b);
}
template <>
inline mpq_class exact_difference<mpq_class>(double a, double b) {
  return mpq_class(mpq_class(a) - mpq_class(b));
}

}  // namespace cullhull::internal
