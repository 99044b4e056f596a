// The engines' input: points as packed doubles, scaled so that filters cannot overflow.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/point_view.hpp"

namespace cullhull::internal::inline exact {

/// Row-major doubles. Each axis is translated (only where that is exact) and scaled by a power of
/// two, so that |x| <= 1; the hull's combinatorics do not change under such a map. `exact` equals
/// `coordinates` unless scaling made something underflow (1e308 beside 1e-308): then it holds the
/// points unscaled, and `coordinates` is off by at most 2^-1074 a coordinate, which filters cover
/// by an absolute term.
struct LocalPoints {
  unsigned dimension = 0;
  std::uint32_t count = 0;
  const double* coordinates = nullptr;
  const double* exact = nullptr;
  /// Every operation of a d x d determinant of differences is exact in doubles (small integer
  /// grids).
  bool small_lattice = false;
  /// The same for determinants of rows (d + 1) p - sum of d + 1 points.
  bool centroid_lattice = false;

  const double* row(std::uint32_t i) const { return coordinates + std::size_t{i} * dimension; }
  const double* exact_row(std::uint32_t i) const { return exact + std::size_t{i} * dimension; }
};

}  // namespace cullhull::internal::inline exact
