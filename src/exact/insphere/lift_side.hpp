// The ladder of in-sphere and power tests, and counts of its decisions.
#pragma once

#include <cstdint>

#include "exact/insphere/lift_filter.hpp"
#include "exact/orientation/column_filter.hpp"
#include "exact/orientation/orientation.hpp"
#include "exact/points/local_points.hpp"

namespace cullhull::internal {

/// Counts of one thread's predicates: signs decided by each rung, and ties.
struct LiftCounts {
  std::uint64_t rungs[3] = {0, 0, 0};
  std::uint64_t ties = 0;

  void add(const LiftCounts& more) {
    for (unsigned r = 0; r < 3; ++r) rungs[r] += more.rungs[r];
    ties += more.ties;
  }
};

/// Returns the side of the plane through the lifted points c[0 .. k] on which the lifted point p
/// is: for a positively oriented cell, negative means below. K: k if known at compile time, else 0.
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
    sign = lift_side_double_double(s, c, p);
    if (sign != Sign::zero) {
      ++counts.rungs[1];
      return sign;
    }
  }
  ++counts.rungs[2];
  return lift_side_exact(s, c, p);
}

/// Returns the orientation of k + 1 points. K as above.
template <unsigned K>
inline Sign base_orientation(const LiftedPoints& s, const double* const* p) {
  Sign sign = Sign::zero;
  if constexpr (K == 0) {
    if (base_orientation_eliminated(s.base, p, sign)) return sign;
  } else if constexpr (K >= 2) {
    if (s.filtered && filtered_by_columns<K, true>(p, s.tiny, sign, s.exact_orientation_limit))
      return sign;
  }
  return orientation(s.base, p);
}

}  // namespace cullhull::internal
