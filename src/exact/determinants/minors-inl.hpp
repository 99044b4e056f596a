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

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::inline exact::HWY_NAMESPACE {
namespace {

/// Computes the minors with the masks [1, end), for rows of `columns` entries: det[mask] is the
/// determinant of the first rows on the columns of the mask.
template <unsigned end, unsigned columns, class T>
HWY_INLINE void minors_of_lanes(const T (*m)[columns], T* det) {
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

}  // namespace
}  // namespace cullhull::internal::inline exact::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif  // CULLHULL_MINORS_INL
