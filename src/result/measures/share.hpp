// A facet's share of the measures, and the measures from the sum of all shares: one text for the
// host and for devices, since the order of operations is part of the canonical result.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

#include "exact/numbers/double_double.hpp"
#include "parallel/host_device.hpp"

namespace cullhull::internal {

/// v 2^e; a multiplication if 2^e is a normal double.
CULLHULL_HD_INLINE double scale_by(double v, int e) {
  return e > -1022 && e < 1023
             ? v * std::bit_cast<double>(static_cast<std::uint64_t>(e + 1023) << 52)
             : std::ldexp(v, e);
}

/// A normal shorter than this fraction of the product of its edges' lengths is computed again with
/// more bits. So the direction of a normal is off by about 2^-38 rad at most, usually far less.
inline constexpr double conditioned = 0x1p-12;

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
  CULLHULL_HD void add(const Share<K, Other>& o) {
    volume = volume + Real(o.volume);
    area = area + Real(o.area);
    for (unsigned c = 0; c < K; ++c) moment[c] = moment[c] + Real(o.moment[c]);
    error += o.error;
    area_error += o.area_error;
  }
};

/// Whether the sums are accurate enough: neither rounding errors of relative size `unit` nor
/// underflow (below 2^-1022 for each product) can show in the measures. Sums: a Share or Totals.
template <class Sums>
CULLHULL_HD_INLINE bool settled(const Sums& t, double unit) {
  constexpr double tolerance = 0x1p-42, far_from_underflow = 0x1p-900;
  const double volume = t.volume.value(), area = t.area.value();
  return t.error * unit <= tolerance * volume && t.area_error * unit <= tolerance * area &&
         volume > far_from_underflow && area > far_from_underflow;
}

/// Rounds v, known to within `error`, times 2^shift to a double `out`. Returns false if the
/// rounding is uncertain or the result is near overflow or underflow. If it returns true, every
/// more precise arithmetic gives the same double.
CULLHULL_HD_INLINE bool round_surely(const DoubleDouble& v, double error, long shift, double& out) {
  const double low = v.high + (v.low - error), high = v.high + (v.low + error);
  if (low != high || !(std::fabs(low) > 0x1p-400 && std::fabs(low) < 0x1p400) || shift < -400 ||
      shift > 400)
    return false;
  out = scale_by(low, static_cast<int>(shift));
  return true;
}

/// Bounds the relative error of quotients and sums of double-doubles, which is a few units of
/// 2^-104, with a wide margin.
inline constexpr double double_double_error = 0x1p-96;

/// Whether q m = v exactly, for q = v / m rounded. Since q is so near the quotient, the difference
/// v.high - fl(q.high m) and the products' rounding errors are exact. Two double-doubles are equal
/// if and only if both their parts are.
CULLHULL_HD_INLINE bool is_quotient(const DoubleDouble& q, double m, const DoubleDouble& v) {
  const DoubleDouble high = DoubleDouble::product(q.high, m), low = DoubleDouble::product(q.low, m);
  const DoubleDouble rest = DoubleDouble::sum((v.high - high.high) - high.low, v.low);
  return rest.high == low.high && rest.low == low.low;
}

/// The largest magnitude of the exponent for which finish_quickly computes anything.
inline constexpr int most_quick_exponent = 40;

/// Computes volume, area and centroid in full dimension k from sums over coordinates in units of
/// 2^exponent; `origin` is vertex 0 in the same units. Returns false if the rounding of a result is
/// uncertain. Then the outputs are not valid.
CULLHULL_HD_INLINE bool finish_quickly(unsigned k, int exponent, const double* origin,
                                       const DoubleDouble& volume, const DoubleDouble& area,
                                       const DoubleDouble* moment, double* volume_out,
                                       double* area_out, double* centroid_out) {
  if (k > 8 || exponent < -most_quick_exponent || exponent > most_quick_exponent) return false;
  double factorial = 1;
  for (unsigned i = 2; i < k; ++i) factorial *= i;
  // For k <= 3 the division by (k - 1)!, 1 or 2, is exact. This matters because a sum of two runs
  // is often half-way between two doubles, and then rounds surely only without error.
  const bool exact = k <= 3;
  const DoubleDouble share = exact ? DoubleDouble(area.high / factorial, area.low / factorial)
                                   : area / DoubleDouble(factorial);
  const double share_error = exact ? 0 : double_double_error * std::fabs(share.high);
  // One sum of few runs in three is divisible by 3, and its quotient may be half-way, too.
  const DoubleDouble content = volume / DoubleDouble(factorial * k);
  const double content_error = is_quotient(content, factorial * k, volume)
                                   ? 0
                                   : double_double_error * std::fabs(content.high);
  if (!round_surely(share, share_error, exponent * (k - 1L), *area_out) ||
      !round_surely(content, content_error, exponent * static_cast<long>(k), *volume_out))
    return false;
  const DoubleDouble weight = volume * DoubleDouble(k + 1.0);
  for (unsigned c = 0; c < k; ++c) {
    const DoubleDouble shift = moment[c] / weight;
    // The origin's coordinates are in units of 2^exponent, which leaves the significand of a normal
    // double unchanged.
    const DoubleDouble from(origin[c]);
    if (from.high != 0 && std::fabs(from.high) < 0x1p-900) return false;
    const double error = double_double_error * (std::fabs(shift.high) + std::fabs(from.high));
    if (!round_surely(from + shift, error, exponent, centroid_out[c])) return false;
  }
  return true;
}

}  // namespace cullhull::internal
