// Floats of many bits with an exponent that cannot overflow here. Of ExactFloat any difference of
// doubles and any product of two such differences is exact.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "exact/numbers/gmpxx.hpp"

namespace cullhull::internal {

/// A float of `bits` bits: an operation's result is cut off there, unless it is exact.
template <mp_bitcnt_t bits>
class WideFloat {
 public:
  WideFloat(double v = 0) {  // NOLINT: every finite double is one
    mpf_init2(v_, bits);
    mpf_set_d(v_, v);
  }
  explicit WideFloat(const mpz_class& v) {
    mpf_init2(v_, bits);
    mpf_set_z(v_, v.get_mpz_t());
  }
  template <mp_bitcnt_t others>
  explicit WideFloat(const WideFloat<others>& v) {
    mpf_init2(v_, bits);
    mpf_set(v_, v.v_);
  }
  WideFloat(const WideFloat& o) {
    mpf_init2(v_, bits);
    mpf_set(v_, o.v_);
  }
  WideFloat& operator=(const WideFloat& o) {
    mpf_set(v_, o.v_);
    return *this;
  }
  ~WideFloat() { mpf_clear(v_); }

  friend WideFloat operator+(const WideFloat& a, const WideFloat& b) {
    return apply(mpf_add, a, b);
  }
  friend WideFloat operator-(const WideFloat& a, const WideFloat& b) {
    return apply(mpf_sub, a, b);
  }
  friend WideFloat operator*(const WideFloat& a, const WideFloat& b) {
    return apply(mpf_mul, a, b);
  }
  friend WideFloat operator/(const WideFloat& a, const WideFloat& b) {
    return apply(mpf_div, a, b);
  }
  WideFloat operator-() const { return WideFloat() - *this; }
  friend bool operator>(const WideFloat& a, const WideFloat& b) { return mpf_cmp(a.v_, b.v_) > 0; }
  bool zero() const { return mpf_sgn(v_) == 0; }
  WideFloat magnitude() const {
    WideFloat r;
    mpf_abs(r.v_, v_);
    return r;
  }
  WideFloat root() const {
    WideFloat r;
    mpf_sqrt(r.v_, v_);
    return r;
  }
  WideFloat times_power_of_two(long e) const {
    WideFloat r;
    if (e >= 0)
      mpf_mul_2exp(r.v_, v_, static_cast<mp_bitcnt_t>(e));
    else
      mpf_div_2exp(r.v_, v_, static_cast<mp_bitcnt_t>(-e));
    return r;
  }
  /// Returns value * 2^shift, rounded to nearest, infinity on overflow.
  double to_double(long shift = 0) const {
    long exponent = 0, rest_exponent = 0;
    double mantissa = mpf_get_d_2exp(&exponent, v_);  // truncated
    const WideFloat rest = *this - WideFloat(mantissa).times_power_of_two(exponent);
    if (!rest.zero()) {
      const double r = mpf_get_d_2exp(&rest_exponent, rest.v_);
      mantissa += std::ldexp(r, static_cast<int>(std::max(rest_exponent - exponent, -500L)));
    }
    return std::ldexp(mantissa, static_cast<int>(std::clamp(exponent + shift, -5000L, 5000L)));
  }

 private:
  template <mp_bitcnt_t others>
  friend class WideFloat;

  static WideFloat apply(void (*op)(mpf_ptr, mpf_srcptr, mpf_srcptr), const WideFloat& a,
                         const WideFloat& b) {
    WideFloat r;
    op(r.v_, a.v_, b.v_);
    return r;
  }
  mpf_t v_;
};

// The count of bits: a difference of two doubles is a multiple of 2^-1074 below 2^1025, so 4352
// bits hold a product of two of them with more than 100 to spare for sums. Example: (2^1000 -
// 2^-1000)^2 has bits from 2^-2000 to 2^2000 and is held exactly.

/// Doubles span 2^-1074 to 2^1024: products of two differences take at most 2 * 2098 bits.
using ExactFloat = WideFloat<4352>;
/// For products, quotients and roots of exact values, and sums without cancellation, that become
/// doubles: of 320 bits all but a few are right, and a hull of few points in a flat takes half of
/// the time that it takes with ExactFloat.
using RoundedFloat = WideFloat<320>;

}  // namespace cullhull::internal
