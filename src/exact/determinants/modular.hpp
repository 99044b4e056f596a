// Ranks and signs of determinants of large integer matrices, from their residues modulo primes:
// a prime takes n^3 steps in 32 bits, where elimination in integers multiplies numbers of n
// entries' length. docs/exactness.md, "Many dimensions".
//
// Why residues decide: let |v| <= 2^b be an integer, b a bound of Hadamard's kind. If v is 0 modulo
// primes whose product exceeds 2^b, v is 0. If the product exceeds 2^(b + 1), the residues
// determine v (Chinese remainder theorem), its sign among it. Example: |v| <= 100 and the residues
// 1 (mod 3), 4 (mod 5), 3 (mod 7), 0 (mod 11): v mod 1155 is 1144, that is -11. Primes are just
// below 2^31, so a determinant of 900 bits takes 31 of them, each an elimination in 32-bit
// arithmetic, where GMP would multiply numbers of 900 bits.
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
