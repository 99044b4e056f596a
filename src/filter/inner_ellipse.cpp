// An edge's determinant u_a v_b - v_a u_b, from l and r as computed, is within 2^-49 (|l| + |r|) +
// 2^-900 of l - r, whatever the size of u and v; only where all are positive is c inside at all,
// and then |u|, |v| < 8, so that the edge's length is within 2^-46 of its computed value. Their
// quotient bounds the distance of the origin from the edge's line from below, and the least of them
// is the disc's radius rho > 2^-20. A point is inside if u^2 + v^2 < rho^2 (1 - 2^-46): the left
// side is right to a relative 2^-49, rho^2 to 2^-51 of what was computed. What underflows is below
// 2^-1000, far below 2^-46 rho^2. NaN and infinities fail the comparison.

#include "filter/inner_ellipse.hpp"

#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/inner_ellipse.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <bit>
#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// The operations of InnerEllipse::contains, in the same order.
std::uint32_t rows_outside(const InnerEllipse::Test& test, const double* rows, std::uint32_t count,
                           std::uint32_t* out) {
  const hn::CappedTag<double, 8> tag;
  using V = hn::Vec<decltype(tag)>;
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(tag));
  const V cx = hn::Set(tag, test.centre[0]), cy = hn::Set(tag, test.centre[1]);
  const V sx = hn::Set(tag, test.scale[0]), sy = hn::Set(tag, test.scale[1]);
  const V limit = hn::Set(tag, test.limit);
  std::uint32_t kept = 0, row = 0;
  for (; row + lanes <= count; row += lanes) {
    V x, y;
    hn::LoadInterleaved2(tag, rows + 2 * std::size_t{row}, x, y);
    const V u = hn::Mul(hn::Sub(x, cx), sx), v = hn::Mul(hn::Sub(y, cy), sy);
    const auto inside = hn::Lt(hn::Add(hn::Mul(u, u), hn::Mul(v, v)), limit);
    std::uint8_t bits[8] = {};
    hn::StoreMaskBits(tag, inside, bits);
    for (unsigned left = ~unsigned{bits[0]} & ((1U << lanes) - 1); left != 0; left &= left - 1)
      out[kept++] = row + static_cast<std::uint32_t>(std::countr_zero(left));
  }
  for (; row < count; ++row) {
    out[kept] = row;
    kept += !test.contains(rows[2 * std::size_t{row}], rows[2 * std::size_t{row} + 1]);
  }
  return kept;
}

}  // namespace
}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(rows_outside);

InnerEllipse::InnerEllipse(const double* rows, const std::vector<std::uint32_t>& corners,
                           const Box& box) {
  // No structured binding: lambdas below capture these.
  double(&centre)[2] = test_.centre, (&scale)[2] = test_.scale;
  for (unsigned j = 0; j < 2; ++j) {
    const double range = box.high[j] - box.low[j];
    if (!(range > 0x1p-900 && range < 0x1p900)) return;
    scale[j] = 2 / range;
  }
  const auto at = [&](std::size_t i, unsigned j) { return rows[2 * std::size_t{corners[i]} + j]; };
  // The centroid of the area, approximately; the bounds below hold for any point in its place.
  double area = 0, moment[2] = {};
  for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
    double a[2], b[2];
    for (unsigned j = 0; j < 2; ++j) {
      a[j] = (at(i, j) - at(0, j)) * scale[j];
      b[j] = (at(i + 1, j) - at(0, j)) * scale[j];
    }
    const double share = a[0] * b[1] - a[1] * b[0];
    area += share;
    for (unsigned j = 0; j < 2; ++j) moment[j] += share * (a[j] + b[j]);
  }
  if (!(area > 0x1p-40)) return;
  for (unsigned j = 0; j < 2; ++j) centre[j] = at(0, j) + moment[j] / (3 * area) / scale[j];
  // u and v are a difference and a product, each off by the factor 1 + 2^-53 at most: their
  // relative error is below 2^-51, |u|, |v| < 8 where they matter, and underflow is far below all
  // bounds. So with l = ua vb, r = va ub as computed, the determinant ua vb - va ub is within 2^-49
  // (|l| + |r|) + 2^-900 of l - r, the length of the edge within 2^-46 of its computed value, and
  // the origin's distance from the edge's line at least `distance`.
  double least = 8;
  const auto image = [&](std::size_t i, unsigned j) { return (at(i, j) - centre[j]) * scale[j]; };
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const std::size_t next = i + 1 < corners.size() ? i + 1 : 0;
    const double ua = image(i, 0), va = image(i, 1), ub = image(next, 0), vb = image(next, 1);
    const double l = ua * vb, r = va * ub;
    const double twice = (l - r) - (0x1p-49 * (std::fabs(l) + std::fabs(r)) + 0x1p-900);
    const double du = ub - ua, dv = vb - va;
    const double distance = twice / (std::sqrt(du * du + dv * dv) + 0x1p-46);
    if (!(distance > 0x1p-20)) return;  // too near to pay, or on the wrong side
    least = std::min(least, distance);
  }
  // What contains() computes is within the factor 1 + 2^-48 of the square of the distance from the
  // origin, and so is the square of `least` rounded.
  test_.limit = least * least * (1 - 0x1p-46);
}

std::uint32_t InnerEllipse::outside(const double* rows, std::uint32_t count,
                                    std::uint32_t* out) const {
  return HWY_DYNAMIC_DISPATCH(rows_outside)(test_, rows, count, out);
}

}  // namespace cullhull::internal
#endif
