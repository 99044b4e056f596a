// Sibson's coordinates: the fractions of a new point's Voronoi cell stolen from each neighbour's
// cell.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <deque>
#include <utility>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/interpolate.hpp"
#include "cullhull/triangulation.hpp"
#include "diagrams/interpolation/stolen_volumes-inl.hpp"
#include "exact/insphere/lift_side.hpp"
#include "exact/numbers/fractions.hpp"
#include "exact/numbers/rationals.hpp"
#include "exact/points/local_points.hpp"
#include "geometry/gather.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/index.hpp"

namespace cullhull::internal {

/// The index of an id in a list, to which it is added if it is absent.
inline std::uint32_t place_of(std::uint32_t id, std::vector<std::uint32_t>& ids) {
  const std::uint32_t at = place_in(ids, id);
  if (at == ids.size()) ids.push_back(id);
  return at;
}

/// Each volume over the sum, within 2^-52 before it is rounded to a double. False if an error bound
/// is larger.
inline bool round_shares(const std::vector<BoundedDoubleDouble>& volumes,
                         std::vector<double>& out) {
  BoundedDoubleDouble sum(0);
  for (const BoundedDoubleDouble& v : volumes) sum = sum + v;
  for (const BoundedDoubleDouble& v : volumes) {
    const BoundedDoubleDouble share = v / sum;
    if (!(share.error <= 0x1p-52)) return false;
    out.push_back(std::max(share.value.value(), 0.0));
  }
  return true;
}

template <unsigned K>
std::vector<double> shares_of(const Cavity<K>& cavity) {
  std::vector<double> shares;
  if (round_shares(StolenVolumes<BoundedDoubleDouble, K>(cavity).run(), shares)) return shares;
  const std::vector<FractionSum> sums = StolenVolumes<Fraction, K, FractionSum>(cavity).run();
  for (const long bits : {4096L, 32768L})  // the least nonzero share is 2^-1075
    if (auto nearest = nearest_shares(sums, bits)) return *std::move(nearest);
  shares.clear();
  const std::vector<mpq_class> volumes = StolenVolumes<mpq_class, K>(cavity).run();
  mpq_class sum = 0;
  for (const mpq_class& v : volumes) sum += v;
  for (const mpq_class& v : volumes) shares.push_back(nearest_double(v / divisor(sum)));
  return shares;
}

/// Writes ids, ascending, with their weights.
inline void write_shares(const std::vector<std::uint32_t>& ids, const std::vector<double>& shares,
                         NaturalNeighbours& out) {
  std::vector<std::pair<std::uint32_t, double>> sorted;
  for (std::size_t i = 0; i < ids.size(); ++i) sorted.emplace_back(ids[i], shares[i]);
  std::sort(sorted.begin(), sorted.end());
  for (const auto& [id, share] : sorted) {
    out.ids.push_back(id);
    out.weights.push_back(share);
  }
}

/// A copy of a triangulation made by delaunay(), with its points scaled.
class NaturalTriangulation {
 public:
  NaturalTriangulation(const PointView& points, const Triangulation& t, const Run& run)
      : d_(t.dimension),
        k_(t.corners() == 0 ? 0 : t.corners() - 1),
        columns_(flat_columns(t.axes, t.dimension)),
        cells_(t.cells),
        neighbours_(t.neighbours) {
    const Array<double> given = gather_points(points, nullptr, points.count, run);
    double largest = 0;
    for (const double v : given) largest = std::max(largest, std::abs(v));
    if (largest > 0) (void)std::frexp(largest, &exponent_);
    bool exact = true;
    for (const double v : given)
      exact = exact && std::ldexp(std::ldexp(v, -exponent_), exponent_) == v;
    if (!exact) exponent_ = 0;
    rows_.resize(given.size());
    for (std::uint64_t i = 0; i < points.count; ++i)
      for (unsigned j = 0; j < d_; ++j)
        rows_[i * d_ + j] = std::ldexp(given[i * d_ + columns_[j]], -exponent_);
    frame_.base = k_;
    frame_.width = frame_.stride = d_;
    frame_.filtered = exact;
  }

