// Sums over the simplices of a hull, and the measures computed from them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "cullhull/hull.hpp"
#include "exact/numbers/double_double.hpp"
#include "exact/numbers/exact_float.hpp"
#include "result/measures/measure_frame.hpp"

namespace cullhull::internal::inline result {

/// Simplices in a run and in a chunk of the sums. A run is summed in doubles, the runs of a chunk
/// in double-doubles, and then the chunks. This order is part of the canonical result. 32 additions
/// of doubles lose at most 5 bits.
inline constexpr std::uint64_t measure_run = 32;
inline constexpr std::uint64_t measure_chunk = std::uint64_t{1} << 13;

/// Sums over simplices in R^K, or one simplex's share of them. The rounding errors of `volume` and
/// `area` are at most `error` and `area_error` times the unit roundoff and a modest constant.
template <unsigned K, class Real = double>
struct Share {
  Real volume = 0, area = 0;
  Real moment[K] = {};
  double error = 0, area_error = 0;

  template <class Other>
  void add(const Share<K, Other>& o) {
    volume = volume + Real(o.volume);
    area = area + Real(o.area);
    for (unsigned c = 0; c < K; ++c) moment[c] = moment[c] + Real(o.moment[c]);
    error += o.error;
    area_error += o.area_error;
  }
};

/// The shares of up to `room` triangles, stored as one array for each number.
template <unsigned room>
struct ShareArrays {
  alignas(64) double volume[room], area[room], moment[3][room], error[room], area_error[room];

  Share<3> at(std::size_t i) const {
    return {
        volume[i], area[i], {moment[0][i], moment[1][i], moment[2][i]}, error[i], area_error[i]};
  }
  void set(std::size_t i, const Share<3>& s) {
    volume[i] = s.volume;
    area[i] = s.area;
    for (unsigned c = 0; c < 3; ++c) moment[c][i] = s.moment[c];
    error[i] = s.error;
    area_error[i] = s.area_error;
  }
  /// The sum of the shares [begin, end), which form a run.
  Share<3> sum(std::size_t begin, std::size_t end) const {
    Share<3> run;
    for (std::size_t i = begin; i < end; ++i) run.add(at(i));
    return run;
  }
};

/// The same sums in any dimension, added in arithmetic of type Sum.
template <class Sum>
struct Totals {
  Sum volume = 0, area = 0;
  std::vector<Sum> moment;
  double error = 0, area_error = 0;
  explicit Totals(unsigned d) : moment(d, Sum(0)) {}
  template <unsigned K>
  explicit Totals(const Share<K, Sum>& s)
      : volume(s.volume),
        area(s.area),
        moment(s.moment, s.moment + K),
        error(s.error),
        area_error(s.area_error) {}
  void add(const Totals& o) {
    volume = volume + o.volume;
    area = area + o.area;
    for (std::size_t c = 0; c < moment.size(); ++c) moment[c] = moment[c] + o.moment[c];
    error += o.error;
    area_error += o.area_error;
  }
};

/// Whether the sums are accurate enough: neither rounding errors of relative size `unit` nor
/// underflow (below 2^-1022 for each product) can show in the measures. Sums: a Share or Totals.
template <class Sums>
bool settled(const Sums& t, double unit) {
  constexpr double tolerance = 0x1p-42, far_from_underflow = 0x1p-900;
  const double volume = t.volume.value(), area = t.area.value();
  return t.error * unit <= tolerance * volume && t.area_error * unit <= tolerance * area &&
         volume > far_from_underflow && area > far_from_underflow;
}

/// Computes volume, area and centroid from sums over coordinates in units of 2^exponent.
void finish_measures(const Frame& frame, const ExactFloat& volume, const ExactFloat& area,
                     const std::vector<ExactFloat>& moment, long exponent, Hull& hull);
/// The same in full dimension from double-doubles; `origin` is vertex 0 in the same units. Returns
/// false if the rounding of a result is uncertain. Then the outputs are not valid.
bool finish_quickly(unsigned k, int exponent, const double* origin, const DoubleDouble& volume,
                    const DoubleDouble& area, const DoubleDouble* moment, double* volume_out,
                    double* area_out, double* centroid_out);
/// The same from sums over the projection onto the frame's axes, in the frame's units.
void finish_measures(const Frame& frame, const Totals<DoubleDouble>& sums, Hull& hull);

}  // namespace cullhull::internal::inline result
