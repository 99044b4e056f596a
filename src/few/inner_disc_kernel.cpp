#include "few/small_hull.hpp"
#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "few/inner_disc_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <bit>

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

/// The operations of InnerDisc::contains, in the same order.
std::uint32_t rows_outside(const InnerDisc::Test& test, const double* rows, std::uint32_t count,
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

std::uint32_t InnerDisc::outside(const double* rows, std::uint32_t count,
                                 std::uint32_t* out) const {
  return HWY_DYNAMIC_DISPATCH(rows_outside)(test_, rows, count, out);
}

}  // namespace cullhull::internal
#endif
