// Redundant vertices of a regular triangulation.
#include <algorithm>

#include "delaunay/triangulate.hpp"
#include "delaunay/write_triangulation.hpp"
#include "exact/numbers/gmpxx.hpp"
#include "exact/numbers/rationals.hpp"
#include "parallel/adjacency.hpp"
#include "parallel/index.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {
namespace {

class Redundancy {
 public:
  Redundancy(const LiftedPoints& s, const Triangulation& t)
      : s_(s), t_(t), places_(places_of_ids(s, t.point_count)) {}

  // Example in the plane without perturbation: lifted points (0, 0 | 0), (2, 0 | 0), (0, 2 | 0) and
  // v = (1, 1 | 0), a power triangulation whose weights make all lifts 0. v lies on the edge
  // between two others: perturbed, it may be a vertex, but it is no extreme point. The planes at v
  // are one plane (z = 0), with the wall over the hull's edge x + y = 2 a second normal: rank 2 of
  // 3, so v is redundant. At (0, 0 | 0) there are the plane and the two walls x = 0 and y = 0: rank
  // 3, extreme.

  /// Whether v is not an extreme point of the lifted points. It is extreme if and only if the
  /// normals of the lower hull's planes at the lifted vertex, together with those of the vertical
  /// planes over the hull's facets at v, have full rank. `cells`, `facets`: all that contain v.
  bool redundant(std::uint32_t v, std::span<const std::uint32_t> cells,
                 std::span<const std::uint32_t> facets) const {
    RationalRows normals;
    const auto spans_all = [&](std::uint32_t cell, std::span<const std::uint32_t> facet) {
      normals.push_back(normal(v, t_.cell(cell), facet));
      if (normals.size() < t_.corners()) return false;
      RationalRows rows = normals;
      return eliminate(rows, t_.corners());
    };
    std::vector<std::uint32_t> groups;
    for (const std::uint32_t c : cells) {
      if (std::count(groups.begin(), groups.end(), t_.group(c)) > 0) continue;
      groups.push_back(t_.group(c));
      if (spans_all(c, {})) return false;
    }
    return std::none_of(facets.begin(), facets.end(), [&](std::uint32_t f) {
      return spans_all(t_.hull_cells[f], t_.hull_facet(f));
    });
  }

 private:
  /// The normal of the plane through the lifted corners of a cell, v among them, or if there is a
  /// facet, of the vertical plane over it: the solution of a system with an equation for each edge
  /// at v. The vertical plane's has the sum 1 with the edge that leaves the facet.
  std::vector<mpq_class> normal(std::uint32_t v, std::span<const std::uint32_t> cell,
                                std::span<const std::uint32_t> facet) const {
    RationalRows rows;
    for (const std::uint32_t u : cell) {
      if (u == v) continue;
      rows.push_back(difference(u, v));
      if (!facet.empty()) rows.back().back() = place_in(facet, u) == facet.size() ? 1 : 0;
    }
    solve(rows);
    std::vector<mpq_class> n;
    for (const auto& row : rows) n.push_back(row.back());
    n.emplace_back(facet.empty() ? -1 : 0);
    return n;
  }
  /// Lifted point u minus lifted point v, exact.
  std::vector<mpq_class> difference(std::uint32_t u, std::uint32_t v) const {
    const double *p = s_.row(places_[u]), *o = s_.row(places_[v]);
    std::vector<mpq_class> row(s_.base + 1);
    mpq_class lift;
    for (unsigned j = 0; j < s_.width; ++j) {
      const mpq_class x = mpq_class(p[j]), y = mpq_class(o[j]);
      if (j < s_.base) row[j] = x - y;
      lift += x * x - y * y;
    }
    if (s_.weighted) lift -= mpq_class(p[s_.width]) - mpq_class(o[s_.width]);
    row[s_.base] = s_.furthest ? mpq_class(-lift) : lift;
    return row;
  }

  const LiftedPoints& s_;
  const Triangulation& t_;
  std::vector<std::uint32_t> places_;
};

// Example: wanted ids 4 and 9, rows (1, 4, 7), (4, 9, 2), (3, 5, 6): row 0 and 1 for id 4, row 1
// for id 9. One pass over all rows serves any number of ids, as a binary search finds whether an id
// is wanted.

/// For each of the wanted ids, which ascend, the rows (of `width` ids) that contain it.
Adjacency<std::uint32_t> rows_around(const Array<std::uint32_t>& ids, unsigned width,
                                     const std::vector<std::uint32_t>& wanted) {
  return {wanted.size(),
          [&](const auto& add) {
    for (std::size_t i = 0; i < ids.size(); ++i) {
      const auto it = std::lower_bound(wanted.begin(), wanted.end(), ids[i]);
      if (it == wanted.end() || *it != ids[i]) continue;
      add(static_cast<std::uint64_t>(it - wanted.begin()), static_cast<std::uint32_t>(i / width));
    }
          }};
}

}  // namespace

std::vector<std::uint32_t> redundant_vertices(const LiftedPoints& s, const Triangulation& t,
                                              const Run& run) {
  // A vertex of a group with one cell is an extreme point, so only vertices of merged cells are
  // tested.
  std::vector<std::uint32_t> candidates;
  if (t.cell_groups.empty()) return candidates;
  std::vector<std::uint32_t> size(t.size());
  for (const std::uint32_t g : t.cell_groups) ++size[g];
  for (std::uint64_t c = 0; c < t.size(); ++c)
    if (size[t.cell_groups[c]] > 1)
      candidates.insert(candidates.end(), t.cell(c).begin(), t.cell(c).end());
  std::sort(candidates.begin(), candidates.end());
  candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
  const Redundancy test(s, t);
  const auto cells = rows_around(t.cells, t.corners(), candidates);
  const auto facets = rows_around(t.hull_facets, t.corners() - 1, candidates);
  std::vector<std::uint8_t> found(candidates.size());
  run.each(candidates.size(), 64, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i)
      found[i] = test.redundant(candidates[i], cells[i], facets[i]) ? 1 : 0;
  });
  std::vector<std::uint32_t> ids;
  for (std::size_t i = 0; i < candidates.size(); ++i)
    if (found[i] != 0) ids.push_back(candidates[i]);
  return ids;
}

}  // namespace cullhull::internal
