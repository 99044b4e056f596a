// The GaugeMap's test of one point, and how the lanes of a warp share points. The CUDA kernel
// (gauge_kernel.cu) and its host twin (tests/agreement/gauge_lanes_test.cpp) both compile this
// text.
//
// Every operation rounds as in gauge_kernel.cpp, so that all three keep the same points: sums and
// products in the same order (-fmad=false), a correctly rounded reciprocal. Three steps are done
// differently, with the same values at a lower cost on a device:
// * floor and conversion to integer run at an eighth of the speed of sums on a device. Rounded
//   downward, place + 2^23 is floor(place) + 2^23 for 0 <= place < 2^23, the cell in its low bits.
// * The norm is a maximum of floats, which ignores a NaN: then that coordinate is never dominant,
//   its fraction is a NaN, and so is the sum. Where all are NaN, so is the norm.
// * The last of the d nodes is the corner plus all strides, whatever the order of the steps.
// Only x * scale - offset is fused, where the product is exact (docs/exactness.md, G3).
//
// The reciprocal. The device's approximation r is off by at most 2^-23 r; the Newton step r + r (1
// - a r), two fused operations, gives in 2^-100 <= a < 2^126 what the device's own correctly
// rounded reciprocal gives. Even r itself would satisfy G3: its 2^-20 + 6 w, then 7 w, stays below
// 2^-19. Beyond 2^126 the reciprocal is 0, places are in the middle of the face, and the sum
// exceeds 1: the point survives. Of an infinity it is a NaN, and so is the sum.
//
// Node numbers are bounded as unsigned integers, so every look-up is in the table whatever the
// coordinates are. Example, 3D: m = 36 cells, y = (0.9, -0.3, 0.6): the axis is x, the places are
// (-1/3 + 1) 18 = 12 and (2/3 + 1) 18 = 30, both shortened by 2^-20: cell (12, 29) with the
// fractions 0.00001 and 0.99999.
#pragma once

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <type_traits>

#include "filter/gauge/gauge_table.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/host_device.hpp"

