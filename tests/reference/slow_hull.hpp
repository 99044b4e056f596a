// The slow, obvious hull: the oracle of the other tests. Exact dyadic numbers over GMP, none of
// the library's code. A point is inserted by testing every facet; the facets it sees (strictly)
// are replaced by the cone from it over their border.
#pragma once

#include <gmpxx.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "slow_elimination.hpp"

namespace cullhull::reference {

/// mantissa * 2^exponent; every double is one, and sums and products stay exact.
struct Dyadic {
  mpz_class mantissa;
  long exponent = 0;

  Dyadic() = default;
  Dyadic(double v) {  // NOLINT: meant to convert
    if (v == 0) return;
    int e = 0;
    mantissa = std::ldexp(std::frexp(v, &e), 53);
    exponent = e - 53;
  }
  int sign() const { return sgn(mantissa); }
  Dyadic operator-() const {
    Dyadic r = *this;
    r.mantissa = -r.mantissa;
    return r;
  }
  Dyadic& operator+=(const Dyadic& b) {
    if (b.sign() == 0) return *this;
    if (sign() == 0) return *this = b;
    if (exponent <= b.exponent) {
      mantissa += b.mantissa << static_cast<unsigned long>(b.exponent - exponent);
    } else {
      mantissa = (mantissa << static_cast<unsigned long>(exponent - b.exponent)) + b.mantissa;
      exponent = b.exponent;
    }
    return *this;
  }
  friend Dyadic operator+(Dyadic a, const Dyadic& b) { return a += b; }
  friend Dyadic operator-(Dyadic a, const Dyadic& b) { return a += -b; }
  friend Dyadic operator*(const Dyadic& a, const Dyadic& b) {
    Dyadic r;
    r.mantissa = a.mantissa * b.mantissa;
    r.exponent = r.sign() == 0 ? 0 : a.exponent + b.exponent;
    return r;
  }
};

/// All (rows x rows) minors of a `rows` x d matrix by column subset (bit set), Laplace along the
/// last row of each.
inline std::vector<Dyadic> minors(const std::vector<std::vector<Dyadic>>& matrix, unsigned d) {
  std::vector<Dyadic> m(std::size_t{1} << d);
  m[0] = Dyadic(1);
  for (std::size_t s = 1; s < m.size(); ++s) {
    const auto k = static_cast<std::size_t>(__builtin_popcountll(s));
    if (k > matrix.size()) continue;
    unsigned position = 0;
    for (unsigned j = 0; j < d; ++j) {
      if (!(s >> j & 1)) continue;
      const Dyadic term = matrix[k - 1][j] * m[s ^ (std::size_t{1} << j)];
      m[s] += (k - 1 + position) % 2 ? -term : term;
      ++position;
    }
  }
  return m;
}

/// normal . x + offset, exactly.
struct Hyperplane {
  std::vector<Dyadic> normal;
  Dyadic offset;

  int side(const double* x) const {
    Dyadic v = offset;
    for (std::size_t j = 0; j < normal.size(); ++j) v += normal[j] * Dyadic(x[j]);
    return v.sign();
  }
};

/// Through d points; the zero normal if they are dependent.
inline Hyperplane hyperplane(unsigned d, const std::vector<const double*>& p) {
  std::vector<std::vector<Dyadic>> rows;
  for (unsigned i = 1; i < d; ++i) {
    rows.emplace_back();
    for (unsigned j = 0; j < d; ++j) rows.back().push_back(Dyadic(p[i][j]) - Dyadic(p[0][j]));
  }
  const std::vector<Dyadic> m = minors(rows, d);
  const std::size_t all = m.size() - 1;
  Hyperplane h;
  for (unsigned j = 0; j < d; ++j) {
    const Dyadic& minor = m[all ^ (std::size_t{1} << j)];
    h.normal.push_back(j % 2 ? -minor : minor);
    h.offset += -(h.normal[j] * Dyadic(p[0][j]));
  }
  return h;
}

/// Rank of vectors of dyadic numbers (rows), by elimination over the rationals.
inline std::size_t rank(const std::vector<std::vector<Dyadic>>& rows) {
  std::vector<testing_support::Rationals> a;
  for (const auto& r : rows) {
    a.emplace_back();
    for (const Dyadic& v : r) {
      mpq_class q(v.mantissa);
      if (v.exponent >= 0)
        q <<= static_cast<unsigned long>(v.exponent);
      else
        q >>= static_cast<unsigned long>(-v.exponent);
      a.back().push_back(q);
    }
  }
  return testing_support::echelon(a).size();
}

struct SlowFacet {
  std::vector<std::uint32_t> vertices;    ///< ids of the input
  std::vector<std::uint32_t> neighbours;  ///< entry j across the ridge opposite to vertex j
  Hyperplane plane;                       ///< negative inside
};

class SlowHull {
 public:
  /// `rows`: packed points of R^d, d >= 2, finite.
  SlowHull(std::vector<double> rows, unsigned d)
      : d_(d), count_(static_cast<std::uint32_t>(rows.size() / d)), rows_(std::move(rows)) {
    start();
    if (affine_dimension_ < static_cast<int>(d_)) return;
    for (std::uint32_t i = 0; i < count_; ++i) insert(i);
    connect();
  }

  unsigned dimension() const { return d_; }
  const std::vector<double>& rows() const { return rows_; }
  const double* point(std::uint32_t i) const { return &rows_[std::size_t{i} * d_]; }
  /// -1: no points, 0: all equal, ..., d. Facets exist for d only.
  int affine_dimension() const { return affine_dimension_; }
  /// Simplicial boundary; coplanar neighbours and vertices that are not extreme may occur.
  const std::vector<SlowFacet>& facets() const { return facets_; }

