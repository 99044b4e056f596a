// A surface of leaders: the first surface of a star hull. A leader is the point farthest from a
// centre in the middle of a cell of directions; leaders of cells that meet at a node of the grid
// are joined. The surface is found at once, by all threads, near to the hull, where a simplex needs
// a dozen rounds to come.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "filter/pseudo_hull/primitives.hpp"
#include "filter/star_hull/star_math.hpp"

namespace cullhull::internal {

// The grid lies on the surface of the cube [0, m]^3: a node has integer coordinates, of which one
// is 0 or m within a face, two on an edge, three at a corner; a cell lies between four nodes. Four
// cells meet at a node, three at a corner of the cube. Node and cell are dual: cells become
// vertices, a node two triangles (c0, c1, c2) and (c0, c2, c3) of the cells around it, a corner
// one. Facets are numbered by nodes, those within faces first, those at the cube's corners last.
//
// Two cells around a node P have a side of the grid in common, from P to a node Q; across the edge
// of their leaders lies a triangle of Q.

/// The grid, and the facets of its nodes.
struct LeaderGrid3 {
  std::uint32_t m;  ///< cells along an edge of the cube, 2 to 2^10

  struct Node {
    std::uint32_t at[3];
  };
  /// The cells around a node, counterclockwise from outside.
  struct Ring {
    std::uint32_t cell[4];
    unsigned size;
  };

  CULLHULL_HD std::uint32_t cells() const { return 6 * m * m; }
  CULLHULL_HD std::uint32_t facets() const { return 12 * m * m - 4; }

  /// The node nearest to the direction y, whose coordinate of the largest magnitude is 1 or -1.
  CULLHULL_HD Node nearest(const double* y) const {
    Node node;
    for (unsigned k = 0; k < 3; ++k)
      node.at[k] = static_cast<std::uint32_t>((y[k] + 1) * (0.5 * m) + 0.5);
    return node;
  }
  CULLHULL_HD std::uint32_t first_facet(const Node& p) const {
    const std::uint32_t inner = m - 1;
    bool border[3];
    unsigned borders = 0;
    for (unsigned k = 0; k < 3; ++k) borders += border[k] = p.at[k] == 0 || p.at[k] == m;
    const auto high = [&](unsigned k) { return std::uint32_t{p.at[k] == m}; };
    if (borders == 3) return 12 * inner * (inner + 2) + (high(0) << 2 | high(1) << 1 | high(2));
    for (unsigned k = 0; k < 3; ++k) {
      const unsigned a = (k + 1) % 3, b = (k + 2) % 3;
      if (borders == 1 && border[k])
        return 2 * (((2 * k + high(k)) * inner + p.at[a] - 1) * inner + p.at[b] - 1);
      if (borders == 2 && !border[k])
        return 12 * inner * inner + 2 * ((4 * k + 2 * high(a) + high(b)) * inner + p.at[k] - 1);
    }
    return 0;
  }
  CULLHULL_HD Node node_of(std::uint32_t facet) const {
    const std::uint32_t inner = m - 1;
    const std::uint32_t edges = 12 * inner * inner, corners = edges + 24 * inner;
    Node p;
    for (unsigned k = 0; k < 3; ++k) {
      const unsigned a = (k + 1) % 3, b = (k + 2) % 3;
      const std::uint32_t within = facet / 2, along = (facet - edges) / 2;
      if (facet >= corners) {
        p.at[k] = ((facet - corners) >> (2 - k) & 1) * m;
      } else if (facet < edges && within / (inner * inner) / 2 == k) {
        p.at[k] = within / (inner * inner) % 2 * m;
        p.at[a] = within / inner % inner + 1;
        p.at[b] = within % inner + 1;
      } else if (facet >= edges && along / inner / 4 == k) {
        p.at[k] = along % inner + 1;
        p.at[a] = along / inner / 2 % 2 * m;
        p.at[b] = along / inner % 2 * m;
      }
    }
    return p;
  }

