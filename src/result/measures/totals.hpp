// Sums over the simplices of a hull, and the measures computed from them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "cullhull/hull_fwd.hpp"
#include "exact/numbers/exact_float.hpp"
#include "result/measures/measure_frame.hpp"
#include "result/measures/share.hpp"

namespace cullhull::internal {

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

/// Computes volume, area and centroid from sums over coordinates in units of 2^exponent. `stretch`:
/// the ratio of the measures to those sums.
void finish_measures(const Frame& frame, const Totals<ExactFloat>& sums, const ExactFloat& stretch,
                     long exponent, Hull& hull);
/// The same from sums over the projection onto the frame's axes, in the frame's units.
void finish_measures(const Frame& frame, const Totals<DoubleDouble>& sums, Hull& hull);

}  // namespace cullhull::internal
