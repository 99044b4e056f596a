// In-sphere and power tests as determinants of integers.
#pragma once

#include <gmp.h>

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "exact/determinants/determinant_sign.hpp"
#include "exact/numbers/double_parts.hpp"
#include "exact/points/integer_points.hpp"

namespace cullhull::internal {

// Example: points with coordinates 0.5, 0.75 and 2 have e = -2: integers 2, 3 and 8. Lifts are in
// units of 2^-4: 4, 9 and 64. A determinant of k coordinates and a lift is then an integer times
// 2^(e (k + 2)), and its sign that of the integer. With 20-bit coordinates in 3D, entries have 21,
// 21, 21 and 42 bits and 4! has 5: 110 <= 126, so 128-bit integers suffice.

/// The matrix of an in-sphere or power test: rows c_1 - c_0, ..., c_k - c_0, p - c_0, each with the
/// difference of the lifts |x|^2 - w as its last entry. A point consists of k coordinates, then
/// those up to `width` that only the lift uses, then, if weighted, the weight. Coordinates are in
/// units of 2^e, one e for all axes, lifts and weights in units of 2^(2 e).
class LiftedRows {
 public:
  LiftedRows(unsigned k, unsigned width, bool weighted, const double* const* c, const double* p)
      : k_(k), d_(width), weighted_(weighted), count_(k + 2) {
    thread_local std::vector<DoubleParts> kept;
    parts_ = &kept;
    kept.resize(std::size_t{count_} * (d_ + 1));
    int low = 0, high = 0;
    bool any = false;
    const auto widen = [&](int bottom, int top) {
      low = any ? std::min(low, bottom) : bottom;
      high = any ? std::max(high, top) : top;
      any = true;
    };
    for (unsigned i = 0; i < count_; ++i) {
      const double* row = i <= k_ ? c[i] : p;
      for (unsigned j = 0; j < d_ + (weighted_ ? 1U : 0U); ++j) {
        const DoubleParts v = double_parts(row[j]);
        kept[std::size_t{i} * (d_ + 1) + j] = v;
        if (v.mantissa == 0) continue;
        const int top = v.exponent + bit_length(static_cast<std::uint64_t>(std::abs(v.mantissa)));
        if (j < d_)
          widen(v.exponent, top);
        else
          widen(floor_half(v.exponent), floor_half(top + 1));
      }
    }
    unit_ = low;
    // Differences of coordinates below 2^(bits + 1), a lift's terms below 2^(2 bits + 2): d + 2 of
    // them stay below 2^62.
    narrow_ = 2 * (high - low) + 2 + bit_length(d_ + 2) <= 62;
  }

  unsigned columns() const { return k_ + 1; }
  bool narrow() const { return narrow_; }
  std::int64_t small(unsigned i, unsigned j) const {
    if (j < k_) return small_at(i + 1, j, unit_) - small_at(0, j, unit_);
    std::int64_t sum = 0;
    for (unsigned a = 0; a < d_; ++a) {
      const std::int64_t v = small_at(i + 1, a, unit_) - small_at(0, a, unit_);
      sum += v * v;
    }
    if (weighted_) sum -= small_at(i + 1, d_, 2 * unit_) - small_at(0, d_, 2 * unit_);
    return sum;
  }
  void big(unsigned i, unsigned j, mpz_ptr out, mpz_ptr scratch) const {
    if (j < k_) return big_difference(i, j, unit_, out, scratch);
    thread_local Big sum, term;
    mpz_set_ui(sum.value, 0);
    for (unsigned a = 0; a < d_; ++a) {
      big_difference(i, a, unit_, term.value, scratch);
      mpz_addmul(sum.value, term.value, term.value);
    }
    if (weighted_) {
      big_difference(i, d_, 2 * unit_, term.value, scratch);
      mpz_sub(sum.value, sum.value, term.value);
    }
    mpz_set(out, sum.value);
  }

 private:
  static int floor_half(int v) { return v >= 0 ? v / 2 : -((1 - v) / 2); }
  const DoubleParts& part(unsigned i, unsigned j) const {
    return (*parts_)[std::size_t{i} * (d_ + 1) + j];
  }
  std::int64_t small_at(unsigned i, unsigned j, int unit) const {
    const DoubleParts& v = part(i, j);
    return v.mantissa == 0 ? 0 : v.mantissa * (std::int64_t{1} << (v.exponent - unit));
  }
  void big_at(unsigned i, unsigned j, int unit, mpz_ptr out) const {
    set_in_units(out, part(i, j), unit);
  }
  void big_difference(unsigned i, unsigned j, int unit, mpz_ptr out, mpz_ptr scratch) const {
    big_at(i + 1, j, unit, out);
    big_at(0, j, unit, scratch);
    mpz_sub(out, out, scratch);
  }

  unsigned k_, d_;
  bool weighted_;
  unsigned count_;
  std::vector<DoubleParts>* parts_;
  int unit_ = 0;
  bool narrow_ = false;
};

}  // namespace cullhull::internal
