// Wolfe's method (Finding the nearest point in a polytope, 1976), started at the tested point:
// either the hull of the other points is at some distance, and the direction to its nearest point
// separates the two, or the point is a convex combination of a few others, the corral. Both results
// are certificates that are checked exactly, whatever the method's rounding.
#include "extreme/hull_membership.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "exact/determinants/minors.hpp"
#include "exact/numbers/rationals.hpp"
#include "exact/orientation/orientation.hpp"

namespace cullhull::internal {

bool SimplexInverse::set(const LocalPoints& points, const std::uint32_t* corners) {
  const unsigned d = points.dimension, n = d + 1;
  constexpr double never = std::numeric_limits<double>::infinity();
  rows_ = n;
  rest_ = never;
  inverse_.resize(std::size_t{n} * n);
  allowed_.resize(n);
  // Inverts A by Gauss-Jordan elimination of [A I]; A's columns are the corners with a 1 below.
  std::vector<double> a(std::size_t{n} * 2 * n, 0.0);
  const auto at = [&](unsigned i, unsigned j) -> double& { return a[std::size_t{i} * 2 * n + j]; };
  const auto entry = [&](unsigned i, unsigned j) {
    return i < d ? points.row(corners[j])[i] : 1.0;
  };
  for (unsigned i = 0; i < n; ++i) {
    for (unsigned j = 0; j < n; ++j) at(i, j) = entry(i, j);
    at(i, n + i) = 1;
  }
  for (unsigned k = 0; k < n; ++k) {
    unsigned pivot = k;
    for (unsigned i = k + 1; i < n; ++i)
      if (std::abs(at(i, k)) > std::abs(at(pivot, k))) pivot = i;
    if (!(std::abs(at(pivot, k)) > 0x1p-60)) return false;
    if (pivot != k)
      for (unsigned j = k; j < 2 * n; ++j) std::swap(at(pivot, j), at(k, j));
    const double scale = 1 / at(k, k);
    for (unsigned j = k; j < 2 * n; ++j) at(k, j) *= scale;
    for (unsigned i = 0; i < n; ++i) {
      const double f = at(i, k);
      if (i == k || f == 0) continue;
      for (unsigned j = k; j < 2 * n; ++j) at(i, j) -= f * at(k, j);
    }
  }
  double rest = 0;
  for (unsigned i = 0; i < n; ++i) {
    double size = 0, worst = 0;
    for (unsigned j = 0; j < n; ++j) {
      inverse_[i * n + j] = at(i, n + j);
      size += std::abs(at(i, n + j));
    }
    allowed_[i] = ((n + 6) * unit_roundoff + points.coordinate_error) * size + 0x1p-1000;
    for (unsigned j = 0; j < n; ++j) {
      double product = i == j ? -1 : 0;
      for (unsigned k = 0; k < n; ++k) product += inverse_[i * n + k] * entry(k, j);
      worst = std::max(worst, std::abs(product));
    }
    rest += worst + allowed_[i] + (n + 4) * unit_roundoff;
  }
  if (!(rest < 0x1p-11)) return false;
  rest_ = 2 * rest * (1 + 0x1p-40);
  return true;
}

bool SimplexInverse::surely_inside(const double* x) const {
  const unsigned n = rows_;
  double sum = 0, least = HUGE_VAL;
  for (unsigned i = 0; i < n; ++i) {
    const double* m = inverse_.data() + std::size_t{i} * n;
    double v = m[n - 1];
    for (unsigned j = 0; j + 1 < n; ++j) v += m[j] * x[j];
    sum += std::abs(v);
    least = std::min(least, v - allowed_[i]);
  }
  return least > rest_ * 1.0625 * (sum + 1);
}

HullMembership::HullMembership(const LocalPoints& points, const Control& control)
    : points_(points),
      control_(control),
      d_(points.dimension),
      direction_(d_),
      narrow_(d_),
      simplices_(most_simplices) {}

bool HullMembership::inside(std::uint32_t point, const PointColumns& others,
                            const PointColumns& working, std::vector<std::uint32_t>& useful) {
  origin_ = points_.row(point);
  if (in_known_simplex(point)) return true;
  begin_with_last(point);
  const bool warm = !corral_.empty();
  Answer answer = search(point, others, working, useful);
  if (answer == Answer::unknown && warm) {
    corral_.clear();
    weights_.clear();
    answer = search(point, others, working, useful);
  }
  if (answer != Answer::unknown) return answer == Answer::inside;
  return inside_exact(points_, point, others.ids(), control_);
}

HullMembership::Answer HullMembership::search(std::uint32_t point, const PointColumns& others,
                                              const PointColumns& working,
                                              std::vector<std::uint32_t>& useful) {
  // Each round adds a useful point; after the last, slow exact arithmetic decides. Some tens of
  // rounds are usual: a lower limit would send more points there, a higher one would delay hopeless
  // cases. Other values are untested.
  constexpr unsigned most_rounds = 200;
  for (unsigned round = 0; round < most_rounds; ++round) {
    control_.check();
    Answer answer = approach(point, working, useful);
    if (answer != Answer::separated) return answer;
    // The direction separates the point from the working points. Does it from all others?
    std::uint32_t against = no_index;
    answer = separates_all(point, others, against);
    if (answer == Answer::separated) return answer;
    // If that point was tried before, rounding prevents progress.
    if (working.contains(against) ||
        std::find(useful.begin(), useful.end(), against) != useful.end())
      return Answer::unknown;
    useful.push_back(against);
  }
  return Answer::unknown;
}

/// Starts with the last point's corral, a good guess for a point near it.
void HullMembership::begin_with_last(std::uint32_t point) {
  std::erase(corral_, point);
  weights_.assign(corral_.size(),
                  1.0 / static_cast<double>(std::max<std::size_t>(1, corral_.size())));
  move_to_nearest();
}

bool HullMembership::in_known_simplex(std::uint32_t point) const {
  for (unsigned k = 0; k < most_simplices; ++k)
    if (simplices_[(newest_ + most_simplices - k) % most_simplices].surely_inside(
            points_.row(point)))
      return true;
  return false;
}

bool HullMembership::prove_inside(std::uint32_t point) {
  if (corral_.size() == d_ + 1) {
    const unsigned next = (newest_ + 1) % most_simplices;
    if (simplices_[next].set(points_, corral_.data()) &&
        simplices_[next].surely_inside(points_.row(point))) {
      newest_ = next;
      return true;
    }
  }
  return certain_inside(point);
}

void HullMembership::narrow_direction() {
  double largest = 0x1p-1000;
  for (const double v : direction_) largest = std::max(largest, std::abs(v));
  for (unsigned j = 0; j < d_; ++j) narrow_[j] = static_cast<float>(direction_[j] / largest);
}

bool HullMembership::in_corral(std::uint32_t q) const {
  return std::find(corral_.begin(), corral_.end(), q) != corral_.end();
}

/// Whether direction_, or direction_ rounded to f32, separates the point from all others. If not
/// (unknown), `against` receives a point on the wrong side.
HullMembership::Answer HullMembership::separates_all(std::uint32_t point,
                                                     const PointColumns& others,
                                                     std::uint32_t& against) {
  narrow_direction();
  double at = 0, size = 0;
  for (unsigned j = 0; j < d_; ++j) {
    at += double{narrow_[j]} * origin_[j];
    size += std::abs(double{narrow_[j]});
  }
  // Bounds the rounding of coordinates to f32 and of d products and sums of numbers of at most |v|;
  // the error of `at` is far smaller.
  const double narrow_bound = (d_ + 3) * 0x1p-24 * size + 0x1p-120;
  const PointColumns::Least found = others.least(narrow_.data(), point);
  against = found.id;
  if (found.value - at > narrow_bound) return Answer::separated;
  if (found.value - at < -narrow_bound) return Answer::unknown;

  const Farthest farthest = most_against(others.ids(), point);
  size = 0;
  for (const double v : direction_) size += std::abs(v);
  // Bounds d products and sums of numbers of at most |v|, twice, and the difference.
  const double bound =
      ((2.0 * d_ + 6) * unit_roundoff + 2 * points_.coordinate_error) * size + 0x1p-1000;
  against = farthest.id;
  if (farthest.least > bound) return Answer::separated;
  if (farthest.least < -bound || points_.exact != points_.coordinates) return Answer::unknown;
  // Doubtful signs are decided exactly; the other points exceed the bound on the right side.
  const auto doubtful =
      std::find_if(others.ids().begin(), others.ids().end(),
                   [&](std::uint32_t o) { return o != point && side_of(point, o) <= 0; });
  if (doubtful == others.ids().end()) return Answer::separated;
  against = *doubtful;
  return Answer::unknown;
}

/// Returns direction_ . (q - point).
double HullMembership::against(std::uint32_t q) const {
  const double* x = points_.row(q);
  double sum = 0;
  for (unsigned j = 0; j < d_; ++j) sum += direction_[j] * (x[j] - origin_[j]);
  return sum;
}

/// Returns the point of `ids` with the least direction . (q - point).
HullMembership::Farthest HullMembership::most_against(const std::vector<std::uint32_t>& ids,
                                                      std::uint32_t point) const {
  Farthest result;
  double low = HUGE_VAL, at = 0;
  for (const std::uint32_t q : ids) {
    const double* x = points_.row(q);
    double sum = 0;
    for (unsigned j = 0; j < d_; ++j) sum += direction_[j] * x[j];
    if (sum < low && q != point) {
      low = sum;
      result.id = q;
    }
  }
  for (unsigned j = 0; j < d_; ++j) at += direction_[j] * origin_[j];
  result.least = low - at;
  return result;
}

/// Does the same among the first `count` points, in f32.
HullMembership::Farthest HullMembership::roughly_most_against(const PointColumns& points,
                                                              std::uint32_t point,
                                                              std::size_t count) {
  narrow_direction();
  Farthest result;
  result.id = points.least(narrow_.data(), point, count).id;
  result.least = result.id == no_index ? HUGE_VAL : against(result.id);
  return result;
}

HullMembership::Answer HullMembership::approach(std::uint32_t point, const PointColumns& working,
                                                const std::vector<std::uint32_t>& useful) {
  const unsigned most_steps = 50 + 20 * d_;
  // The number of points, those of greatest norm, that are scanned first: they decide most steps.
  // More of them decide more steps but lengthen each. Other values are untested.
  constexpr std::size_t outermost = 16 * std::size_t{PointColumns::block};
  for (unsigned step = 0; step < most_steps; ++step) {
    combine();
    double square = 0;
    for (const double v : direction_) square += v * v;
    if (corral_.empty()) {
      // Outward from the middle of the frame: most other points are behind the point in this
      // direction.
      for (unsigned j = 0; j < d_; ++j) direction_[j] = -origin_[j];
    } else if (square < 0x1p-80 || corral_.size() == d_ + 1) {
      if (prove_inside(point)) return Answer::inside;
      if (square < 0x1p-96) return Answer::unknown;
    }
    // Usually one of the first points, which are the outermost, suffices.
    Farthest farthest = roughly_most_against(working, point, outermost);
    if (!(farthest.least < 0) || in_corral(farthest.id))
      farthest = roughly_most_against(working, point, no_index);
    if (in_corral(farthest.id)) farthest = most_against(working.ids(), point);
    const Farthest other = most_against(useful, point);
    if (other.least < farthest.least) farthest = other;
    if (farthest.least > 0) return Answer::separated;
    if (farthest.id == no_index || in_corral(farthest.id))
      return prove_inside(point) ? Answer::inside : Answer::unknown;
    add(farthest.id);
    move_to_nearest();
  }
  return Answer::unknown;
}

void HullMembership::add(std::uint32_t q) {
  corral_.push_back(q);
  weights_.push_back(corral_.size() == 1 ? 1 : 0);
}

/// Sets direction_ to the weighted point of the corral, relative to the query point.
void HullMembership::combine() {
  std::fill(direction_.begin(), direction_.end(), 0.0);
  for (std::size_t i = 0; i < corral_.size(); ++i)
    for (unsigned j = 0; j < d_; ++j)
      direction_[j] += weights_[i] * (points_.row(corral_[i])[j] - origin_[j]);
}

/// Moves towards the nearest point of the corral's flat; removes corners whose weight becomes 0.
void HullMembership::move_to_nearest() {
  while (corral_.size() > 1) {
    if (!nearest_in_flat()) {  // affinely dependent, up to rounding
      corral_.pop_back();
      weights_.pop_back();
      return;
    }
    double share = 1;
    for (std::size_t i = 0; i < corral_.size(); ++i)
      if (flat_[i] <= 0 && weights_[i] > flat_[i])
        share = std::min(share, weights_[i] / (weights_[i] - flat_[i]));
    const bool arrived = std::all_of(flat_.begin(), flat_.end(), [](double v) { return v > 0; });
    if (arrived) {
      weights_ = flat_;
      return;
    }
    std::size_t left = 0;
    std::size_t lowest = 0;
    for (std::size_t i = 0; i < corral_.size(); ++i) {
      weights_[i] += share * (flat_[i] - weights_[i]);
      if (weights_[i] < weights_[lowest]) lowest = i;
    }
    weights_[lowest] = 0;
    for (std::size_t i = 0; i < corral_.size(); ++i) {
      if (!(weights_[i] > 0)) continue;
      weights_[left] = weights_[i];
      corral_[left++] = corral_[i];
    }
    corral_.resize(left);
    weights_.resize(left);
  }
  if (!weights_.empty()) weights_[0] = 1;
}

/// Sets flat_ to the affine weights of the point nearest to the origin in the corral's flat, by the
/// bordered Gram matrix. Returns false if that is singular.
bool HullMembership::nearest_in_flat() {
  const std::size_t n = corral_.size(), m = n + 1;
  system_.assign(m * (m + 1), 0.0);
  const auto at = [&](std::size_t i, std::size_t j) -> double& { return system_[i * (m + 1) + j]; };
  for (std::size_t i = 0; i < n; ++i) {
    const double* p = points_.row(corral_[i]);
    for (std::size_t j = 0; j <= i; ++j) {
      const double* q = points_.row(corral_[j]);
      double dot = 0;
      for (unsigned k = 0; k < d_; ++k) dot += (p[k] - origin_[k]) * (q[k] - origin_[k]);
      at(i, j) = at(j, i) = dot;
    }
    at(i, n) = at(n, i) = 1;
  }
  at(n, m) = 1;
  for (std::size_t k = 0; k < m; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < m; ++i)
      if (std::abs(at(i, k)) > std::abs(at(pivot, k))) pivot = i;
    if (std::abs(at(pivot, k)) < 0x1p-90) return false;
    if (pivot != k)
      for (std::size_t j = 0; j <= m; ++j) std::swap(at(pivot, j), at(k, j));
    for (std::size_t i = k + 1; i < m; ++i) {
      const double f = at(i, k) / at(k, k);
      for (std::size_t j = k; j <= m; ++j) at(i, j) -= f * at(k, j);
    }
  }
  flat_.assign(m, 0.0);
  for (std::size_t k = m; k-- > 0;) {
    double v = at(k, m);
    for (std::size_t j = k + 1; j < m; ++j) v -= at(k, j) * flat_[j];
    flat_[k] = v / at(k, k);
    if (!std::isfinite(flat_[k])) return false;
  }
  flat_.pop_back();
  return true;
}

