// The sign of a determinant in any dimension, by elimination in doubles, with an error bound found
// afterwards. docs/exactness.md, "Signs by elimination", has the proof.
#pragma once

#include "exact/orientation/orientation.hpp"

namespace cullhull::internal {

/// Computes the sign of the determinant of an n x n matrix A. `m` contains A's entries row by row
/// as computed: each within a double's roundoff, those of the last column also within doubt[i];
/// underflow on the way to an entry is below 2^-1060. Both arrays are overwritten. Returns false if
/// doubles cannot decide, or the size or a magnitude is outside the range of the proof. Time:
/// O(n^3).
bool eliminated_sign(unsigned n, double* m, double* doubt, Sign& sign);

}  // namespace cullhull::internal
