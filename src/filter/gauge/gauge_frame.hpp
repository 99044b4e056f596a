// The frame of a map: points of the input relative to a centre, scaled by powers of two, and what
// weights on them prove about a direction.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "filter/gauge/gauge_build.hpp"

namespace cullhull::internal {

/// What a combination of vertices q (relative to the centre) with weights mu >= 0 proves about a
/// direction v.
struct GaugeBound {
  double weight;    ///< at least the sum of the mu
  double residual;  ///< at least |v - sum mu q|_1
};

template <unsigned D>
class GaugeFrame {
 public:
  double centre(unsigned j) const { return centre_[j]; }
  double scale(unsigned j) const { return scale_[j]; }
  /// Returns L: no point of the unit 1-norm ball has a larger gauge.
  double lipschitz() const { return lipschitz_; }
  const double* point(std::uint32_t v) const { return &q_[std::size_t{v} * D]; }
  std::size_t size() const { return q_.size() / D; }

  /// Chooses the scale, powers of two: |x_j - centre_j| is at most reach_j for every point. False
  /// if coordinates are too extreme. `even`: exponents that make the axes as even as they can be.
  bool set(const double* centre, const double* reach, bool even) {
    int exponent[D];
    double part[D];
    for (unsigned j = 0; j < D; ++j) {
      if (!(reach[j] > 0) || !std::isfinite(reach[j])) return false;
      part[j] = std::frexp(reach[j], &exponent[j]);  // reach < 2^exponent, part >= 1/2
    }
    const double most = even ? longest_of_evened(part) : 1;
    for (unsigned j = 0; j < D; ++j) {
      centre_[j] = centre[j];
      if (part[j] > most) ++exponent[j];
      scale_[j] = std::ldexp(1.0, std::clamp(-exponent[j], -1020, 1020));
      const double offset = centre_[j] * scale_[j];
      // An inexact product would shift the centre; only subnormal numbers can do that.
      if (!std::isfinite(offset) || offset / scale_[j] != centre_[j]) return false;
    }
    return true;
  }

  /// Writes the centre moved by `shift`, in the frame's units. It is rounded to f32 if that moves
  /// it little, so that f32 points can be subtracted in f32.
  void moved(const double (&shift)[D], double* centre) const {
    for (unsigned j = 0; j < D; ++j) {
      centre[j] = centre_[j] + shift[j] / scale_[j];
      const double single = static_cast<float>(centre[j]);
      if (std::abs(single - centre[j]) * scale_[j] <= 0x1p-7) centre[j] = single;
    }
  }

  /// Sets all of a table of this dimension and `cells` but its nodes; false if there would be more
  /// than the kernel can number in floats.
  bool fill(GaugeTable& t) const {
    std::uint64_t face = 1;
    for (unsigned k = 0; k + 1 < D; ++k) face *= t.cells + 1;
    if (2 * D * face >= (std::uint64_t{1} << 23)) return false;
    fill_gauge_constants(t, centre_, scale_, face);
    return true;
  }

  void make_room(std::size_t points) { q_.resize(points * D); }
  /// Takes a point, as number v; different ones at the same time.
  void place(std::size_t v, const double* row) {
    for (unsigned j = 0; j < D; ++j) q_[v * D + j] = (row[j] - centre_[j]) * scale_[j];
  }

  GaugeBound bound(const std::uint32_t* ids, const double* v, const double (&mu)[D]) const {
    double weight = 0;
    double rest[D];
    double size[D];
    for (unsigned j = 0; j < D; ++j) rest[j] = v[j], size[j] = std::abs(v[j]);
    for (unsigned i = 0; i < D; ++i) {
      const double m = mu[i] > 0 ? mu[i] : 0;
      const double* q = point(ids[i]);
      weight += m;
      for (unsigned j = 0; j < D; ++j) {
        rest[j] -= m * q[j];
        size[j] += m * std::abs(q[j]);
      }
    }
    double residual = 0;
    for (unsigned j = 0; j < D; ++j)
      residual += std::abs(rest[j]) + (2 * D + 8) * 0x1p-53 * size[j];
    return {weight * (1 + 0x1p-49), residual + (1 + weight) * 0x1p-1000};
  }

