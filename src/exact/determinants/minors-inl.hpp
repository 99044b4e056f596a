// expand_minors() for numbers in lanes. Included once for each instruction set, hence Highway's
// unusual include guard.

#if defined(CULLHULL_MINORS_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CULLHULL_MINORS_INL
#undef CULLHULL_MINORS_INL
#else
#define CULLHULL_MINORS_INL
#endif

#include <hwy/highway.h>

#include <bit>
#include <type_traits>

#include "exact/numbers/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

/// sum + a b, or sum - a b if `minus`; in one operation where there is a fused one.
template <bool minus>
HWY_INLINE Lanes add_product(const Lanes& sum, const Lanes& a, const Lanes& b) {
  return minus ? hn::NegMulAdd(a.v, b.v, sum.v) : hn::MulAdd(a.v, b.v, sum.v);
}

/// Adds the products of a minor's last row with the minors of the other rows, from column j on.
template <unsigned mask, unsigned j, unsigned columns>
HWY_INLINE Lanes minor_from(const Lanes* row, const Lanes* det, const Lanes& sum) {
  if constexpr (j == columns) {
    return sum;
  } else if constexpr ((mask >> j & 1U) == 0) {
    return minor_from<mask, j + 1, columns>(row, det, sum);
  } else {
    constexpr unsigned before = mask & ((1U << j) - 1);
    constexpr bool minus = (std::popcount(mask) - 1 + std::popcount(before)) % 2 == 1;
    const Lanes& minor = det[mask ^ (1U << j)];
    Lanes more;
    if constexpr (before == 0)
      more = minus ? -(row[j] * minor) : row[j] * minor;
    else
      more = add_product<minus>(sum, row[j], minor);
    return minor_from<mask, j + 1, columns>(row, det, more);
  }
}
template <unsigned end, unsigned columns, unsigned mask>
HWY_INLINE void minors_from(const Lanes (*m)[columns], Lanes* det) {
  if constexpr (mask < end) {
    constexpr auto size = static_cast<unsigned>(std::popcount(mask));
    if constexpr (size == 1)
      det[mask] = m[0][std::countr_zero(mask)];
    else
      det[mask] = minor_from<mask, 0, columns>(m[size - 1], det, 0.0);
    minors_from<end, columns, mask + 1>(m, det);
  }
}

/// Computes the minors with the masks [1, end), for rows of `columns` entries: det[mask] is the
/// determinant of the first rows on the columns of the mask. Of plain doubles, up to five columns,
/// everything is unrolled: an expansion whose loops choose columns at run time takes four times as
/// long. Double-doubles gain little, and compilers take minutes for them with sanitizers.
template <unsigned end, unsigned columns, class T>
HWY_INLINE void minors_of_lanes(const T (*m)[columns], T* det) {
  if constexpr (columns <= 5 && std::is_same_v<T, Lanes>) {
    minors_from<end, columns, 1>(m, det);
  } else {
    for (unsigned mask = 1; mask < end; ++mask) {
      const auto size = static_cast<unsigned>(std::popcount(mask));
      const T* const row = m[size - 1];
      if (size == 1) {
        det[mask] = row[std::countr_zero(mask)];
        continue;
      }
      T sum;
      bool minus = size % 2 == 0;
      for (unsigned rest = mask; rest != 0; rest &= rest - 1) {
        const auto j = static_cast<unsigned>(std::countr_zero(rest));
        T term = row[j] * det[mask ^ (1U << j)];
        if (minus) term = -term;
        sum = rest == mask ? term : sum + term;
        minus = !minus;
      }
      det[mask] = sum;
    }
  }
}

}  // namespace
}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CULLHULL_MINORS_INL
