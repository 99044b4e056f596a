// Decides which triangles of one part of the points are final: whatever points the other part's box
// contains, these triangles belong to the triangulation of both parts.
//
// The error of the centre. z solves m_i . z = |m_i|^2 / 2 for the two edges m_i. What the computed
// z fails these equations by, with the roundings of the check, is at most `off` in each. The true
// centre differs from z by M^-1 times that. Entries of M^-1 are cofactors over the determinant, and
// a cofactor is at most the length of the other row (Hadamard): so the distance is at most k^2 off
// Prod |m_i| / (min |m_i| |det|) with k = 2, and |det| is at least its computed value less 64 u
// Prod |m_i|. The code takes twice that.
//
// Example: a triangle with edges of 0.01 at a right angle, det = 1e-4, off = 16 u * 1e-4 = 2e-19:
// the error is below 8 * 2e-19 * 1e-4 / (0.01 * 1e-4) = 2e-16, to which 4 u is added: its circle of
// radius 0.007 is final if it is 2e-15 away from the other part's box. A sliver's circle is so
// large that it meets the box: not final.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "exact/determinants/minors.hpp"
#include "exact/insphere/lift_filter.hpp"
#include "exact/orientation/orientation.hpp"
#include "exact/points/local_points.hpp"

namespace cullhull::internal {

/// The bounding box of a part's points in the plane.
struct PartBox {
  std::array<double, 2> low, high;

  // A ghost stands for the half plane beyond a hull edge. If the other part's box is strictly on
  // the inner side, no point of it is beyond the edge or on its line: the edge is one of the whole
  // set's hull, and the points on its line are this part's alone. Strictness matters: a point of
  // the other part on the line would be between or beyond the edge's ends and change it.

  /// Whether every corner of the box is strictly on the inner side of the hull edge of a ghost,
  /// whose infinite vertex is in slot g.
  bool within(const LiftedPoints& s, const std::uint32_t* ghost, unsigned g) const {
    const double* at[3];
    std::array<double, 2> corner;
    for (unsigned i = 0; i <= 2; ++i) at[i] = i == g ? corner.data() : s.row(ghost[i]);
    for (unsigned bits = 0; bits < 1U << 2; ++bits) {
      for (unsigned a = 0; a < 2; ++a) corner[a] = (bits >> a & 1) != 0 ? high[a] : low[a];
      if (orientation(2, at) != Sign::negative) return false;
    }
    return true;
  }
};

/// Whether the closed circumcircle of a finite cell certainly misses the box; false if in doubt.
/// Compares the distance of the box from an approximate centre z with the radius plus a bound on
/// z's error. docs/exactness.md, "Parts", derives the bound.
inline bool surely_misses(const LiftedPoints& s, const std::uint32_t* v, const PartBox& box) {
  const double* o = s.row(v[0]);
  double m[2][2], half[2];
  double lengths = 1, shortest = 8;  // of the rows, squared
  for (unsigned i = 0; i < 2; ++i) {
    const double* q = s.row(v[i + 1]);
    double square = 0;
    for (unsigned a = 0; a < 2; ++a) {
      m[i][a] = q[a] - o[a];
      square += m[i][a] * m[i][a];
    }
    half[i] = square / 2;
    lengths *= square;
    shortest = std::min(shortest, square);
  }
  double z[2];  // the centre relative to o, by Cramer's rule
  const double det = m[0][0] * m[1][1] - m[0][1] * m[1][0];
  z[0] = (half[0] * m[1][1] - half[1] * m[0][1]) / det;
  z[1] = (half[1] * m[0][0] - half[0] * m[1][0]) / det;
  // The rows' lengths bound the determinant's error and the cofactors (Hadamard).
  const double product = std::sqrt(lengths);
  const double sure = std::abs(det) - 64 * unit_roundoff * product - 0x1p-500;
  double reach = 0, size = 0;
  for (unsigned a = 0; a < 2; ++a) {
    reach += z[a] * z[a];
    size += std::abs(z[a]);
  }
  if (!(sure > 0) || !(reach < 16)) return false;  // radius beyond all points, or NaN
  // Bound on the residual of the equations m_i . z = |m_i|^2 / 2, as computed plus rounding.
  // Cramer's rule converts it into the distance between z and the centre.
  double off = 0;
  for (unsigned i = 0; i < 2; ++i) {
    double dot = 0, magnitude = half[i];
    for (unsigned a = 0; a < 2; ++a) {
      dot += m[i][a] * z[a];
      magnitude += std::abs(m[i][a] * z[a]);
    }
    off = std::max(off, std::abs(dot - half[i]) + 16 * unit_roundoff * magnitude);
  }
  const double error =
      8 * off * product / (std::sqrt(shortest) * sure) + 4 * unit_roundoff * (size + 1) + 0x1p-500;
  const double radius = std::sqrt(reach) * (1 + 16 * unit_roundoff) + 2 * error;
  double distance = 0;
  for (unsigned a = 0; a < 2; ++a) {
    const double at = o[a] + z[a];
    const double gap = std::max(box.low[a] - at, at - box.high[a]);
    if (gap > 0) distance += gap * gap;
  }
  return std::sqrt(distance) * (1 - 16 * unit_roundoff) - 16 * unit_roundoff > radius;
}

}  // namespace cullhull::internal
