// Elimination in rational numbers, for all slow references. Shares nothing with the library.
#pragma once

#include <gmpxx.h>

#include <optional>
#include <utility>
#include <vector>

namespace cullhull::testing_support {

using Rationals = std::vector<mpq_class>;

/// Reduced row echelon form, but for the pivots, which stay as they are; their columns. With its
/// sign for exchanges their product is the determinant.
inline std::vector<unsigned> echelon(std::vector<Rationals>& m, mpq_class* determinant = nullptr) {
  std::vector<unsigned> pivots;
  mpq_class product = 1;
  const std::size_t columns = m.empty() ? 0 : m[0].size();
  for (unsigned c = 0; c < columns && pivots.size() < m.size(); ++c) {
    const std::size_t r = pivots.size();
    std::size_t p = r;
    while (p < m.size() && m[p][c] == 0) ++p;
    if (p == m.size()) {
      product = 0;
      continue;
    }
    if (p != r) product = -product;
    std::swap(m[p], m[r]);
    product *= m[r][c];
    for (std::size_t i = 0; i < m.size(); ++i) {
      if (i == r || m[i][c] == 0) continue;
      const mpq_class f = m[i][c] / m[r][c];
      for (std::size_t j = c; j < columns; ++j) m[i][j] -= f * m[r][j];
    }
    pivots.push_back(c);
  }
  if (determinant != nullptr) *determinant = pivots.size() < m.size() ? mpq_class(0) : product;
  return pivots;
}

/// Solves rows [a | b]; nothing if there is no solution or more than one.
inline std::optional<Rationals> solved(std::vector<Rationals> m, std::size_t unknowns) {
  const std::vector<unsigned> pivots = echelon(m);
  if (pivots.size() != unknowns || (unknowns > 0 && pivots.back() == unknowns)) return std::nullopt;
  Rationals x;
  for (std::size_t i = 0; i < unknowns; ++i) x.push_back(m[i][unknowns] / m[i][i]);
  return x;
}

}  // namespace cullhull::testing_support
