// The volumes that a new point's Voronoi cell steals from its neighbours' cells, as sums over the
// simplices whose circumspheres contain the point. docs/exactness.md, "Natural neighbours", derives
// the signs.
//
// The volume that vertex a loses is a sum over the surface of that part, seen from q: over polygons
// of the faces towards its neighbours b and towards q, and over the edges of these, which are dual
// to the facets of the cavity. A facet (a, b, c) that is positive with the opposite corner of its
// cell has the edge from the centre s on its other side (at the cavity's boundary, of the sphere
// through the facet and q) to the cell's own centre o; with m, any point of the plane between a and
// b, that is det(s, o, m) for a and its negative for b, and likewise for (b, c) and (c, a). Two
// facets (a, b, ..) and (b, a, ..) of the boundary with the centres n and n' close the polygon by
// det(n', n, m), and give det(n, n', m_a) to a and det(n', n, m_b) to b for the faces towards q,
// m_a being the middle of a and q. In the plane det(s, o), and det(n', n) at each corner. Corners
// of the surface on either side cancel whatever the order, and no step decides anything: the
// volumes are one rational formula.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>
#include <vector>

#include "exact/numbers/bounded.hpp"
#include "parallel/index.hpp"

namespace cullhull::internal {

/// The K-dimensional simplices, in d-dimensional space, whose circumspheres contain the query, and
/// the boundary of their union.
template <unsigned K>
struct Cavity {
  using Facet = std::array<std::uint32_t, K>;
  /// Corners as indices into `points`, positively oriented.
  std::vector<std::array<std::uint32_t, K + 1>> cells;
  /// Rows of d doubles; orientation refers to the first K columns.
  std::vector<const double*> points;
  const double* query = nullptr;
  unsigned d = K;

  /// A facet of a cell and the cell across it, or no_index. With the opposite corner appended, the
  /// facet's order is positively oriented.
  struct Side {
    Facet corners;
    std::uint32_t cell, across;
  };
  std::vector<Side> sides;  ///< a facet between two cells only once

  void find_sides() {
    struct Half {
      Facet sorted;
      std::uint32_t side;
    };
    std::vector<Half> halves;
    sides.clear();
    for (std::uint32_t c = 0; c < cells.size(); ++c)
      for (unsigned j = 0; j <= K; ++j) {
        Side s{{}, c, no_index};
        for (unsigned i = 0, n = 0; i <= K; ++i)
          if (i != j) s.corners[n++] = cells[c][i];
        if ((K - j) % 2 == 1) std::swap(s.corners[0], s.corners[1]);
        Facet sorted = s.corners;
        std::sort(sorted.begin(), sorted.end());
        halves.push_back({sorted, static_cast<std::uint32_t>(sides.size())});
        sides.push_back(s);
      }
    std::sort(halves.begin(), halves.end(), [](const Half& a, const Half& b) {
      return a.sorted != b.sorted ? a.sorted < b.sorted : a.side < b.side;
    });
    std::vector<Side> kept;
    for (std::size_t i = 0; i < halves.size(); ++i) {
      Side s = sides[halves[i].side];
      if (i + 1 < halves.size() && halves[i + 1].sorted == halves[i].sorted)
        s.across = sides[halves[++i].side].cell;
      kept.push_back(s);
    }
    sides = std::move(kept);
  }
};

/// `Volume`: the type of a sum of Reals.
template <class Real, unsigned K, class Volume = Real>
class StolenVolumes {
 public:
  using Point = std::array<Real, K>;

  explicit StolenVolumes(const Cavity<K>& cavity) : cavity_(cavity) {}

  /// The stolen volume of each of the cavity's points, all multiplied by the same positive factor.
  std::vector<Volume> run() {
    for (const double* p : cavity_.points) points_.push_back(vector(p, cavity_.query));
    volumes_.assign(points_.size(), Volume(0));
    std::vector<Point> centres;
    for (const auto& cell : cavity_.cells) centres.push_back(centre(cell));
    for (const auto& side : cavity_.sides) {
      const bool inner = side.across != no_index;
      const Point other = inner ? centres[side.across] : centre_with_query(side.corners);
      add_side(side.corners, other, centres[side.cell]);
      if (!inner) rim_.push_back({side.corners, other});
    }
    close();
    return std::move(volumes_);
  }

 private:
  using Facet = typename Cavity<K>::Facet;
  struct Rim {
    Facet corners;
    Point centre;  ///< of the sphere through the corners and the query
  };

  std::vector<Real> vector(const double* a, const double* b) const {
    std::vector<Real> v;
    for (unsigned j = 0; j < cavity_.d; ++j) v.push_back(exact_difference<Real>(a[j], b[j]));
    return v;
  }
  static Real dot(const std::vector<Real>& a, const std::vector<Real>& b) {
    Real sum(0);
    for (std::size_t j = 0; j < a.size(); ++j) sum = sum + a[j] * b[j];
    return sum;
  }
  static Real determinant(const Real& a, const Real& b, const Real& c, const Real& e) {
    return a * e - b * c;
  }
  static Real determinant(const std::array<Point, 3>& m) {
    return m[0][0] * determinant(m[1][1], m[1][2], m[2][1], m[2][2]) -
           m[0][1] * determinant(m[1][0], m[1][2], m[2][0], m[2][2]) +
           m[0][2] * determinant(m[1][0], m[1][1], m[2][0], m[2][1]);
  }

