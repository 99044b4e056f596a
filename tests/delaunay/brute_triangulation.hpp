// Regular triangulations from their definition, in rational numbers: every simplex is tried, merged
// cells are pulled face by face. Shares nothing with the library.
#pragma once

#include <gmpxx.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "slow_elimination.hpp"

namespace cullhull::testing_support {

using CellIds = std::vector<std::uint32_t>;

/// body(subset) for all subsets of `size` of the items.
template <class Body>
void each_subset(const CellIds& items, std::size_t size, const Body& body) {
  if (size > items.size()) return;
  std::vector<std::size_t> at(size);
  for (std::size_t i = 0; i < size; ++i) at[i] = i;
  CellIds chosen(size);
  for (;;) {
    for (std::size_t i = 0; i < size; ++i) chosen[i] = items[at[i]];
    body(chosen);
    std::size_t i = size;
    while (i > 0 && at[i - 1] == items.size() - size + i - 1) --i;
    if (i == 0) return;
    ++at[i - 1];
    for (std::size_t j = i; j < size; ++j) at[j] = at[j - 1] + 1;
  }
}

struct BruteTriangulation {
  int affine_dimension = -1;
  std::set<CellIds> cells;   ///< each ascending
  std::set<CellIds> groups;  ///< vertices of merged cells, ascending
  CellIds hidden;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> duplicates;
};

class BruteForce {
 public:
  /// `sign`: -1 for the upper hull.
  BruteForce(const std::vector<double>& rows, unsigned d, const std::vector<double>& weights = {},
             int sign = 1)
      : n_(static_cast<std::uint32_t>(rows.size() / d)) {
    for (std::uint32_t i = 0; i < n_; ++i) {
      Rationals x;
      mpq_class lift = weights.empty() ? mpq_class(0) : mpq_class(-weights[i]);
      for (unsigned j = 0; j < d; ++j) {
        x.emplace_back(rows[std::size_t{i} * d + j]);
        lift += x[j] * x[j];
      }
      points_.push_back(std::move(x));
      lifts_.push_back(sign * lift);
    }
  }

  BruteTriangulation run() {
    find_duplicates();
    if (n_ == 0) return out_;
    const std::vector<unsigned> axes = axes_of(ids_, all_axes());
    const std::size_t k = axes.size();
    out_.affine_dimension = static_cast<int>(k);
    std::set<CellIds> groups = lower_faces(axes);
    std::set<std::uint32_t> vertices;
    for (const CellIds& group : groups) {
      const CellIds corners = extreme(group, axes);
      out_.groups.insert(corners);
      vertices.insert(corners.begin(), corners.end());
      for (CellIds& cell : pull(corners, axes)) out_.cells.insert(std::move(cell));
    }
    for (const std::uint32_t id : ids_)
      if (vertices.count(id) == 0) out_.hidden.push_back(id);
    return out_;
  }

 private:
  std::vector<unsigned> all_axes() const {
    std::vector<unsigned> axes(points_[0].size());
    for (unsigned j = 0; j < axes.size(); ++j) axes[j] = j;
    return axes;
  }

  void find_duplicates() {
    std::map<Rationals, CellIds> places;
    for (std::uint32_t i = 0; i < n_; ++i) places[points_[i]].push_back(i);
    for (const auto& [x, ids] : places) {
      std::uint32_t best = ids[0];
      for (const std::uint32_t id : ids)
        if (lifts_[id] < lifts_[best]) best = id;
      ids_.push_back(best);
      for (const std::uint32_t id : ids)
        if (id != best) out_.duplicates.emplace_back(id, best);
    }
    std::sort(ids_.begin(), ids_.end());
    std::sort(out_.duplicates.begin(), out_.duplicates.end());
  }

  Rationals difference(std::uint32_t a, std::uint32_t b, const std::vector<unsigned>& axes) const {
    Rationals r;
    for (const unsigned j : axes) r.push_back(points_[a][j] - points_[b][j]);
    return r;
  }

  /// Of `axes` those of the echelon form of the points' flat.
  std::vector<unsigned> axes_of(const CellIds& ids, const std::vector<unsigned>& axes) const {
    std::vector<Rationals> m;
    for (const std::uint32_t id : ids) m.push_back(difference(id, ids[0], axes));
    std::vector<unsigned> kept;
    for (const unsigned c : echelon(m)) kept.push_back(axes[c]);
    return kept;
  }

