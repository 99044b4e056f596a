// Wolfe's method (Finding the nearest point in a polytope, 1976) from the point: either the nearest
// point of the others' hull is some way off, then the direction to it separates, or the point is a
// convex combination of a few others, the corral. Both are certificates that are checked exactly;
// how they were found does not matter.
#include "extreme/hull_membership.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "extreme/rational.hpp"
#include "predicates/minors.hpp"
#include "predicates/orientation.hpp"

namespace cullhull::internal {

HullMembership::HullMembership(const LocalPoints& points, const Control& control)
    : points_(points), control_(control), d_(points.dimension), direction_(d_) {}

bool HullMembership::inside(std::uint32_t point, const std::vector<std::uint32_t>& others,
                            const std::vector<std::uint32_t>& working,
                            std::vector<std::uint32_t>& useful) {
  // Certificates are checked against the coordinates that doubles hold exactly.
  const bool floating = points_.exact == points_.coordinates;
  constexpr unsigned most_rounds = 200;
  corral_.clear();
  weights_.clear();
  origin_ = points_.row(point);
  for (unsigned round = 0; floating && round < most_rounds; ++round) {
    control_.check();
    const Answer answer = approach(point, working, useful);
    if (answer == Answer::inside) return true;
    if (answer == Answer::unknown) break;
    // The direction separates the working points: does it separate all?
    double least = 0;
    const std::uint32_t q = most_against(others, point, least);
    double size = 0;
    for (const double v : direction_) size += std::abs(v);
    // d products and sums of numbers of at most |v|, twice, and the difference.
    const double bound = (2.0 * d_ + 6) * unit_roundoff * size + 0x1p-1000;
    if (least > bound) return false;
    std::uint32_t against = q;
    if (least >= -bound) {
      // Doubtful ones are decided exactly; the rest is beyond the bound on the right side.
      const auto doubtful = std::find_if(others.begin(), others.end(), [&](std::uint32_t o) {
        return o != point && side_of(point, o) <= 0;
      });
      if (doubtful == others.end()) return false;
      against = *doubtful;
    }
    if (std::find(useful.begin(), useful.end(), against) != useful.end() ||
        std::find(working.begin(), working.end(), against) != working.end())
      break;  // it was tried already: rounding keeps us here
    useful.push_back(against);
  }
  ++exact_count_;
  return inside_exact(points_, point, others, control_);
}

/// The point of `ids` with the least direction . (q - point).
std::uint32_t HullMembership::most_against(const std::vector<std::uint32_t>& ids,
                                           std::uint32_t point, double& least) const {
  double low = HUGE_VAL;
  std::uint32_t best = point;
  for (const std::uint32_t q : ids) {
    const double* x = points_.row(q);
    double sum = 0;
    for (unsigned j = 0; j < d_; ++j) sum += direction_[j] * x[j];
    if (sum < low && q != point) {
      low = sum;
      best = q;
    }
  }
  double at = 0;
  for (unsigned j = 0; j < d_; ++j) at += direction_[j] * origin_[j];
  least = low - at;
  return best;
}

HullMembership::Answer HullMembership::approach(std::uint32_t point,
                                                const std::vector<std::uint32_t>& working,
                                                const std::vector<std::uint32_t>& useful) {
  const unsigned most_steps = 50 + 20 * d_;
  for (unsigned step = 0; step < most_steps; ++step) {
    combine();
    double square = 0;
    for (const double v : direction_) square += v * v;
    if (corral_.empty()) {
      // From the middle of the frame outward: a direction that most others are against.
      for (unsigned j = 0; j < d_; ++j) direction_[j] = -origin_[j];
    } else if (square < 0x1p-80 || corral_.size() == d_ + 1) {
      if (certain_inside(point)) return Answer::inside;
      if (square < 0x1p-96) return Answer::unknown;
    }
    double least = 0, least_useful = 0;
    std::uint32_t q = most_against(working, point, least);
    const std::uint32_t r = most_against(useful, point, least_useful);
    if (least_useful < least) {
      least = least_useful;
      q = r;
    }
    if (least > 0) return Answer::separated;
    if (q == point || std::find(corral_.begin(), corral_.end(), q) != corral_.end())
      return certain_inside(point) ? Answer::inside : Answer::unknown;
    add(q);
    move_to_nearest();
  }
  return Answer::unknown;
}

void HullMembership::add(std::uint32_t q) {
  corral_.push_back(q);
  weights_.push_back(corral_.size() == 1 ? 1 : 0);
}

/// direction_ = the corral's point of the present weights, seen from the origin.
void HullMembership::combine() {
  std::fill(direction_.begin(), direction_.end(), 0.0);
  for (std::size_t i = 0; i < corral_.size(); ++i)
    for (unsigned j = 0; j < d_; ++j)
      direction_[j] += weights_[i] * (points_.row(corral_[i])[j] - origin_[j]);
}

/// Towards the nearest point of the corral's flat; what weighs nothing on the way leaves.
void HullMembership::move_to_nearest() {
  while (corral_.size() > 1) {
    if (!nearest_in_flat()) {  // affinely dependent, as far as rounding lets us see
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

/// flat_: affine weights of the point nearest to the origin in the corral's flat, from the bordered
/// Gram matrix. False where that is singular.
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

/// Exactly: whether the point is a convex combination of the corral's points. Solves
/// sum w_i (q_i - p) = 0, sum w_i = 1 over the rationals; the corral may span a flat only.
bool HullMembership::certain_inside(std::uint32_t point) const {
  const std::size_t n = corral_.size(), rows = d_ + 1;
  if (n == 0) return false;
  if (n == rows && d_ <= 8) {
    // A simplex: the point replaces each corner in turn and must not turn it over.
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
  RationalMatrix a(rows, n + 1);
  Rational t;
  const double* p = points_.exact_row(point);
  for (std::size_t i = 0; i < n; ++i) {
    const double* q = points_.exact_row(corral_[i]);
    for (unsigned j = 0; j < d_; ++j) {
      mpq_set_d(a.at(j, i), q[j]);
      mpq_set_d(t.value, p[j]);
      mpq_sub(a.at(j, i), a.at(j, i), t.value);
    }
    mpq_set_si(a.at(d_, i), 1, 1);
  }
  mpq_set_si(a.at(d_, n), 1, 1);
  return a.solves_without_negatives();
}

/// Sign of direction_ . (q - point), exactly.
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
  Rational exact, t, v;
  for (unsigned j = 0; j < d_; ++j) {
    mpq_set_d(t.value, points_.exact_row(q)[j]);
    mpq_set_d(v.value, points_.exact_row(point)[j]);
    mpq_sub(t.value, t.value, v.value);
    mpq_set_d(v.value, direction_[j]);
    mpq_mul(t.value, t.value, v.value);
    mpq_add(exact.value, exact.value, t.value);
  }
  return mpq_sgn(exact.value);
}

}  // namespace cullhull::internal
