// Floats of 4352 bits with an exponent that cannot overflow here: any difference of doubles and any
// product of two such differences is exact.
#pragma once

#include <gmpxx.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace cullhull::internal::inline exact {

class ExactFloat {
 public:
  /// Doubles span 2^-1074 to 2^1024: products of two differences take at most 2 * 2098 bits.
  static constexpr mp_bitcnt_t bits = 4352;

  ExactFloat(double v = 0) {  // NOLINT: every finite double is one
    mpf_init2(v_, bits);
    mpf_set_d(v_, v);
  }
  explicit ExactFloat(const mpz_class& v) {
    mpf_init2(v_, bits);
    mpf_set_z(v_, v.get_mpz_t());
  }
  ExactFloat(const ExactFloat& o) {
    mpf_init2(v_, bits);
    mpf_set(v_, o.v_);
  }
  ExactFloat& operator=(const ExactFloat& o) {
    mpf_set(v_, o.v_);
    return *this;
  }
  ~ExactFloat() { mpf_clear(v_); }

  friend ExactFloat operator+(const ExactFloat& a, const ExactFloat& b) {
    return apply(mpf_add, a, b);
  }
  friend ExactFloat operator-(const ExactFloat& a, const ExactFloat& b) {
    return apply(mpf_sub, a, b);
  }
  friend ExactFloat operator*(const ExactFloat& a, const ExactFloat& b) {
    return apply(mpf_mul, a, b);
  }
  friend ExactFloat operator/(const ExactFloat& a, const ExactFloat& b) {
    return apply(mpf_div, a, b);
  }
  ExactFloat operator-() const { return ExactFloat() - *this; }
  friend bool operator>(const ExactFloat& a, const ExactFloat& b) {
    return mpf_cmp(a.v_, b.v_) > 0;
  }
  bool zero() const { return mpf_sgn(v_) == 0; }
  ExactFloat magnitude() const {
    ExactFloat r;
    mpf_abs(r.v_, v_);
    return r;
  }
  ExactFloat root() const {
    ExactFloat r;
    mpf_sqrt(r.v_, v_);
    return r;
  }
  ExactFloat times_power_of_two(long e) const {
    ExactFloat r;
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
    const ExactFloat rest = *this - ExactFloat(mantissa).times_power_of_two(exponent);
    if (!rest.zero()) {
      const double r = mpf_get_d_2exp(&rest_exponent, rest.v_);
      mantissa += std::ldexp(r, static_cast<int>(std::max(rest_exponent - exponent, -500L)));
    }
    return std::ldexp(mantissa, static_cast<int>(std::clamp(exponent + shift, -5000L, 5000L)));
  }

 private:
  static ExactFloat apply(void (*op)(mpf_ptr, mpf_srcptr, mpf_srcptr), const ExactFloat& a,
                          const ExactFloat& b) {
    ExactFloat r;
    op(r.v_, a.v_, b.v_);
    return r;
  }
  mpf_t v_;
};

}  // namespace cullhull::internal::inline exact
