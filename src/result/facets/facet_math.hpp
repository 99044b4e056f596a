// The arithmetic of one facet, in doubles: for the host and for devices.
#pragma once

#include <cmath>

#include "exact/determinants/cofactors.hpp"
#include "parallel/host_device.hpp"
#include "result/measures/share.hpp"

namespace cullhull::internal {

CULLHULL_HD_INLINE double root(double v) { return std::sqrt(v); }
CULLHULL_HD_INLINE double absolute(double v) { return std::fabs(v); }
CULLHULL_HD_INLINE double greater_of(double a, double b) { return a < b ? b : a; }

#define CULLHULL_MATH CULLHULL_HD_INLINE
#include "result/facets/facet_math-inl.hpp"
#undef CULLHULL_MATH

/// Computes plane and share of a facet whose corners are scaled by the frame's power of two; `unit`
/// is its inverse, `origin` the hull's vertex 0, scaled. Returns false where the normal needs more
/// than doubles; facet_share computes the same bits where they suffice.
template <unsigned K>
CULLHULL_HD_INLINE bool plain_facet(const double (&corner)[K][K], const double (&origin)[K],
                                    double unit, double (&plane)[K + 1], Share<K>& share) {
  double edge[K - 1][K], normal[K], sum[K];
  edges_of<K>(corner, edge);
  cofactors<K>(edge, normal);
  sum_of_corners<K>(corner, origin, sum);
  const double length = root(square_of<K>(normal));
  const FacetMoments<K, double> moments = moments_of<K>(normal, corner[0], origin, sum);
  plane_of<K>(normal, length, corner[0], plane);
  plane[K] = plane[K] * unit;
  share.volume = moments.volume;
  share.area = share.area_error = length;
  for (unsigned c = 0; c < K; ++c) share.moment[c] = moments.moment[c];
  share.error = length * moments.reach;
  double lengths = 1;  // in the plane the normal is as long as the edge
  for (unsigned i = 0; K > 2 && i + 1 < K; ++i) lengths = lengths * root(square_of<K>(edge[i]));
  return largest_of<K>(normal) > 0x1p-400 && (K == 2 || length > conditioned * lengths);
}

/// The same for a facet that plain_facet refused, whose results it replaces, with the normal in
/// double-doubles: the bits of FacetPlane, which computes it so where it is short beside its edges.
/// Returns false where it needs exact arithmetic, or has so small components that they are scaled.
template <unsigned K>
CULLHULL_HD_INLINE bool careful_facet(const double (&corner)[K][K], const double (&origin)[K],
                                      double unit, double (&plane)[K + 1], Share<K>& share) {
  // The largest component is above 2^-400, so it was refused as too short.
  if (!(share.area > 0x1p-399)) return false;
  DoubleDouble edge[K - 1][K], wide[K];
  double lengths = 1, normal[K], sum[K];
  for (unsigned i = 1; i < K; ++i) {
    double square = 0;
    for (unsigned c = 0; c < K; ++c) {
      edge[i - 1][c] = DoubleDouble::sum(corner[i][c], -corner[0][c]);
      square += edge[i - 1][c].value() * edge[i - 1][c].value();
    }
    lengths *= root(square);
  }
  cofactors<K>(edge, wide);
  for (unsigned c = 0; c < K; ++c) normal[c] = wide[c].value();
  sum_of_corners<K>(corner, origin, sum);
  const double length = root(square_of<K>(normal));
  const FacetMoments<K, double> moments = moments_of<K>(normal, corner[0], origin, sum);
  plane_of<K>(normal, length, corner[0], plane);
  plane[K] = plane[K] * unit;
  share.volume = moments.volume;
  share.area = length;
  share.area_error = length + 0x1p-49 * lengths;
  for (unsigned c = 0; c < K; ++c) share.moment[c] = moments.moment[c];
  share.error = share.area_error * moments.reach;
  return largest_of<K>(normal) > 0x1p-400 && length > 0x1p-40 * conditioned * lengths;
}

}  // namespace cullhull::internal