  /// +1 strictly outside, 0 on the boundary, -1 strictly inside.
  int locate(const double* x) const {
    int worst = -1;
    for (const SlowFacet& f : facets_) {
      worst = std::max(worst, f.plane.side(x));
      if (worst > 0) break;
    }
    return worst;
  }

  /// Extreme points, ascending; of equal points the lowest id.
  std::vector<std::uint32_t> extreme_points() const {
    std::set<std::uint32_t> ids;
    for (const SlowFacet& f : facets_) ids.insert(f.vertices.begin(), f.vertices.end());
    std::vector<std::uint32_t> extreme;
    for (const std::uint32_t v : ids) {
      std::vector<std::vector<Dyadic>> normals;
      for (const SlowFacet& f : facets_)
        if (f.plane.side(point(v)) == 0) normals.push_back(f.plane.normal);
      if (rank(normals) == d_) extreme.push_back(lowest_equal(v));
    }
    std::sort(extreme.begin(), extreme.end());
    return extreme;
  }

  /// Maximal facets as ascending lists of extreme points, sorted.
  std::vector<std::vector<std::uint32_t>> maximal_facets() const {
    const std::vector<std::uint32_t> extreme = extreme_points();
    std::set<std::vector<std::uint32_t>> lists;
    for (const SlowFacet& f : facets_) {
      std::vector<std::uint32_t> on;
      for (const std::uint32_t v : extreme)
        if (f.plane.side(point(v)) == 0) on.push_back(v);
      lists.insert(on);
    }
    return {lists.begin(), lists.end()};
  }

 private:
  std::vector<Dyadic> difference(std::uint32_t a, std::uint32_t b) const {
    std::vector<Dyadic> r;
    for (unsigned j = 0; j < d_; ++j) r.push_back(Dyadic(point(a)[j]) - Dyadic(point(b)[j]));
    return r;
  }

  std::uint32_t lowest_equal(std::uint32_t v) const {
    for (std::uint32_t i = 0; i < v; ++i)
      if (std::equal(point(i), point(i) + d_, point(v))) return i;
    return v;
  }

  /// A simplex of the first affinely independent points.
  void start() {
    if (count_ == 0) return;
    std::vector<std::uint32_t> simplex{0};
    std::vector<std::vector<Dyadic>> rows;
    for (std::uint32_t i = 1; i < count_ && simplex.size() <= d_; ++i) {
      if (lowest_equal(i) != i) continue;
      rows.push_back(difference(i, 0));
      if (rank(rows) == rows.size())
        simplex.push_back(i);
      else
        rows.pop_back();
    }
    affine_dimension_ = static_cast<int>(simplex.size()) - 1;
    if (simplex.size() <= d_) return;
    interior_.assign(d_, Dyadic());
    for (const std::uint32_t v : simplex)
      for (unsigned j = 0; j < d_; ++j) interior_[j] += Dyadic(point(v)[j]);
    for (unsigned skip = 0; skip <= d_; ++skip) {
      std::vector<std::uint32_t> f = simplex;
      f.erase(f.begin() + skip);
      add(std::move(f));
    }
  }

  /// interior_ is the sum of d + 1 points: d + 1 times a point inside.
  void add(std::vector<std::uint32_t> vertices) {
    std::vector<const double*> p;
    for (const std::uint32_t v : vertices) p.push_back(point(v));
    SlowFacet f{std::move(vertices), {}, hyperplane(d_, p)};
    Dyadic inside = f.plane.offset * Dyadic(d_ + 1.0);
    for (unsigned j = 0; j < d_; ++j) inside += f.plane.normal[j] * interior_[j];
    if (inside.sign() > 0) {
      for (Dyadic& n : f.plane.normal) n = -n;
      f.plane.offset = -f.plane.offset;
    }
    facets_.push_back(std::move(f));
  }

  void insert(std::uint32_t i) {
    std::map<std::vector<std::uint32_t>, int> ridges;
    std::vector<SlowFacet> kept;
    for (SlowFacet& f : facets_) {
      if (f.plane.side(point(i)) <= 0) {
        kept.push_back(std::move(f));
        continue;
      }
      for (unsigned j = 0; j < d_; ++j) ++ridges[ridge(f, j)];
    }
    facets_ = std::move(kept);
    for (const auto& [r, times] : ridges) {
      if (times == 2) continue;
      std::vector<std::uint32_t> f = r;
      f.push_back(i);
      add(std::move(f));
    }
  }

  std::vector<std::uint32_t> ridge(const SlowFacet& f, unsigned opposite) const {
    std::vector<std::uint32_t> r = f.vertices;
    r.erase(r.begin() + opposite);
    std::sort(r.begin(), r.end());
    return r;
  }

  void connect() {
    std::map<std::vector<std::uint32_t>, std::pair<std::uint32_t, unsigned>> open;
    for (std::uint32_t f = 0; f < facets_.size(); ++f) {
      facets_[f].neighbours.resize(d_);
      for (unsigned j = 0; j < d_; ++j) {
        const auto [it, fresh] = open.try_emplace(ridge(facets_[f], j), f, j);
        if (fresh) continue;
        facets_[f].neighbours[j] = it->second.first;
        facets_[it->second.first].neighbours[it->second.second] = f;
      }
    }
  }

  unsigned d_;
  std::uint32_t count_;
  std::vector<double> rows_;
  int affine_dimension_ = -1;
  std::vector<Dyadic> interior_;
  std::vector<SlowFacet> facets_;
};

}  // namespace cullhull::reference