  unsigned dimension() const { return d_; }
  /// The affine dimension k.
  unsigned base() const { return k_; }
  const std::uint32_t* cell(std::uint32_t c) const {
    return cells_.data() + std::size_t{c} * (k_ + 1);
  }
  const std::uint32_t* neighbours(std::uint32_t c) const {
    return neighbours_.data() + std::size_t{c} * (k_ + 1);
  }
  /// Coordinates in the order of flat_columns(), scaled by a power of two.
  const double* row(std::uint32_t v) const { return rows_.data() + std::size_t{v} * d_; }
  /// The same, unscaled.
  void copy_plain(std::uint32_t v, double* out) const {
    for (unsigned j = 0; j < d_; ++j) out[j] = std::ldexp(row(v)[j], exponent_);
  }
  /// Writes a point's coordinates as row() has them. If scaling is not exact, writes them unscaled
  /// and returns false.
  bool scaled(const double* point, double* out) const {
    bool exact = true;
    for (unsigned j = 0; j < d_; ++j) {
      out[j] = std::ldexp(point[columns_[j]], -exponent_);
      exact = exact && std::ldexp(out[j], exponent_) == point[columns_[j]];
    }
    for (unsigned j = 0; j < d_ && !exact; ++j) out[j] = point[columns_[j]];
    return exact;
  }
  const LiftedPoints& frame() const { return frame_; }

 private:
  unsigned d_, k_;
  int exponent_ = 0;
  std::vector<std::uint32_t> columns_;
  Array<std::uint32_t> cells_, neighbours_;
  Array<double> rows_;
  LiftedPoints frame_;  ///< for predicates; without rows
};

/// Answers queries on one thread.
class NaturalWeights {
 public:
  explicit NaturalWeights(const NaturalTriangulation& t) : t_(t), query_(t.dimension()) {}

  /// Computes the natural neighbours of a point in the cell; `barycentric`: its coordinates there.
  /// See Interpolator. Requires k <= 3.
  void find(const double* point, std::uint32_t cell, const double* barycentric,
            NaturalNeighbours& out) {
    out.ids.clear();
    out.weights.clear();
    plain_rows_.clear();
    plain_ = !t_.scaled(point, query_.data());
    const unsigned k = t_.base();
    const auto corners =
        std::count_if(barycentric, barycentric + k + 1, [](double v) { return v != 0; });
    if (corners > 1 && k > 1) {
      find_cavity(cell);
      const std::vector<HullFacet> facets = hull_facets_at_query();
      if (facets.empty()) return k == 2 ? share_cavity<2>(out) : share_cavity<3>(out);
      if (k == 3 && share_face(facets, out)) return;
    }
    // At a vertex, on a line, or on an edge of the hull: the barycentric coordinates.
    std::vector<std::uint32_t> ids;
    std::vector<double> shares;
    for (unsigned i = 0; i <= k; ++i) {
      if (barycentric[i] == 0) continue;
      ids.push_back(t_.cell(cell)[i]);
      shares.push_back(barycentric[i]);
    }
    write_shares(ids, shares, out);
  }