  /// Twice the coordinates of the cell's middle.
  CULLHULL_HD Node middle(std::uint32_t cell) const {
    const std::uint32_t face = cell / (m * m);
    Node c;
    for (unsigned k = 0; k < 3; ++k) {
      if (face / 2 != k) continue;
      c.at[k] = face % 2 * 2 * m;
      c.at[(k + 1) % 3] = 2 * (cell / m % m) + 1;
      c.at[(k + 2) % 3] = 2 * (cell % m) + 1;
    }
    return c;
  }
  /// The cell of the face of axis k that lies at the low or high side of the node on both others.
  CULLHULL_HD std::uint32_t cell_at(const Node& p, unsigned k, bool high_a, bool high_b) const {
    const std::uint32_t face = 2 * k + (p.at[k] == m);
    return (face * m + p.at[(k + 1) % 3] - !high_a) * m + p.at[(k + 2) % 3] - !high_b;
  }
  CULLHULL_HD Ring around(const Node& p) const {
    bool border[3], high[3];
    unsigned borders = 0, odd = 0;
    for (unsigned k = 0; k < 3; ++k) {
      high[k] = p.at[k] == m;
      borders += border[k] = p.at[k] == 0 || high[k];
      odd += p.at[k] == 0;  // a low face is seen from its other side: the order is reversed
    }
    Ring r;
    r.size = borders == 3 ? 3 : 4;
    r.cell[3] = 0;
    if (borders == 3)
      for (unsigned k = 0; k < 3; ++k)
        r.cell[k] = cell_at(p, k, !high[(k + 1) % 3], !high[(k + 2) % 3]);
    for (unsigned k = 0; k < 3; ++k) {
      const unsigned a = (k + 1) % 3, b = (k + 2) % 3;
      if (borders == 1 && border[k])
        for (unsigned q = 0; q < 4; ++q) r.cell[q] = cell_at(p, k, q == 1 || q == 2, q >= 2);
      // On the face of axis a the others are b and k, on that of b they are k and a.
      if (borders == 2 && !border[k])
        for (unsigned q = 0; q < 4; ++q)
          r.cell[q] =
              q == 0 || q == 3 ? cell_at(p, a, !high[b], q == 3) : cell_at(p, b, q == 2, !high[a]);
    }
    if (odd % 2 != 0) {
      const Ring q = r;
      r.cell[0] = q.size == 3 ? q.cell[2] : q.cell[3];
      r.cell[1] = q.size == 3 ? q.cell[1] : q.cell[2];
      r.cell[2] = q.size == 3 ? q.cell[0] : q.cell[1];
      r.cell[3] = q.cell[0];
    }
    return r;
  }

