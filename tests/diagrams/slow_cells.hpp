// What cells, distances and circumcentres are by definition, in rational numbers.
#pragma once

#include <gmpxx.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "cullhull/triangulation.hpp"
#include "delaunay/brute_triangulation.hpp"
#include "delaunay/lifted_sets.hpp"

namespace cullhull::testing_support {

inline PointView view_of(const LiftedSet& s) {
  return PointView::row_major(s.rows.data(), s.count(), s.dimension);
}

inline Triangulation triangulate(const LiftedSet& s, const TriangulationOptions& o = {}) {
  return s.weights.empty() ? delaunay(view_of(s), o)
                           : regular_triangulation(view_of(s), s.weights, o);
}

inline Rationals rational_row(const double* row, unsigned d) { return Rationals(row, row + d); }
inline Rationals rational_point(const LiftedSet& s, std::uint32_t i) {
  return rational_row(s.rows.data() + std::size_t{i} * s.dimension, s.dimension);
}

/// Solves rows [a | b]; nothing if there is no solution. Unique ones only.
inline std::optional<Rationals> solved(std::vector<Rationals> m, std::size_t unknowns) {
  for (std::size_t c = 0; c < unknowns; ++c) {
    std::size_t p = c;
    while (p < m.size() && m[p][c] == 0) ++p;
    if (p == m.size()) return std::nullopt;
    std::swap(m[p], m[c]);
    for (std::size_t i = 0; i < m.size(); ++i) {
      if (i == c || m[i][c] == 0) continue;
      const mpq_class f = m[i][c] / m[c][c];
      for (std::size_t j = 0; j <= unknowns; ++j) m[i][j] -= f * m[c][j];
    }
  }
  for (std::size_t i = unknowns; i < m.size(); ++i)
    if (m[i][unknowns] != 0) return std::nullopt;
  Rationals x;
  for (std::size_t i = 0; i < unknowns; ++i) x.push_back(m[i][unknowns] / m[i][i]);
  return x;
}

/// Of q in the cell; nothing if q is not in its flat.
inline std::optional<Rationals> slow_barycentric(const LiftedSet& s,
                                                 std::span<const std::uint32_t> cell,
                                                 const Rationals& q) {
  std::vector<Rationals> m;
  std::vector<Rationals> p;
  for (const std::uint32_t v : cell) p.push_back(rational_point(s, v));
  for (unsigned j = 0; j < s.dimension; ++j) {
    Rationals row;
    for (std::size_t i = 1; i < p.size(); ++i) row.push_back(p[i][j] - p[0][j]);
    row.push_back(q[j] - p[0][j]);
    m.push_back(row);
  }
  auto x = solved(m, cell.size() - 1);
  if (!x) return x;
  mpq_class first = 1;
  for (const mpq_class& v : *x) first -= v;
  x->insert(x->begin(), first);
  return x;
}

inline std::uint32_t slow_find(const LiftedSet& s, const Triangulation& t, const Rationals& q) {
  for (std::uint32_t c = 0; c < t.size(); ++c) {
    const auto x = slow_barycentric(s, t.cell(c), q);
    if (x && std::all_of(x->begin(), x->end(), [](const mpq_class& v) { return v >= 0; })) return c;
  }
  return no_index;
}

inline mpq_class slow_power(const LiftedSet& s, std::uint32_t i, const Rationals& q) {
  const Rationals p = rational_point(s, i);
  mpq_class sum = s.weights.empty() ? mpq_class(0) : mpq_class(-s.weights[i]);
  for (unsigned j = 0; j < s.dimension; ++j) sum += (p[j] - q[j]) * (p[j] - q[j]);
  return sum;
}

/// Of all points, hidden ones included: they are never alone nearest, and of several nearest the
/// lowest vertex counts.
inline std::uint32_t slow_nearest(const LiftedSet& s, const Triangulation& t, const Rationals& q) {
  std::uint32_t best = no_index;
  mpq_class least;
  for (std::uint32_t i = 0; i < s.count(); ++i) {
    if (!std::count(t.cells.begin(), t.cells.end(), i)) continue;
    const mpq_class power = slow_power(s, i, q) * (t.furthest_site ? -1 : 1);
    if (best != no_index && power >= least) continue;
    best = i;
    least = power;
  }
  return best;
}

/// Whether v is within `relative` of x times max(|x|, floor).
inline bool near(double v, const mpq_class& x, double relative, const mpq_class& floor = 0) {
  const mpq_class size = abs(x) > floor ? mpq_class(abs(x)) : floor;
  return abs(mpq_class(v) - x) <= mpq_class(relative) * size;
}

/// Whether no double is nearer to x than v is; |x| below 2^1023.
inline bool nearest_to(double v, const mpq_class& x) {
  const mpq_class error = abs(mpq_class(v) - x);
  for (const double other : {std::nextafter(v, -INFINITY), std::nextafter(v, INFINITY)})
    if (abs(mpq_class(other) - x) < error) return false;
  return true;
}

}  // namespace cullhull::testing_support
