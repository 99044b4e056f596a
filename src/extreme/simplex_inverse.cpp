#include "extreme/simplex_inverse.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "exact/determinants/minors.hpp"

namespace cullhull::internal::inline extreme {

bool SimplexInverse::set(const LocalPoints& points, const std::uint32_t* corners) {
  const unsigned d = points.dimension, n = d + 1;
  constexpr double never = std::numeric_limits<double>::infinity();
  rows_ = n;
  rest_ = never;
  // [A I], A's columns being the corners with a 1 below, by Gauss and Jordan.
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
  inverse_.resize(std::size_t{n} * n);
  allowed_.resize(n);
  double rest = 0;
  for (unsigned i = 0; i < n; ++i) {
    double size = 0, worst = 0;
    for (unsigned j = 0; j < n; ++j) {
      inverse_[i * n + j] = at(i, n + j);
      size += std::abs(at(i, n + j));
    }
    allowed_[i] = (n + 6) * unit_roundoff * size + 0x1p-1000;
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

}  // namespace cullhull::internal::inline extreme
