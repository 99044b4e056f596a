// The ladder in 3D, for points of the local frame (|x| <= 1): an inlined filter in doubles, one in
// double-doubles that decides nearly flat cases, then integers. docs/exactness.md, "In 3D".
#pragma once

#include <cmath>
#include <cstdint>

#include "exact/determinants/minors.hpp"
#include "exact/orientation/orientation.hpp"
#include "exact/points/local_points.hpp"

namespace cullhull::internal {

/// Returns det [a; b; c] in doubles, by the same order of operations everywhere.
inline double determinant_3(const double* a, const double* b, const double* c) {
  return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
         a[2] * (b[0] * c[1] - b[1] * c[0]);
}
/// Returns the permanent of the absolute values, by the same order of operations.
inline double permanent_3(const double* a, const double* b, const double* c) {
  return std::abs(a[0]) * (std::abs(b[1] * c[2]) + std::abs(b[2] * c[1])) +
         std::abs(a[1]) * (std::abs(b[2] * c[0]) + std::abs(b[0] * c[2])) +
         std::abs(a[2]) * (std::abs(b[0] * c[1]) + std::abs(b[1] * c[0]));
}

/// Computes the sign of det [b - a; c - a; p - a] in double-doubles; returns false if that is in
/// doubt. `tiny`: the largest effect of underflow on the determinant, 2^-1000 for |x| <= 1.
bool side_in_double_doubles(const double* a, const double* b, const double* c, const double* p,
                            double tiny, Sign& sign);

/// Computes signs among the points of one LocalPoints of dimension 3. Threads may call const
/// functions concurrently, each with its own counts.
class Orientation3D {
 public:
  /// `simplex`: four independent points, whose exact centroid is called O. Time O(n) if the points
  /// are on a lattice, else O(1).
  Orientation3D(const LocalPoints& points, const std::uint32_t* simplex);

  /// Returns O rounded, within 6 u per coordinate.
  const double* centre() const { return centre_; }

  /// Returns the sign of det [b - a; c - a; p - a], like orientation(3, {a, b, c, p}). The
  /// arguments are rows of `points.coordinates` (or copies) and their ids.
  struct Point {
    const double* row;
    std::uint32_t id;
  };
  Sign side(Point a, Point b, Point c, Point p, RungCounts& rungs) const {
    double m[3][3];
    for (unsigned j = 0; j < 3; ++j) {
      m[0][j] = b.row[j] - a.row[j];
      m[1][j] = c.row[j] - a.row[j];
      m[2][j] = p.row[j] - a.row[j];
    }
    const double det = determinant_3(m[0], m[1], m[2]);
    // A small lattice: no operation rounds.
    const double bound =
        exact_doubles_
            ? 0
            : (minor_roundings(3) + 2) * unit_roundoff * permanent_3(m[0], m[1], m[2]) + 0x1p-1000;
    if (exact_doubles_ || std::abs(det) > bound) {
      rungs.count(Rung::filter);
      return sign_of(det);
    }
    return side_hard(a, b, c, p, rungs);
  }

  /// Compares the rows in the cache first: equal points have equal rows, and exact rows would have
  /// to be fetched.
  bool equal(Point a, Point b) const {
    const auto same = [](const double* x, const double* y) {
      return x[0] == y[0] && x[1] == y[1] && x[2] == y[2];
    };
    return same(a.row, b.row) &&
           (points_->exact == points_->coordinates || same(exact_row(a), exact_row(b)));
  }

  /// Returns the sign of det [a - O; b - O; p - O].
  Sign cone_side(Point a, Point b, Point p, RungCounts& rungs) const;

 private:
  Sign side_hard(Point a, Point b, Point c, Point p, RungCounts& rungs) const;
  void find_lattice();
  Sign lattice_side(Point a, Point b, Point c, Point p) const;
  Sign lattice_cone_side(Point a, Point b, Point p) const;
  std::int64_t integer(const double* row, unsigned j) const {
    return static_cast<std::int64_t>(row[j] * to_integer_[j]);
  }
  const double* exact_row(Point p) const { return points_->exact_row(p.id); }

  const LocalPoints* points_;
  std::uint32_t simplex_[4];
  double centre_[3], centre_low_[3];  // O is within 2^-103 of their sum
  bool exact_doubles_;
  /// Whether a 128-bit integer can represent any determinant of differences; then coordinates times
  /// `to_integer_` are integers.
  bool lattice_ = false;
  double to_integer_[3] = {1, 1, 1};
};

}  // namespace cullhull::internal
