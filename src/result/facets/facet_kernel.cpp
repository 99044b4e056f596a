// The arithmetic of FacetBlock. It is compiled for several instruction sets, of which one is chosen
// at run time.

#include "parallel/simd_targets.hpp"
#include "result/facets/facet_plane.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "result/facets/facet_kernel.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include "result/facets/facet_lanes-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

template <unsigned K>
void block(FacetBlock<K>& b) {
  for (unsigned lane = 0; lane < FacetBlock<K>::lanes; lane += lane_count()) {
    Lanes corner[K][K], origin[K], edge[K - 1][K], normal[K], sum[K];
    for (unsigned c = 0; c < K; ++c) {
      origin[c] = load(b.origin[c] + lane);
      for (unsigned j = 0; j < K; ++j) corner[j][c] = load(b.corner[j][c] + lane);
    }
    edges_of<K>(corner, edge);
    Lanes lengths = 1, reach = 1;
    for (const Lanes(&e)[K] : edge) {
      lengths = lengths * root(square_of<K>(e));
      reach = reach * largest_of<K>(e);
    }
    cofactors<K>(edge, normal);
    sum_of_corners<K>(corner, origin, sum);
    for (unsigned c = 0; c < K; ++c) {
      store(normal[c], b.normal[c] + lane);
      store(sum[c], b.sum[c] + lane);
    }
    store(root(square_of<K>(normal)), b.length + lane);
    store(lengths, b.edges + lane);
    store(reach, b.reach + lane);
  }
}

template <unsigned K>
void shares(FacetBlock<K>& b) {
  for (unsigned lane = 0; lane < FacetBlock<K>::lanes; lane += lane_count()) {
    Lanes corner[K], origin[K], normal[K], sum[K], plane[K + 1];
    for (unsigned c = 0; c < K; ++c) {
      corner[c] = load(b.corner[0][c] + lane);
      origin[c] = load(b.origin[c] + lane);
      normal[c] = load(b.normal[c] + lane);
      sum[c] = load(b.sum[c] + lane);
    }
    store(largest_of<K>(normal), b.largest + lane);
    const FacetMoments<K, Lanes> moments = moments_of<K>(normal, corner, origin, sum);
    store(moments.volume, b.volume + lane);
    store(moments.reach, b.span + lane);
    plane_of<K>(normal, load(b.length + lane), corner, plane);
    for (unsigned c = 0; c < K; ++c) store(moments.moment[c], b.moment[c] + lane);
    for (unsigned c = 0; c <= K; ++c) store(plane[c], b.plane[c] + lane);
  }
}

}  // namespace

void block3(FacetBlock<3>& b) { block<3>(b); }
void block4(FacetBlock<4>& b) { block<4>(b); }
void block5(FacetBlock<5>& b) { block<5>(b); }
void block6(FacetBlock<6>& b) { block<6>(b); }
void block7(FacetBlock<7>& b) { block<7>(b); }
void block8(FacetBlock<8>& b) { block<8>(b); }
void shares4(FacetBlock<4>& b) { shares<4>(b); }
void shares5(FacetBlock<5>& b) { shares<5>(b); }
void shares6(FacetBlock<6>& b) { shares<6>(b); }
void shares7(FacetBlock<7>& b) { shares<7>(b); }
void shares8(FacetBlock<8>& b) { shares<8>(b); }

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
HWY_EXPORT(shares4);
HWY_EXPORT(shares5);
HWY_EXPORT(shares6);
HWY_EXPORT(shares7);
HWY_EXPORT(shares8);

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
template <>
void facet_shares(FacetBlock<4>& b) {
  HWY_DYNAMIC_DISPATCH(shares4)(b);
}
template <>
void facet_shares(FacetBlock<5>& b) {
  HWY_DYNAMIC_DISPATCH(shares5)(b);
}
template <>
void facet_shares(FacetBlock<6>& b) {
  HWY_DYNAMIC_DISPATCH(shares6)(b);
}
template <>
void facet_shares(FacetBlock<7>& b) {
  HWY_DYNAMIC_DISPATCH(shares7)(b);
}
template <>
void facet_shares(FacetBlock<8>& b) {
  HWY_DYNAMIC_DISPATCH(shares8)(b);
}

}  // namespace cullhull::internal
#endif
