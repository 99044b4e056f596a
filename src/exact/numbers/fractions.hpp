// Fractions that are never reduced: for sums of many terms that are rounded once, where finding
// common divisors would take most of the time.
#pragma once

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "exact/numbers/bounded.hpp"
#include "exact/numbers/gmpxx.hpp"
#include "exact/numbers/rationals.hpp"

namespace cullhull::internal {

// Example: volumes of parts of a cell are sums of a / D with one determinant D for all: 3 / 7 + 5 /
// 7 is 8 / 7 by one addition, where rational numbers would look for a common divisor each time, of
// integers with thousands of bits. A number is rounded once, at the end.

/// The number numerator / denominator * 2^exponent; the denominator is positive. Fractions divided
/// by the same number have the same denominator and are added without extending it.
class Fraction {
 public:
  Fraction() = default;
  explicit Fraction(double v) {
    if (v == 0) return;
    int exponent = 0;
    numerator_ = std::ldexp(std::frexp(v, &exponent), 53);
    exponent_ = exponent - 53;
  }

  const mpz_class& numerator() const { return numerator_; }
  const mpz_class& denominator() const { return denominator_; }
  long exponent() const { return exponent_; }

  friend Fraction operator*(const Fraction& a, const Fraction& b) {
    return {a.numerator_ * b.numerator_, product(a.denominator_, b.denominator_),
            a.exponent_ + b.exponent_};
  }
  friend Fraction operator/(const Fraction& a, const Fraction& b) {
    Fraction r{product(a.numerator_, b.denominator_), product(a.denominator_, b.numerator_),
               a.exponent_ - b.exponent_};
    if (sgn(r.denominator_) < 0) {
      r.numerator_ = -r.numerator_;
      r.denominator_ = -r.denominator_;
    }
    return r;
  }
  // Example: 3 / 4 * 2^0 + 1 / 4 * 2^2 is (3 + 1 * 2^2) / 4 * 2^0: one shift and one addition, as
  // the denominators are the same number.
  friend Fraction operator+(const Fraction& a, const Fraction& b) {
    if (a.is_zero()) return b;
    if (b.is_zero()) return a;
    const long exponent = std::min(a.exponent_, b.exponent_);
    if (a.denominator_ == b.denominator_)
      return {a.shifted(exponent) + b.shifted(exponent), a.denominator_, exponent};
    return {
        product(a.shifted(exponent), b.denominator_) + product(b.shifted(exponent), a.denominator_),
        product(a.denominator_, b.denominator_), exponent};
  }
  friend Fraction operator-(const Fraction& a) {
    return {-a.numerator_, a.denominator_, a.exponent_};
  }
  friend Fraction operator-(const Fraction& a, const Fraction& b) { return a + -b; }
  bool is_zero() const { return sgn(numerator_) == 0; }

 private:
  Fraction(mpz_class n, mpz_class d, long e)
      : numerator_(std::move(n)), denominator_(std::move(d)), exponent_(e) {}
  static mpz_class product(const mpz_class& a, const mpz_class& b) {
    if (a == 1) return b;
    return b == 1 ? a : mpz_class(a * b);
  }
  mpz_class shifted(long exponent) const {
    return numerator_ << static_cast<mp_bitcnt_t>(exponent_ - exponent);
  }

  mpz_class numerator_, denominator_ = 1;
  long exponent_ = 0;
};

template <>
inline Fraction exact_difference<Fraction>(double a, double b) {
  return Fraction(a) - Fraction(b);
}

/// A sum whose terms are stored one by one.
class FractionSum {
 public:
  explicit FractionSum(double) {}
  friend FractionSum operator+(FractionSum sum, Fraction f) {
    if (!f.is_zero()) sum.terms_.push_back(std::move(f));
    return sum;
  }
  friend FractionSum operator-(FractionSum sum, const Fraction& f) { return std::move(sum) + -f; }
  const std::vector<Fraction>& terms() const { return terms_; }

 private:
  std::vector<Fraction> terms_;
};

/// Returns each of some non-negative sums divided by the sum of all, as the nearest double. Returns
/// nothing if cancellation is so strong that `bits` bits from the largest term's first one do not
/// decide.
inline std::optional<std::vector<double>> nearest_shares(const std::vector<FractionSum>& sums,
                                                         long bits) {
  const auto size = [](const mpz_class& v) {
    return static_cast<long>(mpz_sizeinbase(v.get_mpz_t(), 2));
  };
  std::optional<long> most;  // every summand is below 2^most
  for (const FractionSum& sum : sums)
    for (const Fraction& f : sum.terms()) {
      const long e = size(f.numerator()) - size(f.denominator()) + 1 + f.exponent();
      most = std::max(most.value_or(e), e);
    }
  if (!most) return std::nullopt;
  // Rounds each term down to units of 2^(most - bits), so that a sum of n terms is too small by
  // less than n.
  std::vector<mpz_class> low;
  mpz_class low_of_all = 0, count = 0;
  for (const FractionSum& sum : sums) {
    low.emplace_back(0);
    for (const Fraction& f : sum.terms()) {
      const long shift = f.exponent() - (*most - bits);
      mpz_class n = f.numerator(), d = f.denominator(), whole;
      if (shift >= 0)
        n <<= static_cast<mp_bitcnt_t>(shift);
      else
        d <<= static_cast<mp_bitcnt_t>(-shift);
      mpz_fdiv_q(whole.get_mpz_t(), n.get_mpz_t(), d.get_mpz_t());
      low.back() += whole;
    }
    low_of_all += low.back();
    count += static_cast<unsigned long>(sum.terms().size());
  }
  if (sgn(low_of_all) <= 0) return std::nullopt;
  std::vector<double> shares;
  for (std::size_t i = 0; i < sums.size(); ++i) {
    const mpz_class least = sgn(low[i]) > 0 ? low[i] : mpz_class(0);
    const mpz_class most_of_it = low[i] + static_cast<unsigned long>(sums[i].terms().size());
    mpq_class from(least, low_of_all + count), to(most_of_it, low_of_all);
    from.canonicalize();
    to.canonicalize();
    shares.push_back(nearest_double(from));
    if (nearest_double(to) != shares.back()) return std::nullopt;
  }
  return shares;
}

}  // namespace cullhull::internal
