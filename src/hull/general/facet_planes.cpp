// Planes of new facets: one SIMD vector of facets at a time, compiled once per instruction set.
//
// The facets share the apex p, so the rows of the matrix are v - p. Cofactors come from
// complementary minors: minors of the first half of the rows, minors of the second half, and one
// Laplace expansion over both. The bound uses products of the rows' 1-norms in place of permanents:
// docs/exactness.md, "Cached planes" and "Planes in single precision".
//
// The constant. Follow one of the r! signed products of r entries to its cofactor: r roundings of
// differences; in the first a rows a - 1 of products and at most k - 1 of additions at each level k
// <= a (the first term of a sum costs none), a (a - 1)/2 in all; the same with b; then one product
// and at most C(r, a) - 1 additions:
//
//   N = r + (a - 1) + a (a - 1)/2 + (b - 1) + b (b - 1)/2 + C(r, a).
//
// (4D: 3 + 0 + 0 + 1 + 1 + 3 = 8; 5D: 14; 6D: 21; 7D: 36; 8D: 56. A fused multiply-add rounds
// less.) So |N~_j - N_j| <= gamma_N perm_j, and the permanent of |rows| without column j is at most
// the product Prod of the rows' 1-norms, since Prod multiplied out holds every product of one entry
// a row. Prod ~ is computed by d^2 - 1 roundings a path, so Prod <= (1 - u)^(1 - d^2) Prod ~; as N
// (N + d^2) u < 1/2, the second order is below u and
//
//   |N~_j - N_j| <= (N + 1) u Prod ~ + 2^-1000.
//
// Where points are off by r (Unflattened), so is O; entries of rows are off by 2 r, rows by e = 2 d
// r in the 1-norm. That adds Prod (s_i + e) - Prod s_i to a cofactor, s_i being the norms, and 2 r
// to x - O, here and at the apex.

#include "hull/general/facet_planes.hpp"

#include "parallel/dispatch.hpp"
#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "hull/general/facet_planes.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "exact/determinants/minors.hpp"
#include "hull/general/laplace.hpp"

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

namespace hn = hwy::HWY_NAMESPACE;

// At most 8 doubles: horizons in 4D have too few facets to fill wider vectors.
using F = hn::CappedTag<double, 8>;
using VF = hn::Vec<F>;

/// acc + sign x y; the first term of a sum has no acc.
template <bool first, bool negative>
HWY_INLINE VF term(VF acc, VF x, VF y) {
  if constexpr (first) return negative ? hn::Neg(hn::Mul(x, y)) : hn::Mul(x, y);
  if constexpr (negative) return hn::NegMulAdd(x, y, acc);
  return hn::MulAdd(x, y, acc);
}

/// One minor of `size` rows by expansion along the last of them.
template <unsigned D, unsigned size, unsigned rank, unsigned... k>
HWY_INLINE VF expand(const VF* row, const VF* smaller, std::integer_sequence<unsigned, k...>) {
  VF sum = hn::Zero(F());
  ((sum = term<k == 0, ((size - 1 + k) & 1U) != 0>(sum, row[Subsets<D>::member(size, rank, k)],
                                                   smaller[Subsets<D>::without(size, rank, k)])),
   ...);
  return sum;
}

template <unsigned D, unsigned size, unsigned... rank>
HWY_INLINE void next_minors(const VF* row, const VF* smaller, VF* out,
                            std::integer_sequence<unsigned, rank...>) {
  ((out[rank] = expand<D, size, rank>(row, smaller, std::make_integer_sequence<unsigned, size>())),
   ...);
}

/// Minors of rows[0 .. size) on all sets of `size` columns, in the order of Subsets.
template <unsigned D, unsigned size>
HWY_INLINE void all_minors(const VF (*rows)[D], VF* out) {
  if constexpr (size == 1) {
    for (unsigned j = 0; j < D; ++j) out[j] = rows[0][j];
  } else {
    VF smaller[Subsets<D>::count(size - 1)];
    all_minors<D, size - 1>(rows, smaller);
    next_minors<D, size>(rows[size - 1], smaller, out,
                         std::make_integer_sequence<unsigned, Subsets<D>::count(size)>());
  }
}

template <unsigned D, unsigned j, unsigned... k>
HWY_INLINE VF laplace(const VF* top, const VF* bottom, std::integer_sequence<unsigned, k...>) {
  VF sum = hn::Zero(F());
  ((sum = term<k == 0, Laplace<D>::split(j, k).negative>(sum, top[Laplace<D>::split(j, k).top],
                                                         bottom[Laplace<D>::split(j, k).bottom])),
   ...);
  return sum;
}

template <unsigned D, unsigned... j>
HWY_INLINE void cofactors(const VF (*rows)[D], VF* normal, std::integer_sequence<unsigned, j...>) {
  VF top[Subsets<D>::count(Laplace<D>::top_rows)];
  VF bottom[Subsets<D>::count(Laplace<D>::bottom_rows)];
  all_minors<D, Laplace<D>::top_rows>(rows, top);
  all_minors<D, Laplace<D>::bottom_rows>(rows + Laplace<D>::top_rows, bottom);
  ((normal[j] =
        laplace<D, j>(top, bottom, std::make_integer_sequence<unsigned, Laplace<D>::splits>())),
   ...);
}

