// Volumes of polytopes given by halfspaces, in rational numbers.
#pragma once

#include <gmpxx.h>

#include <algorithm>
#include <vector>

#include "diagrams/slow_cells.hpp"

namespace cullhull::testing_support {

/// Rows a, b: a . x <= b. Lasserre's formula (1983): over facets, the facet's volume times its
/// distance from the origin, where each is projected along an axis. BoundedDouble polytopes alone.
inline mpq_class slow_volume(std::vector<Rationals> rows, unsigned d) {
  std::vector<Rationals> kept;
  for (Rationals& r : rows) {
    unsigned j = 0;
    while (j < d && r[j] == 0) ++j;
    if (j == d) {
      if (r[d] < 0) return 0;
      continue;
    }
    const mpq_class unit = abs(r[j]);
    for (mpq_class& v : r) v /= unit;
    if (std::find(kept.begin(), kept.end(), r) == kept.end()) kept.push_back(r);
  }
  if (d == 1) {
    bool any[2] = {false, false};
    mpq_class end[2];
    for (const Rationals& r : kept) {
      const int side = r[0] > 0 ? 1 : 0;
      const mpq_class bound = r[1] / r[0];
      if (!any[side] || (side == 1 ? bound < end[1] : bound > end[0])) end[side] = bound;
      any[side] = true;
    }
    return any[0] && any[1] && end[1] > end[0] ? mpq_class(end[1] - end[0]) : mpq_class(0);
  }
  mpq_class sum = 0;
  for (std::size_t i = 0; i < kept.size(); ++i) {
    const Rationals& f = kept[i];
    unsigned j = 0;
    while (f[j] == 0) ++j;
    if (f[d] == 0) continue;
    std::vector<Rationals> others;
    for (std::size_t o = 0; o < kept.size(); ++o) {
      if (o == i) continue;
      Rationals r;
      const mpq_class factor = kept[o][j] / f[j];
      for (unsigned c = 0; c <= d; ++c)
        if (c != j) r.push_back(kept[o][c] - factor * f[c]);
      others.push_back(std::move(r));
    }
    sum += f[d] / abs(f[j]) * slow_volume(std::move(others), d - 1);
  }
  return sum / d;
}

/// The points of the box (and of further rows) that are at least as near to point i as to all
/// others, duplicates left out.
inline mpq_class slow_cell(const LiftedSet& s, const Triangulation& t, std::uint32_t i,
                           std::vector<Rationals> rows) {
  if (!std::count(t.cells.begin(), t.cells.end(), i)) return 0;
  const unsigned d = s.dimension;
  const Rationals p = rational_point(s, i);
  for (std::uint32_t o = 0; o < s.count(); ++o) {
    if (o == i || std::any_of(t.duplicates.begin(), t.duplicates.end(),
                              [&](const DuplicatePoint& c) { return c.id == o; }))
      continue;
    // |x - p|^2 - w_p <= |x - q|^2 - w_q
    const Rationals q = rational_point(s, o);
    Rationals row;
    mpq_class right = 0;
    for (unsigned j = 0; j < d; ++j) {
      row.push_back(2 * (q[j] - p[j]));
      right += q[j] * q[j] - p[j] * p[j];
    }
    if (!s.weights.empty()) right -= mpq_class(s.weights[o]) - mpq_class(s.weights[i]);
    row.push_back(right);
    if (t.furthest_site)
      for (mpq_class& v : row) v = -v;
    rows.push_back(row);
  }
  return slow_volume(std::move(rows), d);
}

inline std::vector<Rationals> box_rows(const std::vector<double>& low,
                                       const std::vector<double>& high) {
  std::vector<Rationals> rows;
  for (std::size_t j = 0; j < low.size(); ++j)
    for (const int sign : {-1, 1}) {
      Rationals r(low.size() + 1);
      r[j] = sign;
      r[low.size()] = sign * mpq_class(sign < 0 ? low[j] : high[j]);
      rows.push_back(r);
    }
  return rows;
}

}  // namespace cullhull::testing_support
