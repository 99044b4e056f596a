// The sign of a determinant in any dimension, by elimination in doubles, with an error bound found
// afterwards. docs/exactness.md, "Signs by elimination", has the proof.
#pragma once

#include "exact/orientation/orientation.hpp"

namespace cullhull::internal::inline exact {

/// Sign of the determinant of an n x n matrix A, of which `m` holds, row by row, entries as
/// computed: a double's roundoff off, those of the last column also by up to doubt[i]; what
/// underflowed on the way to an entry is below 2^-1060. Both arrays are overwritten. False where
/// doubles cannot tell, or the size or a magnitude is outside the range of the proof. Time: O(n^3).
bool eliminated_sign(unsigned n, double* m, double* doubt, Sign& sign);

}  // namespace cullhull::internal::inline exact
