// In-sphere tests, one cell in each lane of a vector; compiled once per instruction set.
#include "exact/insphere/lift_sides.hpp"

#include <bit>
#include <cstdint>

#include "exact/insphere/lift_filter.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "exact/insphere/lift_sides.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::inline exact::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<double, sides_block>;
using V = hn::Vec<F>;

/// A DoubleDouble in each lane, with the same error bounds.
struct DoubleDoubles {
  V high, low;
};

HWY_INLINE DoubleDoubles sum_of(V a, V b) {
  const V s = hn::Add(a, b);
  const V t = hn::Sub(s, a);
  return {s, hn::Add(hn::Sub(a, hn::Sub(s, t)), hn::Sub(b, t))};
}
HWY_INLINE DoubleDoubles quick_sum_of(V a, V b) {
  const V s = hn::Add(a, b);
  return {s, hn::Sub(b, hn::Sub(s, a))};
}
HWY_INLINE DoubleDoubles product_of(V a, V b) {
  const V p = hn::Mul(a, b);
#if HWY_NATIVE_FMA
  return {p, hn::MulSub(a, b, p)};
#else
  const V split = hn::Set(F(), 134217729.0);
  const V ta = hn::Mul(split, a), tb = hn::Mul(split, b);
  const V ah = hn::Sub(ta, hn::Sub(ta, a)), bh = hn::Sub(tb, hn::Sub(tb, b));
  const V al = hn::Sub(a, ah), bl = hn::Sub(b, bh);
  const V rest = hn::Add(hn::Add(hn::Sub(hn::Mul(ah, bh), p), hn::Mul(ah, bl)), hn::Mul(al, bh));
  return {p, hn::Add(rest, hn::Mul(al, bl))};
#endif
}
HWY_INLINE DoubleDoubles add(const DoubleDoubles& a, const DoubleDoubles& b) {
  const DoubleDoubles s = sum_of(a.high, b.high), t = sum_of(a.low, b.low);
  const DoubleDoubles u = quick_sum_of(s.high, hn::Add(s.low, t.high));
  return quick_sum_of(u.high, hn::Add(u.low, t.low));
}
HWY_INLINE DoubleDoubles multiply(const DoubleDoubles& a, const DoubleDoubles& b) {
  const DoubleDoubles p = product_of(a.high, b.high);
  return quick_sum_of(p.high,
                      hn::Add(p.low, hn::Add(hn::Mul(a.high, b.low), hn::Mul(a.low, b.high))));
}
HWY_INLINE DoubleDoubles negative(const DoubleDoubles& a) {
  return {hn::Neg(a.high), hn::Neg(a.low)};
}

/// Computes the signs of one vector of cells. `corners`, `signs`: the data of the first cell.
template <unsigned K>
HWY_INLINE void sides_of_vector(const double* corners, const double* p, double tiny,
                                double* signs) {
  const F f;
  constexpr unsigned columns = K + 1, full = 1U << columns;
  // The rows of all corners relative to p: up to the sign (-1)^columns, their determinant is that
  // of lifted_rows(), whose rows are relative to the first corner.
  DoubleDoubles m[columns][columns];
  V largest[columns];
  for (V& v : largest) v = hn::Zero(f);
  for (unsigned i = 0; i < columns; ++i) {
    for (unsigned j = 0; j < K; ++j) {
      const DoubleDoubles v =
          sum_of(hn::LoadU(f, corners + (i * K + j) * sides_block), hn::Set(f, -p[j]));
      largest[j] = hn::Max(largest[j], hn::Abs(v.high));
      const DoubleDoubles square = multiply(v, v);
      m[i][j] = v;
      m[i][K] = j == 0 ? square : add(m[i][K], square);
    }
    largest[K] = hn::Max(largest[K], hn::Abs(m[i][K].high));
  }
  // det[mask]: the minor of the first rows on the columns of a mask, as in expand_minors.
  DoubleDoubles det[full];
  for (unsigned mask = 1; mask < full; ++mask) {
    const auto size = static_cast<unsigned>(std::popcount(mask));
    const DoubleDoubles* const row = m[size - 1];
    if (size == 1) {
      det[mask] = row[std::countr_zero(mask)];
      continue;
    }
    DoubleDoubles sum;
    bool minus = size % 2 == 0;
    for (unsigned rest = mask; rest != 0; rest &= rest - 1) {
      const auto j = static_cast<unsigned>(std::countr_zero(rest));
      DoubleDoubles term = multiply(row[j], det[mask ^ (1U << j)]);
      if (minus) term = negative(term);
      sum = rest == mask ? term : add(sum, term);
      minus = !minus;
    }
    det[mask] = sum;
  }
  V value = det[full - 1].high;
  if (columns % 2 == 1) value = hn::Neg(value);
  constexpr double roundings = minor_roundings(columns) + 2 * K + K + 10;
  V bound = hn::Set(f, roundings * double_double_roundoff * factorial(columns));
  for (const V& v : largest) bound = hn::Mul(bound, v);
  bound = hn::Add(bound, hn::Set(f, tiny));
  const V one = hn::Set(f, 1.0), none = hn::Zero(f);
  const V above = hn::IfThenElse(hn::Gt(value, bound), one, none);
  hn::StoreU(hn::IfThenElse(hn::Lt(value, hn::Neg(bound)), hn::Neg(one), above), f, signs);
}

template <unsigned K>
void sides_of_block(const double* corners, const double* p, double tiny, double* signs) {
  for (std::size_t lane = 0; lane < sides_block; lane += hn::Lanes(F()))
    sides_of_vector<K>(corners + lane, p, tiny, signs + lane);
}

}  // namespace

void sides_of_cells(unsigned k, const double* corners, const double* p, double tiny,
                    double* signs) {
  with_dimension<3, 5, 6>(
      k, [&](auto dimension) { sides_of_block<dimension()>(corners, p, tiny, signs); });
}

}  // namespace cullhull::internal::inline exact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal::inline exact {

HWY_EXPORT(sides_of_cells);

void lift_sides_double_double(unsigned k, const double* corners, const double* p, double tiny,
                              double* signs) {
  HWY_DYNAMIC_DISPATCH(sides_of_cells)(k, corners, p, tiny, signs);
}

}  // namespace cullhull::internal::inline exact
#endif
