// In-sphere and power tests in doubles, with bounds. docs/exactness.md, "Lifting", derives them.
//
// Example in the plane: the cell (0, 0), (1, 0), (0, 1) and p = (0.9, 0.9). The rows relative to
// the first corner are (1, 0 | 1), (0, 1 | 1) and (0.9, 0.9 | 1.62), the determinant is 1.62 - 0.9
// - 0.9 = -0.18: negative, so p is inside of the circle. Column maxima 1, 1 and 1.62 give the bound
// lift_roundings(2, 2) u * 6 * 1.62 = 2.6e-14. p = (1, 1) gives exactly 0: the four points are on
// one circle, and as all numbers are whole, 6 * 1 * 1 * 2 is far below 2^53 units, so the zero is
// exact (s.exact_limit) and a tie.
//
// The count of roundings: a product of the expansion meets minor_roundings(k + 1) roundings, in
// which each entry counts one for its difference. Where the entry is a lift it meets 2 d + 2 more:
// both factors of a square have the error of the difference (one was counted), d squares are
// rounded, then d - 1 sums and a weight. The maxima are of computed values, and their product is
// rounded k + 1 times: k + 8 in all.
#pragma once

#include <algorithm>
#include <cmath>

#include "exact/determinants/minors.hpp"
#include "exact/numbers/double_double.hpp"
#include "exact/orientation/orientation.hpp"
#include "exact/points/local_points.hpp"