  /// The side of the triangle across the edge from the ring's q-th cell to the next one.
  CULLHULL_HD StarSide across(const Node& p, const Ring& r, unsigned q) const {
    const std::uint32_t from = r.cell[q], to = q + 1 == r.size ? r.cell[0] : r.cell[(q + 1) % 4];
    const Node c = middle(from), d = middle(to);
    Node other;
    for (unsigned k = 0; k < 3; ++k) other.at[k] = c.at[k] == d.at[k] ? c.at[k] - p.at[k] : p.at[k];
    const Ring there = around(other);
    unsigned e = 0;
    for (unsigned j = 1; j < 4; ++j)
      if (j < there.size && there.cell[j] == to) e = j;
    // The edges of (c0, c1, c2) lie opposite to corners 2, 0, 1, those of (c0, c2, c3) to 2, 0, 1.
    if (there.size == 3) return side_of_facet(first_facet(other), (e + 2) % 3);
    return side_of_facet(first_facet(other) + (e >= 2), e == 0 ? 2 : e == 3 ? 1 : 0);
  }
  /// A facet with cells in place of vertices.
  CULLHULL_HD StarFacet facet(std::uint32_t f) const {
    const Node p = node_of(f);
    const Ring r = around(p);
    const std::uint32_t first = first_facet(p);
    if (r.size == 3)
      return {{r.cell[0], r.cell[1], r.cell[2]},
              {across(p, r, 1), across(p, r, 2), across(p, r, 0)}};
    if (f == first)
      return {{r.cell[0], r.cell[1], r.cell[2]},
              {across(p, r, 1), side_of_facet(f + 1, 2), across(p, r, 0)}};
    return {{r.cell[0], r.cell[2], r.cell[3]},
            {across(p, r, 2), across(p, r, 3), side_of_facet(first, 1)}};
  }
};

/// Where directions are measured: from a centre, in units of half the extent of each axis.
struct LeaderFrame {
  double centre[3], unit[3];
};

/// The direction of x, scaled so that its largest magnitude is 1, and the square of its length
/// before that; NaN at the centre and for a row that must survive.
CULLHULL_HD_INLINE double cube_direction(const LeaderFrame& frame, const double* x, double* y) {
  double largest = 0, square = 0;
  for (unsigned k = 0; k < 3; ++k) {
    y[k] = (x[k] - frame.centre[k]) * frame.unit[k];
    square += y[k] * y[k];
    largest = std::fabs(y[k]) > largest ? std::fabs(y[k]) : largest;
  }
  for (unsigned k = 0; k < 3; ++k) y[k] = y[k] / largest;
  return square;
}

// A leader is offered as the bits of its squared distance in f32 above those of its row: of equal
// ones the lowest row wins. That the outer half of a cell is left out keeps leaders apart: two
// cells' leaders are seen from the centre in the order of the cells.

/// Offers each row in the middle of a cell to that cell.
template <class Rows>
struct OfferLeader {
  Rows rows;
  LeaderGrid3 grid;
  LeaderFrame frame;

  CULLHULL_HD Offer operator()(std::uint32_t i) const {
    double x[3], y[3];
    rows.load(i, x);
    const double square = cube_direction(frame, x, y);
    Offer offer = {no_item, 0};
    for (unsigned k = 0; k < 3; ++k) {
      if (offer.cell != no_item || std::fabs(y[k]) != 1) continue;
      const double a = (y[(k + 1) % 3] + 1) * (0.5 * grid.m),
                   b = (y[(k + 2) % 3] + 1) * (0.5 * grid.m);
      if (!(std::fabs(a - std::floor(a) - 0.5) <= 0.25 &&
            std::fabs(b - std::floor(b) - 0.5) <= 0.25))
        break;
      const std::uint32_t face = 2 * k + (y[k] > 0);
      offer.cell =
          (face * grid.m + static_cast<std::uint32_t>(a)) * grid.m + static_cast<std::uint32_t>(b);
      offer.value = std::uint64_t{std::bit_cast<std::uint32_t>(static_cast<float>(square))} << 32 |
                    (no_item - i);
    }
    return offer;
  }
};

/// Makes the facets: vertices are rows, no_item where a cell has no leader.
struct JoinLeaders {
  LeaderGrid3 grid;
  const std::uint64_t* best;
  StarFacet* facet;
  CULLHULL_HD void operator()(std::uint32_t f) const {
    StarFacet made = grid.facet(f);
    for (auto& v : made.vertex) v = no_item - static_cast<std::uint32_t>(best[v]);
    facet[f] = made;
  }
};

/// The walk of a row begins at a triangle of the node nearest to its direction.
struct FromNearestNode {
  LeaderGrid3 grid;
  LeaderFrame frame;
  CULLHULL_HD std::uint32_t operator()(const double* x) const {
    double y[3];
    cube_direction(frame, x, y);
    // Comparisons that a NaN fails.
    return y[0] <= 1 && y[1] <= 1 && y[2] <= 1 ? grid.first_facet(grid.nearest(y)) : 0;
  }
};

}  // namespace cullhull::internal