 private:
  struct HullFacet {
    std::uint32_t cell;
    unsigned slot;  ///< the corner it is opposite to
  };
  const double* row(std::uint32_t v) {
    if (!plain_) return t_.row(v);
    plain_rows_.emplace_back(t_.dimension());
    t_.copy_plain(v, plain_rows_.back().data());
    return plain_rows_.back().data();
  }
  std::vector<const double*> rows_of(std::uint32_t cell) {
    std::vector<const double*> rows;
    for (unsigned i = 0; i <= t_.base(); ++i) rows.push_back(row(t_.cell(cell)[i]));
    return rows;
  }
  /// Whether the query is strictly inside the cell's circumsphere.
  bool in_sphere(std::uint32_t cell) {
    const std::vector<const double*> rows = rows_of(cell);
    LiftCounts counts;
    const Sign sign = plain_
                          ? lift_side_exact(t_.frame(), rows.data(), query_.data())
                          : with_dimension<2, 3, 0>(t_.base(), [&](auto k) {
                              return lift_side<k()>(t_.frame(), rows.data(), query_.data(), counts);
                            });
    return sign == Sign::negative;
  }
  /// Collects the cells whose circumspheres contain the query. They are connected through facets,
  /// so a flood fill from one of them finds all.
  void find_cavity(std::uint32_t cell) {
    cells_.assign(1, cell);
    for (std::size_t at = 0; at < cells_.size(); ++at)
      for (unsigned j = 0; j <= t_.base(); ++j) {
        const std::uint32_t next = t_.neighbours(cells_[at])[j];
        if (next != no_index && std::find(cells_.begin(), cells_.end(), next) == cells_.end() &&
            in_sphere(next))
          cells_.push_back(next);
      }
  }
  /// The hull's facets that belong to cavity cells and whose planes contain the query. There the
  /// cavity does not enclose the query, and areas and volumes would be unbounded.
  std::vector<HullFacet> hull_facets_at_query() {
    std::vector<HullFacet> facets;
    for (const std::uint32_t c : cells_)
      for (unsigned j = 0; j <= t_.base(); ++j) {
        if (t_.neighbours(c)[j] != no_index) continue;
        std::vector<const double*> rows = rows_of(c);
        rows[j] = query_.data();
        if (orientation(t_.base(), rows.data()) == Sign::zero) facets.push_back({c, j});
      }
    return facets;
  }
  template <unsigned K>
  void share_cavity(NaturalNeighbours& out) {
    Cavity<K> cavity;
    std::vector<std::uint32_t> ids;
    for (const std::uint32_t c : cells_) {
      cavity.cells.emplace_back();
      for (unsigned i = 0; i <= K; ++i) cavity.cells.back()[i] = place_of(t_.cell(c)[i], ids);
    }
    for (const std::uint32_t id : ids) cavity.points.push_back(row(id));
    cavity.query = query_.data();
    cavity.d = t_.dimension();
    cavity.find_sides();
    write_shares(ids, shares_of(cavity), out);
  }
  /// 3D: if the query is inside a face of the hull, the weights are those in the face's own
  /// triangulation, which are the limit from inside. False if the facets are not coplanar; the
  /// query is then on an edge of the hull.
  bool share_face(const std::vector<HullFacet>& facets, NaturalNeighbours& out) {
    Cavity<2> cavity;
    std::vector<std::uint32_t> ids;
    for (const HullFacet& f : facets) {
      cavity.cells.emplace_back();
      for (unsigned i = 0, n = 0; i <= 3; ++i)
        if (i != f.slot) cavity.cells.back()[n++] = place_of(t_.cell(f.cell)[i], ids);
    }
    std::vector<const double*> rows;
    for (const std::uint32_t id : ids) rows.push_back(row(id));
    for (const double* p : rows) {
      const double* corners[] = {rows[0], rows[1], rows[2], p};
      if (orientation(3, corners) != Sign::zero) return false;
    }
    const unsigned d = t_.dimension();
    for (const auto& axes : {std::pair(0U, 1U), std::pair(0U, 2U), std::pair(1U, 2U)}) {
      const unsigned x = axes.first, y = axes.second;
      std::vector<std::vector<double>> turned;
      const auto turn = [&](const double* p) {
        std::vector<double> r{p[x], p[y]};
        for (unsigned j = 0; j < d; ++j)
          if (j != x && j != y) r.push_back(p[j]);
        turned.push_back(std::move(r));
      };
      for (const double* p : rows) turn(p);
      turn(query_.data());
      cavity.points.clear();
      for (std::size_t i = 0; i < rows.size(); ++i) cavity.points.push_back(turned[i].data());
      cavity.query = turned.back().data();
      cavity.d = d;
      Sign sign = Sign::zero;
      for (auto& cell : cavity.cells) {
        const double* corners[] = {cavity.points[cell[0]], cavity.points[cell[1]],
                                   cavity.points[cell[2]]};
        sign = orientation(2, corners);
        if (sign == Sign::zero) break;
        if (sign == Sign::negative) std::swap(cell[1], cell[2]);
      }
      if (sign == Sign::zero) continue;
      cavity.find_sides();
      write_shares(ids, shares_of(cavity), out);
      return true;
    }
    return false;
  }

  const NaturalTriangulation& t_;
  std::vector<double> query_;
  bool plain_ = false;  ///< whether this query uses unscaled rows
  std::deque<std::vector<double>> plain_rows_;
  std::vector<std::uint32_t> cells_;  ///< the cells whose circumspheres contain the query
};

}  // namespace cullhull::internal
