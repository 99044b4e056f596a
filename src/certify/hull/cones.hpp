// Side tests in doubles against the planes of the simplices: the fast stage of every check of
// certify. docs/exactness.md, "Cones"; the bounds:
//
// The centre o is a double. With y = fl(x - o) in units that bring every vertex to within 1 (powers
// of two), M = N / (N*w) the plane of a simplex through w = v_0 - o, and cofactors N~ off by a_c =
// (N(r) + 3) u P_c + 2^-1000, the height h = fl(N~*w) is off by b = 1.01 Sum (a_c |w_c| + (k + 3) u
// |N~_c w_c|) and used if b < h / 2. Then m_c = fl(N~_c / h) is off by (a_c + (|N~_c| + a_c) b / (h
// - b)) / h + u |m_c|, and the dot product m*y, with y's own rounding, by (k + 2) u Sum |m_c y_c|
// more: together at most E = 1.02 Sum eps_c R_c for points within the box of half extents R_c. A
// walk goes to the neighbour with the greatest m*y until none is greater. If there m_f*y - E_f
// exceeds m_h*y + E_h for every neighbour h, x is in the open cone of f ("Cached planes"), and with
// m_f*y + E_f < 1 it is strictly inside; a sum that begins with E is compared with 1 - 2^-50, which
// covers the roundings of E itself. Else exact signs decide. A height used in this way is positive,
// so o is strictly beneath that simplex. Ball: |M_f| <= |m_f| + 2 E_f since R_c >= 1/2; a point
// nearer to o than the least 1 / (|m_f| + 2 E_f) is strictly inside.
#pragma once

#include <cmath>
#include <cstdint>
#include <vector>

#include "certify/certificate.hpp"

namespace cullhull::internal::certify {

/// Planes n . y = 1 of all simplices, each with a bound of the rounding error of n . y. Coordinates
/// y are relative to the centre, scaled on each axis.
class Cones {
 public:
  static constexpr unsigned max_dimension = 8;

  explicit Cones(const Subject& s) : s_(s), k_(s.k) {}
  /// Computes the planes around the subject's centre. Afterwards usable() is false if there is no
  /// centre, for dimensions other than 2 to 8, and if extents exceed the range of the proof.
  void place();
  void drop() { planes_.clear(); }
  bool usable() const { return !planes_.empty(); }

  /// Whether the centre is strictly beneath simplex f; false if doubles do not decide it.
  bool beneath(std::uint32_t f) const { return std::isfinite(plane(f)[k_]); }
  /// Whether y, in the vertices' box, is strictly beneath simplex f; false if undecided.
  template <unsigned K>
  bool strictly_beneath(std::uint32_t f, const double* y) const {
    const double* n = plane(f);
    double sum = n[K];
    for (unsigned j = 0; j < K; ++j) sum += n[j] * y[j];
    return sum < 1 - 0x1p-50;
  }

  /// Sets y to x relative to the centre, scaled as the planes are; false if outside the vertices'
  /// box.
  bool relative(const double* x, double* y) const {
    for (unsigned j = 0; j < k_; ++j) y[j] = (x[j] - centre_[j]) * scale_[j];
    return in_box(y);
  }
  bool in_box(const double* y) const {
    bool within = true;
    for (unsigned j = 0; j < k_; ++j) within = within && std::fabs(y[j]) <= reach_[j];
    return within;
  }
  double scale(unsigned j) const { return scale_[j]; }
  const std::vector<double>& scales() const { return scale_; }

  /// True only if the point is strictly inside. Starts at simplex f, and sets f to the last simplex
  /// visited: the one that the ray through the point meets, or one near it.
  bool strictly_inside(const double* y, std::uint32_t& f) const;
  /// Points with |y|^2 below this, computed in doubles in any order, are strictly inside; 0 if the
  /// planes give no such bound.
  double ball() const { return ball_; }
  const std::vector<double>& centre() const { return centre_; }
  /// n . y of simplex f.
  double value(std::uint32_t f, const double* y) const;

 private:
  template <unsigned K>
  void build();
  template <unsigned K>
  bool strictly_inside_in(const double* y, std::uint32_t& f) const;
  bool choose_units();
  template <unsigned K>
  bool build_plane(std::uint32_t f, double* out) const;
  double* plane(std::uint32_t f) { return planes_.data() + std::size_t{f} * (k_ + 1); }
  const double* plane(std::uint32_t f) const { return planes_.data() + std::size_t{f} * (k_ + 1); }

  const Subject& s_;
  const unsigned k_;
  std::vector<double> centre_, scale_, reach_;
  double ball_ = 0;
  Array<double> planes_;  ///< k + 1 per simplex: n, then the bound (infinite: unusable)
};

}  // namespace cullhull::internal::certify
