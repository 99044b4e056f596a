// Ranks and signs of determinants of large integer matrices, from their residues modulo primes:
// a prime takes n^3 steps in 32 bits, where elimination in integers multiplies numbers of n
// entries' length. docs/exactness.md, "Many dimensions".
#pragma once

#include "exact/orientation/orientation.hpp"
#include "exact/planes/exact_plane.hpp"

namespace cullhull::internal {

/// From these dimensions on primes take less time than fraction-free elimination.
inline constexpr unsigned ranks_by_primes = 16;
inline constexpr unsigned signs_by_primes = 24;

/// The rank of the matrix with entries m[i * columns + j]. `pivots`, if given, receives the columns
/// of the pivots of its row echelon form, ascending.
unsigned rank_by_primes(BigNumbers& m, unsigned rows, unsigned columns, unsigned* pivots);
/// The sign of the determinant of the n x n matrix with entries m[i * n + j].
Sign determinant_sign_by_primes(BigNumbers& m, unsigned n);

}  // namespace cullhull::internal
