#include "exact/planes/eliminated_plane.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <limits>

#include "exact/determinants/minors.hpp"
#include "exact/numbers/double_parts.hpp"
#include "exact/planes/elimination.hpp"

namespace cullhull::internal {
namespace {

/// The largest dimension with a proof: bounds are sums of non-negative terms, each with fewer than
/// 4 (d + 2)^2 factors 1 + u.
constexpr unsigned largest_dimension = 4096;
constexpr double bound_roundings = 1 + 0x1p-20;
/// Bounds of what underflow adds to an entry of the factors' product, and to a dot product with the
/// plane.
constexpr double factor_tiny = 0x1p-950, product_tiny = 0x1p-800;
/// u^2; double-double sums err by 3 u^2, products by 7 u^2 (Joldes, Muller, Popescu 2017).
constexpr double square_roundoff = unit_roundoff * unit_roundoff;

/// Bounds a sum of d products of double-doubles: |computed - exact| <= this times the sum of
/// magnitudes.
double double_double_dot(unsigned d) { return (4.0 * d + 12) * square_roundoff; }

}  // namespace

bool EliminatedPlane::set(unsigned d, const double* const* p) {
  d_ = d;
  p_ = p;
  if (d < 2 || d > largest_dimension) return false;
  const unsigned m = d - 1;
  stride_ = elimination_stride(d);
  lu_.assign(m * stride_, 0.0);
  for (auto* v : {&z_, &error_, &scale_, &weight_, &image_, &work_}) v->resize(d);
  exponent_.resize(d);
  for (unsigned i = 0; i < m; ++i)
    for (unsigned j = 0; j < d; ++j) at(i, j) = p[i + 1][j] - p[0][j];
  return scale_columns() && eliminate() && bound_error();
}

/// Scales each column by a power of two so that its largest entry is in [0.5, 1).
bool EliminatedPlane::scale_columns() {
  const unsigned m = d_ - 1;
  largest_scale_ = 0;
  for (unsigned j = 0; j < d_; ++j) work_[j] = 0;
  for (unsigned i = 0; i < m; ++i)
    for (unsigned j = 0; j < d_; ++j) work_[j] = std::max(work_[j], std::abs(at(i, j)));
  for (unsigned j = 0; j < d_; ++j) {
    if (!(work_[j] <= std::numeric_limits<double>::max())) return false;
    int e = 0;
    if (work_[j] > 0) std::frexp(work_[j], &e);
    if (std::abs(e) > 1000) return false;
    exponent_[j] = e;
    scale_[j] = std::ldexp(1.0, -e);
    largest_scale_ = std::max(largest_scale_, scale_[j]);
  }
  for (unsigned i = 0; i < m; ++i)
    for (unsigned j = 0; j < d_; ++j) at(i, j) *= scale_[j];
  return true;
}

/// Factors with complete pivoting, so that no entry of L exceeds 1 in magnitude, and no entry of U
/// its row's pivot. Returns false if a pivot is outside the range of the proof.
bool EliminatedPlane::eliminate() {
  const unsigned m = d_ - 1;
  column_.resize(d_);
  row_.resize(m);
  bool odd = false;
  if (internal::eliminate(lu_.data(), m, d_, row_.data(), column_.data(), 0x1p-400, 0x1p60, odd) <
      m)
    return false;
  determinant_log_ = 0;
  double mantissa = 1;
  for (unsigned r = 0; r < m; ++r) {
    int e = 0;
    mantissa = std::frexp(mantissa * std::abs(at(r, r)), &e);
    determinant_log_ += e;
    if (at(r, r) < 0) odd = !odd;
  }
  sign_ = odd ? -1 : 1;
  determinant_log_ += std::log2(mantissa) + 1;
  return true;
}

/// Solves U x = x in place.
void EliminatedPlane::solve_back(std::vector<double>& x) const {
  const unsigned m = d_ - 1;
  for (unsigned r = m; r-- > 0;) {
    const double* row = lu_.data() + r * stride_;
    double sum = x[r];
    for (unsigned j = r + 1; j < m; ++j) sum -= row[j] * x[j];
    x[r] = sum / row[r];
  }
}

/// Solves L U x = x in place.
void EliminatedPlane::solve(std::vector<double>& x) const {
  const unsigned m = d_ - 1;
  for (unsigned r = 0; r < m; ++r) {
    const double* row = lu_.data() + r * stride_;
    for (unsigned j = 0; j < r; ++j) x[r] -= row[j] * x[j];
  }
  solve_back(x);
}

/// Sets x = G x for x >= 0, where G >= |(L U)^-1|, by the inverses of the comparison matrices.
void EliminatedPlane::bound_inverse(std::vector<double>& x) const {
  const unsigned m = d_ - 1;
  for (unsigned r = 0; r < m; ++r) {
    const double* row = lu_.data() + r * stride_;
    for (unsigned j = 0; j < r; ++j) x[r] += std::abs(row[j]) * x[j];
  }
  for (unsigned r = m; r-- > 0;) {
    const double* row = lu_.data() + r * stride_;
    for (unsigned j = r + 1; j < m; ++j) x[r] += std::abs(row[j]) * x[j];
    x[r] /= std::abs(row[r]);
  }
}

/// Finds z by substitution, and a bound of its error. Works in pivot order; the results are in the
/// order of the axes.
bool EliminatedPlane::bound_error() {
  const unsigned m = d_ - 1;
  std::vector<double>&z = work_, &v = weight_;
  for (unsigned r = 0; r < m; ++r) z[r] = -at(r, m);
  z[m] = 1;
  solve_back(z);
  for (unsigned r = 0; r < d_; ++r) {
    v[r] = std::max(std::abs(z[r]), 1.0);
    if (!(v[r] < 0x1p60)) return false;
    z_[column_[r]] = z[r];
  }
  error_[column_[m]] = 0;
  return bound_by_comparison() || bound_by_inverses();
}

// Bound by comparison matrices. E z~ is known up to rounding, so the error of z~ is (L V)^-1 times
// it, up to the factor that F, the error of the factors, costs: with G >= |(L V)^-1|, h = G
// (roundings) and theta = max h_i / max(|z_i|, 1), the error is at most 2 h / (1 - theta) <= 2.67 h
// for theta <= 1/4; 2.75 h covers the roundings of the bound. Example in 9D: points in a cube give
// theta of about 2^-29 and a relative error of z of that size: rung 2 decides unless a point is
// within 2^-29 of the plane. The bound overestimates by a power of d, since comparison matrices
// drop all cancellation: 2^-16 in 16D, 2^-12 in 20D.

/// Bounds the error in O(d^2) time, but the bound grows like a power of d.
bool EliminatedPlane::bound_by_comparison() {
  const unsigned m = d_ - 1;
  const std::vector<double>& v = weight_;
  std::vector<double>& h = image_;
  inverted_ = false;
  // h = G (gamma |L| |U| v + what underflow adds): bottom up, because row i of L needs the rows
  // above it.
  double sum = v[m];
  for (unsigned r = 0; r < m; ++r) {
    double a = 0;
    for (unsigned j = r; j < d_; ++j) a += std::abs(at(r, j)) * v[j];
    h[r] = a;
    sum += v[r];
  }
  const double gamma = (d_ + 1) * unit_roundoff * bound_roundings;
  for (unsigned r = m; r-- > 0;) {
    for (unsigned j = 0; j < r; ++j) h[r] += std::abs(at(r, j)) * h[j];
    h[r] = gamma * h[r] + factor_tiny * sum;
  }
  bound_inverse(h);
  shrink_ = 0;
  for (unsigned r = 0; r < m; ++r) {
    h[r] *= bound_roundings;
    if (!(h[r] <= 0.25 * v[r])) return false;  // NaN too
    shrink_ = std::max(shrink_, h[r] / v[r] * bound_roundings);
    error_[column_[r]] = 2.75 * h[r];
  }
  return true;
}

// Bound by inverses, in tens of dimensions. X ~ L^-1 (1 on the diagonal) and Y ~ V^-1 are computed,
// and B = X E_c Y, whose computed value is off by at most gamma_(2m+1) |X|(|D||Y|). Let H >= |I -
// B| and theta the largest row sum of H. For theta <= 1/4 det B > 0, so det(E_c) has the sign of
// the pivots' product, |det B| <= (1 + theta)^m, and with s >= |X||E z~|
//
//   |z~ - z| = |Y B^-1 X E z~| <= |Y| (I - H)^-1 s <= |Y| (s + H 1 max s / (1 - theta)).
//
// It does not matter how X and Y were found: bad ones give a large theta, never a wrong bound.

/// Bounds the error nearly sharply, in three times the elimination's time.
bool EliminatedPlane::bound_by_inverses() {
  const unsigned m = d_ - 1;
  inverted_ = true;
  invert_factors();
  bound_product();
  shrink_ = 0;
  for (unsigned r = 0; r < m; ++r) {
    if (!(image_[r] <= 0.25)) return false;  // NaN too
    shrink_ = std::max(shrink_, image_[r]);
  }
  std::vector<double>& e = work_;
  for (unsigned i = 0; i < m; ++i) {
    double residual = 0, magnitude = 0;
    for (unsigned j = 0; j < d_; ++j) {
      const double term = scaled_edge(i, j) * z_[column_[j]];
      residual += term;
      magnitude += std::abs(term);
    }
    e[i] = (std::abs(residual) + (d_ + 2) * unit_roundoff * magnitude) * bound_roundings +
           product_tiny;
  }
  if (!bound_of_residual(e)) return false;
  for (unsigned r = 0; r < m; ++r) error_[column_[r]] = e[r];
  return true;
}

/// Computes X ~ L^-1 below the diagonal (X has ones on it), and Y ~ V^-1 on and above the diagonal.
void EliminatedPlane::invert_factors() {
  const unsigned m = d_ - 1;
  inverse_.assign(std::size_t{m} * m, 0.0);
  const auto x = [&](unsigned i, unsigned j) -> double& {
    return inverse_[std::size_t{i} * m + j];
  };
  for (unsigned i = 0; i < m; ++i)
    for (unsigned k = 0; k < i; ++k) {
      const double l = at(i, k);
      for (unsigned j = 0; j < k; ++j) x(i, j) -= l * x(k, j);
      x(i, k) -= l;
    }
  for (unsigned i = m; i-- > 0;) {
    for (unsigned k = i + 1; k < m; ++k)
      for (unsigned j = k; j < m; ++j) x(i, j) -= at(i, k) * x(k, j);
    for (unsigned j = i + 1; j < m; ++j) x(i, j) /= at(i, i);
    x(i, i) = 1 / at(i, i);
  }
}

double EliminatedPlane::scaled_edge(unsigned i, unsigned j) const {
  const unsigned c = column_[j];
  return (p_[row_[i] + 1][c] - p_[0][c]) * scale_[c];
}

/// Computes an upper bound of |I - X E Y| 1 into image_.
void EliminatedPlane::bound_product() {
  const unsigned m = d_ - 1;
  const auto x = [&](unsigned i, unsigned j) { return inverse_[std::size_t{i} * m + j]; };
  product_.assign(std::size_t{m} * m, 0.0);
  std::vector<double>& magnitude = work_;  // |E| |Y| 1
  for (unsigned i = 0; i < m; ++i) {
    double* row = product_.data() + std::size_t{i} * m;
    magnitude[i] = 0;
    for (unsigned k = 0; k < m; ++k) {
      const double e = scaled_edge(i, k);
      double sum = 0;
      for (unsigned j = k; j < m; ++j) {
        row[j] += e * x(k, j);
        sum += std::abs(x(k, j));
      }
      magnitude[i] += std::abs(e) * sum;
    }
  }
  const double gamma = (2 * d_ + 4) * unit_roundoff;
  for (unsigned i = m; i-- > 0;) {  // upwards: rows of X below r are overwritten
    double* row = product_.data() + std::size_t{i} * m;
    double all = magnitude[i], rest = 0;
    for (unsigned k = 0; k < i; ++k) {
      const double* other = product_.data() + std::size_t{k} * m;
      for (unsigned j = 0; j < m; ++j) row[j] += x(i, k) * other[j];
      all += std::abs(x(i, k)) * magnitude[k];
    }
    for (unsigned j = 0; j < m; ++j) rest += std::abs(row[j] - (i == j ? 1 : 0));
    image_[i] = (rest + gamma * all) * bound_roundings + product_tiny;
  }
}

/// Turns bounds of |E z| into bounds of the error of z.
bool EliminatedPlane::bound_of_residual(std::vector<double>& x) const {
  const unsigned m = d_ - 1;
  double worst = 0;
  if (!inverted_) {
    bound_inverse(x);
    for (unsigned i = 0; i < m; ++i) {
      if (!(x[i] < weight_[i])) return false;  // NaN too
      worst = std::max(worst, x[i] / weight_[i]);
    }
    for (unsigned i = 0; i < m; ++i) x[i] = (x[i] + 1.5 * worst * image_[i]) * bound_roundings;
    return true;
  }
  const auto inverse = [&](unsigned i, unsigned j) {
    return std::abs(inverse_[std::size_t{i} * m + j]);
  };
  for (unsigned i = m; i-- > 0;)
    for (unsigned j = 0; j < i; ++j) x[i] += inverse(i, j) * x[j];
  for (unsigned i = 0; i < m; ++i) {
    if (!(x[i] < 0x1p60)) return false;
    worst = std::max(worst, x[i]);
  }
  for (unsigned i = 0; i < m; ++i) x[i] += 1.5 * worst * image_[i];
  for (unsigned i = 0; i < m; ++i) {
    double sum = 0;
    for (unsigned j = i; j < m; ++j) sum += inverse(i, j) * x[j];
    x[i] = sum * bound_roundings * bound_roundings;
    if (!(x[i] < weight_[i])) return false;
  }
  return true;
}

/// Returns the dot product of edge `row_[i]` and the refined plane, rounded to a double; `bound`
/// receives a bound of its error.
double EliminatedPlane::residual(unsigned i, double& bound) const {
  const double *p = p_[0], *q = p_[row_[i] + 1];
  DoubleDouble sum;
  double magnitude = 0;
  for (unsigned j = 0; j < d_; ++j) {
    const DoubleDouble exact = DoubleDouble::sum(q[j], -p[j]);
    const DoubleDouble e(exact.high * scale_[j], exact.low * scale_[j]);
    sum = sum + e * refined_[j];
    magnitude += std::abs(e.high * refined_[j].high);
  }
  bound = magnitude * double_double_dot(d_) + product_tiny;
  return sum.value();
}

// Refinement. z~ is a pair of doubles a component; corrections c solve L V c = -r with residuals r
// = E z~ in double-doubles, where E is exact as pairs. A sum of d products is then off by at most
// (4 d + 12) u^2 of its magnitudes (products 7 u^2, sums 3 u^2 + 13 u^3). With g = G |r| of the
// last residual and kappa = max g_i / v_i the error is at most (I - H)^-1 g <= g + h kappa / (1 -
// theta); 1.5 h kappa is used. Corrections are found with the factors, so each step gains about as
// many bits as the factors are right by, until the residual's own error ends it.

/// Iterative refinement with residuals in double-doubles. The last residual gives the error bound.
bool EliminatedPlane::refine() {
  const unsigned m = d_ - 1;
  refined_.assign(z_.begin(), z_.end());
  refined_error_.assign(d_, 0.0);
  double bound = 0;
  for (int step = 0; step < 2; ++step) {
    for (unsigned i = 0; i < m; ++i) work_[i] = -residual(i, bound);
    solve(work_);
    for (unsigned i = 0; i < m; ++i) {
      DoubleDouble& z = refined_[column_[i]];
      z = z + DoubleDouble(work_[i]);
    }
  }
  for (unsigned i = 0; i < m; ++i) {
    const double r = std::abs(residual(i, bound));
    work_[i] = r * bound_roundings + bound;
  }
  if (!bound_of_residual(work_)) return false;
  for (unsigned i = 0; i < m; ++i) refined_error_[column_[i]] = work_[i];
  return true;
}

Sign EliminatedPlane::side(const double* x, bool& known) const {
  double value = 0, magnitude = 0, wrong = 0;
  for (unsigned j = 0; j < d_; ++j) {
    const double y = (x[j] - p_[0][j]) * scale_[j];
    const double t = z_[j] * y;
    value += t;
    magnitude += std::abs(t);
    wrong += error_[j] * std::abs(y);
  }
  return decide(x, value, (d_ + 2) * unit_roundoff * magnitude + wrong, known);
}

Sign EliminatedPlane::refined_side(const double* x, bool& known) const {
  DoubleDouble value;
  double magnitude = 0, wrong = 0;
  for (unsigned j = 0; j < d_; ++j) {
    const DoubleDouble exact = DoubleDouble::sum(x[j], -p_[0][j]);
    const DoubleDouble y(exact.high * scale_[j], exact.low * scale_[j]);
    value = value + y * refined_[j];
    magnitude += std::abs(refined_[j].high * y.high);
    wrong += refined_error_[j] * std::abs(y.high);
  }
  return decide(x, value.value(),
                double_double_dot(d_) * magnitude + wrong + unit_roundoff * std::abs(value.high),
                known);
}

/// Decides a sign: `value` is within `bound` of exact, apart from the rounding of the bound itself
/// and underflow.
Sign EliminatedPlane::decide(const double* x, double value, double bound, bool& known) const {
  const double most = bound * bound_roundings + product_tiny;
  // After an overflow, also of the low parts of products, the value is infinite or exceeds this
  // limit.
  known = most < 0x1p300 && std::abs(value) > most;
  if (known) return sign_of(sign_ * value);
  known = below_unit(x, std::abs(value) + most);
  return Sign::zero;
}

// Zero on lattices. If all coordinates of axis j are multiples of 2^l_j, the determinant is a
// multiple of the unit 2^(l_1 + ... + l_d). It is at most Prod |pivots| (1 + theta)^m (|z . y| +
// bound). If that is less than the unit, the determinant is zero. Example: whole numbers in 9D have
// the unit 1. With pivots whose product is 10^15, |z . y| + bound = 1e-13 proves nothing, but 1e-25
// after a refinement does: 1e-10 < 1. Logarithms carry one bit of slack each.

/// Whether the determinant, at most `magnitude` times the pivots' product, is smaller than the unit
/// of which it is a multiple: the product over all axes of the largest power of two that divides
/// all coordinates on that axis.
bool EliminatedPlane::below_unit(const double* x, double magnitude) const {
  if (!(magnitude < 0x1p300)) return false;  // NaN too
  double unit_log = 0;
  for (unsigned j = 0; j < d_; ++j) {
    int lowest = std::numeric_limits<int>::max();
    if (x[j] != 0) lowest = lowest_bit_exponent(x[j]);
    for (unsigned i = 0; i < d_; ++i)
      if (p_[i][j] != 0) lowest = std::min(lowest, lowest_bit_exponent(p_[i][j]));
    if (lowest == std::numeric_limits<int>::max()) return true;  // a column of zeros
    unit_log += lowest - exponent_[j];
  }
  // (1 + theta)^(d - 1) for the rounding of the factors, and one bit for that of the logarithms.
  const double most = determinant_log_ + 1.5 * (d_ - 1) * shrink_ + std::log2(magnitude) + 1;
  return most < unit_log;
}

}  // namespace cullhull::internal
