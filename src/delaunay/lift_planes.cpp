// Planes of lifted cells, one cell per vector lane; compiled once per instruction set.
#include "delaunay/lift_planes.hpp"

#include <array>
#include <bit>
#include <cstdint>

#include "exact/insphere/lift_filter.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "delaunay/lift_planes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::inline delaunay::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using F = hn::CappedTag<double, lift_block>;
using V = hn::Vec<F>;

/// Computes the planes of one vector of cells. `m`, `out`: the data of the first cell.
template <unsigned K>
HWY_INLINE void planes_of_vector(double* m, double* out) {
  const F f;
  constexpr unsigned columns = K + 1, full = 1U << columns;
  const auto entry = [&](unsigned i, unsigned j) { return m + (i * columns + j) * lift_block; };
  V largest[columns];
  for (V& v : largest) v = hn::Zero(f);
  for (unsigned i = 0; i < K; ++i) {
    V lift = hn::Zero(f);
    for (unsigned j = 0; j < K; ++j) {
      const V v = hn::LoadU(f, entry(i, j));
      largest[j] = hn::Max(largest[j], hn::Abs(v));
      lift = hn::Add(lift, hn::Mul(v, v));
    }
    largest[K] = hn::Max(largest[K], lift);
    hn::StoreU(lift, f, entry(i, K));
  }
  // det[mask]: the minor of the first rows on the columns of a mask, expanded along its last row
  // (as in expand_minors).
  V det[full];
  for (unsigned mask = 1; mask < full; ++mask) {
    const auto size = static_cast<unsigned>(std::popcount(mask));
    if (size > K) continue;
    if (size == 1) {
      det[mask] = hn::LoadU(f, entry(0, static_cast<unsigned>(std::countr_zero(mask))));
      continue;
    }
    V sum = hn::Zero(f);
    bool negative = size % 2 == 0;
    for (unsigned rest = mask; rest != 0; rest &= rest - 1) {
      const auto j = static_cast<unsigned>(std::countr_zero(rest));
      const V term = hn::Mul(hn::LoadU(f, entry(size - 1, j)), det[mask ^ (1U << j)]);
      sum = negative ? hn::Sub(sum, term) : hn::Add(sum, term);
      negative = !negative;
    }
    det[mask] = sum;
  }
  // The cofactors of the last of K + 1 rows.
  for (unsigned j = 0; j < columns; ++j) {
    const V d = det[(full - 1) ^ (1U << j)];
    hn::StoreU((K + j) % 2 == 0 ? d : hn::Neg(d), f, out + j * lift_block);
  }
  constexpr double roundings = minor_roundings(K + 1) + 2 * K + K + 18;
  constexpr double factor = roundings * unit_roundoff * factorial(K);
  V linear = hn::Zero(f);
  for (unsigned left = 0; left < columns; ++left) {
    V product = hn::Set(f, left < K ? factor : factor * K);
    for (unsigned j = 0; j < columns; ++j)
      if (j != left) product = hn::Mul(product, largest[j]);
    if (left < K)
      linear = hn::Add(linear, product);
    else
      hn::StoreU(product, f, out + (K + 2) * lift_block);
  }
  hn::StoreU(linear, f, out + (K + 1) * lift_block);
}

template <unsigned K>
void planes_of_block(double* rows, double* planes) {
  for (std::size_t lane = 0; lane < lift_block; lane += hn::Lanes(F()))
    planes_of_vector<K>(rows + lane, planes + lane);
}

}  // namespace

void planes_of_cells(unsigned k, double* rows, double* planes) {
  with_dimension<3, 5, 6>(k, [&](auto dimension) { planes_of_block<dimension()>(rows, planes); });
}

}  // namespace cullhull::internal::inline delaunay::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal::inline delaunay {

HWY_EXPORT(planes_of_cells);

void lift_planes(unsigned k, double* rows, double* planes) {
  HWY_DYNAMIC_DISPATCH(planes_of_cells)(k, rows, planes);
}

}  // namespace cullhull::internal::inline delaunay
#endif
