// The ladder of in-sphere and power tests, and the rule for ties.
#pragma once

#include <cstdint>

#include "exact/insphere/lift_exact.hpp"
#include "exact/insphere/lift_filter.hpp"
#include "exact/orientation/orientation.hpp"
#include "exact/points/lifted_points.hpp"

namespace cullhull::internal::inline exact {

/// What predicates count: a thread's own.
struct LiftCounts {
  std::uint64_t rungs[3] = {0, 0, 0};
  std::uint64_t ties = 0;

  void add(const LiftCounts& more) {
    for (unsigned r = 0; r < 3; ++r) rungs[r] += more.rungs[r];
    ties += more.ties;
  }
};

/// Which side of the plane through the lifted points c[0 .. k] the lifted point p is on: for a
/// positively oriented cell, negative means below. K: k where it is known early, else 0.
template <unsigned K>
inline Sign lift_side(const LiftedPoints& s, const double* const* c, const double* p,
                      LiftCounts& counts) {
  Sign sign = Sign::zero;
  if (s.filtered) {
    bool known = false;
    if constexpr (K != 0)
      known = lift_side_filtered<K>(s, c, p, sign);
    else
      known = lift_side_eliminated(s, c, p, sign);
    if (known) {
      ++counts.rungs[0];
      return sign;
    }
    sign = lift_side_wide(s, c, p);
    if (sign != Sign::zero) {
      ++counts.rungs[1];
      return sign;
    }
  }
  ++counts.rungs[2];
  return lift_side_exact(s, c, p);
}

/// Orientation of k + 1 points. K as above.
template <unsigned K>
inline Sign base_orientation(const LiftedPoints& s, const double* const* p) {
  if constexpr (K == 2) {
    if (s.filtered) {
      const double ax = p[1][0] - p[0][0], ay = p[1][1] - p[0][1];
      const double bx = p[2][0] - p[0][0], by = p[2][1] - p[0][1];
      const double l = ax * by, r = ay * bx;
      // Differences, products and the last difference: 4 roundings a path, and those of the bound.
      const double det = l - r, bound = 6 * unit_roundoff * (std::abs(l) + std::abs(r)) + s.tiny;
      if (det > bound) return Sign::positive;
      if (det < -bound) return Sign::negative;
    }
  } else if constexpr (K >= 3) {
    if (s.filtered) {
      double m[K][K];
      double largest[K] = {};
      for (unsigned i = 0; i < K; ++i)
        for (unsigned j = 0; j < K; ++j) {
          m[i][j] = p[i + 1][j] - p[0][j];
          largest[j] = std::max(largest[j], std::abs(m[i][j]));
        }
      double det[1U << K];
      expand_minors<K, false>(m, K, det, static_cast<double*>(nullptr));
      // Each of the K! products: K differences, the roundings of the expansion; those of the bound.
      double bound = (minor_roundings(K) + 2 * K) * factorial(K) * unit_roundoff;
      for (unsigned j = 0; j < K; ++j) bound *= largest[j];
      bound += s.tiny;
      if (det[(1U << K) - 1] > bound) return Sign::positive;
      if (det[(1U << K) - 1] < -bound) return Sign::negative;
    }
  }
  if constexpr (K == 0) {
    Sign sign = Sign::zero;
    if (base_orientation_eliminated(s.base, p, sign)) return sign;
  }
  return orientation(s.base, p);
}

}  // namespace cullhull::internal::inline exact
