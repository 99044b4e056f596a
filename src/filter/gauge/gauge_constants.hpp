// The constants that all ways to build a GaugeMap's table share: docs/exactness.md, "GaugeMap".
#pragma once

#include <cmath>
#include <cstdint>
#include <limits>

#include "filter/gauge/gauge_table.hpp"

namespace cullhull::internal::inline filter {

/// Smallest float >= v.
inline float round_up(double v) {
  const auto f = static_cast<float>(v);
  return static_cast<double>(f) >= v ? f
                                     : std::nextafter(f, std::numeric_limits<float>::infinity());
}

/// What the kernel's roundings may add to a gauge (G3), to be added to every node.
inline double gauge_allowance(unsigned d, double lipschitz) {
  return (1 + 0x1p-40) * lipschitz * ((d - 1) * 0x1p-19 + d * 0x1p-23);
}
/// With a larger allowance hardly a point would be culled, since gauges below 1 are dropped.
inline constexpr double most_gauge_allowance = 0.25;

/// Fills all but the nodes, of which a face has `face`; dimension and cells are set already.
inline void fill_gauge_constants(GaugeTable& t, const double* centre, const double* scale,
                                 std::uint64_t face) {
  const unsigned d = t.dimension;
  t.single_precision = true;
  for (unsigned j = 0; j < d; ++j) {
    t.scale[j] = scale[j];
    t.offset[j] = centre[j] * scale[j];
    t.scale_f32[j] = static_cast<float>(t.scale[j]);
    t.offset_f32[j] = static_cast<float>(t.offset[j]);
    t.single_precision = t.single_precision && t.scale[j] >= 0x1p-120 && t.scale[j] <= 0x1p120 &&
                         static_cast<double>(t.offset_f32[j]) == t.offset[j];
  }
  t.middle = static_cast<float>(t.cells) / 2;
  t.half_cells = t.middle * (1 - 0x1p-20F);
  std::uint64_t corners = 0, stride = 1;
  for (unsigned k = 0; k + 1 < d; ++k, stride *= t.cells + 1) {
    t.stride[k] = static_cast<float>(stride);
    corners += stride;
  }
  t.face_stride = static_cast<float>(face);
  t.last_corner = static_cast<std::uint32_t>(2 * d * face - 1 - corners);
  t.threshold = 1 - (static_cast<float>(d) + 6) * 0x1p-23F;
}

}  // namespace cullhull::internal::inline filter
