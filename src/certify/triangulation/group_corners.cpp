#include "certify/triangulation/group_corners.hpp"

#include <gmpxx.h>

#include <algorithm>
#include <map>
#include <utility>
#include <vector>

namespace cullhull::internal::certify {
namespace {

using Vector = std::vector<mpq_class>;

/// Brings rows to echelon form; returns the rank. `pivots`: the pivots' columns.
std::size_t eliminate(std::vector<Vector>& rows, std::size_t columns,
                      std::vector<std::size_t>& pivots) {
  pivots.clear();
  std::size_t rank = 0;
  for (std::size_t c = 0; c < columns && rank < rows.size(); ++c) {
    std::size_t p = rank;
    while (p < rows.size() && rows[p][c] == 0) ++p;
    if (p == rows.size()) continue;
    std::swap(rows[p], rows[rank]);
    for (std::size_t r = 0; r < rows.size(); ++r) {
      if (r == rank || rows[r][c] == 0) continue;
      const mpq_class factor = rows[r][c] / rows[rank][c];
      for (std::size_t j = c; j < columns; ++j) rows[r][j] -= factor * rows[rank][j];
    }
    pivots.push_back(c);
    ++rank;
  }
  return rank;
}

/// A vector orthogonal to k - 1 independent rows of k columns.
Vector normal_to(std::vector<Vector> rows, std::size_t k) {
  std::vector<std::size_t> pivots;
  eliminate(rows, k, pivots);
  std::size_t open = 0;
  while (std::count(pivots.begin(), pivots.end(), open) > 0) ++open;
  Vector n(k);
  n[open] = 1;
  for (std::size_t r = 0; r < pivots.size(); ++r)
    n[pivots[r]] = -rows[r][open] / rows[r][pivots[r]];
  return n;
}

}  // namespace

bool GroupCorners::corner(std::uint32_t v, const std::vector<std::uint32_t>& cells) const {
  const std::size_t k = t_.corners() - 1;
  std::vector<Vector> normals;
  for (const std::uint32_t c : cells)
    for (unsigned j = 0; j <= k; ++j) {
      const std::uint32_t o = t_.neighbours_of(c)[j];
      if (t_.cell(c)[j] == v || (o != no_cell && t_.group(o) == t_.group(c))) continue;
      std::vector<Vector> edges;
      for (unsigned i = 0; i <= k; ++i) {
        const std::uint32_t u = t_.cell(c)[i];
        if (i == j || u == v) continue;
        Vector edge(k);
        for (std::size_t a = 0; a < k; ++a) edge[a] = mpq_class(row_(u)[a]) - mpq_class(row_(v)[a]);
        edges.push_back(std::move(edge));
      }
      normals.push_back(normal_to(std::move(edges), k));
    }
  std::vector<std::size_t> pivots;
  return eliminate(normals, k, pivots) == k;
}

std::optional<std::uint32_t> GroupCorners::first_that_is_none(const Run& run) const {
  std::vector<std::uint32_t> size(t_.size());
  for (const std::uint32_t g : t_.cell_groups) ++size[g];
  // A vertex of a group with one cell is a corner of it.
  std::vector<bool> proved(t_.point_count);
  for (std::uint64_t c = 0; c < t_.size(); ++c)
    if (size[t_.cell_groups[c]] == 1)
      for (const std::uint32_t v : t_.cell(c)) proved[v] = true;
  std::map<std::uint32_t, std::vector<std::uint32_t>> cells;  // of each vertex's first group
  for (std::uint32_t c = 0; c < t_.size(); ++c)
    for (const std::uint32_t v : t_.cell(c)) {
      if (proved[v]) continue;
      auto& list = cells[v];
      if (list.empty() || t_.cell_groups[list[0]] == t_.cell_groups[c]) list.push_back(c);
    }
  for (const auto& [v, list] : cells) {
    run.check();
    if (!corner(v, list)) return v;
  }
  return std::nullopt;
}

}  // namespace cullhull::internal::certify
