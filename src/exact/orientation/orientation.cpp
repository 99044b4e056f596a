#include "exact/orientation/orientation.hpp"

#include <gmp.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include "exact/determinants/determinant_sign.hpp"
#include "exact/determinants/minors.hpp"
#include "exact/determinants/modular.hpp"
#include "exact/numbers/double_double.hpp"
#include "exact/planes/exact_plane.hpp"
#include "exact/points/integer_points.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/int128.hpp"

namespace cullhull::internal {
namespace {

// ---------------------------------------------------------------------------------------------
// Rung 2: double arithmetic with a bound from the permanent (docs/exactness.md, "Orientation
// filter").

// Why two magnitude limits: with differences M in [2^-100, 2^100] a determinant of D <= 6 rows and
// its permanent stay below 6! 2^600, far from overflow. A product that underflows loses at most
// 2^-1075 and is multiplied by at most D - 1 further factors (8 M each with the sums): less than
// 2^-343 in all, so 2^-340 covers it. Example: points on a circle of radius 1 around (10^6, 10^6)
// in 2D: differences are exact to u, det is about 1, the bound 6 u * 2: shifted points need no more
// than centred ones, as only differences count.
template <unsigned D>
bool filtered(const double* const* p, Sign& sign) {
  double m[D][D];
  double largest = 0;
  for (unsigned i = 0; i < D; ++i)
    for (unsigned j = 0; j < D; ++j) {
      m[i][j] = p[i + 1][j] - p[0][j];
      largest = std::max(largest, std::abs(m[i][j]));
    }
  // Within these magnitudes no product overflows (8! 2^800), and all underflows, even if amplified
  // by later factors, add up to less than 2^-340.
  if (!(largest >= 0x1p-100 && largest <= 0x1p100)) return false;
  double det[1U << D], perm[1U << D];
  expand_minors<D, true>(m, D, det, perm);
  constexpr double factor = (minor_roundings(D) + 2) * unit_roundoff;
  const double value = det[(1U << D) - 1];
  const double bound = factor * perm[(1U << D) - 1] + 0x1p-340;
  if (value > bound) {
    sign = Sign::positive;
    return true;
  }
  if (value < -bound) {
    sign = Sign::negative;
    return true;
  }
  // All points may be on a plane orthogonal to an axis, as on a box: a column of zeros (differences
  // of doubles are zero only if the doubles are equal).
  for (unsigned j = 0; j < D; ++j) {
    bool zero = true;
    for (unsigned i = 0; i < D; ++i) zero &= m[i][j] == 0;
    if (!zero) continue;
    sign = Sign::zero;
    return true;
  }
  return false;
}

bool filtered(unsigned d, const double* const* p, Sign& sign) {
  if (d == 1) {
    sign = sign_of(p[1][0] < p[0][0] ? -1 : p[1][0] > p[0][0] ? 1 : 0);  // exact
    return true;
  }
  constexpr unsigned most = plane_only ? 2 : 6;
  return with_dimension<2, most, 0>(d, [&](auto k) {
    if constexpr (k > 0) return filtered<k>(p, sign);
    return false;
  });
}

// ---------------------------------------------------------------------------------------------
// Rung 3: integers. Column j of the points is divided by the largest power of two that divides all
// of its coordinates; signs of determinants do not change under positive column scaling.

// The centroid is (s_0 + ... + s_d) / (d + 1). Rows p - centroid times d + 1 are integers where
// coordinates are, and the determinant is multiplied by (d + 1)^d > 0, which keeps its sign.
// Example in the plane: the simplex (0, 0), (1, 0), (0, 1) and p = (1, 1): 3 (1, 1) - (1, 1) = (2,
// 2), three times the vector (2/3, 2/3) from the centroid to p.

/// The matrix with rows (d + 1) p[i] - sum of the d + 1 points of a simplex.
class CentroidDifferences {
 public:
  CentroidDifferences(unsigned d, const double* const* p, const double* const* simplex)
      : points_(d, p, d, simplex, d + 1) {
    // The sum of d + 1 coordinates and (d + 1) times one coordinate each stay below 2^61, so their
    // difference does not overflow.
    narrow_ = points_.bits() + bit_length(d + 1) <= 61;
    if (!narrow_) return;
    sums_.assign(d, 0);
    for (unsigned j = 0; j < d; ++j)
      for (unsigned i = 0; i <= d; ++i) sums_[j] += points_.small(d + i, j);
  }
  unsigned columns() const { return points_.dimension(); }
  bool narrow() const { return narrow_; }
  std::int64_t small(unsigned i, unsigned j) const {
    return static_cast<std::int64_t>(columns() + 1) * points_.small(i, j) - sums_[j];
  }
  void big(unsigned i, unsigned j, mpz_ptr out, mpz_ptr scratch) const {
    const unsigned d = columns();
    points_.big(i, j, out);
    mpz_mul_ui(out, out, d + 1);
    for (unsigned k = 0; k <= d; ++k) {
      points_.big(d + k, j, scratch);
      mpz_sub(out, out, scratch);
    }
  }

