// Sums of fractions that are never reduced, against rational numbers.
#include "exact/numbers/fractions.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace cullhull::internal {
namespace fractions_test {

/// The same number both ways.
struct Twin {
  Fraction fraction;
  mpq_class exact;

  explicit Twin(double v) : fraction(v), exact(v) {}
  Twin(Fraction f, mpq_class q) : fraction(std::move(f)), exact(std::move(q)) {}
  friend Twin operator+(const Twin& a, const Twin& b) {
    return {a.fraction + b.fraction, a.exact + b.exact};
  }
  friend Twin operator-(const Twin& a, const Twin& b) {
    return {a.fraction - b.fraction, a.exact - b.exact};
  }
  friend Twin operator*(const Twin& a, const Twin& b) {
    return {a.fraction * b.fraction, a.exact * b.exact};
  }
  friend Twin operator/(const Twin& a, const Twin& b) {
    return {a.fraction / b.fraction, a.exact / b.exact};
  }
};

mpq_class value(const Fraction& f) {
  mpq_class q(f.numerator(), f.denominator());
  q.canonicalize();
  if (f.exponent() >= 0)
    mpq_mul_2exp(q.get_mpq_t(), q.get_mpq_t(), static_cast<mp_bitcnt_t>(f.exponent()));
  else
    mpq_div_2exp(q.get_mpq_t(), q.get_mpq_t(), static_cast<mp_bitcnt_t>(-f.exponent()));
  return q;
}

TEST(Fractions, AreTheNumbersThatRationalsAre) {
  std::mt19937_64 random(1);
  std::uniform_real_distribution<double> mantissa(-1, 1);
  for (const int range : {3, 1000}) {
    const auto number = [&] {
      const int e = static_cast<int>(random() % (2 * range + 1)) - range;
      return Twin(random() % 9 == 0 ? 0.0 : std::ldexp(mantissa(random), e));
    };
    for (int i = 0; i < 200; ++i) {
      const Twin a = number(), b = number(), c = number(), d = number();
      Twin result = a * b - c * d;
      if (c.exact != 0) result = result / c + (a - b) / c;
      if (result.exact != 0) result = result - Twin(1) / result;
      EXPECT_TRUE(value(result.fraction) == result.exact);
      EXPECT_TRUE(result.fraction.denominator() > 0);
      EXPECT_EQ(result.fraction.is_zero(), result.exact == 0);
    }
  }
  const Fraction third = Fraction(1) / Fraction(-3);
  EXPECT_TRUE((third + third).denominator() == third.denominator());  // one denominator stays one
  const mpq_class difference = mpq_class(1e300) - mpq_class(1e-300);
  EXPECT_TRUE(value(exact_difference<Fraction>(1e300, 1e-300)) == difference);
}

TEST(Fractions, SharesAreTheNearestDoubles) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> mantissa(0.5, 1);
  int decided = 0;
  for (int i = 0; i < 300; ++i) {
    const int range = i % 3 == 0 ? 1000 : 20;
    const auto number = [&] {
      const int e = static_cast<int>(random() % (2 * range + 1)) - range;
      return Twin(std::ldexp(mantissa(random), e));
    };
    std::vector<FractionSum> sums;
    std::vector<mpq_class> exact;
    mpq_class all = 0;
    for (int v = 0; v < 5; ++v) {
      const Twin kept = number() / number(), lost = number() * number() / number();
      sums.emplace_back(0);
      sums.back() = sums.back() + lost.fraction + kept.fraction - lost.fraction;
      exact.push_back(kept.exact);
      if (v == 4) sums.back() = sums.back() - kept.fraction;  // nothing is left
      if (v == 4) exact.back() = 0;
      all += exact.back();
    }
    const auto shares = nearest_shares(sums, i % 2 == 0 ? 4096 : 32768);
    if (!shares) continue;
    ++decided;
    for (int v = 0; v < 5; ++v) EXPECT_EQ((*shares)[v], nearest_double(exact[v] / all)) << i;
  }
  EXPECT_GT(decided, 250);
}

TEST(Fractions, WhatBitsDoNotDecideIsLeftToRationals) {
  const auto sum = [](double v) { return FractionSum(0) + Fraction(v); };
  // 1/2 + 2^-54 is between two doubles.
  EXPECT_FALSE(nearest_shares({sum(0x1p52) + Fraction(0.5), sum(0x1p52 - 0.5)}, 4096));
  const FractionSum nothing_left = sum(0x1p1000) - Fraction(0x1p1000);
  EXPECT_FALSE(nearest_shares({nothing_left, nothing_left}, 4096));
  EXPECT_FALSE(nearest_shares({FractionSum(0)}, 4096));
  EXPECT_EQ(nearest_shares({sum(0x1p1000) + Fraction(1) - Fraction(0x1p1000), sum(3)}, 4096),
            (std::vector<double>{0.25, 0.75}));
}

}  // namespace fractions_test
}  // namespace cullhull::internal
