// In-sphere and power tests: the rungs that are not compiled for one dimension. docs/exactness.md,
// "Lifting".
#pragma once

#include "exact/orientation/orientation.hpp"
#include "exact/points/lifted_points.hpp"

namespace cullhull::internal::inline exact {

/// Sign of det [c_i - c_0, lift(c_i) - lift(c_0)], i = 1 .. k, and the same of p as the last row:
/// which side of the plane of lifted c the lifted point p is on; for a positively oriented cell,
/// negative is below. By integers.
Sign lift_side_exact(const LiftedPoints& s, const double* const* c, const double* p);

/// The same by elimination in doubles, for any k and s.filtered: false if they cannot tell.
bool lift_side_eliminated(const LiftedPoints& s, const double* const* c, const double* p,
                          Sign& sign);

/// Orientation of k + 1 points by elimination in doubles: false if they cannot tell.
bool base_orientation_eliminated(unsigned k, const double* const* p, Sign& sign);

/// `lift_side_exact` by double-doubles where their bound allows, for 2 <= k <= 6 and s.filtered;
/// zero: they cannot tell.
Sign lift_side_double_double(const LiftedPoints& s, const double* const* c, const double* p);

}  // namespace cullhull::internal::inline exact