namespace cullhull::internal {

/// Relative error of one operation of DoubleDouble: 7 u^2 for products, 3 u^2 for sums (Joldes,
/// Muller, Popescu 2017), with room for second-order terms.
inline constexpr double double_double_roundoff = 0x1p-102;

/// Bounds the roundings on any path of the determinant of k + 1 rows [differences, lift], d squares
/// in a lift, those of the bound included. A product passes the roundings of the expansion and
/// those of its lift: a difference's twice, a square, d - 1 sums, a weight; the magnitudes and
/// their product add k + d + 4.
constexpr double lift_roundings(unsigned k, unsigned d) {
  return minor_roundings(k + 1) + 2 * d + k + 10;
}

/// Bounds the error of that determinant; largest[K]: the largest sum of the magnitudes of a lift's
/// terms.
template <unsigned K>
double lift_bound(const double* largest, unsigned d, double roundoff, double tiny) {
  return determinant_bound<K + 1>(largest, lift_roundings(K, d), roundoff, tiny);
}

inline double lift_difference(double a, double b, double) { return a - b; }
inline DoubleDouble lift_difference(double a, double b, DoubleDouble) {
  return DoubleDouble::sum(a, -b);
}
inline double magnitude_of(double v) { return std::abs(v); }
inline double magnitude_of(const DoubleDouble& v) { return std::abs(v.high); }

/// Computes the matrix of an in-sphere or power test, in numbers of one kind: rows c_1 - c_0, ...,
/// c_k - c_0, p - c_0, each with the difference of the lifts |x|^2 - w as its last entry; and the
/// largest magnitudes of its columns.
template <unsigned K, class Real>
inline void lifted_rows(const LiftedPoints& s, const double* const* c, const double* p,
                        Real (&m)[K + 1][K + 1], double* largest) {
  const bool plain = s.stride == K;  // neither a flat nor weights
  for (unsigned i = 0; i <= K; ++i) {
    const double* q = i < K ? c[i + 1] : p;
    Real lift = 0;
    for (unsigned j = 0; j < K; ++j) {
      const Real v = lift_difference(q[j], c[0][j], Real());
      m[i][j] = v;
      largest[j] = std::max(largest[j], magnitude_of(v));
      lift = lift + v * v;
    }
    double magnitude = magnitude_of(lift);
    if (!plain) {
      for (unsigned j = K; j < s.width; ++j) {
        const Real v = lift_difference(q[j], c[0][j], Real());
        lift = lift + v * v;
      }
      magnitude = magnitude_of(lift);
      if (s.weighted) {
        const Real w = lift_difference(q[s.width], c[0][s.width], Real());
        lift = lift - w;
        magnitude += magnitude_of(w);
      }
    }
    m[i][K] = lift;
    largest[K] = std::max(largest[K], magnitude);
  }
}

/// Evaluates lift_side in doubles; returns false if they cannot decide. Only if s.filtered.
template <unsigned K>
inline bool lift_side_filtered(const LiftedPoints& s, const double* const* c, const double* p,
                               Sign& sign) {
  double m[K + 1][K + 1];
  double largest[K + 1] = {};
  lifted_rows<K>(s, c, p, m, largest);
  const double value = determinant(m);
  const double bound = lift_bound<K>(largest, s.width, unit_roundoff, s.tiny);
  if (value > bound) {
    sign = Sign::positive;
  } else if (value < -bound) {
    sign = Sign::negative;
  } else {
    double product = factorial(K + 1);
    for (unsigned j = 0; j <= K; ++j) product *= largest[j];
    // Without a lattice nothing is exact, not even a product that underflows to 0.
    if (!(s.exact_limit > 0 && product <= s.exact_limit)) return false;
    sign = sign_of(value);  // all terms were whole numbers of units below 2^53
  }
  if (s.furthest) sign = -sign;
  return true;
}

// Example: points on the unit sphere, rounded to doubles, are within about 1e-16 of it. Their lifts
// |p - o|^2 differ from an affine function of p by as little, and squares of about 1 are rounded by
// as much: they decide nothing. Powers are those small differences themselves, with errors of 2^-94
// = 5e-29.

/// Bounds the magnitude of the difference of two powers (LiftedPoints::powers) and 2^52 times its
/// error. docs/exactness.md, "Common spheres".
inline double power_size(double a, double b) {
  return std::abs(a) + std::abs(b) + 4 * LiftedPoints::power_error / unit_roundoff;
}

/// Evaluates lift_side in doubles with powers as lifts, for the cell of the points c and the point
/// p, by place; returns false if they cannot decide. Only if s.powers is not empty.
template <unsigned K>
inline bool lift_side_by_powers(const LiftedPoints& s, const std::uint32_t* c, std::uint32_t p,
                                Sign& sign) {
  double m[K + 1][K + 1];
  double largest[K + 1] = {};
  const double *origin = s.row(c[0]), power = s.powers[c[0]];
  for (unsigned i = 0; i <= K; ++i) {
    const std::uint32_t v = i < K ? c[i + 1] : p;
    for (unsigned j = 0; j < K; ++j) {
      m[i][j] = s.row(v)[j] - origin[j];
      largest[j] = std::max(largest[j], std::abs(m[i][j]));
    }
    m[i][K] = s.powers[v] - power;
    largest[K] = std::max(largest[K], power_size(s.powers[v], power));
  }
  const double value = determinant(m), bound = lift_bound<K>(largest, K, unit_roundoff, s.tiny);
  sign = sign_of(value);
  return std::abs(value) > bound;
}

// In-sphere and power tests: the rungs whose dimension is a run-time value. docs/exactness.md,
// "Lifting".

/// Returns the sign of the determinant with rows [c_i - c_0, lift(c_i) - lift(c_0)], i = 1 .. k,
/// and [p - c_0, lift(p) - lift(c_0)], by integers: the side of the plane through the lifted c on
/// which the lifted p is; for a positively oriented cell, negative is below.
Sign lift_side_exact(const LiftedPoints& s, const double* const* c, const double* p);

/// Does the same by elimination in doubles, for any k if s.filtered; returns false if they cannot
/// decide.
bool lift_side_eliminated(const LiftedPoints& s, const double* const* c, const double* p,
                          Sign& sign);

/// Orientation of k + 1 points by elimination in doubles; returns false if they cannot decide.
bool base_orientation_eliminated(unsigned k, const double* const* p, Sign& sign);

/// Evaluates `lift_side_exact` in double-doubles, for 2 <= k <= 6 if s.filtered; returns zero if
/// they cannot decide.
Sign lift_side_double_double(const LiftedPoints& s, const double* const* c, const double* p);

}  // namespace cullhull::internal
