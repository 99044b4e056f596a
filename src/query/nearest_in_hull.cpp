// For weights w_i > 0 (doubles, m of them) the point q = Sum w_i x_i / W, W = Sum w_i, is in the
// hull of the x_i, whatever the weights are: how good they are affects the quality only. |v - q| =
// |Sum w_i (x_i - v)| / W. Each coordinate of the sum is computed from m differences, products and
// additions: off by at most gamma_(m+1) S, S = Sum w_i |x_i - v|, and the computed S~ is at least
// (1 - gamma_(m+1)) S. The allowance (m + 4) u S~ exceeds gamma_(m+1) S and its own rounding.
// Squares, sum, root, the division by W~ >= (1 - gamma_(m-1)) W and the last product lose at most
// (m + d / 2 + 8) u relatively; the factor 1 + (2 m + d + 16) u gives it back.
//
// Scale. Coordinates are multiplied by a power of two, 2^+-1022 at the utmost, that brings the
// largest to [1, 4) at most: exact but where it underflows, by at most 2^-1075. Differences of
// doubles do not underflow; products lose at most 2^-1075 each. 2^-1000 a coordinate covers both;
// squares that underflow are covered by 2^-500 on the distance. With a requested distance below
// 2^-490 of that scale no vertex is dropped.

#include <algorithm>
#include <cmath>
#include <limits>

#include "query/vertex_search.hpp"