namespace cullhull::internal {

inline constexpr unsigned warp_lanes = 32;

/// The constants of a GaugeTable in the form that a kernel receives, by value.
template <unsigned D, class C>
struct GaugeConstants {
  C scale[D];
  C offset[D];
  float half_cells;
  float middle;
  float face_base[D];        ///< first node of the axis's positive face, plus 2^23
  float stride[D - 1];       ///< as floats, for the corner
  std::int32_t step[D - 1];  ///< the same as integers, for the steps to the other nodes
  std::int32_t all_steps;
  float face_stride;
  std::uint32_t last_corner;
  float threshold;
};

/// Converts a table's constants. C may be float only where GaugeTable::single_precision says that
/// all are exact in it: else the bound would not hold.
template <unsigned D, class C>
GaugeConstants<D, C> gauge_constants(const GaugeTable& t) {
  GaugeConstants<D, C> c{};
  for (unsigned j = 0; j < D; ++j) {
    c.scale[j] = static_cast<C>(t.scale[j]);
    c.offset[j] = static_cast<C>(t.offset[j]);
    c.face_base[j] = 2.0F * static_cast<float>(j) * t.face_stride + 0x1p23F;
  }
  for (unsigned k = 0; k + 1 < D; ++k) {
    c.stride[k] = t.stride[k];
    c.step[k] = static_cast<std::int32_t>(t.stride[k]);
    c.all_steps += c.step[k];
  }
  c.half_cells = t.half_cells;
  c.middle = t.middle;
  c.face_stride = t.face_stride;
  c.last_corner = t.last_corner;
  c.threshold = t.threshold;
  return c;
}

namespace lanes {

CULLHULL_HD_INLINE std::uint32_t bits_of(float v) {
#ifdef __CUDA_ARCH__
  return __float_as_uint(v);
#else
  return std::bit_cast<std::uint32_t>(v);
#endif
}

/// Returns the larger number; of a number and a NaN the number.
CULLHULL_HD_INLINE float larger(float a, float b) {
#ifdef __CUDA_ARCH__
  return fmaxf(a, b);
#else
  return b > a || a != a ? b : a;
#endif
}

/// floor(v) + 2^23, for 0 <= v < 2^23; NaN for NaN.
CULLHULL_HD_INLINE float floor_and_shift(float v) {
#ifdef __CUDA_ARCH__
  return __fadd_rd(v, 0x1p23F);
#else
  return std::floor(v) + 0x1p23F;
#endif
}

/// Returns 1 / v, correctly rounded for 2^-100 <= v < 2^126. In that range the device's
/// approximation and one Newton step give what __frcp_rn gives, without its branch to a slow path.
/// For larger numbers the device gives 0, for an infinity or NaN a NaN: such points survive anyway.
CULLHULL_HD_INLINE float reciprocal(float v) {
#ifdef __CUDA_ARCH__
  float r;
  asm("rcp.approx.ftz.f32 %0, %1;" : "=f"(r) : "f"(v));
  return __fmaf_rn(r, __fmaf_rn(-v, r, 1.0F), r);
#else
  return 1.0F / v;
#endif
}

/// Returns x in the frame. The product is exact, so fusing it changes nothing.
CULLHULL_HD_INLINE float centred(float x, float scale, float offset) {
#ifdef __CUDA_ARCH__
  return __fmaf_rn(x, scale, -offset);
#else
  return x * scale - offset;
#endif
}
CULLHULL_HD_INLINE float centred(double x, double scale, double offset) {
#ifdef __CUDA_ARCH__
  return __double2float_rn(__fma_rn(x, scale, -offset));
#else
  return static_cast<float>(x * scale - offset);
#endif
}

template <unsigned K>
CULLHULL_HD void order(float (&key)[K], std::int32_t (&step)[K], unsigned i, unsigned j) {
  const bool swap = key[i] < key[j];  // never for a NaN: steps stay a permutation
  const float high = swap ? key[j] : key[i];
  key[j] = swap ? key[i] : key[j];
  key[i] = high;
  const std::int32_t first = swap ? step[j] : step[i];
  step[j] = swap ? step[i] : step[j];
  step[i] = first;
}

/// Sorts by the networks of gauge_kernel.cpp.
template <unsigned K>
CULLHULL_HD void sort_descending(float (&key)[K], std::int32_t (&step)[K]) {
  if constexpr (K == 2) {
    order(key, step, 0, 1);
  } else if constexpr (K == 3) {
    order(key, step, 0, 1), order(key, step, 1, 2), order(key, step, 0, 1);
  } else if constexpr (K == 4) {
    order(key, step, 0, 1), order(key, step, 2, 3), order(key, step, 0, 2);
    order(key, step, 1, 3), order(key, step, 1, 2);
  } else if constexpr (K == 5) {
    order(key, step, 0, 1), order(key, step, 3, 4), order(key, step, 2, 4);
    order(key, step, 2, 3), order(key, step, 1, 4), order(key, step, 0, 3);
    order(key, step, 0, 2), order(key, step, 1, 3), order(key, step, 1, 2);
  }
}

}  // namespace lanes

/// Where the ray through a point leaves the cube: in which cell, and where in it.
template <unsigned D>
struct GaugePlace {
  float norm;            ///< of the point
  std::uint32_t corner;  ///< the cell's lowest corner; any node for a point that is not finite
  float fraction[D - 1];
};

/// Reads no node.
template <unsigned D, class C>
CULLHULL_HD GaugePlace<D> gauge_place(const GaugeConstants<D, C>& t, const float (&y)[D]) {
  constexpr float tiny = 0x1p-100F;  // the smallest divisor: quotients stay finite in floats
  constexpr std::uint32_t shift_bits = 0x4B000000U;  // the bits of 2^23

  // Dominant axis, the first of equal ones; grid axis k is axis k below it, k + 1 from it on.
  float prefix[D];
  prefix[0] = std::fabs(y[0]);
  for (unsigned k = 1; k < D; ++k) prefix[k] = lanes::larger(prefix[k - 1], std::fabs(y[k]));
  GaugePlace<D> at;
  at.norm = prefix[D - 1];
  float other[D - 1];
  float dominant = y[D - 1];
  float corner = t.face_base[D - 1];
  for (unsigned k = D - 1; k-- > 0;) {
    const bool reached = prefix[k] == at.norm;
    other[k] = reached ? y[k + 1] : y[k];
    dominant = reached ? y[k] : dominant;
    corner = reached ? t.face_base[k] : corner;
  }
  corner += static_cast<std::int32_t>(lanes::bits_of(dominant)) < 0 ? t.face_stride : 0.0F;

  // Cell and fractions.
  const float inverse = lanes::reciprocal(lanes::larger(at.norm, tiny));
  for (unsigned k = 0; k < D - 1; ++k) {
    const float place = other[k] * inverse * t.half_cells + t.middle;
    const float cell = lanes::floor_and_shift(place) - 0x1p23F;
    at.fraction[k] = place - cell;
    corner += cell * t.stride[k];  // integers: exact
  }
  const std::uint32_t node_bits = lanes::bits_of(corner) - shift_bits;
  at.corner = node_bits < t.last_corner ? node_bits : t.last_corner;
  return at;
}

/// What the test compares with the threshold: an upper bound of the gauge, up to rounding; NaN or
/// infinite for a point that is not finite.
template <unsigned D, class C, class Nodes>
CULLHULL_HD float gauge_bound(const GaugeConstants<D, C>& t, const Nodes& nodes, GaugePlace<D> at) {
  std::int32_t step[D - 1];
  for (unsigned k = 0; k < D - 1; ++k) step[k] = t.step[k];
  // Kuhn's simplex: from the lowest corner one step per axis, in the order of falling fractions.
  std::uint32_t node = at.corner;
  const std::uint32_t last = node + static_cast<std::uint32_t>(t.all_steps);
  float(&fraction)[D - 1] = at.fraction;
  lanes::sort_descending(fraction, step);
  float sum = (1.0F - fraction[0]) * nodes[node];
  for (unsigned k = 0; k + 2 < D; ++k) {
    node += static_cast<std::uint32_t>(step[k]);
    sum += (fraction[k] - fraction[k + 1]) * nodes[node];
  }
  sum += fraction[D - 2] * nodes[last];
  return at.norm * sum;
}

/// Returns whether the point is provably strictly inside; false if it has a NaN or an infinity.
template <unsigned D, class C, class Nodes>
CULLHULL_HD bool gauge_inside(const GaugeConstants<D, C>& t, const Nodes& nodes,
                              const float (&y)[D]) {
  return gauge_bound(t, nodes, gauge_place(t, y)) < t.threshold;
}

// A warp reads `group_points` points at a time and returns as many bits, in words of 32 in the
// points' order: bit i of the mask, counted from the lowest, is set if point i survives. A layout
// defines which points belong to a lane and how they are read.

/// Packed rows that begin at a multiple of 16 bytes: a lane reads neighbouring points, as many as
/// make its bytes a multiple of 16, only by vectors of that size.
template <unsigned D_, class T_>
struct PackedRows {
  using T = T_;
  static constexpr unsigned D = D_;
  static constexpr unsigned lane_points = 16 / sizeof(T);
  static constexpr unsigned group_points = warp_lanes * lane_points;
  const T* data;

