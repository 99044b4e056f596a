#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "exact/determinants/minors.hpp"
#include "exact/planes/eliminated_plane.hpp"
#include "hull/general/facet_planes.hpp"

namespace cullhull::internal {
namespace {

/// The largest error of a plane from plane_between(); beyond it the plane is computed from its
/// points. At this limit one test in some thousand needs an exact sign, which takes as long as some
/// hundred tests. (Measured in 9D to 20D: 2^-14 saves a tenth less time, 2^-7 no more.)
constexpr double widest = 0x1p-10;

/// An eliminated plane with a larger error is refined to double-doubles, which takes as long as the
/// elimination or twice as long: planes made from it keep within `widest` for longer. The bounds of
/// elimination grow steeply with the dimension: 2^-29 in 9D, 2^-16 in 16D, 2^-12 in 20D.
constexpr double loose = 0x1p-20;

/// Planes whose normals have a larger 1-norm are rejected.
constexpr double largest_size = 0x1p100;

/// What rounding a plane and a point to floats adds to the error of their dot product. `reached`:
/// the sum of |n_j| times the reach along axis j.
double rounding_to_float(unsigned d, double reached) {
  return reached * (d + 3) * 0x1p-24 * (1 + 0x1p-10) + 0x1p-120;
}

class AnyPlanes {
 public:
  explicit AnyPlanes(const PlaneFrame& frame)
      : frame_(frame), d_(frame.dimension), normal_(d_), rows_(d_) {}

  void plane(const std::uint32_t* v, bool sharp, float* out, double* wide) {
    for (unsigned i = 0; i < d_; ++i) rows_[i] = frame_.rows + std::size_t{v[i]} * d_;
    // Rows that are not exact are off by at most 2^-1074. The terms for underflow cover that,
    // unless elimination scaled rows up by 2^50 or more.
    const bool known = frame_.row_error == 0 && plane_.set(d_, rows_.data()) &&
                       (frame_.exact_rows || plane_.largest_scale() < 0x1p50);
    if (known && !sharp && scaled(false, out, wide) && wide[d_] <= loose) return;
    if (known && plane_.refine() && scaled(true, out, wide)) return;
    if (known && scaled(false, out, wide)) return;
    std::fill_n(out, d_, 0.0F);
    std::fill_n(wide, d_, 0.0);
    out[d_] = std::numeric_limits<float>::infinity();
    wide[d_] = std::numeric_limits<double>::infinity();
  }

 private:
  /// Scales the plane and bounds its error as the vector code does; false where it cannot.
  /// `refined`: takes the plane computed in double-doubles, whose bound is sharp.
  bool scaled(bool refined, float* out, double* wide) {
    double size = 0, reached = 0, level = 0, total_error = 0;
    for (unsigned j = 0; j < d_; ++j) {
      normal_[j] = refined ? plane_.refined_normal(j) : plane_.normal(j);
      const double own = refined ? plane_.refined_error(j) : plane_.error(j);
      total_error += own * (1 + 0x1p-40) + 0x1p-1000;
      size += std::abs(normal_[j]);
      reached += std::abs(normal_[j]) * frame_.reach[j];
      level += normal_[j] * (rows_[0][j] - frame_.centre[j]);
    }
    const double bound = 1.0625 * (4 * total_error + (6.0 * d_ + 18) * unit_roundoff * size);
    const double magnitude = std::abs(level);
    if (!(magnitude > 0x1p-900 && magnitude > 8 * bound)) return false;
    const double scale = 1 / level, absolute = std::abs(scale);
    const double own_error = bound * absolute * (1 + 0x1p-40);
    const double error = own_error + rounding_to_float(d_, reached * absolute);
    if (!(error <= 0.5 && size * absolute < largest_size)) return false;
    for (unsigned j = 0; j < d_; ++j) out[j] = static_cast<float>(wide[j] = normal_[j] * scale);
    out[d_] = static_cast<float>(error * (1 + 0x1p-22));
    wide[d_] = own_error * (1 + 2.5 * reached * absolute);  // |g| <= reached / (1 - error)
    return true;
  }

