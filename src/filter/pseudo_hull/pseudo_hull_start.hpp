// From the points of a subset to the simplex that its pseudo-hull grows from.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

#include "filter/pseudo_hull/primitives.hpp"
#include "parallel/host_device.hpp"

namespace cullhull::internal {

/// The lowest and the highest points along each axis, the first of equal ones; no_item if there are
/// no points.
template <unsigned D>
struct AxisExtremes {
  double low[D], high[D];
  std::uint32_t lowest[D], highest[D];

  CULLHULL_HD AxisExtremes() {
    for (unsigned k = 0; k < D; ++k) {
      low[k] = std::numeric_limits<double>::infinity();
      high[k] = -std::numeric_limits<double>::infinity();
      lowest[k] = highest[k] = no_item;
    }
  }
  /// Merges two results, in any order. Comparisons with NaN are false, so such points are skipped.
  CULLHULL_HD void take(const AxisExtremes& b) {
    for (unsigned k = 0; k < D; ++k) {
      if (b.low[k] < low[k] || (b.low[k] == low[k] && b.lowest[k] < lowest[k])) {
        low[k] = b.low[k];
        lowest[k] = b.lowest[k];
      }
      if (b.high[k] > high[k] || (b.high[k] == high[k] && b.highest[k] < highest[k])) {
        high[k] = b.high[k];
        highest[k] = b.highest[k];
      }
    }
  }
};

template <unsigned D>
struct TakeExtremes {
  CULLHULL_HD AxisExtremes<D> operator()(AxisExtremes<D> a, const AxisExtremes<D>& b) const {
    a.take(b);
    return a;
  }
};

/// Finds the extremes of the rows [step * grain, (step + 1) * grain).
template <unsigned D, class Rows>
struct ExtremesOfStep {
  Rows rows;
  std::uint32_t count, grain;

  CULLHULL_HD AxisExtremes<D> operator()(std::uint32_t step) const {
    const std::uint32_t begin = step * grain;
    const std::uint32_t end = count - begin < grain ? count : begin + grain;
    AxisExtremes<D> e;
    for (std::uint32_t i = begin; i < end; ++i) {
      double x[D];
      rows.load(i, x);
      for (unsigned k = 0; k < D; ++k) {
        e.low[k] = x[k] < e.low[k] ? x[k] : e.low[k];
        e.high[k] = x[k] > e.high[k] ? x[k] : e.high[k];
      }
    }
    for (unsigned k = 0; k < D; ++k) {
      e.lowest[k] = first_at(k, e.low[k], begin, end);
      e.highest[k] = first_at(k, e.high[k], begin, end);
    }
    return e;
  }

 private:
  CULLHULL_HD std::uint32_t first_at(unsigned k, double value, std::uint32_t begin,
                                     std::uint32_t end) const {
    for (std::uint32_t i = begin; i < end; ++i) {
      double x[D];
      rows.load(i, x);
      if (x[k] == value) return i;
    }
    return no_item;
  }
};

/// The extremes, when the executor has found them: get().
template <unsigned D, class Executor, class Rows>
auto extremes_of(Executor& executor, const Rows& rows, std::uint32_t count) {
  constexpr std::uint32_t grain = Executor::grain;
  return executor.begin_reduce(static_cast<std::uint32_t>(chunk_count(count, grain)),
                               AxisExtremes<D>{}, ExtremesOfStep<D, Rows>{rows, count, grain},
                               TakeExtremes<D>{});
}

// From h = fl(high / 2 - low / 2) < 2^e follows high - low <= 2^(e + 1): halving is exact but for
// subnormal numbers, the difference is rounded once, and rounding does not cross a power of two.
// Example: an axis from 1e6 to 1e6 + 3 has h = 1.5 and the scale 2^-2: the extent is 0.75. Nothing
// is shifted: only differences of two points are computed, which have no more error far from the
// origin.

/// Computes powers of two that scale the extent of every axis into [1/2, 1], or below if the extent
/// is less than 2^-1000. Returns false if an axis has no extent: the points lie in a flat.
template <unsigned D>
bool axis_scales(const AxisExtremes<D>& e, double* scale) {
  for (unsigned k = 0; k < D; ++k) {
    if (!(e.low[k] < e.high[k])) return false;
    int exponent = 0;
    std::frexp(e.high[k] / 2 - e.low[k] / 2, &exponent);  // halved, as the extent may overflow
    scale[k] = std::ldexp(1.0, std::min(1000, -(exponent + 1)));
  }
  return true;
}

// Example in space: the first two corners give a line, the third is farthest from it, the fourth
// farthest from their plane. Each step projects out one direction: the distance of x from a flat is
// the length of what is left of x - origin. Rounding may choose a corner that is not quite the
// farthest: a slightly smaller simplex, nothing else.

/// The affine hull of the points chosen so far, as an orthonormal basis in doubles. Approximate:
/// the planes of the simplex have their own error bounds.
template <unsigned D>
class Flat {
 public:
  void start(const double* origin) {
    std::copy_n(origin, D, origin_);
    rank_ = 0;
  }
  unsigned rank() const { return rank_; }
  CULLHULL_HD double square_distance(const double* x) const {
    double v[D];
    return residual(x, v);
  }
  void extend(const double* x) {
    const double square = residual(x, basis_[rank_]);
    for (double& v : basis_[rank_]) v /= std::sqrt(square);
    ++rank_;
  }

