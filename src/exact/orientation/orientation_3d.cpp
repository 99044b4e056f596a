#include "exact/orientation/orientation_3d.hpp"

#include <algorithm>

#include "exact/numbers/double_double.hpp"
#include "exact/numbers/double_parts.hpp"
#include "parallel/int128.hpp"

namespace cullhull::internal {
namespace {

DoubleDouble cross(DoubleDouble a, DoubleDouble b, DoubleDouble c, DoubleDouble d) {
  return a * b - c * d;
}

double determinant_high(const DoubleDouble (&m)[3][3]) {
  const DoubleDouble x = m[0][0] * cross(m[1][1], m[2][2], m[1][2], m[2][1]);
  const DoubleDouble y = m[0][1] * cross(m[1][2], m[2][0], m[1][0], m[2][2]);
  const DoubleDouble z = m[0][2] * cross(m[1][0], m[2][1], m[1][1], m[2][0]);
  return (x + y + z).high;
}

double high_permanent(const DoubleDouble (&m)[3][3]) {
  double h[3][3];
  for (unsigned i = 0; i < 3; ++i)
    for (unsigned j = 0; j < 3; ++j) h[i][j] = m[i][j].high;
  return permanent_3(h[0], h[1], h[2]);
}

Sign lattice_sign(const std::int64_t (&m)[3][3]) {
  const auto minor = [&](unsigned j, unsigned k) {
    return Int128{m[1][j]} * m[2][k] - Int128{m[1][k]} * m[2][j];
  };
  const Int128 det = m[0][0] * minor(1, 2) + m[0][1] * minor(2, 0) + m[0][2] * minor(0, 1);
  return det > 0 ? Sign::positive : det < 0 ? Sign::negative : Sign::zero;
}

/// Whether four points lie on at most two parallels of an axis, as those do that an object has in
/// common with its mirror image: they are on a plane.
bool on_two_lines(const double* a, const double* b, const double* c, const double* p) {
  for (unsigned j = 0; j < 3; ++j) {
    const unsigned k = j == 2 ? 0 : j + 1;
    const auto same = [j, k](const double* v, const double* w) {
      return v[j] == w[j] && v[k] == w[k];
    };
    const double* const other = !same(a, b) ? b : !same(a, c) ? c : p;
    const auto on_either = [&](const double* v) { return same(v, a) || same(v, other); };
    if (on_either(c) && on_either(p)) return true;
  }
  return false;
}

}  // namespace

// The bound of double-doubles. Differences of doubles are exact as pairs (two-sum); products err by
// 7 u^2 relatively, sums by 3 u^2 + 13 u^3. A 2 x 2 minor has two products and a sum: 7 + 3 +
// (second order) = 10.1 u^2 of its permanent. Its product with an entry adds 7: 17.2 u^2. Two more
// sums add 3 each: 23.5 u^2 of the permanent of the whole. 2^-101 = 32 u^2 is used, which also
// covers computing the permanent from the high parts. Example: four points of size 1, 1e-20 off a
// common plane that is across no axis: the permanent is about 2, the bound 1e-30 and the
// determinant 1e-20: decided, where doubles, with a bound of 2e-15, are not.
bool side_in_double_doubles(const double* a, const double* b, const double* c, const double* p,
                            double tiny, Sign& sign) {
  if (on_two_lines(a, b, c, p)) {
    sign = Sign::zero;
    return true;
  }
  DoubleDouble m[3][3];
  for (unsigned j = 0; j < 3; ++j) {
    m[0][j] = DoubleDouble::sum(b[j], -a[j]);
    m[1][j] = DoubleDouble::sum(c[j], -a[j]);
    m[2][j] = DoubleDouble::sum(p[j], -a[j]);
    // The points may be on a plane orthogonal to an axis, the usual cause of exact zeros away from
    // lattices.
    sign = Sign::zero;
    if (m[0][j].high == 0 && m[1][j].high == 0 && m[2][j].high == 0) return true;
  }
  const double det = determinant_high(m);
  sign = sign_of(det);
  return std::abs(det) > 0x1p-101 * high_permanent(m) + tiny;
}

Orientation3D::Orientation3D(const LocalPoints& points, const std::uint32_t* simplex)
    : points_(&points), exact_doubles_(points.small_lattice) {
  std::copy_n(simplex, 4, simplex_);
  for (unsigned j = 0; j < 3; ++j) {
    const DoubleDouble sum =
        DoubleDouble::sum(points.row(simplex[0])[j], points.row(simplex[1])[j]) +
        DoubleDouble::sum(points.row(simplex[2])[j], points.row(simplex[3])[j]);
    centre_[j] = sum.high / 4;
    centre_low_[j] = sum.low / 4;
  }
  find_lattice();
}

// Example: coordinates that were floats in [1/2, 1) are multiples of 2^-24, so l = -24 and b = 25
// on each axis: 75 <= 121. Doubles there have l = -53, b = 54: 162, so GMP decides them.

/// Finds out whether 128-bit integers suffice. Coordinates are multiples of 2^l, |x| <= 1:
/// differences are at most 2^(1 - l) units, and a determinant at most 3! times a product of three;
/// that of cone_side has 4 a - (sum of four points) in the first row, at most four times as much.
/// All must be below 2^127.
void Orientation3D::find_lattice() {
  if (points_->exact != points_->coordinates) return;
  int bits[3] = {1, 1, 1}, sum = 3;
  for (std::uint32_t i = 0; i < points_->count; ++i)
    for (unsigned j = 0; j < 3; ++j) {
      const double v = points_->row(i)[j];
      if (v == 0) continue;
      if (!(std::abs(v) <= 1)) return;  // points outside of a local frame
      const int b = 1 - lowest_bit_exponent(v);
      if (b <= bits[j]) continue;
      sum += b - bits[j];
      bits[j] = b;
      if (sum > 121 || b > 60) return;
    }
  lattice_ = true;
  for (unsigned j = 0; j < 3; ++j) to_integer_[j] = std::ldexp(1.0, bits[j] - 1);
}

Sign Orientation3D::lattice_side(Point a, Point b, Point c, Point p) const {
  std::int64_t m[3][3];
  for (unsigned j = 0; j < 3; ++j) {
    const std::int64_t base = integer(a.row, j);
    m[0][j] = integer(b.row, j) - base;
    m[1][j] = integer(c.row, j) - base;
    m[2][j] = integer(p.row, j) - base;
  }
  return lattice_sign(m);
}

Sign Orientation3D::lattice_cone_side(Point a, Point b, Point p) const {
  std::int64_t m[3][3];
  for (unsigned j = 0; j < 3; ++j) {
    const std::int64_t base = integer(a.row, j);
    m[0][j] = 4 * base;
    for (const std::uint32_t s : simplex_) m[0][j] -= integer(points_->row(s), j);
    m[1][j] = integer(b.row, j) - base;
    m[2][j] = integer(p.row, j) - base;
  }
  return lattice_sign(m);
}

Sign Orientation3D::side_hard(Point a, Point b, Point c, Point p, RungCounts& rungs) const {
  rungs.count(Rung::exact);
  if (lattice_) return lattice_side(a, b, c, p);
  Sign sign = Sign::zero;
  if (points_->exact == points_->coordinates &&
      side_in_double_doubles(a.row, b.row, c.row, p.row, 0x1p-1000, sign))
    return sign;
  const double* rows[4] = {exact_row(a), exact_row(b), exact_row(c), exact_row(p)};
  return orientation_exact(3, rows);
}

// The bound in doubles. The centre O, rounded, is off by u and a - O by 4 u a coordinate. With the
// 1-norms l_0, l_1, l_2 of the three rows the permanent is at most l_0 l_1 l_2, and the roundings
// of the expansion cost 9 u l_0 l_1 l_2. The error of the first row is multiplied by 2 x 2 minors
// of the other two, which add up to at most l_1 l_2: 4 u l_1 l_2. Used is u l_1 l_2 (11 l_0 + 9).
// Example: with edges of length 0.001 (1-norms about 0.0015) and l_0 = 1 that is 5e-21: it shrinks
// with the square of the edges, as the determinant does. In double-doubles O is a pair within 3
// u^2: at most 27 u^2 l_0 l_1 l_2 + 4 u^2 l_1 l_2, and 2^-101 l_1 l_2 (l_0 + 1) is used.
Sign Orientation3D::cone_side(Point a, Point b, Point p, RungCounts& rungs) const {
  // det [a - O; b - a; p - a]: only the first row depends on O, and the bound shrinks with the
  // edge.
  double h[3][3], length[3] = {0, 0, 0};
  for (unsigned j = 0; j < 3; ++j) {
    h[0][j] = a.row[j] - centre_[j];
    h[1][j] = b.row[j] - a.row[j];
    h[2][j] = p.row[j] - a.row[j];
    for (unsigned i = 0; i < 3; ++i) length[i] += std::abs(h[i][j]);
  }
  double det = determinant_3(h[0], h[1], h[2]);
  const double scale = length[1] * length[2];
  if (std::abs(det) > unit_roundoff * scale * (11 * length[0] + 9) + 0x1p-1000) {
    rungs.count(Rung::filter);
    return sign_of(det);
  }
  rungs.count(Rung::exact);
  if (lattice_) return lattice_cone_side(a, b, p);
  if (points_->exact == points_->coordinates) {
    DoubleDouble m[3][3];
    for (unsigned j = 0; j < 3; ++j) {
      m[0][j] = DoubleDouble::sum(a.row[j], -centre_[j]) - centre_low_[j];
      m[1][j] = DoubleDouble::sum(b.row[j], -a.row[j]);
      m[2][j] = DoubleDouble::sum(p.row[j], -a.row[j]);
    }
    det = determinant_high(m);
    if (std::abs(det) > 0x1p-101 * scale * (length[0] + 1) + 0x1p-1000) return sign_of(det);
  }
  const double* rows[3] = {exact_row(a), exact_row(b), exact_row(p)};
  const double* simplex[4];
  for (unsigned i = 0; i < 4; ++i) simplex[i] = points_->exact_row(simplex_[i]);
  return orientation_from_centroid_exact(3, rows, simplex);
}

}  // namespace cullhull::internal