  const PlaneFrame& frame_;
  const unsigned d_;
  EliminatedPlane plane_;
  std::vector<double> normal_;
  std::vector<const double*> rows_;
};

/// What the arithmetic of a wide plane's gauge adds to the plane's own error, for planes whose
/// normals have 1-norms that sum to `size` - 1.
double gauge_rounding(unsigned d, double size) { return (4.0 * d + 16) * unit_roundoff * size; }

}  // namespace

WideGauge::WideGauge(const PlaneFrame& frame, const double* wide) : frame_(frame), wide_(wide) {
  const unsigned d = frame.dimension;
  double size = 1;
  for (unsigned j = 0; j < d; ++j) size += std::abs(wide[j]);
  doubt_ = (wide[d] + gauge_rounding(d, size)) * (1 + 0x1p-20);
}

double WideGauge::of(std::uint32_t point) const {
  const unsigned d = frame_.dimension;
  const double *x = frame_.rows + std::size_t{point} * d, *c = frame_.centre;
  double sums[4] = {0, 0, 0, 0};  // the bound holds for any order, and these make vectors
  unsigned j = 0;
  for (; j + 4 <= d; j += 4)
    for (unsigned k = 0; k < 4; ++k) sums[k] += wide_[j + k] * (x[j + k] - c[j + k]);
  for (; j < d; ++j) sums[0] += wide_[j] * (x[j] - c[j]);
  return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

void facet_planes_any(const PlaneFrame& frame, const std::uint32_t* facets, std::size_t count,
                      float* planes, double* wide, bool sharp) {
  AnyPlanes any(frame);
  const std::size_t stride = frame.dimension + 1;
  std::vector<double> unused(wide == nullptr ? stride : 0);
  for (std::size_t i = 0; i < count; ++i)
    any.plane(facets + i * frame.dimension, sharp, planes + i * stride,
              wide == nullptr ? unused.data() : wide + i * stride);
}

// Let R be the ridge between f, which p sees, and h, which it does not: a = 1 - g_h(p) >= 0, b =
// g_f(p) - 1 > 0. The plane through R and p has the gauge lambda g_f + (1 - lambda) g_h with lambda
// = a / (a + b): it is 1 on R and at p. So a new plane takes O(d) operations from two that are kept
// in doubles, with bounds e_f and e_h of |g~ - g| at every point. As computed at p, gauges are off
// by at most M_f = e_f + r and M_h = e_h + r, r = (4 d + 16) u (1 + Sum |n|). With s = a~ + b~ and
// lambda~ = a~ / s, lambda~ - lambda = (a~ b - a b~) / (s (a + b)) is a mean of both errors over s,
// with the weights lambda and 1 - lambda. It is at most sigma_0 = max(M_f, M_h) / s, so lambda~ may
// stand for lambda in the weights:
//
//   |lambda~ - lambda| <= sigma
//       = (|lambda~| e_f + |1 - lambda~| e_h + r + sigma_0 max(M_f, M_h)) / s.
//
// The new gauge is off by lambda~ (g~_f - g_f) + (1 - lambda~) (g~_h - g_h) + (lambda~ - lambda)
// (g_f - g_h). As |g_f - g_h| <= |n_f - n_h| rho + e_f + e_h with rho the farthest point's distance
// from O, that is at most
//
//   e = |lambda~| e_f + |1 - lambda~| e_h + sigma (|n_f - n_h| rho + e_f + e_h)
//       + 16 u (1 + Sum |n|),
//
// the last term for the new normal's rounding. Errors grow by some factor with each generation;
// where e exceeds 2^-10 the plane is eliminated anew. Planes of the first simplex, and others whose
// bound by elimination exceeds 2^-20, are refined ("Planes by elimination", rounded to doubles,
// which adds 2^-52 |z|): with sharp bounds at the beginning more generations follow. |g~ - g| <= e
// max(1, |g|), so rounding to f32 adds what it does in "Planes in single precision".
bool plane_between(const PlaneFrame& frame, const double* seen, const double* unseen,
                   std::uint32_t point, float* plane, double* wide) {
  const unsigned d = frame.dimension;
  const double* x = frame.rows + std::size_t{point} * d;
  double above = -1, beneath = -1, size = 1, spread = 0;
  for (unsigned j = 0; j < d; ++j) {
    const double y = x[j] - frame.centre[j];
    above += seen[j] * y;
    beneath += unseen[j] * y;
    size += std::abs(seen[j]) + std::abs(unseen[j]);
    const double difference = seen[j] - unseen[j];
    spread += difference * difference;
  }
  spread = std::sqrt(spread) * frame.radius;  // bounds the planes' difference at any point
  const double sum = above - beneath, of_seen = -beneath / sum, of_unseen = above / sum;
  const double largest = std::max(seen[d], unseen[d]) + gauge_rounding(d, size);
  const double crude_shift = largest / sum;
  // The sum is negative only where a bound is too wide, as infinite ones are. Rejects NaN, too.
  if (!(crude_shift >= 0 && crude_shift < 0x1p-4)) return false;
  const double mean = std::abs(of_seen) * seen[d] + std::abs(of_unseen) * unseen[d];
  const double shift =
      (mean + gauge_rounding(d, size) + crude_shift * largest) / sum * (1 + 0x1p-20);
  const double error =
      (mean + shift * (spread + seen[d] + unseen[d]) + 16 * unit_roundoff * size) * (1 + 0x1p-20);
  double own_size = 0, reached = 0;
  for (unsigned j = 0; j < d; ++j) {
    wide[j] = of_seen * seen[j] + of_unseen * unseen[j];
    plane[j] = static_cast<float>(wide[j]);
    own_size += std::abs(wide[j]);
    reached += std::abs(wide[j]) * frame.reach[j];
  }
  const double rounding = rounding_to_float(d, reached);
  if (!(error <= widest && error + rounding <= 0.5 && own_size < largest_size)) return false;
  wide[d] = error;
  plane[d] = static_cast<float>((error + rounding) * (1 + 0x1p-22));
  return true;
}

}  // namespace cullhull::internal
