// The predicates of the insertion: the position of the point to be inserted relative to a cell's
// facets and its circumsphere.
#pragma once

#include <array>
#include <cstdint>
#include <type_traits>
#include <vector>

#include "delaunay/cell_store.hpp"
#include "exact/insphere/lift_side.hpp"
#include "exact/orientation/orientation.hpp"
#include "exact/points/local_points.hpp"

namespace cullhull::internal {

/// Exact signs of one point at a time. K: the dimension if it is a compile-time constant, else 0.
template <unsigned K>
class PointSigns {
 public:
  explicit PointSigns(const LiftedPoints& s) : s_(s) {
    if constexpr (K == 0) {
      at_.resize(s.base + 1);
      probe_.resize(s.base + 1);
    }
  }
  const LiftCounts& counts() const { return counts_; }

  /// Sets the query point, which is called p below.
  void set_query(std::uint32_t point) {
    point_ = point;
    p_ = s_.row(point);
  }

  /// The coordinates of p.
  const double* point() const { return p_; }

  /// The orientation of k + 1 points.
  Sign orientation(const std::uint32_t* v) {
    for (unsigned i = 0; i < corners(); ++i) at_[i] = s_.row(v[i]);
    return base_orientation<K>(s_, at_.data());
  }

  /// The orientation of a cell whose corner j is replaced by p; only corner j may be infinite.
  Sign replaced(const std::uint32_t* v, unsigned j) {
    for (unsigned i = 0; i < corners(); ++i) probe_[i] = i == j ? p_ : s_.row(v[i]);
    return base_orientation<K>(s_, probe_.data());
  }

  /// A slot of a finite cell, other than `from`, whose opposite facet separates p from the cell;
  /// corners() if there is no such slot.
  unsigned separating_facet(const std::uint32_t* v, unsigned from) {
    if constexpr (K == 2 || K == 3) {
      if (s_.filtered) return separating_facet_filtered(v, from);
    }
    for (unsigned j = 0; j < corners(); ++j)
      if (j != from && replaced(v, j) == Sign::negative) return j;
    return corners();
  }

  /// Whether p is below the lifted cell (without weights: inside its circumsphere), ties broken.
  bool conflict(const std::uint32_t* v) {
    if constexpr (K >= 2) {
      Sign by_powers = Sign::zero;
      if (!s_.powers.empty() && lift_side_by_powers<K>(s_, v, point_, by_powers)) {
        ++counts_.rungs[0];
        return by_powers == Sign::negative;
      }
    }
    for (unsigned i = 0; i < corners(); ++i) at_[i] = s_.row(v[i]);
    const Sign side = lift_side<K>(s_, at_.data(), p_, counts_);
    if (side != Sign::zero) return side == Sign::negative;
    return tied_conflict(v);
  }

  /// The same for any cell of a store. p is in conflict with a ghost if it is beyond its finite
  /// facet, or on it and in conflict with the cell there.
  bool conflict(CellStore<K>& store, std::uint32_t c) {
    if (const unsigned g = store.ghost_slot(c); g < corners()) {
      const Sign beyond = replaced(store.vertices(c), g);
      if (beyond != Sign::zero) return beyond == Sign::positive;
      c = store.cell_of(store.neighbours(c)[g]);
    }
    return conflict(store.vertices(c));
  }

  // Symbolic perturbation, as an example. The corners of a square are a = (0, 0), b = (1, 0), c =
  // (1, 1), d = (0, 1) with ids 0, 1, 2, 3. All four lie on one circle, so d is neither inside nor
  // outside of the circle of a, b, c: E = 0. Lower the lift of id 0 by e_0. E is linear in each
  // lift, and the coefficient of a's is the orientation of the cell with d in the place of a: (d,
  // b, c) is turned left, so it is positive: no conflict. Indeed the lift of a went down, and the
  // plane over a, b, c with it, so at d the plane is lower than before, and d is above it. The
  // triangulation keeps (a, b, c) and adds (a, c, d): its diagonal is at the lowest id. If the
  // coefficient were zero, id 1 would be asked next; the point's own coefficient is never zero (the
  // cell is not flat), so the search ends.
  //
  // Any other order of insertion asks the same signs of the same ids, and so ends at the same
  // diagonal.

  /// conflict() for a point on the lifted cell's plane. Symbolic perturbation lowers the lift of id
  /// i by an infinitesimal e_i, e_0 >> e_1 >> ...; the first nonzero coefficient in the order of
  /// ids decides. docs/exactness.md, "Ties".
  bool tied_conflict(const std::uint32_t* v) {
    ++counts_.ties;
    const std::uint32_t own = s_.ids[point_];
    std::uint64_t next = 0;  // the coefficients of ids below this are zero
    for (;;) {
      unsigned slot = corners();
      std::uint32_t lowest = own;
      for (unsigned i = 0; i < corners(); ++i) {
        const std::uint32_t id = s_.ids[v[i]];
        if (id < next || id >= lowest) continue;
        lowest = id;
        slot = i;
      }
      if (slot == corners()) return true;
      const Sign sign = replaced(v, slot);
      if (sign != Sign::zero) return sign == Sign::negative;
      next = std::uint64_t{lowest} + 1;
    }
  }

 private:
  using Rows =
      std::conditional_t<K != 0, std::array<const double*, K + 1>, std::vector<const double*>>;
  unsigned corners() const { return (K ? K : s_.base) + 1; }

  // All d + 1 signs come from the differences of the corners from p, which are computed once:
  // replacing corner j by p leaves the determinant of the other corners' differences, with the sign
  // (-1)^j from moving p to the front. Example in the plane: p inside of (a, b, c): (b - p) x (c -
  // p), (c - p) x (a - p) and (a - p) x (b - p) are all positive.

  /// separating_facet() with a floating-point filter: the orientation with corner j replaced by p
  /// is (-1)^j times the determinant of the other corners' differences from p.
  unsigned separating_facet_filtered(const std::uint32_t* v, unsigned from) {
    double m[K + 1][K];
    double largest[K] = {};
    for (unsigned i = 0; i <= K; ++i) {
      const double* q = s_.row(v[i]);
      for (unsigned a = 0; a < K; ++a) {
        m[i][a] = q[a] - p_[a];
        largest[a] = std::max(largest[a], std::abs(m[i][a]));
      }
    }
    const double bound =
        determinant_bound<K>(largest, minor_roundings(K) + 6, unit_roundoff, s_.tiny);
    for (unsigned j = 0; j <= K; ++j) {
      if (j == from) continue;
      double det = 0;
      const double *a = m[j == 0 ? 1 : 0], *b = m[j <= 1 ? 2 : 1];
      if constexpr (K == 2) {
        det = a[0] * b[1] - a[1] * b[0];
      } else {
        const double* c = m[j <= 2 ? 3 : 2];
        det = a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) +
              a[2] * (b[0] * c[1] - b[1] * c[0]);
      }
      if (j % 2 == 1) det = -det;
      if (det > bound) continue;
      if (det < -bound || replaced(v, j) == Sign::negative) return j;
    }
    return K + 1;
  }

  const LiftedPoints& s_;
  const double* p_ = nullptr;
  std::uint32_t point_ = 0;
  Rows at_, probe_;
  LiftCounts counts_;
};

}  // namespace cullhull::internal
