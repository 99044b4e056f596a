#include "certify/hull/inner_ball.hpp"

#include "geometry/gather.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "certify/hull/inner_ball.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <bit>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::certify::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<double, 8>;
using V = hn::Vec<Tag>;

/// Loads vectors of coordinates from rows of K numbers.
template <unsigned K>
void load_rows(const double* at, V (&x)[K]) {
  const Tag tag;
  if constexpr (K > 4) {
    double column[hn::MaxLanes(Tag())];
    for (unsigned j = 0; j < K; ++j) {
      for (std::size_t lane = 0; lane < hn::Lanes(tag); ++lane) column[lane] = at[lane * K + j];
      x[j] = hn::LoadU(tag, column);
    }
  }
  if constexpr (K == 2) hn::LoadInterleaved2(tag, at, x[0], x[1]);
  if constexpr (K == 3) hn::LoadInterleaved3(tag, at, x[0], x[1], x[2]);
  if constexpr (K == 4) hn::LoadInterleaved4(tag, at, x[0], x[1], x[2], x[3]);
}

template <unsigned K>
void load_rows(const float* at, V (&x)[K]) {
  const Tag tag;
  const hn::Rebind<float, Tag> half;
  hn::Vec<decltype(half)> v[K];
  if constexpr (K == 2) hn::LoadInterleaved2(half, at, v[0], v[1]);
  if constexpr (K == 3) hn::LoadInterleaved3(half, at, v[0], v[1], v[2]);
  if constexpr (K == 4) hn::LoadInterleaved4(half, at, v[0], v[1], v[2], v[3]);
  for (unsigned j = 0; j < K; ++j) x[j] = hn::PromoteTo(tag, v[j]);
}

/// Appends the positions (from `first` on) of lanes whose point is not in the ball.
template <unsigned K>
HWY_INLINE std::uint32_t append_outside(const InnerBall::Test& test, const V (&x)[K],
                                        std::uint32_t first, std::uint16_t* out,
                                        std::uint32_t kept) {
  const Tag tag;
  V square = hn::Zero(tag);
  for (unsigned j = 0; j < K; ++j) {
    const V y = hn::Mul(hn::Sub(x[j], hn::Set(tag, test.centre[j])), hn::Set(tag, test.scale[j]));
    square = hn::MulAdd(y, y, square);
  }
  std::uint8_t bits[8] = {};
  hn::StoreMaskBits(tag, hn::Lt(square, hn::Set(tag, test.square)), bits);
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(tag));
  for (unsigned left = ~unsigned{bits[0]} & ((1U << lanes) - 1); left != 0; left &= left - 1)
    out[kept++] = static_cast<std::uint16_t>(first + static_cast<unsigned>(std::countr_zero(left)));
  return kept;
}

template <unsigned K, class T>
std::uint32_t rows_outside(const InnerBall::Test& test, const T* rows, std::uint32_t count,
                           std::uint16_t* out) {
  const auto lanes = static_cast<std::uint32_t>(hn::Lanes(Tag()));
  std::uint32_t kept = 0, i = 0;
  V x[K];
  for (; i + lanes <= count; i += lanes) {
    load_rows<K>(rows + std::size_t{i} * K, x);
    kept = append_outside<K>(test, x, i, out, kept);
  }
  for (; i < count; ++i) out[kept++] = static_cast<std::uint16_t>(i);  // less than a vector
  return kept;
}

template <unsigned K>
std::uint32_t outside_in(const InnerBall::Test& test, const PointView& points, std::uint64_t begin,
                         std::uint32_t count, std::uint16_t* out) {
  if (const double* const rows = packed_doubles(points))
    return rows_outside<K>(test, rows + begin * K, count, out);
  if constexpr (K <= 4) {
    // Vectors can be loaded from any address, but a typed pointer must be aligned.
    const std::byte* at = points.address(begin, 0);
    if (points.packed_rows() && points.scalar == ScalarType::f32 &&
        reinterpret_cast<std::uintptr_t>(at) % sizeof(float) == 0)
      return rows_outside<K>(test, reinterpret_cast<const float*>(at), count, out);
  }
  double rows[K * InnerBall::block];
  load_rows_as_given(points, begin, begin + count, rows);
  return rows_outside<K>(test, rows, count, out);
}

std::uint32_t outside(const InnerBall::Test& test, const PointView& points, std::uint64_t begin,
                      std::uint32_t count, std::uint16_t* out) {
  return with_dimension<2, 5, 6>(
      test.dimension, [&](auto k) { return outside_in<k>(test, points, begin, count, out); });
}

}  // namespace
}  // namespace cullhull::internal::certify::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal::certify {

HWY_EXPORT(outside);

InnerBall::InnerBall(const std::vector<double>& centre, const std::vector<double>& scale,
                     double square) {
  if (centre.size() < 2 || centre.size() > max_dimension) return;
  test_.dimension = static_cast<unsigned>(centre.size());
  test_.square = square;
  for (unsigned j = 0; j < test_.dimension; ++j) {
    test_.centre[j] = centre[j];
    test_.scale[j] = scale[j];
  }
}

std::uint32_t InnerBall::outside(const PointView& points, std::uint64_t begin, std::uint32_t count,
                                 std::uint16_t* out) const {
  return HWY_DYNAMIC_DISPATCH(outside)(test_, points, begin, count, out);
}

}  // namespace cullhull::internal::certify
#endif