  mpq_class orientation(const CellIds& ids, const std::vector<unsigned>& axes) const {
    std::vector<Rationals> m;
    for (std::size_t i = 1; i < ids.size(); ++i) m.push_back(difference(ids[i], ids[0], axes));
    mpq_class det = 1;
    if (!m.empty()) echelon(m, &det);
    return det;
  }

  /// det [differences, lift] with q last, times the sign of the simplex: negative: q is below.
  mpq_class height(const CellIds& cell, std::uint32_t q, const std::vector<unsigned>& axes,
                   const mpq_class& orientation) const {
    std::vector<Rationals> m;
    for (std::size_t i = 1; i <= cell.size(); ++i) {
      const std::uint32_t id = i < cell.size() ? cell[i] : q;
      m.push_back(difference(id, cell[0], axes));
      m.back().push_back(lifts_[id] - lifts_[cell[0]]);
    }
    mpq_class det;
    echelon(m, &det);
    return orientation > 0 ? det : mpq_class(-det);
  }

  std::set<CellIds> lower_faces(const std::vector<unsigned>& axes) const {
    std::set<CellIds> faces;
    each_subset(ids_, axes.size() + 1, [&](const CellIds& cell) {
      const mpq_class o = orientation(cell, axes);
      if (o == 0) return;
      CellIds on;
      for (const std::uint32_t q : ids_) {
        const mpq_class h = height(cell, q, axes, o);
        if (h < 0) return;
        if (h == 0) on.push_back(q);
      }
      faces.insert(on);
    });
    return faces;
  }

  /// Those of the ids that no simplex of the others has.
  CellIds extreme(const CellIds& ids, const std::vector<unsigned>& axes) const {
    CellIds corners;
    for (const std::uint32_t id : ids) {
      CellIds others;
      for (const std::uint32_t o : ids)
        if (o != id) others.push_back(o);
      bool inside = false;
      for (std::size_t size = 1; size <= axes.size() + 1 && !inside; ++size)
        each_subset(others, size,
                    [&](const CellIds& simplex) { inside = inside || within(id, simplex, axes); });
      if (!inside) corners.push_back(id);
    }
    return corners;
  }

  /// In an affinely independent simplex.
  bool within(std::uint32_t id, const CellIds& simplex, const std::vector<unsigned>& axes) const {
    if (axes_of(simplex, axes).size() + 1 != simplex.size()) return false;
    CellIds all = simplex;
    all.push_back(id);
    const std::vector<unsigned> kept = axes_of(all, axes);
    if (kept.size() + 1 != simplex.size()) return false;
    const mpq_class whole = orientation(simplex, kept);
    for (std::size_t i = 0; i < simplex.size(); ++i) {
      CellIds other = simplex;
      other[i] = id;
      if (orientation(other, kept) * whole < 0) return false;
    }
    return true;
  }

  std::vector<CellIds> pull(const CellIds& ids, const std::vector<unsigned>& axes) const {
    const std::size_t k = axes.size();
    if (ids.size() == k + 1) return {ids};
    std::set<CellIds> facets;
    each_subset(ids, k, [&](const CellIds& facet) {
      if (axes_of(facet, axes).size() + 1 != k) return;
      CellIds on;
      bool above = false, below = false;
      for (const std::uint32_t q : ids) {
        CellIds all = facet;
        all.push_back(q);
        const mpq_class o = orientation(all, axes);
        above = above || o > 0;
        below = below || o < 0;
        if (o == 0) on.push_back(q);
      }
      if (!(above && below)) facets.insert(on);
    });
    std::vector<CellIds> cells;
    for (const CellIds& facet : facets) {
      if (facet[0] == ids[0]) continue;
      for (CellIds part : pull(facet, axes_of(facet, axes))) {
        part.insert(part.begin(), ids[0]);
        cells.push_back(std::move(part));
      }
    }
    return cells;
  }

  std::uint32_t n_;
  std::vector<Rationals> points_;
  Rationals lifts_;
  CellIds ids_;
  BruteTriangulation out_;
};

}  // namespace cullhull::testing_support