/// Decides exactly whether the point is a convex combination of the corral's points. Solves sum w_i
/// (q_i - p) = 0, sum w_i = 1 in rational numbers; the corral need not be full-dimensional.
bool HullMembership::certain_inside(std::uint32_t point) const {
  const std::size_t n = corral_.size(), rows = d_ + 1;
  if (n == 0) return false;
  if (n == rows && d_ <= 8) {
    // A simplex: replacing each corner in turn by the point must not change the orientation.
    std::vector<const double*> q(n);
    for (std::size_t i = 0; i < n; ++i) q[i] = points_.exact_row(corral_[i]);
    const Sign whole = orientation(d_, q.data());
    bool within = whole != Sign::zero;
    for (std::size_t i = 0; i < n && within; ++i) {
      const double* corner = std::exchange(q[i], points_.exact_row(point));
      within = orientation(d_, q.data()) != -whole;
      q[i] = corner;
    }
    return within;
  }
  RationalRows a(rows, std::vector<mpq_class>(n + 1));
  const double* p = points_.exact_row(point);
  for (std::size_t i = 0; i < n; ++i) {
    const double* q = points_.exact_row(corral_[i]);
    for (unsigned j = 0; j < d_; ++j) a[j][i] = mpq_class(q[j]) - mpq_class(p[j]);
    a[d_][i] = 1;
  }
  a[d_][n] = 1;
  return solves_without_negatives(a);
}

/// Returns the sign of direction_ . (q - point), exactly. Coordinates must be exact.
int HullMembership::side_of(std::uint32_t point, std::uint32_t q) const {
  const double* x = points_.row(q);
  double sum = 0, size = 0;
  for (unsigned j = 0; j < d_; ++j) {
    const double term = direction_[j] * (x[j] - origin_[j]);
    sum += term;
    size += std::abs(term);
  }
  const double bound = (d_ + 4.0) * unit_roundoff * size + 0x1p-1000;
  if (sum > bound) return 1;
  if (sum < -bound) return -1;
  mpq_class exact;
  for (unsigned j = 0; j < d_; ++j)
    exact += (mpq_class(points_.exact_row(q)[j]) - mpq_class(points_.exact_row(point)[j])) *
             mpq_class(direction_[j]);
  return sgn(exact);
}

}  // namespace cullhull::internal
