// Signs of determinants of integers: in 128 bits if they provably suffice, else by GMP.
#pragma once

#include <gmp.h>

#include <cstddef>
#include <cstdint>
#include <cstdlib>

#include "exact/determinants/minors.hpp"
#include "exact/orientation/orientation.hpp"
#include "exact/planes/exact_plane.hpp"
#include "exact/points/integer_points.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/int128.hpp"

namespace cullhull::internal {

// `Rows` below is a square matrix with columns(); narrow(), whether entries fit 64 bits; small(i,
// j), valid if narrow; and big(i, j, out, scratch), always valid.

// Hadamard without roots: a determinant is a sum of d! products with one entry of each column. If
// entries of column j are below 2^b_j, each product is below 2^(b_1 + ... + b_d) and the sum below
// that times d!. Minors of fewer rows have fewer factors. Example: 3D points on a grid of 2^40 x
// 2^40 x 2^40 units: differences have 40 bits, 3 * 40 + 3 = 123 <= 126, so 128-bit integers decide;
// on a grid of 2^42 units they need GMP.

/// Computes the determinant in 128 bits, if it provably fits: the sum over columns of the bits of
/// the largest entry, plus the bits of d!.
template <unsigned D, class Rows>
bool determinant_128(const Rows& a, Sign& sign) {
  std::int64_t m[D][D];
  int bits = 0;
  for (unsigned j = 0; j < D; ++j) {
    std::uint64_t any = 0;
    for (unsigned i = 0; i < D; ++i) {
      m[i][j] = a.small(i, j);
      any |= static_cast<std::uint64_t>(std::abs(m[i][j]));
    }
    bits += bit_length(any);
  }
  if (bits + factorial_bits[D] > 126) return false;
  Int128 det[1U << D];
  expand_minors<D, false>(m, D, det, static_cast<Int128*>(nullptr));
  const Int128 value = det[(1U << D) - 1];
  sign = value > 0 ? Sign::positive : value < 0 ? Sign::negative : Sign::zero;
  return true;
}

template <class Rows>
bool determinant_128(const Rows& a, Sign& sign) {
  constexpr unsigned most = plane_only ? 4 : 8;
  return a.narrow() && with_dimension<2, most, 0>(a.columns(), [&](auto k) {
           if constexpr (k > 0) return determinant_128<k>(a, sign);
           return false;
         });
}

/// Returns numbers that the thread keeps for reuse.
inline BigNumbers& kept_numbers(std::size_t count) {
  thread_local BigNumbers kept;
  kept.resize(count);
  return kept;
}

// Fraction-free elimination keeps integers: after step k every entry (i, j) is the minor of rows 0
// .. k, i and columns 0 .. k, j, so dividing by the pivot of the step before is exact (Sylvester's
// identity). Example: of [2 1; 4 5] the entry (1, 1) becomes 2 * 5 - 4 * 1 = 6, the determinant
// itself. Numbers grow to the length of minors, not to products of lengths as they would without
// the division.

/// Returns the determinant's sign by fraction-free elimination.
template <class Rows>
Sign determinant_sign_big(const Rows& rows) {
  const unsigned n = rows.columns();
  BigNumbers& m = kept_numbers(std::size_t{n} * n + 1);
  for (unsigned i = 0; i < n; ++i)
    for (unsigned j = 0; j < n; ++j)
      rows.big(i, j, m[std::size_t{i} * n + j], m[std::size_t{n} * n]);
  int sign = 1;
  if (echelon_form(m, n, n, true, nullptr, &sign) < n) return Sign::zero;
  return static_cast<Sign>(sign * mpz_sgn(m[std::size_t{n} * n - 1]));
}

template <class Rows>
Sign determinant_sign(const Rows& a) {
  Sign sign = Sign::zero;
  if (determinant_128(a, sign)) return sign;
  return determinant_sign_big(a);
}

}  // namespace cullhull::internal