 private:
  CULLHULL_HD double residual(const double* x, double* v) const {
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
  double origin_[D] = {};
  double basis_[D][D] = {};
  unsigned rank_ = 0;
};

/// A point and its squared distance from a flat. Farther keeps the farther of two, the first of
/// equal ones.
struct FarPoint {
  double square = -1;
  std::uint32_t point = no_item;
};
struct Farther {
  CULLHULL_HD FarPoint operator()(const FarPoint& a, const FarPoint& b) const {
    return b.square > a.square || (b.square == a.square && b.point < a.point) ? b : a;
  }
};
template <unsigned D, class Rows>
struct DistanceFromFlat {
  Rows rows;
  Flat<D> flat;
  CULLHULL_HD FarPoint operator()(std::uint32_t i) const {
    double x[D];
    rows.load(i, x);
    const double square = flat.square_distance(x);
    return square >= 0 ? FarPoint{square, i} : FarPoint{};  // never for a NaN
  }
};

/// Copies rows as doubles into the host's memory.
template <unsigned D, class Rows, unsigned Most>
struct CopyRows {
  Rows rows;
  std::uint32_t row[Most];
  double* out;
  CULLHULL_HD void operator()(std::uint32_t i) const {
    rows.load(row[i], out + std::size_t{i} * D);
  }
};
template <unsigned D, class Rows, class Executor>
class RowReader {
 public:
  /// Reads the coordinates of `count` rows, one after another.
  void read(Executor& executor, const Rows& rows, const std::uint32_t* row, std::uint32_t count,
            double* out) {
    CopyRows<D, Rows, 2 * D> body{rows, {}, executor.reserve(buffer_, 2 * D * D)};
    std::copy_n(row, count, body.row);
    executor.for_each(count, body);
    executor.fetch(buffer_.data(), std::size_t{count} * D, out);
  }

 private:
  typename Executor::template Array<double> buffer_;
};

/// D + 1 points that span a simplex: row numbers and coordinates.
template <unsigned D>
struct StartSimplex {
  std::uint32_t row[D + 1];
  double corner[D + 1][D];
};

/// Chooses the two of the axes' extreme points that are farthest from each other, then repeatedly
/// the one farthest from the flat of those chosen; if the extreme points are in that flat, the
/// farthest of all points. Returns false if the points lie in a flat, or too near to one for
/// doubles to decide.
template <unsigned D, class Rows, class Executor>
bool choose_simplex(Executor& executor, RowReader<D, Rows, Executor>& reader, const Rows& rows,
                    std::uint32_t count, const AxisExtremes<D>& e, StartSimplex<D>& simplex) {
  // Distances in the frame, where the points' extent is about 1. If the farthest extreme point is
  // within `thin`, all points are searched for a farther one, which takes a pass; within `flat`, 16
  // ulps of 1, there is no simplex. A bad value would cost time or culled points, never
  // correctness; other values are untested.
  constexpr double thin = 0x1p-12, flat = 0x1p-48;
  std::uint32_t candidates[2 * D];
  std::copy_n(e.lowest, D, candidates);
  std::copy_n(e.highest, D, candidates + D);
  double at[2 * D][D];
  reader.read(executor, rows, candidates, 2 * D, at[0]);

  Flat<D> hull;
  double best = -1;
  const auto set_corner = [&](unsigned c, std::uint32_t row, const double* x) {
    simplex.row[c] = row;
    std::copy_n(x, D, simplex.corner[c]);
  };
  for (unsigned a = 0; a < 2 * D; ++a) {
    hull.start(at[a]);
    for (unsigned b = 0; b < 2 * D; ++b) {
      const double v = hull.square_distance(at[b]);
      if (v > best) {
        best = v;
        set_corner(0, candidates[a], at[a]);
        set_corner(1, candidates[b], at[b]);
      }
    }
  }
  if (!(best > flat * flat)) return false;
  hull.start(simplex.corner[0]);
  hull.extend(simplex.corner[1]);
  while (hull.rank() < D) {
    const unsigned next = hull.rank() + 1;
    double farthest = -1;
    for (unsigned c = 0; c < 2 * D; ++c)
      if (const double v = hull.square_distance(at[c]); v > farthest) {
        farthest = v;
        set_corner(next, candidates[c], at[c]);
      }
    if (!(farthest > thin * thin)) {
      const FarPoint far =
          executor.reduce(count, FarPoint{}, DistanceFromFlat<D, Rows>{rows, hull}, Farther{});
      if (far.point == no_item) return false;
      double x[D];
      reader.read(executor, rows, &far.point, 1, x);
      farthest = far.square;
      set_corner(next, far.point, x);
    }
    if (!(farthest > flat * flat)) return false;
    hull.extend(simplex.corner[next]);
  }
  return true;
}

}  // namespace cullhull::internal