  CULLHULL_HD static std::uint64_t point(std::uint64_t group, unsigned lane, unsigned k) {
    return group * group_points + std::uint64_t{lane} * lane_points + k;
  }
  template <bool Whole>
  CULLHULL_HD void read(std::uint64_t group, unsigned lane, std::uint64_t count,
                        T (&x)[lane_points][D]) const {
    const std::uint64_t first = point(group, lane, 0);
    if constexpr (Whole) {
#ifdef __CUDA_ARCH__
      using Vector = std::conditional_t<sizeof(T) == 4, float4, double2>;
      union {
        Vector v[D];
        T x[lane_points][D];
      } all;
      const Vector* from = reinterpret_cast<const Vector*>(data + first * D);
      for (unsigned v = 0; v < D; ++v) all.v[v] = __ldg(from + v);
      for (unsigned k = 0; k < lane_points; ++k)
        for (unsigned j = 0; j < D; ++j) x[k][j] = all.x[k][j];
#else
      std::memcpy(x, data + first * D, sizeof x);
#endif
    } else {
      for (unsigned k = 0; k < lane_points; ++k)
        for (unsigned j = 0; j < D; ++j)
          x[k][j] = first + k < count ? data[(first + k) * D + j] : T{};
    }
  }
};

/// Any strides: lane l reads points l, l + 32, ..., so that columns are read 32 values at a time.
template <unsigned D_, class T_>
struct AnyStrides {
  using T = T_;
  static constexpr unsigned D = D_;
  static constexpr unsigned lane_points = 16 / sizeof(T);
  static constexpr unsigned group_points = warp_lanes * lane_points;
  const std::byte* data;
  std::ptrdiff_t point_stride;
  std::ptrdiff_t coordinate_stride;

