// Coordinates of points as exact integers, for determinants without rounding.
#pragma once

#include <gmp.h>

#include <algorithm>
#include <bit>
#include <cstdint>
#include <cstdlib>
#include <vector>

#include "exact/numbers/double_parts.hpp"

namespace cullhull::internal {

inline int bit_length(std::uint64_t v) { return 64 - std::countl_zero(v); }

/// Sets out to v / 2^unit, an integer. Requires v = 0 or unit <= v.exponent. GMP takes integers as
/// `long`, which holds no mantissa of 53 bits on Windows; a double holds each.
inline void set_in_units(mpz_ptr out, const DoubleParts& v, long unit) {
  if constexpr (sizeof(long) == sizeof v.mantissa)
    mpz_set_si(out, static_cast<long>(v.mantissa));
  else
    mpz_set_d(out, static_cast<double>(v.mantissa));
  if (v.mantissa != 0) mpz_mul_2exp(out, out, static_cast<mp_bitcnt_t>(v.exponent - unit));
}

/// An mpz_t that is freed by its destructor.
struct Big {
  Big() { mpz_init(value); }
  ~Big() { mpz_clear(value); }
  Big(const Big&) = delete;
  Big& operator=(const Big&) = delete;
  mpz_t value;
};

// Example: the values 0.5, 3 and -1.25 of an axis are 2, 12 and -5 in units of 2^-2. Dividing a
// column by a positive number changes no sign of a determinant, so each axis has a unit of its own:
// one axis in metres and one in nanometres need not be brought to one scale.

/// Coordinates of points as exact integers, column j in units of 2^exponent(j).
class IntegerPoints {
 public:
  /// Points may be given in two arrays: `count` at p, then `more_count` at more.
  IntegerPoints(unsigned d, const double* const* p, unsigned count,
                const double* const* more = nullptr, unsigned more_count = 0)
      : d_(d) {
    const std::size_t size = std::size_t{count + more_count} * d;
    if (size > few) {
      many_.resize(size);
      many_exponents_.resize(d);
      scaled_ = many_.data();
      exponent_ = many_exponents_.data();
    }
    for (unsigned j = 0; j < d; ++j) {
      int low = 0, high = 0;
      bool any = false;
      for (unsigned i = 0; i < count + more_count; ++i) {
        const DoubleParts s = double_parts(i < count ? p[i][j] : more[i - count][j]);
        scaled_[std::size_t{i} * d + j] = s;
        if (s.mantissa == 0) continue;
        const int top = s.exponent + bit_length(static_cast<std::uint64_t>(std::abs(s.mantissa)));
        low = any ? std::min(low, s.exponent) : s.exponent;
        high = any ? std::max(high, top) : top;
        any = true;
      }
      exponent_[j] = low;
      bits_ = std::max(bits_, high - low);
    }
  }
  IntegerPoints(const IntegerPoints&) = delete;
  IntegerPoints& operator=(const IntegerPoints&) = delete;
  unsigned dimension() const { return d_; }
  /// Every coordinate is below 2^bits() in magnitude.
  int bits() const { return bits_; }
  int exponent(unsigned j) const { return exponent_[j]; }

  /// Requires bits() <= 62.
  std::int64_t small(unsigned i, unsigned j) const {
    const DoubleParts& s = scaled_[std::size_t{i} * d_ + j];
    return s.mantissa == 0 ? 0 : s.mantissa * (std::int64_t{1} << (s.exponent - exponent_[j]));
  }
  void big(unsigned i, unsigned j, mpz_ptr out) const {
    set_in_units(out, scaled_[std::size_t{i} * d_ + j], exponent_[j]);
  }

 private:
  static constexpr std::size_t few = 12;  // four points in space

  unsigned d_;
  int bits_ = 0;
  DoubleParts few_[few];
  int few_exponents_[few];
  std::vector<DoubleParts> many_;
  std::vector<int> many_exponents_;
  DoubleParts* scaled_ = few_;
  int* exponent_ = few_exponents_;
};

// Differences have at most one bit more than coordinates: with bits() <= 61 they fit 64-bit
// integers, and determinants of 128 bits can be tried.

/// The matrix of an orientation, with rows p[i] - p[0].
class Differences {
 public:
  Differences(unsigned d, const double* const* p, unsigned rows) : points_(d, p, rows + 1) {}
  unsigned columns() const { return points_.dimension(); }
  bool narrow() const { return points_.bits() <= 62; }  // then a difference fits 64 bits
  int exponent(unsigned j) const { return points_.exponent(j); }
  std::int64_t small(unsigned i, unsigned j) const {
    return points_.small(i + 1, j) - points_.small(0, j);
  }
  void big(unsigned i, unsigned j, mpz_ptr out, mpz_ptr scratch) const {
    points_.big(i + 1, j, out);
    points_.big(0, j, scratch);
    mpz_sub(out, out, scratch);
  }

 private:
  IntegerPoints points_;
};

}  // namespace cullhull::internal
