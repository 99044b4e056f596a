// A sphere that most of the points are on, up to the last bits of their coordinates.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "exact/insphere/circumcentre.hpp"
#include "exact/numbers/double_double.hpp"
#include "exact/points/local_points.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

// Why powers may replace squared distances: E(c, p), the determinant of "Lifting" in
// docs/exactness.md, does not change when an affine function of x is added to all lifts. |x|^2 and
// the power |x - c|^2 - r^2 differ by 2 c . x + const, so any centre c and radius r will do. Near
// the sphere powers are small, so rounding them costs little.
//
// The bound. Differences are exact as pairs, up to 3 in magnitude. k <= 6 squares of up to 9 err by
// 7 * 2^-106 of themselves, five sums and the difference of r^2 by 3 * 2^-106 of at most 54: less
// than 2^-95 in all. A power is then rounded to a double. A difference of two powers is off by at
// most u |difference| + u (|a| + |b|) + 2^-93 <= 2 u S with S = |a| + |b| + 4 * 2^-94 / u, and S
// takes the place of the lift's magnitude in the bounds (power_size).
//
// Example: directions on a unit sphere rounded to doubles have powers of about 1e-16. S is about
// 2e-16 + 1.8e-12, the bound of a test some 1e-25 of the cell's volume, while determinants are
// about 1e-16 of it: decided in doubles.

/// |x - centre|^2 within 2^-95, for coordinates of at most 1 and a centre of at most 2 in
/// magnitude, in up to six dimensions. docs/exactness.md, "Common spheres".
inline DoubleDouble squared_distance(const double* x, const std::vector<double>& centre) {
  DoubleDouble sum = 0.0;
  for (std::size_t j = 0; j < centre.size(); ++j) {
    const DoubleDouble v = DoubleDouble::sum(x[j], -centre[j]);
    sum = sum + v * v;
  }
  return sum;
}

/// Sets s.powers if at least half of the points are so close to the sphere through `simplex`, the
/// places of k + 1 independent points, that in-sphere tests with squared distances would not be
/// decided in doubles. The points then have no lattice. For 2 to 6 dimensions, full-dimensional
/// points without weights, in the scaled frame.
inline void find_common_sphere(LiftedPoints& s, const std::vector<std::uint32_t>& simplex,
                               const Run& run) {
  // For fewer points the exact centre takes longer than their in-sphere tests.
  constexpr std::uint32_t least_points = 256;
  constexpr double most_centre = 2;
  // Squared distances of about the square of the extent are rounded by 2^-53 of it: many roundings,
  // and cells of small volume. On float coordinates (2^-24) they decide all tests.
  constexpr double close = 0x1p-36;
  // In-sphere tests on a finer lattice are exact in doubles only for cells smaller than 2^-19.
  constexpr int finest_lattice = -30;
  const unsigned k = s.base;
  if (s.count < least_points || k < 2 || k > 6 || s.stride != k || s.may_hide || !s.filtered ||
      s.tiny > 0x1p-1000 ||
      s.exact_limit > std::ldexp(1.0, 53 + finest_lattice * static_cast<int>(k + 2)))
    return;
  std::vector<const double*> corners;
  for (const std::uint32_t place : simplex) corners.push_back(s.row(place));
  std::vector<double> centre(k);
  circumcentre(k, k, false, corners.data(), centre.data());
  for (const double c : centre)
    if (!(std::abs(c) <= most_centre)) return;
  const DoubleDouble squared_radius = squared_distance(corners[0], centre);
  const auto power = [&](std::uint32_t i) {
    return (squared_distance(s.row(i), centre) - squared_radius).value();
  };
  constexpr std::uint32_t sample = 64;
  std::vector<double> powers;
  double squared_extent = 0;
  for (std::uint32_t i = 0; i < sample; ++i) {
    const auto place = static_cast<std::uint32_t>(std::uint64_t{i} * s.count / sample);
    double square = 0;
    for (unsigned j = 0; j < k; ++j) square += std::pow(s.row(place)[j] - s.row(0)[j], 2);
    squared_extent = std::max(squared_extent, square);
    powers.push_back(std::abs(power(place)));
  }
  // The error of a power, 2^-94, has to be far below the distances from the sphere.
  constexpr double least_squared_extent = 0x1p-20;
  const auto on_sphere = std::count_if(powers.begin(), powers.end(),
                                       [&](double p) { return p <= close * squared_extent; });
  if (2 * on_sphere < sample || squared_extent < least_squared_extent) return;
  s.exact_limit = s.exact_orientation_limit = 0;
  s.powers.resize(s.count);
  run.each(s.count, light_grain, [&](std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) s.powers[i] = power(static_cast<std::uint32_t>(i));
  });
}

}  // namespace cullhull::internal
