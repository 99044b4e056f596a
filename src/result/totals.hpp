// Sums over the simplices of a hull, and the measures they give.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "cullhull/hull.hpp"
#include "geometry/double_double.hpp"
#include "geometry/wide_float.hpp"
#include "result/measure_frame.hpp"

namespace cullhull::internal {

/// Short runs are added up in plain doubles, runs of a chunk in double-doubles, then the chunks:
/// the order is part of the canonical result.
inline constexpr std::uint64_t measure_run = 32;
inline constexpr std::uint64_t measure_chunk = std::uint64_t{1} << 13;

/// Sums over a run of simplices. `error` and `area_error` bound, up to a modest constant and in
/// units of the last place, what rounding may have done to `volume` and `area`.
template <class Sum>
struct Totals {
  Sum volume = 0, area = 0;
  std::vector<Sum> moment;
  double error = 0, area_error = 0;
  explicit Totals(unsigned d) : moment(d, Sum(0)) {}
  template <class Other>
  void add(const Totals<Other>& o) {
    volume = volume + Sum(o.volume);
    area = area + Sum(o.area);
    for (std::size_t c = 0; c < moment.size(); ++c) moment[c] = moment[c] + Sum(o.moment[c]);
    error += o.error;
    area_error += o.area_error;
  }
};

/// Whether rounding by `unit` and underflow (below 2^-1022 for each product) are harmless. Sums: as
/// Totals.
template <class Sums>
bool settled(const Sums& t, double unit) {
  constexpr double tolerance = 0x1p-42, far_from_underflow = 0x1p-900;
  const double volume = t.volume.value(), area = t.area.value();
  return t.error * unit <= tolerance * volume && t.area_error * unit <= tolerance * area &&
         volume > far_from_underflow && area > far_from_underflow;
}

/// Volume, area and centroid from sums in units of 2^exponent per coordinate.
void finish_measures(const Frame& frame, const Wide& volume, const Wide& area,
                     const std::vector<Wide>& moment, long exponent, Hull& hull);
/// The same for full dimension from double-doubles, `origin` being vertex 0 in the same units;
/// false where a rounding is in doubt.
bool finish_quickly(unsigned k, int exponent, const double* origin, const DoubleDouble& volume,
                    const DoubleDouble& area, const DoubleDouble* moment, double* volume_out,
                    double* area_out, double* centroid_out);
/// The same from sums on the frame's axes and in its units.
void finish_measures(const Frame& frame, const Totals<DoubleDouble>& sums, Hull& hull);

}  // namespace cullhull::internal
