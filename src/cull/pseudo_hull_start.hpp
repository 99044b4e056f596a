// From the points of a subset to the simplex its pseudo-hull grows from.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "parallel/primitives.hpp"

namespace cullhull::internal {

/// The lowest and the highest points along each axis, the first of equal ones; no_item where there
/// is none.
template <unsigned D>
struct AxisExtremes {
  double low[D], high[D];
  std::uint32_t lowest[D], highest[D];

  AxisExtremes() {
    std::fill_n(low, D, std::numeric_limits<double>::infinity());
    std::fill_n(high, D, -std::numeric_limits<double>::infinity());
    std::fill_n(lowest, D, no_item);
    std::fill_n(highest, D, no_item);
  }
  /// Later items; comparisons with NaN are false, so such points are passed over.
  void take(const AxisExtremes& b) {
    for (unsigned k = 0; k < D; ++k) {
      if (b.low[k] < low[k]) {
        low[k] = b.low[k];
        lowest[k] = b.lowest[k];
      }
      if (b.high[k] > high[k]) {
        high[k] = b.high[k];
        highest[k] = b.highest[k];
      }
    }
  }
};

/// Of the rows [begin, end).
template <unsigned D>
AxisExtremes<D> axis_extremes(const double* rows, std::uint32_t begin, std::uint32_t end) {
  AxisExtremes<D> e;
  for (std::uint32_t i = begin; i < end; ++i) {
    for (unsigned k = 0; k < D; ++k) {
      const double x = rows[std::size_t{i} * D + k];
      e.low[k] = x < e.low[k] ? x : e.low[k];
      e.high[k] = x > e.high[k] ? x : e.high[k];
    }
  }
  for (unsigned k = 0; k < D; ++k) {
    const auto first_at = [&](double value) {
      for (std::uint32_t i = begin; i < end; ++i)
        if (rows[std::size_t{i} * D + k] == value) return i;
      return no_item;
    };
    e.lowest[k] = first_at(e.low[k]);
    e.highest[k] = first_at(e.high[k]);
  }
  return e;
}

/// Powers of two that bring the extent of every axis into [1/2, 1], or below where it is less than
/// 2^-1000. False if an axis has no extent: the points lie in a flat.
template <unsigned D>
bool axis_scales(const AxisExtremes<D>& e, double* scale) {
  for (unsigned k = 0; k < D; ++k) {
    if (!(e.low[k] < e.high[k])) return false;
    int exponent = 0;
    std::frexp(e.high[k] / 2 - e.low[k] / 2, &exponent);  // halves: the extent itself may overflow
    scale[k] = std::ldexp(1.0, std::min(1000, -(exponent + 1)));
  }
  return true;
}

/// The affine hull of the points chosen so far, as an orthonormal basis in doubles. Approximate:
/// the planes of the simplex are what is proved afterwards.
template <unsigned D>
class Flat {
 public:
  void start(const double* origin) {
    origin_ = origin;
    rank_ = 0;
  }
  unsigned rank() const { return rank_; }
  double square_distance(const double* x) const {
    double v[D];
    return residual(x, v);
  }
  void extend(const double* x) {
    const double square = residual(x, basis_[rank_]);
    for (double& v : basis_[rank_]) v /= std::sqrt(square);
    ++rank_;
  }

 private:
  double residual(const double* x, double* v) const {
    for (unsigned k = 0; k < D; ++k) v[k] = x[k] - origin_[k];
    for (unsigned b = 0; b < rank_; ++b) {
      double along = 0;
      for (unsigned k = 0; k < D; ++k) along += v[k] * basis_[b][k];
      for (unsigned k = 0; k < D; ++k) v[k] -= along * basis_[b][k];
    }
    double square = 0;
    for (unsigned k = 0; k < D; ++k) square += v[k] * v[k];
    return square;
  }
  const double* origin_ = nullptr;
  double basis_[D][D];
  unsigned rank_ = 0;
};

/// D + 1 rows that span a simplex: two of the axes' extreme points farthest from one another, then
/// each time the one farthest from the flat of those before; where the extreme points lie in a
/// flat, the farthest of all points. False if the points lie in a flat, or so nearly that doubles
/// cannot tell.
template <unsigned D, class Executor>
bool choose_simplex(const double* rows, std::uint32_t count, const AxisExtremes<D>& e,
                    const Executor& executor, std::uint32_t* simplex) {
  // Distances in the frame, where the points' extent is about 1.
  constexpr double thin = 0x1p-12, flat = 0x1p-48;
  const auto row = [&](std::uint32_t i) { return rows + std::size_t{i} * D; };
  std::uint32_t candidates[2 * D];
  std::copy_n(e.lowest, D, candidates);
  std::copy_n(e.highest, D, candidates + D);

  Flat<D> hull;
  double best = -1;
  for (const std::uint32_t a : candidates) {
    hull.start(row(a));
    for (const std::uint32_t b : candidates) {
      const double v = hull.square_distance(row(b));
      if (v > best) {
        best = v;
        simplex[0] = a;
        simplex[1] = b;
      }
    }
  }
  if (!(best > flat * flat)) return false;
  hull.start(row(simplex[0]));
  hull.extend(row(simplex[1]));
  while (hull.rank() < D) {
    struct Far {
      double square;
      std::uint32_t point;
    } far{-1, no_item};
    const auto farther = [](const Far& a, const Far& b) { return b.square > a.square ? b : a; };
    const auto measured = [&](std::uint32_t i) { return Far{hull.square_distance(row(i)), i}; };
    for (const std::uint32_t c : candidates) far = farther(far, measured(c));
    if (!(far.square > thin * thin))
      far = executor.reduce(count, Far{-1, no_item}, measured, farther);
    if (!(far.square > flat * flat)) return false;
    simplex[hull.rank() + 1] = far.point;
    hull.extend(row(far.point));
  }
  return true;
}

}  // namespace cullhull::internal