 private:
  IntegerPoints points_;
  bool narrow_ = false;
  std::vector<std::int64_t> sums_;
};

// Rounding once: 128-bit integers hold the cross product exactly, and the conversion to double is
// its only rounding, so each component is right to 2^-53 of itself, whatever cancelled.

/// Computes the cross product of two rows that fit 64 bits, rounded.
bool narrow_plane(const Differences& a, double* normal) {
  long exponents[3];
  for (unsigned j = 0; j < 3; ++j) {
    const unsigned u = j == 0 ? 1 : 0, v = j == 2 ? 1 : 2;
    // Entries below 2^63, so each product is below 2^126 and the difference below 2^127.
    const Int128 value =
        Int128{a.small(0, u)} * a.small(1, v) - Int128{a.small(0, v)} * a.small(1, u);
    int e = 0;
    normal[j] = std::frexp(static_cast<double>(j == 1 ? -value : value), &e);
    exponents[j] = static_cast<long>(e) - a.exponent(j);
  }
  return scale_normal(3, normal, exponents);
}

}  // namespace

Sign orientation_exact(unsigned d, const double* const* p) {
  const Differences rows(d, p, d);
  if (plane_only || d < signs_by_primes) return determinant_sign(rows);
  BigNumbers& m = kept_numbers(std::size_t{d} * d + 1);
  for (unsigned i = 0; i < d; ++i)
    for (unsigned j = 0; j < d; ++j)
      rows.big(i, j, m[std::size_t{i} * d + j], m[std::size_t{d} * d]);
  return determinant_sign_by_primes(m, d);
}

namespace {

// Example: a = (3, 1), b = (6, 2), c = (0, 0) are on a line: l = 3 * 2, r = 1 * 6, equal and exact,
// so the turn is 0 without integers. With a = (0.1, 0.3), b = (0.9, 2.7) and c = 0 both products
// round to the same double although, of these doubles, the exact products differ; their rounding
// errors, which Dekker's product gives exactly, are compared then.

/// Computes the sign of (a - c) x (b - c), the difference of two products, if the four differences
/// are doubles, as they mostly are on lattices and lines, where the sign is often exactly zero.
/// Rounding is monotone, so products that differ after rounding are in that order; else their
/// rounding errors decide. Returns false, with `sign` undefined, if a difference is rounded, or if
/// something overflows or underflows.
bool compare_products(const double* a, const double* b, const double* c, Sign& sign) {
  const DoubleDouble ax = DoubleDouble::sum(a[0], -c[0]), ay = DoubleDouble::sum(a[1], -c[1]),
                     bx = DoubleDouble::sum(b[0], -c[0]), by = DoubleDouble::sum(b[1], -c[1]);
  // A NaN, after an overflow, does not equal 0 either.
  if (!(ax.low == 0 && ay.low == 0 && bx.low == 0 && by.low == 0)) return false;
  const DoubleDouble l = DoubleDouble::product(ax.high, by.high),
                     r = DoubleDouble::product(ay.high, bx.high);
  if (l.high != r.high) {
    sign = l.high > r.high ? Sign::positive : Sign::negative;
    return l.high == l.high && r.high == r.high;
  }
  if (l.high == 0) {
    sign = Sign::zero;
    return (ax.high == 0 || by.high == 0) && (ay.high == 0 || bx.high == 0);
  }
  // From 2^-900 on the error is a multiple of at least 2^(-900 - 106), hence a double.
  if (!(std::fabs(l.high) >= 0x1p-900)) return false;
  sign = sign_of(l.low > r.low ? 1 : l.low < r.low ? -1 : 0);
  return l.low == l.low && r.low == r.low;  // splitting a factor may overflow
}

}  // namespace

Sign turn_exact(const double* a, const double* b, const double* c) {
  Sign sign = Sign::zero;
  if (compare_products(a, b, c, sign)) return sign;
  const double* p[3] = {a, b, c};
  return orientation_exact(2, p);
}

Sign orientation_from_centroid_exact(unsigned d, const double* const* p,
                                     const double* const* simplex) {
  return determinant_sign(CentroidDifferences(d, p, simplex));
}

namespace {

/// The same where a determinant takes less time than the cofactors, which serve many points.
Sign eliminated_once(unsigned d, const double* const* p, Rung* rung) {
  thread_local EliminatedPlane plane;
  if (rung != nullptr) *rung = Rung::filter;
  if (plane.set(d, p)) {
    bool known = false;
    Sign sign = plane.side(p[d], known);
    if (known) return sign;
    if (plane.refine()) {
      sign = plane.refined_side(p[d], known);
      if (known) return sign;
    }
  }
  if (rung != nullptr) *rung = Rung::exact;
  return orientation_exact(d, p);
}

/// Computes the sign by rung 2 with elimination, then by rung 3 with cofactors.
Sign eliminated(unsigned d, const double* const* p, Rung* rung) {
  if (!plane_only && d >= signs_by_primes) return eliminated_once(d, p, rung);
  thread_local OrientedPlane plane;
  plane.set(d, p);
  return plane.side(p[d], rung);
}

}  // namespace

Sign orientation(unsigned d, const double* const* p, Rung* rung) {
  if (!plane_only && d >= elimination_pays) return eliminated(d, p, rung);
  Sign sign = Sign::zero;
  if (rung != nullptr) *rung = Rung::filter;
  if (filtered(d, p, sign)) return sign;
  if (rung != nullptr) *rung = Rung::exact;
  if (plane_only || d < 4) return orientation_exact(d, p);
  // 128-bit integers are fastest if they suffice, double-doubles where integers would be long.
  if (determinant_128(Differences(d, p, d), sign)) return sign;
  return eliminated(d, p, rung);
}

unsigned affine_rank_exact(unsigned d, const double* const* p, unsigned count, unsigned* columns) {
  if (count < 2) return 0;
  const unsigned rows = count - 1;
  const Differences a(d, p, rows);
  BigNumbers& m = kept_numbers(std::size_t{rows} * d + 1);
  for (unsigned i = 0; i < rows; ++i)
    for (unsigned j = 0; j < d; ++j)
      a.big(i, j, m[std::size_t{i} * d + j], m[std::size_t{rows} * d]);
  // Columns from left to right: the pivots are those of the row echelon form, which depend on the
  // flat alone, not on the points that span it.
  return !plane_only && std::min(rows, d) >= ranks_by_primes
             ? rank_by_primes(m, rows, d, columns)
             : echelon_form(m, rows, d, false, columns);
}

bool plane_exact(unsigned d, const double* const* p, double* normal) {
  if (d == 1) {
    normal[0] = 0.5;
    return true;
  }
  if (d == 3) {
    const Differences edges(d, p, 2);
    if (edges.narrow()) return narrow_plane(edges, normal);
  }
  thread_local ExactPlane plane;
  plane.set(d, p);
  if (plane.degenerate()) return false;
  plane.normal(normal);
  return true;
}

}  // namespace cullhull::internal
