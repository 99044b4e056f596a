#include "filter/lattice/whole_range.hpp"

#include "geometry/gather.hpp"
#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/lattice/whole_range.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cmath>

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// Adding and subtracting it rounds to whole numbers below 2^51 in magnitude.
constexpr double rounder = 0x1.8p52;

template <unsigned D>
void range_of_rows(const double* rows, std::uint32_t count, WholeRange& range) {
  const hn::CappedTag<double, 8> tag;
  using V = hn::Vec<decltype(tag)>;
  const std::size_t lanes = hn::Lanes(tag), values = D * std::size_t{count};
  double off[D] = {}, zero = 0;
  for (unsigned a = 0; a < D; ++a) range.low[a] = range.high[a] = rows[a];
  std::size_t i = 0;
  if (values >= D * lanes) {  // the lanes of D vectors in turn have a whole number of rows
    const V round = hn::Set(tag, rounder);
    V none = hn::Zero(tag), least[D], most[D], rest[D];
    for (unsigned k = 0; k < D; ++k) {
      least[k] = most[k] = hn::LoadU(tag, rows + k * lanes);
      rest[k] = hn::Zero(tag);
    }
    for (; i + D * lanes <= values; i += D * lanes)
      for (unsigned k = 0; k < D; ++k) {
        const V v = hn::LoadU(tag, rows + i + k * lanes);
        least[k] = hn::Min(least[k], v);
        most[k] = hn::Max(most[k], v);
        rest[k] = hn::Max(rest[k], hn::Abs(hn::Sub(v, hn::Sub(hn::Add(v, round), round))));
        none = hn::Add(none, hn::Mul(v, hn::Zero(tag)));  // NaN for NaN and infinities
      }
    alignas(64) double out[8];
    const auto reduce = [&](const V& v, unsigned k, auto&& add) {
      hn::Store(v, tag, out);
      for (std::size_t j = 0; j < lanes; ++j) add((k * lanes + j) % D, out[j]);
    };
    for (unsigned k = 0; k < D; ++k) {
      reduce(least[k], k,
             [&](std::size_t a, double v) { range.low[a] = std::min(range.low[a], v); });
      reduce(most[k], k,
             [&](std::size_t a, double v) { range.high[a] = std::max(range.high[a], v); });
      reduce(rest[k], k, [&](std::size_t a, double v) { off[a] = std::max(off[a], v); });
    }
    reduce(none, 0, [&](std::size_t, double v) { zero += v; });
  }
  for (; i < values; ++i) {
    const double v = rows[i];
    const std::size_t a = i % D;
    range.low[a] = std::min(range.low[a], v);
    range.high[a] = std::max(range.high[a], v);
    off[a] = std::max(off[a], std::abs(v - ((v + rounder) - rounder)));
    zero += v * 0.0;
  }
  range.finite = zero == 0;
  for (unsigned a = 0; a < D; ++a)
    range.whole[a] = off[a] == 0 && range.low[a] > -0x1p50 && range.high[a] < 0x1p50;
}

void range_of(const double* rows, std::uint32_t count, unsigned d, WholeRange& range) {
  if (d == 2)
    range_of_rows<2>(rows, count, range);
  else
    range_of_rows<3>(rows, count, range);
}

}  // namespace
}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(range_of);

WholeRange whole_range(const double* rows, std::uint32_t count, unsigned d) {
  WholeRange range;
  HWY_DYNAMIC_DISPATCH(range_of)(rows, count, d, range);
  return range;
}

WholeRange whole_range(const PointView& points, std::uint64_t count) {
  WholeRange all{};
  for_row_blocks(points, count, [&](std::uint64_t first, const double* rows, std::uint32_t n) {
    const WholeRange part = whole_range(rows, n, points.dimension);
    if (first == 0) all = part;
    all.finite &= part.finite;
    for (unsigned a = 0; a < points.dimension; ++a) {
      all.low[a] = std::min(all.low[a], part.low[a]);
      all.high[a] = std::max(all.high[a], part.high[a]);
      all.whole[a] &= part.whole[a];
    }
  });
  return all;
}

}  // namespace cullhull::internal
#endif
