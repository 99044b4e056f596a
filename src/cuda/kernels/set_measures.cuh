// Planes and measures of hulls that warps have found, in the CPU's operations and order, so that
// their bits are the CPU's. What these leave uncertain is the CPU's.
#pragma once

#include <cstdint>

#include "cuda/kernels/coordinate.cuh"
#include "cuda/kernels/set_hulls_kernel.hpp"
#include "result/facets/facet_math.hpp"

namespace cullhull::internal {

/// The simplices of one set's hull, its coordinates scaled by a power of two.
template <unsigned D, class T>
class FoundHullOfSet {
 public:
  __device__ FoundHullOfSet(const DevicePointView& points, const WarpSets& sets, std::uint64_t set)
      : vertex_count(sets.counts[set] & 0xFF),
        simplex_count(sets.counts[set] >> 8),
        points_(points),
        first_(sets.starts[set]),
        vertices_(sets.vertices + first_),
        simplices_(sets.simplices + simplex_room(D) * first_) {}

  const unsigned vertex_count, simplex_count;
  int exponent = 0;

  /// Scales by the power of two that make_frame chooses. False where that is far from 1 or the hull
  /// is thin along an axis.
  __device__ bool find_exponent() {
    double low[D], high[D], largest = 0;
#pragma unroll
    for (unsigned c = 0; c < D; ++c) low[c] = 0x1p1000, high[c] = -0x1p1000;
    for (unsigned v = 0; v < vertex_count; ++v)
#pragma unroll
      for (unsigned c = 0; c < D; ++c) {
        const double x = given(vertices_[v], c);
        low[c] = x < low[c] ? x : low[c];
        high[c] = x > high[c] ? x : high[c];
        largest = greater_of(largest, absolute(x));
      }
    const auto field = static_cast<int>(__double_as_longlong(largest) >> 52);
    scale_to(field == 0 ? -2000 : field - 1022);  // ilogb + 1
    if (exponent < -most_quick_exponent || exponent > most_quick_exponent) return false;
    bool wide = true;
#pragma unroll
    for (unsigned c = 0; c < D; ++c)
      wide = wide && high[c] * scale_ - low[c] * scale_ > (D == 2 ? 0x1p-200 : 0x1p-133);
    return wide;
  }
  __device__ void scale_to(int e) {
    exponent = e;
    scale_ = scale_by(1, -e);
  }

  /// Plane and share of a simplex. False where they need more than doubles.
  __device__ bool facet(unsigned i, double (&plane)[D + 1], Share<D>& share) const {
    double corner[D][D], origin[D];
#pragma unroll
    for (unsigned j = 0; j < D; ++j) scaled(simplices_[D * i + j], corner[j]);
    scaled(vertices_[0], origin);
    return plain_facet<D>(corner, origin, scale_by(1, exponent), plane, share);
  }

  /// Volume, area and centroid. False where doubles leave any of them, or a plane, uncertain.
  __device__ bool measure(double& volume, double& area, double (&centroid)[D]) const {
    Share<D, DoubleDouble> all;
    Share<D> run;
    for (unsigned i = 0; i < simplex_count; ++i) {
      double plane[D + 1];
      Share<D> share;
      if (!facet(i, plane, share)) return false;
      run.add(share);
      if ((i + 1) % measure_run != 0 && i + 1 != simplex_count) continue;
      all.add(run);
      run = {};
    }
    double origin[D];
    scaled(vertices_[0], origin);
    return settled(all, 0x1p-53) && finish_quickly(D, exponent, origin, all.volume, all.area,
                                                   all.moment, &volume, &area, centroid);
  }

 private:
  __device__ double given(unsigned v, unsigned c) const {
    return static_cast<double>(coordinate<T>(points_, first_ + v, c));
  }
  __device__ void scaled(unsigned v, double (&x)[D]) const {
#pragma unroll
    for (unsigned c = 0; c < D; ++c) x[c] = given(v, c) * scale_;
  }

  const DevicePointView& points_;
  const std::uint64_t first_;
  const std::uint8_t *const vertices_, *const simplices_;
  double scale_ = 1;
};

}  // namespace cullhull::internal
