#include "cullhull/hull.hpp"
#include "parallel/simd_targets.hpp"
#include "result/write/few_triangles.hpp"

// Vectors are kept in arrays below, which sizeless types do not allow.
#define HWY_DISABLED_TARGETS CULLHULL_SPARED_TARGETS
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "result/write/few_triangle_shares.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>

#include "result/facets/facet_lanes-inl.hpp"
#include "result/facets/facet_plane.hpp"
#include "result/measures/measure_frame.hpp"

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

constexpr unsigned block = 8;  // facets whose corners are gathered at once: a vector of doubles

struct Corners {
  alignas(64) double at[3][3][block];  // corner, coordinate
};

/// Computes one vector of facets, from lane `lane` of the corners on, by the operations of
/// facet_block and facet_share in the same order.
template <class Shares>
HWY_INLINE void share(const Corners& corners, unsigned lane, const double* from, double scale,
                      double unit, unsigned i, Shares& out, double* planes) {
  Lanes corner[3][3], origin[3], edge[2][3], normal[3], sum[3];
  for (unsigned c = 0; c < 3; ++c) {
    origin[c] = from[c];
    for (unsigned j = 0; j < 3; ++j) corner[j][c] = load(corners.at[j][c] + lane) * scale;
  }
  edges_of<3>(corner, edge);
  cofactors<3>(edge, normal);
  sum_of_corners<3>(corner, origin, sum);
  const Lanes square = square_of<3>(normal);
  write_shares(normal, root(square), corner[0], origin, sum, unit, i, out, planes);
  // Closed facets are well conditioned by a factor of two more than facet_share requires, so that
  // both agree whatever the rounding; their normals' components are between 2^-351 and 8, as
  // coordinates are at most 1.
  const Lanes shortest =
      4 * conditioned * conditioned * (square_of<3>(edge[0]) * square_of<3>(edge[1]));
  const M closed = hn::And(square > shortest, square > 0x1p-700);
  out.open[i / 64] |= std::uint64_t{bits_of(hn::Not(closed))} << i % 64;
}

template <class Points, class Hull, class Shares>
HWY_INLINE void all_shares(const Points& points, const Hull& hull, int exponent, Shares& shares,
                           double* planes) {
  const double scale = scale_by(1, -exponent), unit = scale_by(1, exponent);
  double origin[3];
  for (unsigned c = 0; c < 3; ++c) origin[c] = points.axes[c][hull.ids[0]] * scale;
  std::fill(std::begin(shares.open), std::end(shares.open), 0);
  Corners corners;
  for (unsigned i = 0; i < hull.count; i += block) {
    const auto* vertex = hull.vertices + std::size_t{3} * i;
    for (unsigned lane = 0; lane < block; ++lane)
      for (unsigned j = 0; j < 3; ++j) {
        const unsigned id = *vertex++;
        for (unsigned c = 0; c < 3; ++c) corners.at[j][c][lane] = points.axes[c][id];
      }
    for (unsigned lane = 0; lane < block; lane += lane_count())
      share(corners, lane, origin, scale, unit, i + lane, shares, planes);
  }
  // Copies that pad the last vector are not facets.
  for (unsigned w = 0; w < std::size(shares.open); ++w)
    if (hull.count < 64 * w + 64)
      shares.open[w] &= hull.count > 64 * w ? ~(~std::uint64_t{0} << hull.count % 64) : 0;
}

template <class T, class Short>
HWY_INLINE void widen_all(const Short* from, std::size_t count, T* to) {
  const hn::CappedTag<T, 64 / sizeof(T)> tag;
  const hn::Rebind<Short, decltype(tag)> narrow;
  for (std::size_t i = 0; i < count; i += hn::Lanes(tag)) {
    const auto v = hn::LoadU(narrow, from + i);
    if constexpr (sizeof(T) == 4)
      hn::StoreU(hn::PromoteTo(tag, v), tag, to + i);
    else
      hn::StoreU(hn::PromoteTo(tag, hn::PromoteTo(hn::Rebind<std::uint32_t, decltype(tag)>(), v)),
                 tag, to + i);
  }
}

}  // namespace

void shares_in(const SmallPoints3D& points, const SmallHull3D& hull, int exponent,
               SmallShares<SmallHull3D::max_facets>& shares, double* planes) {
  all_shares(points, hull, exponent, shares, planes);
}
void medium_shares_in(const MediumPoints3D& points, const MediumHull3D& hull, int exponent,
                      SmallShares<MediumHull3D::max_facets>& shares, double* planes) {
  all_shares(points, hull, exponent, shares, planes);
}
void widen_8_32(const std::uint8_t* from, std::size_t count, std::uint32_t* to) {
  widen_all(from, count, to);
}
void widen_8_64(const std::uint8_t* from, std::size_t count, std::uint64_t* to) {
  widen_all(from, count, to);
}
void widen_16_32(const std::uint16_t* from, std::size_t count, std::uint32_t* to) {
  widen_all(from, count, to);
}
void widen_16_64(const std::uint16_t* from, std::size_t count, std::uint64_t* to) {
  widen_all(from, count, to);
}

}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(shares_in);
HWY_EXPORT(medium_shares_in);
HWY_EXPORT(widen_8_32);
HWY_EXPORT(widen_8_64);
HWY_EXPORT(widen_16_32);
HWY_EXPORT(widen_16_64);

void small_shares(const SmallPoints3D& points, const SmallHull3D& hull, int exponent,
                  SmallShares<SmallHull3D::max_facets>& shares, double* planes) {
  HWY_DYNAMIC_DISPATCH(shares_in)(points, hull, exponent, shares, planes);
}
void small_shares(const MediumPoints3D& points, const MediumHull3D& hull, int exponent,
                  SmallShares<MediumHull3D::max_facets>& shares, double* planes) {
  HWY_DYNAMIC_DISPATCH(medium_shares_in)(points, hull, exponent, shares, planes);
}
void widen(const std::uint8_t* from, std::size_t count, std::uint32_t* to) {
  HWY_DYNAMIC_DISPATCH(widen_8_32)(from, count, to);
}
void widen(const std::uint8_t* from, std::size_t count, std::uint64_t* to) {
  HWY_DYNAMIC_DISPATCH(widen_8_64)(from, count, to);
}
void widen(const std::uint16_t* from, std::size_t count, std::uint32_t* to) {
  HWY_DYNAMIC_DISPATCH(widen_16_32)(from, count, to);
}
void widen(const std::uint16_t* from, std::size_t count, std::uint64_t* to) {
  HWY_DYNAMIC_DISPATCH(widen_16_64)(from, count, to);
}

}  // namespace cullhull::internal
#endif
