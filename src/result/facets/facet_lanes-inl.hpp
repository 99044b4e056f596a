// The arithmetic of a vector of facets at a time: compiles facet_math-inl.hpp for vectors instead
// of doubles. It is included once for each instruction set, hence Highway's unusual include guard.

#if defined(CULLHULL_FACET_LANES_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef CULLHULL_FACET_LANES_INL
#undef CULLHULL_FACET_LANES_INL
#else
#define CULLHULL_FACET_LANES_INL
#endif

#include <hwy/highway.h>

#include <bit>
#include <cstddef>
#include <cstdint>

#include "exact/numbers/lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

/// The mask as bits, lane 0 in the lowest.
HWY_INLINE unsigned bits_of(M mask) {
  std::uint8_t bytes[8] = {};
  hn::StoreMaskBits(D(), mask, bytes);
  return bytes[0];
}

#define CULLHULL_MATH HWY_INLINE
#include "exact/determinants/cofactors-inl.hpp"
#include "result/facets/facet_math-inl.hpp"
#undef CULLHULL_MATH

/// Loads a row of four doubles for each lane and ignores the fourth numbers.
HWY_INLINE void load_rows(const double* rows, Lanes (&v)[3]) {
  V unused;
  hn::LoadInterleaved4(D(), rows, v[0].v, v[1].v, v[2].v, unused);
}
HWY_INLINE void store_rows(const Lanes (&v)[3], Lanes fourth, double* rows) {
  hn::StoreInterleaved4(v[0].v, v[1].v, v[2].v, fourth.v, D(), rows);
}

/// Writes the shares of a vector of triangles from index i on, and their planes to planes[4 i ...),
/// with offsets multiplied by `unit`. The bits are those of facet_share for well-conditioned
/// normals.
template <class Shares>
HWY_INLINE void write_shares(const Lanes (&normal)[3], Lanes length, const Lanes (&corner)[3],
                             const Lanes (&origin)[3], const Lanes (&sum)[3], double unit,
                             unsigned i, Shares& shares, double* planes) {
  const FacetMoments<3, Lanes> moments = moments_of<3>(normal, corner, origin, sum);
  store(moments.volume, shares.volume + i);
  for (unsigned c = 0; c < 3; ++c) store(moments.moment[c], shares.moment[c] + i);
  store(length, shares.area + i);
  store(length, shares.area_error + i);
  store(length * moments.reach, shares.error + i);
  Lanes plane[4];
  plane_of<3>(normal, length, corner, plane);
  hn::StoreInterleaved4(plane[0].v, plane[1].v, plane[2].v, (plane[3] * unit).v, D(),
                        planes + std::size_t{4} * i);
}

}  // namespace
}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#endif
