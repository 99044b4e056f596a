// In-sphere and power tests in doubles, with bounds. docs/exactness.md, "Lifting", derives them.
#pragma once

#include <algorithm>
#include <cmath>

#include "exact/determinants/minors.hpp"
#include "exact/orientation/orientation.hpp"
#include "exact/points/lifted_points.hpp"

namespace cullhull::internal::inline exact {

constexpr double factorial(unsigned n) { return n < 2 ? 1 : n * factorial(n - 1); }

/// Error of the determinant of k + 1 rows [differences, lift], if each column's entries are at most
/// largest[j] in magnitude (the lift's: the sum of the magnitudes of its terms) and operations err
/// by `roundoff`. A product of k + 1 entries passes the roundings of the expansion and those of its
/// lift: a difference's twice, a square, d - 1 sums, a weight; the magnitudes and their product add
/// k + d + 4. What underflows adds up to less than `tiny`.
template <unsigned K>
double lift_bound(const double* largest, unsigned d, double roundoff, double tiny) {
  double product = largest[0];
  for (unsigned j = 1; j <= K; ++j) product *= largest[j];
  const double roundings = minor_roundings(K + 1) + 2 * d + K + 10;
  return roundings * roundoff * factorial(K + 1) * product + tiny;
}

/// lift_side by doubles: false if they cannot tell. Only for s.filtered.
template <unsigned K>
inline bool lift_side_filtered(const LiftedPoints& s, const double* const* c, const double* p,
                               Sign& sign) {
  double m[K + 1][K + 1];
  double largest[K + 1] = {};
  const bool plain = s.stride == K;  // neither a flat nor weights
  for (unsigned i = 0; i <= K; ++i) {
    const double* q = i < K ? c[i + 1] : p;
    double lift = 0;
    for (unsigned j = 0; j < K; ++j) {
      const double v = q[j] - c[0][j];
      m[i][j] = v;
      largest[j] = std::max(largest[j], std::abs(v));
      lift += v * v;
    }
    double magnitude = lift;
    if (!plain) {
      for (unsigned j = K; j < s.width; ++j) {
        const double v = q[j] - c[0][j];
        lift += v * v;
      }
      magnitude = lift;
      if (s.weighted) {
        const double w = q[s.width] - c[0][s.width];
        lift -= w;
        magnitude += std::abs(w);
      }
    }
    m[i][K] = lift;
    largest[K] = std::max(largest[K], magnitude);
  }
  double det[1U << (K + 1)];
  expand_minors<K + 1, false>(m, K + 1, det, static_cast<double*>(nullptr));
  const double value = det[(1U << (K + 1)) - 1];
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
    sign = sign_of(value);  // all of it was whole numbers of units below 2^53
  }
  if (s.furthest) sign = -sign;
  return true;
}

}  // namespace cullhull::internal::inline exact