template <unsigned D>
void planes_of_group(const PlaneFrame& frame, const double* apex, const double* buffer,
                     std::size_t lanes, std::size_t used, float* planes) {
  const F f;
  VF rows[D - 1][D];
  VF norms = hn::Set(f, 1.0), blur = hn::Zero(f);
  for (unsigned i = 0; i + 1 < D; ++i) {
    VF sum = hn::Zero(f);
    for (unsigned j = 0; j < D; ++j) {
      rows[i][j] = hn::Load(f, buffer + (i * D + j) * lanes);
      sum = hn::Add(sum, hn::Abs(rows[i][j]));
    }
    if (frame.row_error > 0) {
      const VF e = hn::Set(f, 2 * D * frame.row_error);
      blur = hn::MulAdd(blur, hn::Add(sum, e), hn::Mul(norms, e));
    }
    norms = hn::Mul(norms, sum);
  }
  VF normal[D];
  cofactors<D>(rows, normal, std::make_integer_sequence<unsigned, D>());

  VF size = hn::Zero(f), reached = hn::Zero(f), level = hn::Zero(f);
  for (unsigned j = 0; j < D; ++j) {
    const VF a = hn::Abs(normal[j]);
    size = hn::Add(size, a);
    reached = hn::MulAdd(a, hn::Set(f, frame.reach[j]), reached);
    level = hn::MulAdd(normal[j], hn::Set(f, apex[j] - frame.centre[j]), level);
  }
  const VF magnitude = hn::Abs(level);
  const VF wrong =
      hn::MulAdd(norms, hn::Set(f, PlaneBounds<D>::per_norm),
                 hn::MulAdd(blur, hn::Set(f, PlaneBounds<D>::per_blur), hn::Set(f, 0x1p-990)));
  const VF bound =
      hn::MulAdd(size, hn::Set(f, PlaneBounds<D>::per_size + 4.25 * frame.row_error), wrong);
  const VF scale = hn::Div(hn::Set(f, 1.0), level);
  const VF absolute = hn::Abs(scale);
  const VF error =
      hn::MulAdd(hn::Mul(bound, absolute), hn::Set(f, 1 + 0x1p-40),
                 hn::MulAdd(hn::Mul(reached, absolute), hn::Set(f, PlaneBounds<D>::per_reach),
                            hn::Set(f, 0x1p-120)));
  const auto good = hn::And(hn::And(hn::Gt(magnitude, hn::Set(f, 0x1p-900)),
                                    hn::Gt(magnitude, hn::Mul(bound, hn::Set(f, 8.0)))),
                            hn::And(hn::Le(error, hn::Set(f, 0.5)),
                                    hn::Lt(hn::Mul(size, absolute), hn::Set(f, 0x1p100))));
  const hn::Rebind<float, F> narrow;
  HWY_ALIGN float out[(D + 1) * hn::MaxLanes(F())];
  for (unsigned j = 0; j < D; ++j)
    hn::Store(hn::DemoteTo(narrow, hn::IfThenElseZero(good, hn::Mul(normal[j], scale))), narrow,
              out + j * lanes);
  // Conversion rounds to nearest; multiplying by 1 + 2^-22 (two units of f32) first makes it round
  // up. Infinity is set as a float: emulated vectors convert an infinite double to the largest
  // float.
  const VF wider = hn::IfThenElse(good, hn::Mul(error, hn::Set(f, 1 + 0x1p-22)), hn::Set(f, 2.0));
  const auto narrowed = hn::DemoteTo(narrow, wider);
  hn::Store(hn::IfThenElse(hn::Gt(narrowed, hn::Set(narrow, 1.0F)),
                           hn::Set(narrow, std::numeric_limits<float>::infinity()), narrowed),
            narrow, out + D * lanes);
  for (std::size_t k = 0; k < used; ++k)
    for (unsigned j = 0; j <= D; ++j) planes[k * (D + 1) + j] = out[j * lanes + k];
}

template <unsigned D>
void planes_in(const PlaneFrame& frame, std::uint32_t apex, const std::uint32_t* facets,
               const std::uint8_t* apex_slot, std::size_t count, float* planes) {
  const std::size_t lanes = hn::Lanes(F());
  HWY_ALIGN double buffer[(D - 1) * D * hn::MaxLanes(F())];
  const double* p = frame.rows + std::size_t{apex} * D;
  for (std::size_t first = 0; first < count; first += lanes) {
    const std::size_t used = std::min(lanes, count - first);
    for (std::size_t k = 0; k < lanes; ++k) {
      const std::size_t facet = first + std::min(k, used - 1);
      const std::uint32_t* v = facets + facet * D;
      double* column = buffer + k;
      for (unsigned i = 0; i + 1 < D; ++i) {
        const double* q = frame.rows + std::size_t{v[i + (i >= apex_slot[facet])]} * D;
        for (unsigned j = 0; j < D; ++j, column += lanes) *column = q[j] - p[j];
      }
    }
    planes_of_group<D>(frame, p, buffer, lanes, used, planes + first * (D + 1));
  }
}

}  // namespace

void planes_of_facets(const PlaneFrame& frame, std::uint32_t apex, const std::uint32_t* facets,
                      const std::uint8_t* apex_slot, std::size_t count, float* planes) {
  with_dimension<4, 7, 8>(frame.dimension, [&](auto d) {
    planes_in<d>(frame, apex, facets, apex_slot, count, planes);
  });
}

}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE

namespace cullhull::internal {

HWY_EXPORT(planes_of_facets);

void facet_planes(const PlaneFrame& frame, std::uint32_t apex, const std::uint32_t* facets,
                  const std::uint8_t* apex_slot, std::size_t count, float* planes) {
  if (frame.dimension >= 4 && frame.dimension <= 8) {
    HWY_DYNAMIC_DISPATCH(planes_of_facets)(frame, apex, facets, apex_slot, count, planes);
    return;
  }
  facet_planes_any(frame, facets, count, planes);
}

}  // namespace cullhull::internal
#endif
