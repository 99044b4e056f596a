// Rational numbers that are rounded to doubles once, at the end.
#pragma once

#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "exact/numbers/gmpxx.hpp"

namespace cullhull::internal {

/// Returns the nearest double, ties to even; infinity beyond the range.
inline double nearest_double(const mpq_class& x) {
  if (x == 0) return 0;
  const mpq_class size = abs(x);
  // 2^(e - 1) <= size < 2^(e + 1)
  const auto bits = [](const mpz_class& v) {
    return static_cast<long>(mpz_sizeinbase(v.get_mpz_t(), 2));
  };
  long e = bits(size.get_num()) - bits(size.get_den());
  if (e > 1026) return sgn(x) * std::numeric_limits<double>::infinity();
  // Units in which a double of this size has 53 bits, but at least 2^-1074.
  const auto scaled = [&](long unit) {
    mpq_class q;
    if (unit >= 0)
      mpq_div_2exp(q.get_mpq_t(), size.get_mpq_t(), static_cast<mp_bitcnt_t>(unit));
    else
      mpq_mul_2exp(q.get_mpq_t(), size.get_mpq_t(), static_cast<mp_bitcnt_t>(-unit));
    return q;
  };
  if (scaled(e) < 1) --e;  // now 2^e <= size < 2^(e + 1)
  const long unit = e - 52 < -1074 ? -1074 : e - 52;
  const mpq_class q = scaled(unit);
  mpz_class whole = q.get_num() / q.get_den();
  const mpq_class rest = q - whole;
  const int half = cmp(rest, mpq_class(1, 2));
  if (half > 0 || (half == 0 && mpz_odd_p(whole.get_mpz_t()) != 0)) ++whole;
  return sgn(x) * std::ldexp(whole.get_d(), static_cast<int>(unit));
}

using RationalRows = std::vector<std::vector<mpq_class>>;

// Example: the rows [1 2 | 5] and [3 4 | 11] become [1 0 | 1] and [0 -2 | -4]: the solution is (1,
// 2), each entry a quotient of its row.

/// Gauss-Jordan elimination: clears all but one entry of each of the first `columns` columns; row r
/// keeps that of column r. Returns false, with the rows partly cleared, if a column depends on
/// those before.
inline bool eliminate(RationalRows& m, std::size_t columns) {
  mpq_class factor, term;
  for (std::size_t c = 0; c < columns; ++c) {
    std::size_t pivot = c;
    while (pivot < m.size() && sgn(m[pivot][c]) == 0) ++pivot;
    if (pivot >= m.size()) return false;
    std::swap(m[pivot], m[c]);
    for (std::size_t i = 0; i < m.size(); ++i) {
      if (i == c || sgn(m[i][c]) == 0) continue;
      factor = m[i][c] / m[c][c];
      for (std::size_t j = c; j < m[i].size(); ++j) {
        term = factor * m[c][j];
        m[i][j] -= term;
      }
    }
  }
  return true;
}

/// Solves the square system whose rows end with their right-hand sides; the last column becomes the
/// solution. Returns false unless there is exactly one.
inline bool solve(RationalRows& m) {
  const std::size_t n = m.size();
  if (!eliminate(m, n)) return false;
  for (std::size_t i = 0; i < n; ++i) m[i][n] /= m[i][i];
  return true;
}

/// Whether the system, with at least as many rows as unknowns, has exactly one solution and that
/// has no negative component. Overwrites the rows.
inline bool solves_without_negatives(RationalRows& m) {
  const std::size_t n = m.empty() ? 0 : m[0].size() - 1;
  if (!eliminate(m, n)) return false;
  for (std::size_t i = n; i < m.size(); ++i)
    if (sgn(m[i][n]) != 0) return false;
  for (std::size_t k = 0; k < n; ++k)
    if (sgn(m[k][n]) * sgn(m[k][k]) < 0) return false;
  return true;
}

}  // namespace cullhull::internal
