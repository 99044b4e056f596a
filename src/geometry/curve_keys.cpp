// Hilbert keys, a point per vector lane; compiled once per instruction set.
#include "geometry/curve_frame.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "geometry/curve_keys.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using U = hn::CappedTag<std::uint32_t, curve_block>;
using V = hn::Vec<U>;

/// Returns a lane mask: all ones where one of the bits is set.
HWY_INLINE V where(V x, V bits) {
  return hn::VecFromMask(U(), hn::Ne(hn::And(x, bits), hn::Zero(U())));
}

/// D: the dimension if known at compile time, so that coordinates stay in registers, else 0.
template <unsigned D>
void keys_of_vector(unsigned dimension, unsigned bits, std::uint32_t* cells, std::uint32_t* keys) {
  const U u;
  const unsigned d = D ? D : dimension;
  V c[D ? D : 32];
  for (unsigned j = 0; j < d; ++j) c[j] = hn::LoadU(u, cells + j * curve_block);
  for (std::uint32_t q = 1U << (bits - 1); q > 1; q >>= 1) {
    const V bit = hn::Set(u, q), lower = hn::Set(u, q - 1);
    for (unsigned j = 0; j < d; ++j) {
      // Inverts low bits of c[0] where the bit is set, else exchanges those of c[0] and c[j].
      const V set = where(c[j], bit);
      const V t = hn::AndNot(set, hn::And(hn::Xor(c[0], c[j]), lower));
      c[0] = hn::Xor(c[0], hn::Or(t, hn::And(lower, set)));
      c[j] = hn::Xor(c[j], t);
    }
  }
  for (unsigned j = 1; j < d; ++j) c[j] = hn::Xor(c[j], c[j - 1]);
  V t = hn::Zero(u);
  for (std::uint32_t q = 1U << (bits - 1); q > 1; q >>= 1)
    t = hn::Xor(t, hn::And(hn::Set(u, q - 1), where(c[d - 1], hn::Set(u, q))));
  for (unsigned j = 0; j < d; ++j) c[j] = hn::Xor(c[j], t);
  V key = hn::Zero(u);
  const V one = hn::Set(u, 1);
  for (unsigned b = bits; b-- > 0;)
    for (unsigned j = 0; j < d; ++j)
      key = hn::Or(hn::Add(key, key), hn::And(hn::ShiftRightSame(c[j], static_cast<int>(b)), one));
  hn::StoreU(key, u, keys);
}

template <unsigned D>
void keys_of_block(unsigned d, unsigned bits, std::uint32_t* cells, std::uint32_t* keys) {
  for (std::size_t k = 0; k < curve_block; k += hn::Lanes(U()))
    keys_of_vector<D>(d, bits, cells + k, keys + k);
}

}  // namespace

void keys_on_curve(unsigned d, unsigned bits, std::uint32_t* cells, std::uint32_t* keys) {
  with_dimension<4, 6, 0>(d, [&](auto k) { keys_of_block<k>(d, bits, cells, keys); });
}

}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(keys_on_curve);

void curve_keys(unsigned d, unsigned bits, std::uint32_t* cells, std::uint32_t* keys) {
  HWY_DYNAMIC_DISPATCH(keys_on_curve)(d, bits, cells, keys);
}

}  // namespace cullhull::internal
#endif