  /// Solves K linear equations with the matrix `m` and the right-hand side `right`.
  static Point solve(const std::array<Point, K>& m, const Point& right) {
    Point x;
    if constexpr (K == 2) {
      const Real det = determinant(m[0][0], m[0][1], m[1][0], m[1][1]);
      divisor(det);
      x[0] = determinant(right[0], m[0][1], right[1], m[1][1]) / det;
      x[1] = determinant(m[0][0], right[0], m[1][0], right[1]) / det;
    } else {
      const Real det = determinant(m);
      divisor(det);
      for (unsigned j = 0; j < 3; ++j) {
        std::array<Point, 3> with = m;
        for (unsigned i = 0; i < 3; ++i) with[i][j] = right[i];
        x[j] = determinant(with) / det;
      }
    }
    return x;
  }

  /// Twice the centre, in their flat, of the sphere through the origin and the ends of these
  /// vectors; its first K coordinates.
  Point doubled_centre(const std::vector<std::vector<Real>>& edges) const {
    std::array<Point, K> m;
    Point right;
    for (unsigned i = 0; i < K; ++i) right[i] = dot(edges[i], edges[i]);
    if (cavity_.d == K) {
      for (unsigned i = 0; i < K; ++i)
        for (unsigned j = 0; j < K; ++j) m[i][j] = edges[i][j];
      return solve(m, right);
    }
    for (unsigned i = 0; i < K; ++i)
      for (unsigned j = 0; j < K; ++j) m[i][j] = dot(edges[i], edges[j]);
    const Point shares = solve(m, right);
    Point x;
    for (unsigned j = 0; j < K; ++j) {
      x[j] = Real(0);
      for (unsigned i = 0; i < K; ++i) x[j] = x[j] + shares[i] * edges[i][j];
    }
    return x;
  }
  /// Twice the circumcentre, relative to the query.
  Point centre(const std::array<std::uint32_t, K + 1>& cell) const {
    std::vector<std::vector<Real>> edges;
    for (unsigned i = 1; i <= K; ++i)
      edges.push_back(vector(cavity_.points[cell[i]], cavity_.points[cell[0]]));
    Point c = doubled_centre(edges);
    for (unsigned j = 0; j < K; ++j) c[j] = c[j] + points_[cell[0]][j] + points_[cell[0]][j];
    return c;
  }
  Point centre_with_query(const Facet& corners) const {
    std::vector<std::vector<Real>> edges;
    for (const std::uint32_t v : corners) edges.push_back(points_[v]);
    return doubled_centre(edges);
  }

  void add(std::uint32_t v, const Real& volume) { volumes_[v] = std::move(volumes_[v]) + volume; }
  void subtract(std::uint32_t v, const Real& volume) {
    volumes_[v] = std::move(volumes_[v]) - volume;
  }
  /// Twice the midpoint of two points, or of one point and the query.
  Point doubled_middle(std::uint32_t a, std::uint32_t b) const {
    Point m;
    for (unsigned j = 0; j < K; ++j) m[j] = points_[a][j] + points_[b][j];
    return m;
  }
  Point doubled_middle(std::uint32_t a) const {
    Point m;
    for (unsigned j = 0; j < K; ++j) m[j] = points_[a][j];
    return m;
  }

  /// Adds the diagram's edge across a facet, from the circumcentre beyond it to the cell's own.
  void add_side(const Facet& f, const Point& other, const Point& own) {
    if constexpr (K == 2) {
      const Real area = determinant(other[0], other[1], own[0], own[1]);
      add(f[0], area);
      subtract(f[1], area);
    } else {
      for (unsigned i = 0; i < 3; ++i) {
        const std::uint32_t a = f[i], b = f[(i + 1) % 3];
        const Real volume = determinant({other, own, doubled_middle(a, b)});
        add(a, volume);
        subtract(b, volume);
      }
    }
  }

  /// Adds the new cell's own edges, between the spheres of boundary facets that share a ridge.
  void close() {
    if constexpr (K == 2) {
      for (const Rim& to : rim_)
        for (const Rim& from : rim_)
          if (from.corners[1] == to.corners[0])
            add(to.corners[0],
                determinant(from.centre[0], from.centre[1], to.centre[0], to.centre[1]));
    } else {
      struct RimEdge {
        std::uint32_t low, high, rim;
        bool forward;
      };
      std::vector<RimEdge> edges;
      for (std::uint32_t r = 0; r < rim_.size(); ++r)
        for (unsigned i = 0; i < 3; ++i) {
          const std::uint32_t a = rim_[r].corners[i], b = rim_[r].corners[(i + 1) % 3];
          edges.push_back({std::min(a, b), std::max(a, b), r, a < b});
        }
      std::sort(edges.begin(), edges.end(), [](const RimEdge& x, const RimEdge& y) {
        return x.low != y.low     ? x.low < y.low
               : x.high != y.high ? x.high < y.high
                                  : x.forward > y.forward;
      });
      for (std::size_t i = 0; i + 1 < edges.size(); i += 2)
        close(edges[i].low, edges[i].high, rim_[edges[i].rim].centre,
              rim_[edges[i + 1].rim].centre);
    }
  }
  /// `own`: the centre for the facet that has a before b, `other`: for the one that has b before a.
  void close(std::uint32_t a, std::uint32_t b, const Point& own, const Point& other) {
    if constexpr (K == 3) {
      const Real between = determinant({other, own, doubled_middle(a, b)});
      add(a, between);
      subtract(b, between);
      add(a, determinant({own, other, doubled_middle(a)}));
      add(b, determinant({other, own, doubled_middle(b)}));
    }
  }

  const Cavity<K>& cavity_;
  std::vector<std::vector<Real>> points_;  ///< relative to the query
  std::vector<Volume> volumes_;
  std::vector<Rim> rim_;
};

}  // namespace cullhull::internal