  /// Solves for the weights of v on these points, positive or not; returns the determinant.
  double weights(const std::uint32_t* ids, const double* v, double (&mu)[D]) const {
    double a[D][D];
    for (unsigned i = 0; i < D; ++i) {
      const double* q = point(ids[i]);
      for (unsigned j = 0; j < D; ++j) a[j][i] = q[j];
      mu[i] = v[i];
    }
    return eliminate(a, mu);
  }

  /// Gaussian elimination with partial pivoting: solves a x = b into b, returns det a.
  static double eliminate(double (&a)[D][D], double (&b)[D]) {
    double det = 1;
    for (unsigned k = 0; k < D; ++k) {
      unsigned pivot = k;
      for (unsigned r = k + 1; r < D; ++r)
        if (std::abs(a[r][k]) > std::abs(a[pivot][k])) pivot = r;
      if (pivot != k) {
        std::swap(a[pivot], a[k]);
        std::swap(b[pivot], b[k]);
        det = -det;
      }
      det *= a[k][k];
      // A flat cone: a huge solution makes the walk leave it.
      const double inverse = 1 / (a[k][k] != 0 ? a[k][k] : 0x1p-80);
      a[k][k] = inverse;
      for (unsigned r = k + 1; r < D; ++r) {
        const double factor = a[r][k] * inverse;
        for (unsigned c = k + 1; c < D; ++c) a[r][c] -= factor * a[k][c];
        b[r] -= factor * b[k];
      }
    }
    for (unsigned k = D; k-- > 0;) {
      for (unsigned c = k + 1; c < D; ++c) b[k] -= a[k][c] * b[c];
      b[k] *= a[k][k];
    }
    return det;
  }

  // Why L holds without any facet: for each +-e_j weights with e = Sum mu q + r, Sum mu <= s and
  // |r|_1 <= rho <= 1/2 were found. For any u take the e with u . e = |u|_inf. With the support
  // function h of the hull, |u|_inf <= s h(u) + rho |u|_inf, so h(u) >= |u|_inf (1 - rho) / s: the
  // hull contains the 1-norm ball of radius (1 - rho) / s, and L = s / (1 - rho). It also proves
  // that the centre is strictly inside.

  /// Computes L: no point of the unit 1-norm ball has a larger gauge (exactness.md, G1).
  /// suggest(v, ids, mu) gives weights for a direction.
  template <class Suggest>
  bool bound_axes(const Suggest& suggest) {
    double weight = 0;
    double residual = 0;
    for (unsigned j = 0; j < 2 * D; ++j) {
      double v[D] = {};
      v[j / 2] = j % 2 ? -1 : 1;
      std::uint32_t ids[D] = {};
      double mu[D] = {};
      suggest(v, ids, mu);
      const GaugeBound b = bound(ids, v, mu);
      if (!(b.residual < 0.5) || !(b.weight < 0x1p20)) return false;
      weight = std::max(weight, b.weight);
      residual = std::max(residual, b.residual);
    }
    lipschitz_ = weight / (1 - residual) * (1 + 0x1p-49);
    return true;
  }

 private:
  // A ball whose reach is 0.999 along one axis and 1.001 along another would be stretched to twice
  // its length along the first: cells of directions would be of little use there.

  /// The longest of the axes that keep their power of two; longer ones get the next, if that makes
  /// the axes more even.
  static double longest_of_evened(const double (&part)[D]) {
    double best = 1, least = 2;
    for (unsigned k = 0; k < D; ++k) {
      double low = 1, high = 0;
      for (const double p : part) {
        const double scaled = p > part[k] ? p / 2 : p;
        low = std::min(low, scaled);
        high = std::max(high, scaled);
      }
      if (high / low < least) {
        least = high / low;
        best = part[k];
      }
    }
    return best;
  }

  double centre_[D] = {};
  double scale_[D] = {};
  std::vector<double> q_;  ///< points in the frame
  double lipschitz_ = 0;
};

}  // namespace cullhull::internal