namespace cullhull::internal {

NearestInHull::NearestInHull(unsigned dimension) : d_(dimension), x_(dimension) {}

double NearestInHull::dot(const double* a, const double* b) const {
  double sum = 0;
  for (unsigned j = 0; j < d_; ++j) sum += a[j] * b[j];
  return sum;
}

bool NearestInHull::search(const double* rows, std::size_t count, double enough) {
  std::uint32_t first = 0;
  double least = std::numeric_limits<double>::infinity(), longest = 0;
  for (std::uint32_t i = 0; i < count; ++i) {
    const double square = dot(rows + i * d_, rows + i * d_);
    longest = std::max(longest, square);
    if (square < least) {
      least = square;
      first = i;
    }
  }
  now_.places.assign(1, first);
  now_.weights.assign(1, 1.0);
  combine(rows);
  best_ = now_;
  // Each step strictly decreases the distance; steps below the rounding errors are not taken.
  const double noise = 0x1p-51 * std::sqrt(longest);
  for (std::size_t step = 0; step < 64 + 8 * std::size_t{d_}; ++step) {
    const double square = dot(x_.data(), x_.data()), norm = std::sqrt(square);
    if (norm <= noise || norm <= 0x1p-500) break;
    std::uint32_t extreme = 0;
    double lowest = std::numeric_limits<double>::infinity();
    for (std::uint32_t i = 0; i < count; ++i) {
      const double along = dot(x_.data(), rows + i * d_);
      if (along < lowest) {
        lowest = along;
        extreme = i;
      }
    }
    if (lowest > enough * norm) return false;
    if (square - lowest <= noise * norm) break;
    if (!enter(rows, extreme) || !(dot(x_.data(), x_.data()) < square)) break;
    best_ = now_;
  }
  return true;
}

/// Wolfe's minor cycle: moves to the point nearest to the origin in the hull of the rows in use and
/// `row`. False where that makes no progress.
bool NearestInHull::enter(const double* rows, std::uint32_t row) {
  if (std::find(now_.places.begin(), now_.places.end(), row) != now_.places.end()) return false;
  now_.places.push_back(row);
  now_.weights.push_back(0.0);
  for (;;) {
    if (!affine_minimum(rows)) return false;
    // Moves towards it as far as all weights stay positive.
    double step = 1;
    std::size_t leaving = now_.places.size();
    for (std::size_t i = 0; i < now_.places.size(); ++i) {
      if (affine_[i] > 0) continue;
      const double at = now_.weights[i] / (now_.weights[i] - affine_[i]);
      if (leaving == now_.places.size() || at < step) {
        step = at;
        leaving = i;
      }
    }
    if (leaving == now_.places.size()) {
      now_.weights = affine_;
      combine(rows);
      return true;
    }
    if (!(step >= 0)) return false;
    for (std::size_t i = 0; i < now_.weights.size(); ++i)
      now_.weights[i] += step * (affine_[i] - now_.weights[i]);
    now_.weights[leaving] = 0;
    for (std::size_t i = now_.places.size(); i-- > 0;)
      if (!(now_.weights[i] > 0)) {
        now_.places.erase(now_.places.begin() + static_cast<std::ptrdiff_t>(i));
        now_.weights.erase(now_.weights.begin() + static_cast<std::ptrdiff_t>(i));
      }
    if (now_.places.empty()) return false;
  }
}

/// Sets affine_ to the weights, of sum 1, of the point nearest to the origin in the flat of the
/// rows in use, by orthogonalization. False where the rows are too nearly dependent for doubles.
bool NearestInHull::affine_minimum(const double* rows) {
  const std::size_t n = now_.places.size() - 1;
  if (n > d_) return false;
  const double* origin = rows + std::size_t{now_.places[0]} * d_;
  basis_.assign(n * d_, 0);
  triangle_.assign(n * n, 0);
  projections_.assign(n, 0);
  std::vector<double>& rest = affine_;  // used first for the part of -origin outside of the span
  rest.assign(d_, 0);
  for (unsigned j = 0; j < d_; ++j) rest[j] = -origin[j];
  for (std::size_t i = 0; i < n; ++i) {
    double* e = basis_.data() + i * d_;
    const double* row = rows + std::size_t{now_.places[i + 1]} * d_;
    for (unsigned j = 0; j < d_; ++j) e[j] = row[j] - origin[j];
    const double length = std::sqrt(dot(e, e));
    for (std::size_t k = 0; k < i; ++k) {
      const double* q = basis_.data() + k * d_;
      const double along = dot(q, e);
      triangle_[k * n + i] = along;
      for (unsigned j = 0; j < d_; ++j) e[j] -= along * q[j];
    }
    const double height = std::sqrt(dot(e, e));
    if (!(height > 0x1p-45 * length)) return false;
    triangle_[i * n + i] = height;
    for (unsigned j = 0; j < d_; ++j) e[j] /= height;
    projections_[i] = dot(e, rest.data());
    for (unsigned j = 0; j < d_; ++j) rest[j] -= projections_[i] * e[j];
  }
  affine_.assign(n + 1, 0);
  affine_[0] = 1;
  for (std::size_t i = n; i-- > 0;) {
    double value = projections_[i];
    for (std::size_t k = i + 1; k < n; ++k) value -= triangle_[i * n + k] * affine_[k + 1];
    affine_[i + 1] = value / triangle_[i * n + i];
    affine_[0] -= affine_[i + 1];
  }
  return true;
}

void NearestInHull::combine(const double* rows) {
  std::fill(x_.begin(), x_.end(), 0.0);
  for (std::size_t i = 0; i < now_.places.size(); ++i) {
    const double* row = rows + std::size_t{now_.places[i]} * d_;
    for (unsigned j = 0; j < d_; ++j) x_[j] += now_.weights[i] * row[j];
  }
}

double NearestInHull::bound(const double* rows) const {
  const std::size_t m = best_.places.size();
  double total = 0;
  for (const double w : best_.weights) total += w;
  // (m + 4) 2^-53 |terms| bounds the rounding of differences, products and sums; the last factor
  // that of the remaining operations.
  double squares = 0;
  for (unsigned j = 0; j < d_; ++j) {
    double sum = 0, size = 0;
    for (std::size_t i = 0; i < m; ++i) {
      const double term = best_.weights[i] * rows[std::size_t{best_.places[i]} * d_ + j];
      sum += term;
      size += std::fabs(term);
    }
    const double error = static_cast<double>(m + 4) * 0x1p-53 * size + 0x1p-1000;
    squares += (std::fabs(sum) + error) * (std::fabs(sum) + error);
  }
  const double slack = 1 + static_cast<double>(2 * m + d_ + 16) * 0x1p-53;
  return (std::sqrt(squares) / total) * slack + 0x1p-500;
}

}  // namespace cullhull::internal
