#include "few/whole_range.hpp"

#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "few/whole_range.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::inline few::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Adding and subtracting it rounds to whole numbers below 2^51 in magnitude.
constexpr double rounder = 0x1.8p52;

void range_of(const double* rows, std::uint32_t count, WholeRange& range) {
  const hn::CappedTag<double, 8> tag;
  using V = hn::Vec<decltype(tag)>;
  const std::size_t lanes = hn::Lanes(tag), values = 2 * std::size_t{count};
  double low[2] = {rows[0], rows[1]}, high[2] = {rows[0], rows[1]}, off[2] = {}, zero = 0;
  std::size_t i = 0;
  if (lanes >= 2 && values >= lanes) {  // even lanes have x, odd lanes y
    const V round = hn::Set(tag, rounder);
    V least = hn::LoadU(tag, rows), most = least, rest = hn::Zero(tag), none = hn::Zero(tag);
    for (; i + lanes <= values; i += lanes) {
      const V v = hn::LoadU(tag, rows + i);
      least = hn::Min(least, v);
      most = hn::Max(most, v);
      rest = hn::Max(rest, hn::Abs(hn::Sub(v, hn::Sub(hn::Add(v, round), round))));
      none = hn::Add(none, hn::Mul(v, hn::Zero(tag)));  // NaN for NaN and infinities
    }
    alignas(64) double lows[8], highs[8], rests[8], nones[8];
    hn::Store(least, tag, lows);
    hn::Store(most, tag, highs);
    hn::Store(rest, tag, rests);
    hn::Store(none, tag, nones);
    for (std::size_t j = 0; j < lanes; ++j) {
      low[j % 2] = std::min(low[j % 2], lows[j]);
      high[j % 2] = std::max(high[j % 2], highs[j]);
      off[j % 2] = std::max(off[j % 2], rests[j]);
      zero += nones[j];
    }
  }
  for (; i < values; ++i) {
    const double v = rows[i];
    low[i % 2] = std::min(low[i % 2], v);
    high[i % 2] = std::max(high[i % 2], v);
    off[i % 2] = std::max(off[i % 2], std::abs(v - ((v + rounder) - rounder)));
    zero += v * 0.0;
  }
  range.finite = zero == 0;
  for (unsigned a = 0; a < 2; ++a) {
    range.low[a] = low[a];
    range.high[a] = high[a];
    range.whole[a] = off[a] == 0 && low[a] > -0x1p50 && high[a] < 0x1p50;
  }
}

}  // namespace
}  // namespace cullhull::internal::inline few::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal::inline few {

HWY_EXPORT(range_of);

WholeRange whole_range(const double* rows, std::uint32_t count) {
  WholeRange range;
  HWY_DYNAMIC_DISPATCH(range_of)(rows, count, range);
  return range;
}

}  // namespace cullhull::internal::inline few
#endif
