// The arithmetic of FacetBlock, compiled once per instruction set and chosen at run time.

#include "result/facet_kernel.hpp"

#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "result/facet_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <bit>

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using Tag = hn::CappedTag<double, 8>;
using V = hn::Vec<Tag>;

/// As in cofactors.hpp, which says why and how.
template <unsigned K>
HWY_INLINE void normals(const V (&e)[K - 1][K], V (&n)[K]) {
  if constexpr (K == 3) {
    n[0] = hn::Sub(hn::Mul(e[0][1], e[1][2]), hn::Mul(e[0][2], e[1][1]));
    n[1] = hn::Sub(hn::Mul(e[0][2], e[1][0]), hn::Mul(e[0][0], e[1][2]));
    n[2] = hn::Sub(hn::Mul(e[0][0], e[1][1]), hn::Mul(e[0][1], e[1][0]));
  } else {
    constexpr unsigned full = (1U << K) - 1;
    V minor[full + 1];
    for (unsigned c = 0; c < K; ++c) minor[1U << c] = e[0][c];
    for (unsigned mask = 3; mask < full; ++mask) {
      const auto rows = static_cast<unsigned>(std::popcount(mask));
      if (rows < 2) continue;
      const V* row = e[rows - 1];
      V sum = hn::Zero(Tag());
      bool negative = (rows & 1U) == 0;
      for (unsigned rest = mask; rest != 0; rest &= rest - 1) {
        const auto c = static_cast<unsigned>(std::countr_zero(rest));
        const V term = hn::Mul(row[c], minor[mask & ~(1U << c)]);
        sum = negative ? hn::Sub(sum, term) : hn::Add(sum, term);
        negative = !negative;
      }
      minor[mask] = sum;
    }
    for (unsigned c = 0; c < K; ++c) {
      n[c] = minor[full & ~(1U << c)];
      if (((K - 1 + c) & 1U) != 0) n[c] = hn::Neg(n[c]);
    }
  }
}

template <unsigned K>
void block(FacetBlock<K>& b) {
  const Tag tag;
  for (unsigned lane = 0; lane < FacetBlock<K>::lanes;
       lane += static_cast<unsigned>(hn::Lanes(tag))) {
    const auto load = [&](const double* from) HWY_ATTR { return hn::Load(tag, from + lane); };
    V edge[K - 1][K];
    V lengths = hn::Set(tag, 1.0), reach = lengths;
    for (unsigned i = 1; i < K; ++i) {
      V square = hn::Zero(tag), largest = hn::Zero(tag);
      for (unsigned c = 0; c < K; ++c) {
        const V v = hn::Sub(load(b.corner[i][c]), load(b.corner[0][c]));
        edge[i - 1][c] = v;
        square = hn::Add(square, hn::Mul(v, v));
        largest = hn::Max(largest, hn::Abs(v));
      }
      lengths = hn::Mul(lengths, hn::Sqrt(square));
      reach = hn::Mul(reach, largest);
    }
    V n[K];
    normals<K>(edge, n);
    V square = hn::Zero(tag);
    for (unsigned c = 0; c < K; ++c) {
      square = hn::Add(square, hn::Mul(n[c], n[c]));
      hn::Store(n[c], tag, b.normal[c] + lane);
      V sum = hn::Zero(tag);
      const V origin = load(b.origin[c]);
      for (unsigned j = 0; j < K; ++j) sum = hn::Add(sum, hn::Sub(load(b.corner[j][c]), origin));
      hn::Store(sum, tag, b.sum[c] + lane);
    }
    hn::Store(hn::Sqrt(square), tag, b.length + lane);
    hn::Store(lengths, tag, b.edges + lane);
    hn::Store(reach, tag, b.reach + lane);
  }
}

}  // namespace

void block3(FacetBlock<3>& b) { block<3>(b); }
void block4(FacetBlock<4>& b) { block<4>(b); }
void block5(FacetBlock<5>& b) { block<5>(b); }
void block6(FacetBlock<6>& b) { block<6>(b); }
void block7(FacetBlock<7>& b) { block<7>(b); }
void block8(FacetBlock<8>& b) { block<8>(b); }

}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(block3);
HWY_EXPORT(block4);
HWY_EXPORT(block5);
HWY_EXPORT(block6);
HWY_EXPORT(block7);
HWY_EXPORT(block8);

template <>
void facet_block(FacetBlock<3>& b) {
  HWY_DYNAMIC_DISPATCH(block3)(b);
}
template <>
void facet_block(FacetBlock<4>& b) {
  HWY_DYNAMIC_DISPATCH(block4)(b);
}
template <>
void facet_block(FacetBlock<5>& b) {
  HWY_DYNAMIC_DISPATCH(block5)(b);
}
template <>
void facet_block(FacetBlock<6>& b) {
  HWY_DYNAMIC_DISPATCH(block6)(b);
}
template <>
void facet_block(FacetBlock<7>& b) {
  HWY_DYNAMIC_DISPATCH(block7)(b);
}
template <>
void facet_block(FacetBlock<8>& b) {
  HWY_DYNAMIC_DISPATCH(block8)(b);
}

}  // namespace cullhull::internal
#endif