  CULLHULL_HD static std::uint64_t point(std::uint64_t group, unsigned lane, unsigned k) {
    return group * group_points + k * warp_lanes + lane;
  }
  template <bool Whole>
  CULLHULL_HD void read(std::uint64_t group, unsigned lane, std::uint64_t count,
                        T (&x)[lane_points][D]) const {
    for (unsigned k = 0; k < lane_points; ++k) {
      const std::uint64_t i = point(group, lane, k);
      const std::byte* row = data + static_cast<std::ptrdiff_t>(i) * point_stride;
      for (unsigned j = 0; j < D; ++j)
        x[k][j] = Whole || i < count ? *reinterpret_cast<const T*>(
                                           row + static_cast<std::ptrdiff_t>(j) * coordinate_stride)
                                     : T{};
    }
  }
};

/// Returns a mask: bit k is set if the lane's k-th point of the group exists and survives; points
/// that are not finite do. `Whole`: all of the group's points exist.
template <bool Whole, class Layout, class C, class Nodes>
CULLHULL_HD std::uint32_t lane_survivors(const GaugeConstants<Layout::D, C>& t, const Nodes& nodes,
                                         const Layout& layout, std::uint64_t group, unsigned lane,
                                         std::uint64_t count) {
  typename Layout::T x[Layout::lane_points][Layout::D];
  layout.template read<Whole>(group, lane, count, x);
  std::uint32_t bits = 0;
#ifdef __CUDA_ARCH__
#pragma unroll
#endif
  for (unsigned k = 0; k < Layout::lane_points; ++k) {
    float y[Layout::D];
    for (unsigned j = 0; j < Layout::D; ++j)
      y[j] = lanes::centred(static_cast<C>(x[k][j]), t.scale[j], t.offset[j]);
    bool survives = !gauge_inside(t, nodes, y);
    if constexpr (!Whole) survives &= Layout::point(group, lane, k) < count;
    bits |= static_cast<std::uint32_t>(survives) << k;
  }
  return bits;
}

/// Does the same for any group: whole ones and the last, which ends at `count`.
template <class Layout, class C, class Nodes>
CULLHULL_HD std::uint32_t lane_survivors(const GaugeConstants<Layout::D, C>& t, const Nodes& nodes,
                                         const Layout& layout, std::uint64_t group, unsigned lane,
                                         std::uint64_t count) {
  if ((group + 1) * Layout::group_points <= count)  // all lanes of a warp agree
    return lane_survivors<true>(t, nodes, layout, group, lane, count);
  return lane_survivors<false>(t, nodes, layout, group, lane, count);
}

/// Returns the number of groups that contain `count` points.
template <class Layout>
CULLHULL_HD std::uint64_t group_count(std::uint64_t count) {
  return (count + Layout::group_points - 1) / Layout::group_points;
}

/// Calls use(layout) with the layout that reads the points fastest.
template <unsigned D, class T, class Use>
void with_layout(const void* data, std::ptrdiff_t point_stride, std::ptrdiff_t coordinate_stride,
                 const Use& use) {
  const bool packed = coordinate_stride == static_cast<std::ptrdiff_t>(sizeof(T)) &&
                      point_stride == static_cast<std::ptrdiff_t>(D * sizeof(T));
  if (packed && reinterpret_cast<std::uintptr_t>(data) % 16 == 0)
    use(PackedRows<D, T>{static_cast<const T*>(data)});
  else
    use(AnyStrides<D, T>{static_cast<const std::byte*>(data), point_stride, coordinate_stride});
}

/// Calls run.template operator()<D, T, C>() for the points' dimension and scalar; the frame is
/// computed in C.
template <class Run>
void with_types(const GaugeTable& t, ScalarType scalar, const Run& run) {
  with_dimension<2, 5, 6>(t.dimension, [&](auto d) {
    if (scalar == ScalarType::f64)
      run.template operator()<d, double, double>();
    else if (t.single_precision)
      run.template operator()<d, float, float>();
    else
      run.template operator()<d, float, double>();
  });
}

}  // namespace cullhull::internal
