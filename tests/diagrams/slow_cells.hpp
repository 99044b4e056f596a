// What cells, distances and circumcentres are by definition, in rational numbers.
#pragma once

#include <gmpxx.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <vector>

#include "cullhull/triangulation.hpp"
#include "delaunay/brute_triangulation.hpp"
#include "delaunay/lifted_sets.hpp"

namespace cullhull::testing_support {

inline Rationals rational_row(const double* row, unsigned d) { return Rationals(row, row + d); }
inline Rationals rational_point(const LiftedSet& s, std::uint32_t i) {
  return rational_row(s.rows.data() + std::size_t{i} * s.dimension, s.dimension);
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

inline mpq_class dot(const Rationals& a, const Rationals& b) {
  mpq_class sum = 0;
  for (std::size_t j = 0; j < a.size(); ++j) sum += a[j] * b[j];
  return sum;
}
inline Rationals minus(const Rationals& a, const Rationals& b) {
  Rationals r;
  for (std::size_t j = 0; j < a.size(); ++j) r.push_back(a[j] - b[j]);
  return r;
}

/// p_0 and a mixture of edges with equal powers to all corners.
inline Rationals slow_centre(const LiftedSet& s, std::span<const std::uint32_t> cell) {
  std::vector<Rationals> edges, m;
  const Rationals from = rational_point(s, cell[0]);
  for (std::size_t i = 1; i < cell.size(); ++i)
    edges.push_back(minus(rational_point(s, cell[i]), from));
  for (std::size_t i = 0; i < edges.size(); ++i) {
    Rationals row;
    for (const Rationals& e : edges) row.push_back(dot(edges[i], e));
    mpq_class lift = dot(edges[i], edges[i]);
    if (!s.weights.empty())
      lift -= mpq_class(s.weights[cell[i + 1]]) - mpq_class(s.weights[cell[0]]);
    row.emplace_back(lift / 2);
    m.push_back(row);
  }
  const Rationals shares = *solved(m, edges.size());
  Rationals centre = from;
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (std::size_t j = 0; j < centre.size(); ++j) centre[j] += shares[i] * edges[i][j];
  return centre;
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
