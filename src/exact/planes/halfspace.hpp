// Halfspaces in numbers of any kind, and the point in which D of their planes meet.
#pragma once

#include <array>
#include <cstddef>

#include "exact/numbers/bounded.hpp"

namespace cullhull::internal {

/// The halfspace normal . x <= offset.
template <unsigned D, class Real>
struct Halfspace {
  std::array<Real, D> normal;
  Real offset;
};

// Example: p = (0, 0) and q = (2, 0) without weights: e . x <= |e|^2 / 2 is 2 x <= 2, the half
// plane x <= 1. With w_p = 2 it is 2 x <= 3: a heavier site has a larger cell.

/// Returns the halfspace of points x, relative to p, with |x|^2 - w_p <= |x - e|^2 - w_q, where e =
/// q - p: e . x <= (|e|^2 + w_p - w_q) / 2. Weights follow the coordinates in the rows.
template <unsigned D, class Real>
Halfspace<D, Real> bisector(const double* p, const double* q, bool weighted) {
  Halfspace<D, Real> h;
  Real sum = weighted ? exact_difference<Real>(p[D], q[D]) : Real(0.0);
  for (unsigned j = 0; j < D; ++j) {
    h.normal[j] = exact_difference<Real>(q[j], p[j]);
    sum = sum + h.normal[j] * h.normal[j];
  }
  h.offset = sum * Real(0.5);
  return h;
}

template <class Real>
std::array<Real, 3> cross(const std::array<Real, 3>& a, const std::array<Real, 3>& b) {
  std::array<Real, 3> r;
  for (unsigned j = 0; j < 3; ++j) {
    const unsigned k = (j + 1) % 3, l = (j + 2) % 3;
    r[j] = a[k] * b[l] - a[l] * b[k];
  }
  return r;
}

/// Returns the point in which the planes meet, which must be unique, by Cramer's rule.
template <class Real>
std::array<Real, 1> meeting(const std::array<const Halfspace<1, Real>*, 1>& h) {
  return {Real(h[0]->offset / divisor(h[0]->normal[0]))};
}
template <class Real>
std::array<Real, 2> meeting(const std::array<const Halfspace<2, Real>*, 2>& h) {
  const auto &a = *h[0], &b = *h[1];
  const Real det = a.normal[0] * b.normal[1] - a.normal[1] * b.normal[0];
  divisor(det);
  return {Real((a.offset * b.normal[1] - b.offset * a.normal[1]) / det),
          Real((a.normal[0] * b.offset - b.normal[0] * a.offset) / det)};
}
template <class Real>
std::array<Real, 3> meeting(const std::array<const Halfspace<3, Real>*, 3>& h) {
  std::array<Real, 3> sum, minors;
  for (unsigned i = 0; i < 3; ++i) {
    minors = cross(h[(i + 1) % 3]->normal, h[(i + 2) % 3]->normal);
    for (unsigned j = 0; j < 3; ++j) {
      const Real term = h[i]->offset * minors[j];
      sum[j] = i == 0 ? term : Real(sum[j] + term);
    }
  }
  // `minors` belong to the last plane.
  Real det = h[2]->normal[0] * minors[0];
  for (unsigned j = 1; j < 3; ++j) det = det + h[2]->normal[j] * minors[j];
  divisor(det);
  for (Real& x : sum) x = x / det;
  return sum;
}

}  // namespace cullhull::internal
