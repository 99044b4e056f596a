// The points that engines get: for hulls packed doubles, scaled so that filters cannot overflow;
// for triangulations rows in insertion order that contain everything their lifts need.
//
// Why scaling by powers of two: it changes no bit of a mantissa, so unless a number becomes
// subnormal the scaled points decide as the given ones do. Example: longitudes 7.1 to 7.2, all of
// one sign and within a factor of two, are shifted by 7.1 exactly (Sterbenz) and scaled to [-1, 1];
// the bounds that assume |x| <= 1 then apply with the extent, not the offset, as their size.
#pragma once

#include <cstdint>
#include <vector>

#include "cullhull/array.hpp"
#include "cullhull/point_view.hpp"

namespace cullhull::internal {

/// Row-major doubles. Each axis is translated (only if that is exact) and scaled by a power of two,
/// so that |x| <= 1; the hull's combinatorics do not change under such a map. `exact` equals
/// `coordinates` unless scaling made something underflow (1e308 beside 1e-308): then `exact` points
/// to the unscaled points, and `coordinates` is off by at most 2^-1074 per coordinate, which
/// filters cover by an absolute term. Only where it says so, `coordinates` may be an image.
struct LocalPoints {
  unsigned dimension = 0;
  std::uint32_t count = 0;
  const double* coordinates = nullptr;
  const double* exact = nullptr;
  /// More than underflow: `coordinates` are within this of an affine image of `exact`
  /// (Unflattened).
  double coordinate_error = 0;
  /// Every operation of a d x d determinant of differences is exact in doubles (small integer
  /// grids).
  bool small_lattice = false;

  const double* row(std::uint32_t i) const { return coordinates + std::size_t{i} * dimension; }
  const double* exact_row(std::uint32_t i) const { return exact + std::size_t{i} * dimension; }
};

/// The points of a triangulation for the engine: in insertion order, each row with the data of its
/// lift. The lift itself, |x|^2 - w, is never rounded: it exists only in predicates.
struct LiftedPoints {
  unsigned base = 0;   ///< k: orientation uses the first k numbers of a row
  unsigned width = 0;  ///< d >= k: the lift is the sum of the first d squares
  unsigned stride = 0;
  std::uint32_t count = 0;
  bool weighted = false;  ///< the number after the width is the weight
  bool furthest = false;  ///< the lift is negated
  /// Some points may not become vertices: weights, or the upper hull.
  bool may_hide = false;
  /// Coordinates are at most 2^l in magnitude and weights 2^(2 l), l as below, so that no filter
  /// can overflow. If false, signs are computed exactly at once.
  bool filtered = false;
  /// More than underflow adds to a filter's determinant: 2^-1000 if l = 0, and 2^(-1000 + (k + 2)
  /// l) if small coordinates prevent scaling large ones down.
  double tiny = 0x1p-1000;
  /// Doubles compute an in-sphere determinant without rounding if the product of the largest
  /// magnitudes of its columns is at most this: 2^53 units of a lattice that contains all points
  /// and weights; 0: no such lattice.
  double exact_limit = 0;
  double exact_orientation_limit = 0;  ///< the same for an orientation

  /// If most points are nearly on one sphere (find_common_sphere), the power |x - c|^2 - r^2 of
  /// each point, off by at most 2^-53 of its magnitude and power_error: a lift of small numbers.
  /// Never beside a lattice.
  Array<double> powers;
  static constexpr double power_error = 0x1p-94;

  Array<double> rows;
  Array<std::uint32_t> ids;  ///< the caller's ids, in insertion order

  const double* row(std::uint32_t i) const { return rows.data() + std::size_t{i} * stride; }
};

}  // namespace cullhull::internal
