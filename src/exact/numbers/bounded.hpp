// Numbers that carry an error bound: double-doubles and doubles.
#pragma once

#include <cmath>

#include "cullhull/error.hpp"
#include "exact/numbers/double_double.hpp"
#include "exact/numbers/gmpxx.hpp"
#include "exact/orientation/orientation.hpp"

namespace cullhull::internal {

/// Throws Error{invalid_argument}. Simplices of triangulations have a volume, so their determinants
/// are not zero; those from outside may be wrong.
[[noreturn]] inline void flat_simplex() {
  throw Error(ErrorCode::invalid_argument,
              "this is no triangulation of these points: a cell is flat");
}

/// Returns x. Throws like flat_simplex() if it is zero and of GMP's numbers, whose division by zero
/// ends the process; other numbers become infinite or NaN.
template <class Real>
const Real& divisor(const Real& x) {
  if constexpr (requires { x.is_zero(); }) {
    if (x.is_zero()) flat_simplex();
  } else if constexpr (requires { sgn(x); }) {
    if (sgn(x) == 0) flat_simplex();
  }
  return x;
}

// How bounds propagate: with |a - A| <= s and |b - B| <= t the exact A B is within |a| t + |b| s +
// s t of a b, to which the rounding of the product is added; quotients need |b| > 2 t, so that B is
// not near 0. Example: a = 3 and b = 2, both within 1e-20: the product is 6 within (3 + 2) 1e-20 +
// 1e-40. A sign is certain if |value| > error.

/// A double-double with a bound: the exact number is within `error` of `value`. Operations err by
/// less than 2^-101 relatively, and by 2^-1000 if something underflows; factors of 1 + 2^-40 cover
/// the roundings of the bounds themselves. Overflow makes the bound infinite or NaN.
struct BoundedDoubleDouble {
  DoubleDouble value;
  double error = 0;

  BoundedDoubleDouble() = default;
  BoundedDoubleDouble(double v) : value(v) {}  // NOLINT: every double is one
  BoundedDoubleDouble(DoubleDouble v, double e) : value(v), error(e) {}
  static BoundedDoubleDouble difference(double a, double b) {
    return {DoubleDouble::sum(a, -b), 0};
  }

  friend BoundedDoubleDouble operator+(const BoundedDoubleDouble& a, const BoundedDoubleDouble& b) {
    const DoubleDouble v = a.value + b.value;
    return {v, (a.error + b.error + 0x1p-100 * std::abs(v.high)) * grow};
  }
  friend BoundedDoubleDouble operator-(const BoundedDoubleDouble& a) { return {-a.value, a.error}; }
  friend BoundedDoubleDouble operator-(const BoundedDoubleDouble& a, const BoundedDoubleDouble& b) {
    return a + -b;
  }
  friend BoundedDoubleDouble operator*(const BoundedDoubleDouble& a, const BoundedDoubleDouble& b) {
    const DoubleDouble v = a.value * b.value;
    const double x = std::abs(a.value.high), y = std::abs(b.value.high);
    return {v, (x * b.error + y * a.error + a.error * b.error + 0x1p-100 * x * y) * grow + tiny};
  }
  friend BoundedDoubleDouble operator/(const BoundedDoubleDouble& a, const BoundedDoubleDouble& b) {
    const double y = std::abs(b.value.high);
    if (!(y > 2 * b.error)) return {DoubleDouble(), INFINITY};
    const DoubleDouble v = a.value / b.value;
    const double x = std::abs(v.high);
    return {v, ((a.error + x * b.error) / (y - b.error) + 0x1p-97 * x) * grow + tiny};
  }

 private:
  static constexpr double grow = 1 + 0x1p-40, tiny = 0x1p-1000;
};

/// A double with a bound; operations err by 2^-53 relatively: the cheap first try.
struct BoundedDouble {
  double value = 0, error = 0;

  BoundedDouble() = default;
  BoundedDouble(double v) : value(v) {}  // NOLINT: every double is one
  BoundedDouble(double v, double e) : value(v), error(e) {}

  friend BoundedDouble operator+(const BoundedDouble& a, const BoundedDouble& b) {
    const double v = a.value + b.value;
    return {v, (a.error + b.error + 0x1p-53 * std::abs(v)) * grow};
  }
  friend BoundedDouble operator-(const BoundedDouble& a) { return {-a.value, a.error}; }
  friend BoundedDouble operator-(const BoundedDouble& a, const BoundedDouble& b) { return a + -b; }
  friend BoundedDouble operator*(const BoundedDouble& a, const BoundedDouble& b) {
    const double v = a.value * b.value, x = std::abs(a.value), y = std::abs(b.value);
    return {v,
            (x * b.error + y * a.error + a.error * b.error + 0x1p-53 * std::abs(v)) * grow + tiny};
  }
  friend BoundedDouble operator/(const BoundedDouble& a, const BoundedDouble& b) {
    const double y = std::abs(b.value), v = a.value / b.value, x = std::abs(v);
    if (!(y > 2 * b.error)) return {0, INFINITY};
    return {v, ((a.error + x * b.error) / (y - b.error) + 0x1p-53 * x) * grow + tiny};
  }

 private:
  static constexpr double grow = 1 + 0x1p-40, tiny = 0x1p-1000;
};

/// Returns the exact number's sign; zero if the bound does not decide it.
inline Sign certain_sign(const BoundedDoubleDouble& v) {
  const double high = v.value.high;
  if (!std::isfinite(high) || !std::isfinite(v.value.low)) return Sign::zero;
  return high > v.error ? Sign::positive : high < -v.error ? Sign::negative : Sign::zero;
}

// Example: value 1 + 2^-60 and error 2^-70: both ends round to 1. Value 1 + 2^-53 and error 2^-70:
// the lower end rounds to 1, the upper one to 1 + 2^-52, so a rational number has to decide.

/// Whether everything within the error rounds to the same double (Ziv 1991), which `out` receives.
inline bool rounds_alike(const BoundedDoubleDouble& v, double& out) {
  const auto [high, low] = v.value;
  const double doubt = v.error * (1 + 0x1p-40) + 0x1p-100 * std::abs(low);
  out = high + (low + doubt);
  return std::isfinite(out) && out == high + (low - doubt);
}

/// Returns a - b as a number of either kind.
template <class Real>
Real exact_difference(double a, double b);
template <>
inline BoundedDoubleDouble exact_difference<BoundedDoubleDouble>(double a, double b) {
  return BoundedDoubleDouble::difference(a, b);
}
template <>
inline BoundedDouble exact_difference<BoundedDouble>(double a, double b) {
  return BoundedDouble(a) - BoundedDouble(b);
}
template <>
inline mpq_class exact_difference<mpq_class>(double a, double b) {
  return mpq_class(mpq_class(a) - mpq_class(b));
}

}  // namespace cullhull::internal
