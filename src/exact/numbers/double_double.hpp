// Double-doubles: unevaluated sums of two doubles with |low| <= u |high|, u = 2^-53; about 104
// bits. Error bounds relative to the result, barring overflow and underflow: sums 3 u^2 + 13 u^3,
// products 7 u^2, quotients 16 u^2 (Joldes, Muller and Popescu, "Tight and rigorous error bounds
// for basic building blocks of double-word arithmetic", 2017).
#pragma once

#include <cmath>

#include "parallel/host_device.hpp"

namespace cullhull::internal {

struct DoubleDouble {
  double high = 0, low = 0;

  DoubleDouble() = default;
  CULLHULL_HD DoubleDouble(double v) : high(v) {}  // NOLINT: every double is one
  CULLHULL_HD DoubleDouble(double h, double l) : high(h), low(l) {}
  CULLHULL_HD double value() const { return high + low; }

  // Example: sum(1, 2^-60) is {1, 2^-60}: 1 + 2^-60 rounds to 1, and what was lost is a double
  // again. The six operations find it whatever the order of magnitudes is.

  /// Returns a + b exactly (Knuth).
  static CULLHULL_HD DoubleDouble sum(double a, double b) {
    const double s = a + b;
    const double t = s - a;
    return {s, (a - (s - t)) + (b - t)};
  }
  // Veltkamp splits a into a high part of 26 bits and the rest by 2^27 + 1 = 134217729; products of
  // parts are exact. Example: product(1 + 2^-30, 1 + 2^-30) is {1 + 2^-29, 2^-60}. Splitting
  // overflows beyond 2^996.

  /// Returns a * b exactly (Dekker, Veltkamp), barring overflow and underflow.
  static CULLHULL_HD DoubleDouble product(double a, double b) {
    const double p = a * b;
    const double ta = 134217729.0 * a, tb = 134217729.0 * b;
    const double ah = ta - (ta - a), bh = tb - (tb - b);
    const double al = a - ah, bl = b - bh;
    return {p, ((ah * bh - p) + ah * bl + al * bh) + al * bl};
  }
  CULLHULL_HD DoubleDouble operator-() const { return {-high, -low}; }
  friend CULLHULL_HD DoubleDouble operator+(DoubleDouble a, DoubleDouble b) {
    DoubleDouble s = sum(a.high, b.high);
    const DoubleDouble t = sum(a.low, b.low);
    s = quick(s.high, s.low + t.high);
    return quick(s.high, s.low + t.low);
  }
  friend CULLHULL_HD DoubleDouble operator-(DoubleDouble a, DoubleDouble b) { return a + -b; }
  friend CULLHULL_HD DoubleDouble operator*(DoubleDouble a, DoubleDouble b) {
    const DoubleDouble p = product(a.high, b.high);
    return quick(p.high, p.low + (a.high * b.low + a.low * b.high));
  }
  friend CULLHULL_HD DoubleDouble operator/(DoubleDouble a, DoubleDouble b) {
    const double q1 = a.high / b.high;
    DoubleDouble rest = a - b * DoubleDouble(q1);
    const double q2 = rest.high / b.high;
    rest = rest - b * DoubleDouble(q2);
    return quick(q1, q2) + DoubleDouble(rest.high / b.high);
  }

 private:
  static CULLHULL_HD DoubleDouble quick(double a, double b) {
    const double s = a + b;
    return {s, b - (s - a)};
  }
};

}  // namespace cullhull::internal
