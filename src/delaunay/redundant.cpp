#include "delaunay/redundant.hpp"

#include <gmpxx.h>

#include <algorithm>
#include <numeric>

#include "delaunay/write_triangulation.hpp"
#include "parallel/adjacency.hpp"

namespace cullhull::internal {
namespace {

using Row = std::vector<mpq_class>;

// Example: the rows (1, 2, 3) and (2, 4, 7): the first is kept; the second less twice the first is
// (0, 0, 1), which becomes the second row, and the first is cleared in that column: (1, 2, 0) and
// (0, 0, 1). The column without a pivot is the middle one, so the normal is (-2, 1, 0): orthogonal
// to both.

/// A basis of the space that rational rows span, in reduced echelon form.
class EchelonBasis {
 public:
  explicit EchelonBasis(unsigned columns) : columns_(columns) {}
  std::size_t rank() const { return rows_.size(); }
  const std::vector<Row>& rows() const { return rows_; }
  const std::vector<unsigned>& pivots() const { return pivots_; }

  void add(Row row) {
    for (std::size_t r = 0; r < rows_.size(); ++r) {
      const mpq_class factor = row[pivots_[r]];
      if (factor == 0) continue;
      for (unsigned j = 0; j < columns_; ++j) row[j] -= factor * rows_[r][j];
    }
    unsigned pivot = 0;
    while (pivot < columns_ && row[pivot] == 0) ++pivot;
    if (pivot == columns_) return;
    const mpq_class scale = row[pivot];
    for (mpq_class& v : row) v /= scale;
    // Reduced: every other row is zero in the column of this pivot.
    for (Row& other : rows_) {
      const mpq_class factor = other[pivot];
      if (factor == 0) continue;
      for (unsigned j = 0; j < columns_; ++j) other[j] -= factor * row[j];
    }
    rows_.push_back(std::move(row));
    pivots_.push_back(pivot);
  }

  /// A row orthogonal to all rows added. Requires rank columns - 1.
  Row normal() const {
    unsigned open = 0;
    while (std::count(pivots_.begin(), pivots_.end(), open) > 0) ++open;
    Row n(columns_);
    n[open] = 1;
    for (std::size_t r = 0; r < rows_.size(); ++r) n[pivots_[r]] = -rows_[r][open];
    return n;
  }

 private:
  unsigned columns_;
  std::vector<Row> rows_;
  std::vector<unsigned> pivots_;
};

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
    const unsigned k = t_.corners() - 1;
    EchelonBasis normals(k + 1);
    std::vector<std::uint32_t> groups;
    for (const std::uint32_t c : cells) {
      if (std::count(groups.begin(), groups.end(), t_.group(c)) > 0) continue;
      groups.push_back(t_.group(c));
      EchelonBasis plane(k + 1);
      for (const std::uint32_t u : t_.cell(c))
        if (u != v) plane.add(difference(u, v));
      normals.add(plane.normal());
      if (normals.rank() == k + 1) return false;
    }
    for (const std::uint32_t f : facets) {
      EchelonBasis wall(k + 1);
      for (const std::uint32_t u : t_.hull_facet(f))
        if (u != v) wall.add(difference(u, v));
      Row up(k + 1);
      up[k] = 1;
      wall.add(std::move(up));
      normals.add(wall.normal());
      if (normals.rank() == k + 1) return false;
    }
    return true;
  }

 private:
  /// Lifted point u minus lifted point v, exact.
  Row difference(std::uint32_t u, std::uint32_t v) const {
    const double *p = s_.row(places_[u]), *o = s_.row(places_[v]);
    Row row(s_.base + 1);
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
