// The GaugeMap's SIMD kernel, compiled once per instruction set and chosen at run time.
//
// A block of points is translated, scaled and rounded to f32 into a buffer that stays in L1 (the
// only step that depends on the input's layout and type), then tested a vector at a time. Every
// target performs the same IEEE operations per point, so all of them keep the same points. Products
// are fused only where the product is exact, or where the map tests the point afterwards.
//
// Where the cheapest test decides most points, blocks are so short that the processor reads the
// next block while it tests one; there prefetching costs time. Elsewhere the input is prefetched.

#include "filter/gauge/gauge_table.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/simd_targets.hpp"

#define HWY_DISABLED_TARGETS (CULLHULL_SIZELESS_TARGETS | HWY_SSE4)
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "filter/gauge/gauge_kernel.cpp"
#include <hwy/cache_control.h>
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

#include <algorithm>
#include <cstring>

#include "filter/gauge/gauge_blocks-inl.hpp"

HWY_BEFORE_NAMESPACE();
namespace cullhull::internal::HWY_NAMESPACE {
namespace {

// ---------------------------------------------------------------- packed rows of f32 or f64

/// Scale and offset of the elements of D consecutive vectors of rows.
template <unsigned D, class T>
struct RowPattern {
  static constexpr std::size_t lanes = hn::MaxLanes(hn::ScalableTag<T>());
  HWY_ALIGN T scale[D * lanes];
  HWY_ALIGN T offset[D * lanes];
  RowPattern(const T* s, const T* o) {
    for (std::size_t e = 0; e < D * lanes; ++e) scale[e] = s[e % D], offset[e] = o[e % D];
  }
};

HWY_INLINE void store_f32(hn::ScalableTag<float> d, hn::Vec<hn::ScalableTag<float>> v, float* to) {
  hn::StoreU(v, d, to);
}
#if HWY_HAVE_FLOAT64
HWY_INLINE void store_f32(hn::ScalableTag<double> d, hn::Vec<hn::ScalableTag<double>> v,
                          float* to) {
  const hn::Rebind<float, decltype(d)> half;
  hn::StoreU(hn::DemoteTo(half, v), half, to);
}
#endif

// The conversion is the only step that knows the points' type and layout, so that the test itself
// exists once. Rounding a coordinate to f32 moves it by at most 2^-24 of the largest one, which the
// map's nodes have in advance (docs/exactness.md, G3).

/// Converts `count` rows from `from` to `to`: translated, scaled, rounded to f32, zero-padded.
template <unsigned D, class T>
HWY_INLINE void convert_rows(const RowPattern<D, T>& pattern, const T* HWY_RESTRICT from,
                             std::uint32_t count, float* HWY_RESTRICT to) {
  std::size_t done = 0;
#if HWY_HAVE_FLOAT64
  const hn::ScalableTag<T> d;
  const std::size_t lanes = hn::Lanes(d);
  for (; done + lanes <= count; done += lanes) {
    for (unsigned k = 0; k < D; ++k) {
      const auto x = hn::LoadU(d, from + done * D + k * lanes);
      // The product is exact, so fusing it changes nothing.
      store_f32(d,
                hn::MulSub(x, hn::Load(d, pattern.scale + k * lanes),
                           hn::Load(d, pattern.offset + k * lanes)),
                to + done * D + k * lanes);
    }
  }
#endif
  for (std::size_t e = done * D; e < std::size_t{count} * D; ++e)
    to[e] = static_cast<float>(from[e] * pattern.scale[e % D] - pattern.offset[e % D]);
  const std::size_t padded = (count + hn::Lanes(F()) - 1) / hn::Lanes(F()) * hn::Lanes(F());
  std::fill(to + std::size_t{count} * D, to + padded * D, 0.0F);
}

template <unsigned D>
HWY_INLINE void load_rows(const float* HWY_RESTRICT rows, VF (&y)[D]) {
  const F f;
  if constexpr (D == 2) {
    hn::LoadInterleaved2(f, rows, y[0], y[1]);
  } else if constexpr (D == 3) {
    hn::LoadInterleaved3(f, rows, y[0], y[1], y[2]);
  } else if constexpr (D == 4) {
    hn::LoadInterleaved4(f, rows, y[0], y[1], y[2], y[3]);
  } else {
    const I i;
    const VI row = hn::Mul(hn::Iota(i, 0), hn::Set(i, static_cast<std::int32_t>(D)));
    for (unsigned k = 0; k < D; ++k) y[k] = hn::GatherIndex(f, rows + k, row);
  }
}

template <unsigned D, class T>
std::size_t survivors_rows(const GaugeTable& t, const GaugeCore* core, const T* data,
                           const T* scale, const T* offset, std::uint32_t count,
                           std::uint32_t* ids) {
  const RowPattern<D, T> pattern(scale, offset);
  Blocks<D> blocks(t, core, ids);
  HWY_ALIGN float rows[(many + hn::MaxLanes(F())) * D];
  for (std::uint32_t b = 0; b < count;) {
    const std::uint32_t n = std::min(blocks.room(), count - b);
    convert_rows<D, T>(pattern, data + std::size_t{b} * D, n, rows);
    // Prefetch two blocks ahead: the next block would arrive too late.
    const T* later = data + (std::size_t{b} + 2 * many) * D;
    blocks.add(
        b, n,
        [&](std::uint32_t k, VF(&y)[D]) HWY_ATTR { load_rows<D>(rows + std::size_t{k} * D, y); },
        [&](std::uint32_t k) HWY_ATTR {
      for (std::size_t e = 0; e < D * hn::Lanes(F()); e += 64 / sizeof(T))
        hwy::Prefetch(later + std::size_t{k} * D + e);
        });
    b += n;
  }
  return blocks.finish();
}

// ---------------------------------------------------------------- any layout, any scalar

/// Converts one coordinate of `count` points; computes in C, which represents every T exactly.
template <class C, class T>
void convert_axis(const std::byte* from, std::ptrdiff_t stride, std::uint32_t count, C scale,
                  C offset, float* HWY_RESTRICT to) {
  const auto convert = [&](const std::byte* p) {
    T value;
    std::memcpy(&value, p, sizeof value);  // any alignment
    return static_cast<float>(static_cast<C>(value) * scale - offset);
  };
  if (stride == static_cast<std::ptrdiff_t>(sizeof(T))) {
    for (std::uint32_t k = 0; k < count; ++k) to[k] = convert(from + k * sizeof(T));
  } else {
    for (std::uint32_t k = 0; k < count; ++k)
      to[k] = convert(from + static_cast<std::ptrdiff_t>(k) * stride);
  }
}

void convert_axis(const GaugeTable& t, const PointView& v, std::uint64_t first, std::uint32_t count,
                  unsigned axis, float* to) {
  const std::byte* p = v.address(first, axis);
  const double s = t.scale[axis];
  const double o = t.offset[axis];
  if (v.scalar == ScalarType::f32 && t.single_precision)
    return convert_axis<float, float>(p, v.point_stride, count, t.scale_f32[axis],
                                      t.offset_f32[axis], to);
  with_scalar(v.scalar, [&](auto zero) {
    convert_axis<double, decltype(zero)>(p, v.point_stride, count, s, o, to);
  });
}

template <unsigned D>
std::size_t survivors_any(const GaugeTable& t, const GaugeCore* core, const PointView& v,
                          std::uint64_t begin, std::uint32_t count, std::uint32_t* ids) {
  Blocks<D> blocks(t, core, ids);
  constexpr std::size_t row = many + hn::MaxLanes(F());
  HWY_ALIGN float columns[D * row];
  for (std::uint32_t b = 0; b < count; b += many) {
    const std::uint32_t n = std::min(many, count - b);
    for (unsigned k = 0; k < D; ++k) {
      float* column = columns + k * row;
      convert_axis(t, v, begin + b, n, k, column);
      std::fill(column + n, column + n + hn::Lanes(F()), 0.0F);
    }
    for (std::uint32_t first = 0; first < n;) {
      const std::uint32_t some = std::min(blocks.room(), n - first);
      blocks.add(
          b + first, some,
          [&](std::uint32_t k, VF(&y)[D]) HWY_ATTR {
        for (unsigned j = 0; j < D; ++j) y[j] = hn::LoadU(F(), columns + j * row + first + k);
          },
          [](std::uint32_t) HWY_ATTR {});
      first += some;
    }
  }
  return blocks.finish();
}

template <unsigned D>
std::size_t survivors_in(const GaugeTable& t, const GaugeCore* core, const PointView& v,
                         std::uint64_t begin, std::uint32_t count, std::uint32_t* ids) {
  const std::byte* p = v.address(begin, 0);
  const auto aligned = [&](std::size_t a) { return reinterpret_cast<std::uintptr_t>(p) % a == 0; };
  if (v.packed_rows() && v.scalar == ScalarType::f64 && aligned(alignof(double)))
    return survivors_rows<D, double>(t, core, reinterpret_cast<const double*>(p), t.scale, t.offset,
                                     count, ids);
  if (v.packed_rows() && v.scalar == ScalarType::f32 && aligned(alignof(float)) &&
      t.single_precision)
    return survivors_rows<D, float>(t, core, reinterpret_cast<const float*>(p), t.scale_f32,
                                    t.offset_f32, count, ids);
  return survivors_any<D>(t, core, v, begin, count, ids);
}

/// Calls take(k, y) for the vectors of `count` packed rows.
template <unsigned D, class Take>
HWY_INLINE void each_vector(const GaugeTable& t, const double* data, std::uint32_t count,
                            const Take& take) {
  const RowPattern<D, double> pattern(t.scale, t.offset);
  HWY_ALIGN float rows[(many + hn::MaxLanes(F())) * D];
  for (std::uint32_t b = 0; b < count; b += many) {
    const std::uint32_t n = std::min(many, count - b);
    convert_rows<D, double>(pattern, data + std::size_t{b} * D, n, rows);
    for (std::uint32_t k = 0; k < n; k += static_cast<std::uint32_t>(hn::Lanes(F()))) {
      VF y[D];
      load_rows<D>(rows + std::size_t{k} * D, y);
      take(b + k, y);
    }
  }
}

}  // namespace

void bounds(const GaugeTable& t, const double* rows, std::uint32_t count, float* out) {
  with_dimension<2, 5, 6>(t.dimension, [&](auto d) {
    each_vector<d>(t, rows, count, [&](std::uint32_t k, const VF(&y)[d]) HWY_ATTR {
      hn::StoreU(gauge_bound<d>(t, t.nodes.data(), y), F(), out + k);
    });
  });
}

void corners(const GaugeTable& t, const double* rows, std::uint32_t count, std::uint32_t* out) {
  with_dimension<2, 5, 6>(t.dimension, [&](auto d) {
    each_vector<d>(t, rows, count, [&](std::uint32_t k, const VF(&y)[d]) HWY_ATTR {
      VF fraction[d - 1];
      hn::StoreU(corner_of<d>(t, direction_of<d>(y), fraction), U(), out + k);
    });
  });
}

std::size_t survivors(const GaugeTable& t, const GaugeCore* core, const PointView& v,
                      std::uint64_t begin, std::uint64_t end, std::uint32_t* ids) {
  const auto count = static_cast<std::uint32_t>(end - begin);
  return with_dimension<2, 5, 6>(
      t.dimension, [&](auto d) { return survivors_in<d>(t, core, v, begin, count, ids); });
}

}  // namespace cullhull::internal::HWY_NAMESPACE
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace cullhull::internal {

HWY_EXPORT(survivors);
HWY_EXPORT(bounds);
HWY_EXPORT(corners);

void gauge_corners(const GaugeTable& table, const double* rows, std::uint32_t count,
                   std::uint32_t* corners) {
  HWY_DYNAMIC_DISPATCH(corners)(table, rows, count, corners);
}

void gauge_bounds(const GaugeTable& table, const double* rows, std::uint32_t count, float* out) {
  HWY_DYNAMIC_DISPATCH(bounds)(table, rows, count, out);
}

std::size_t gauge_survivors(const GaugeTable& table, const PointView& points, std::uint64_t begin,
                            std::uint64_t end, std::uint32_t* ids, const GaugeCore* core) {
  return HWY_DYNAMIC_DISPATCH(survivors)(table, core, points, begin, end, ids);
}

}  // namespace cullhull::internal
#endif
