// Tests of points against all planes of a small hull, compiled once per instruction set.
#include "hull/general/facet_planes.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hull/general/facet_sieve.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, 16>;
using V = hn::Vec<F>;

/// Tests two vectors of points. A point's largest n . y - level over all facets decides; rounding
/// cannot change the sign of a difference.
template <unsigned D>
void two_vectors(const float* planes, std::size_t count, const float* y, std::uint8_t* beneath) {
  const F f;
  const std::size_t lanes = hn::Lanes(f);
  V a[D], b[D];
  for (unsigned j = 0; j < D; ++j) {
    a[j] = hn::LoadU(f, y + j * sieve_block);
    b[j] = hn::LoadU(f, y + j * sieve_block + lanes);
  }
  // Every 64 facets: stop if no point of the two vectors is beneath all facets so far.
  constexpr std::size_t at_once = 64;
  V highest_a = hn::Set(f, -1.0F), highest_b = highest_a;
  for (std::size_t first = 0; first < count; first += at_once) {
    for (std::size_t i = first; i < std::min(count, first + at_once); ++i) {
      const float* n = planes + i * (D + 1);
      V normal = hn::Set(f, n[0]);
      V sum_a = hn::Mul(normal, a[0]), sum_b = hn::Mul(normal, b[0]);
      for (unsigned j = 1; j < D; ++j) {
        normal = hn::Set(f, n[j]);
        sum_a = hn::MulAdd(normal, a[j], sum_a);
        sum_b = hn::MulAdd(normal, b[j], sum_b);
      }
      const V level = hn::Set(f, n[D]);
      highest_a = hn::Max(highest_a, hn::Sub(sum_a, level));
      highest_b = hn::Max(highest_b, hn::Sub(sum_b, level));
    }
    if (hn::AllFalse(f, hn::Lt(hn::Min(highest_a, highest_b), hn::Zero(f)))) break;
  }
  HWY_ALIGN float out[2 * hn::MaxLanes(F())];
  hn::Store(highest_a, f, out);
  hn::Store(highest_b, f, out + lanes);
  for (std::size_t k = 0; k < 2 * lanes; ++k) beneath[k] = out[k] < 0 ? 1 : 0;
}

template <unsigned D>
void block(const float* planes, std::size_t count, const float* y, std::uint8_t* beneath) {
  const std::size_t step = 2 * hn::Lanes(F());
  for (std::size_t k = 0; k < sieve_block; k += step)
    two_vectors<D>(planes, count, y + k, beneath + k);
}

/// Stores the lanes of a mask as bits k, k + 1, ... of `bytes`, from the lowest k on. StoreMaskBits
/// may write up to 8 bytes (seen_room). These targets have vectors of one size: MaxLanes.
HWY_INLINE void store_bits(hn::Mask<F> mask, std::size_t k, std::uint8_t* bytes) {
  if constexpr (hn::MaxLanes(F()) >= 8) {
    hn::StoreMaskBits(F(), mask, bytes + k / 8);
  } else {
    std::uint8_t bits[8];
    hn::StoreMaskBits(F(), mask, bits);
    bytes[k / 8] = static_cast<std::uint8_t>((k % 8 == 0 ? 0 : bytes[k / 8]) | bits[0] << k % 8);
  }
}

template <unsigned D>
bool seen_in(const float* groups, std::size_t count, const float* point, std::uint8_t* seen,
             std::uint8_t* open) {
  using Group = PlaneGroup<D>;
  const F f;
  V y[D];
  for (unsigned j = 0; j < D; ++j) y[j] = hn::Set(f, point[j]);
  const V one = hn::Set(f, 1.0F);
  V lowest = one;  // of the differences from beneath: below 0 if nothing is doubtful
  for (std::size_t g = 0; g < count; ++g) {
    const float* const planes = groups + g * (D + 1) * Group::size;
    for (std::size_t k = 0; k < Group::size; k += hn::Lanes(f)) {
      V gauge = hn::Mul(hn::Load(f, planes + k), y[0]);
      for (unsigned j = 1; j < D; ++j)
        gauge = hn::MulAdd(hn::Load(f, planes + j * Group::size + k), y[j], gauge);
      const V error = hn::Load(f, planes + D * Group::size + k);
      // Rounding cannot change the sign of a difference.
      const V below = hn::Sub(hn::Sub(one, error), gauge);
      lowest = hn::Min(lowest, below);
      store_bits(hn::Gt(gauge, hn::Add(one, error)), k, seen + 2 * g);
      store_bits(hn::Not(hn::Gt(below, hn::Zero(f))), k, open + 2 * g);
    }
  }
  return !hn::AllTrue(f, hn::Gt(lowest, hn::Zero(f)));
}

}  // namespace

bool seen(unsigned d, const float* groups, std::size_t count, const float* y, std::uint8_t* seen,
          std::uint8_t* open) {
  return with_dimension<4, 7, 8>(d,
                                 [&](auto k) { return seen_in<k>(groups, count, y, seen, open); });
}

void beneath(unsigned d, const float* planes, std::size_t count, const float* y,
             std::uint8_t* beneath) {
  with_dimension<4, 7, 8>(d, [&](auto k) { block<k>(planes, count, y, beneath); });
}

}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(beneath);
HWY_EXPORT(seen);

void beneath_facets(unsigned d, const float* planes, std::size_t count, const float* y,
                    std::uint8_t* beneath) {
  HWY_DYNAMIC_DISPATCH(beneath)(d, planes, count, y, beneath);
}

bool seen_facets(unsigned d, const float* groups, std::size_t count, const float* y,
                 std::uint8_t* seen_bits, std::uint8_t* open) {
  return HWY_DYNAMIC_DISPATCH(seen)(d, groups, count, y, seen_bits, open);
}

}  // namespace cullhull::internal
#endif
