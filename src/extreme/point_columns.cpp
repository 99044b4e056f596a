// The scan over blocks of points, compiled once per instruction set.
//
// A box's bound is computed by the same operations, in the same order, as a point's value, from the
// box's corner that is least along the direction. Rounded products and sums are monotone, so the
// bound is at most every computed value of the block: skipping the block does not change the
// result.

#include "extreme/point_columns.hpp"

#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "extreme/point_columns.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <limits>

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<float, PointColumns::box_group>;

/// Returns direction . x of a vector of points; from(j) is the address of their coordinates j.
template <class From>
HWY_INLINE hn::Vec<F> along(const From& from, unsigned d, const float* direction) {
  const F f;
  hn::Vec<F> sum = hn::Mul(hn::LoadU(f, from(0)), hn::Set(f, direction[0]));
  for (unsigned j = 1; j < d; ++j)
    sum = hn::MulAdd(hn::LoadU(f, from(j)), hn::Set(f, direction[j]), sum);
  return sum;
}

void least_in_block(const float* columns, unsigned d, const float* direction, std::uint32_t first,
                    std::uint32_t except, float* best, std::uint32_t* best_slot) {
  const F f;
  const std::size_t lanes = hn::Lanes(f);
  HWY_ALIGN float values[hn::MaxLanes(F())];
  for (std::size_t at = 0; at < PointColumns::block; at += lanes) {
    const auto sum =
        along([&](unsigned j) { return columns + j * PointColumns::block + at; }, d, direction);
    if (hn::AllFalse(f, hn::Lt(sum, hn::Set(f, *best)))) continue;
    hn::Store(sum, f, values);
    for (std::size_t k = 0; k < lanes; ++k) {
      const auto slot = static_cast<std::uint32_t>(first + at + k);
      if (values[k] < *best && slot != except) {
        *best = values[k];
        *best_slot = slot;
      }
    }
  }
}

void least_in_columns(const float* columns, const float* low, const float* high, std::size_t blocks,
                      unsigned d, const float* direction, std::uint32_t except, float* best,
                      std::uint32_t* best_slot) {
  constexpr std::size_t group = PointColumns::box_group, block = PointColumns::block;
  const F f;
  const std::size_t lanes = hn::Lanes(f);
  HWY_ALIGN float bounds[hn::MaxLanes(F())];
  for (std::size_t first = 0; first < blocks; first += lanes) {
    const std::size_t base = first / group * d * group + first % group;
    const auto bound =
        along([&](unsigned j) { return (direction[j] < 0 ? high : low) + base + j * group; }, d,
              direction);
    if (hn::AllFalse(f, hn::Lt(bound, hn::Set(f, *best)))) continue;
    hn::Store(bound, f, bounds);
    for (std::size_t k = 0; k < lanes; ++k) {
      const std::size_t b = first + k;
      if (b < blocks && bounds[k] < *best)
        least_in_block(columns + b * d * block, d, direction, static_cast<std::uint32_t>(b * block),
                       except, best, best_slot);
    }
  }
}

}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(least_in_columns);

PointColumns::PointColumns(const LocalPoints& points)
    : points_(points), slot_(points.count, no_index) {}

PointColumns::PointColumns(const LocalPoints& points, const std::vector<std::uint32_t>& ids,
                           const Control& control)
    : PointColumns(points) {
  for (const std::uint32_t i : ids) {
    if (ids_.size() % 65536 == 0) control.check();
    add(i);
  }
}

void PointColumns::add(std::uint32_t id) {
  const unsigned d = points_.dimension;
  constexpr float nan = std::numeric_limits<float>::quiet_NaN();
  const std::size_t slot = ids_.size(), b = slot / block, g = b / box_group;
  slot_[id] = static_cast<std::uint32_t>(slot);
  ids_.push_back(id);
  if (slot % block == 0) columns_.resize((b + 1) * d * block, nan);
  if (slot % (block * box_group) == 0) {
    low_.resize((g + 1) * d * box_group, nan);
    high_.resize((g + 1) * d * box_group, nan);
  }
  const double* x = points_.row(id);
  for (unsigned j = 0; j < d; ++j) {
    const auto v = static_cast<float>(x[j]);
    columns_[(b * d + j) * block + slot % block] = v;
    float& low = low_[(g * d + j) * box_group + b % box_group];
    float& high = high_[(g * d + j) * box_group + b % box_group];
    low = slot % block == 0 ? v : std::min(low, v);
    high = slot % block == 0 ? v : std::max(high, v);
  }
}

PointColumns::Least PointColumns::least(const float* direction, std::uint32_t except,
                                        std::size_t count) const {
  Least result;
  std::uint32_t slot = no_index;
  result.value = std::numeric_limits<float>::infinity();
  HWY_DYNAMIC_DISPATCH(least_in_columns)
  (columns_.data(), low_.data(), high_.data(), (std::min(ids_.size(), count) + block - 1) / block,
   points_.dimension, direction, slot_[except], &result.value, &slot);
  if (slot != no_index) result.id = ids_[slot];
  return result;
}

}  // namespace cullhull::internal
#endif  // HWY_ONCE
