// Pseudo-random numbers that are the same, bit for bit, on every machine. They are computed with
// + - * / and sqrt alone, which IEEE 754 rounds the same everywhere (with contraction off), and
// without std:: distributions or transcendental functions of libm, which differ between systems.
#pragma once

#include <cmath>
#include <cstdint>

namespace cullhull::internal {

/// A bijective hash of 64 bits whose output bits look random: SplitMix64's finaliser (Steele, Lea,
/// Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014).
constexpr std::uint64_t mix64(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9ULL;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebULL;
  return z ^ (z >> 31);
}

/// The natural logarithm of a positive normal number, with an error of a few ulps. x = m 2^e with m
/// near 1, and log m = 2 atanh(s) for s = (m - 1) / (m + 1), as a series. |s| <= 0.172, so the
/// first omitted term is below 2e-19 of the sum.
inline double portable_log(double x) {
  int exponent = 0;
  double m = std::frexp(x, &exponent);
  if (m < 0.70710678118654752) {
    m *= 2;
    --exponent;
  }
  const double s = (m - 1) / (m + 1);
  const double q = s * s;
  double sum = 0;
  for (int k = 23; k >= 1; k -= 2) sum = sum * q + 1.0 / k;
  return 2 * s * sum + exponent * 0.69314718055994531;
}

/// A stream of random numbers; every pair (seed, index) has its own. A loop that gives each chunk
/// the stream of its index draws the same numbers whichever thread runs the chunk.
class RandomStream {
 public:
  RandomStream(std::uint64_t seed, std::uint64_t index)
      : state_(mix64(mix64(seed + golden) ^ (index * 0xd1342543de82ef95ULL + golden))) {}

  /// 64 random bits.
  std::uint64_t bits() { return mix64(state_ += golden); }
  /// Uniform in [0, 1), a multiple of 2^-53.
  double unit() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  /// Uniform in [-1, 1), a multiple of 2^-52.
  double symmetric() { return unit() * 2 - 1; }
  /// An integer in [0, n) for 1 <= n <= 2^32; the bias is less than n 2^-32.
  std::uint64_t below(std::uint64_t n) { return ((bits() >> 32) * n) >> 32; }
  /// Exponentially distributed with mean 1; never 0.
  double exponential() {
    return -portable_log((static_cast<double>(bits() >> 11) + 0.5) * 0x1p-53);
  }
  /// Normally distributed with mean 0 and variance 1: Marsaglia's polar method, which needs no
  /// sine.
  double normal() {
    if (have_spare_) {
      have_spare_ = false;
      return spare_;
    }
    double u = 0, v = 0, s = 0;
    do {
      u = symmetric();
      v = symmetric();
      s = u * u + v * v;
    } while (s >= 1 || s == 0);
    const double f = std::sqrt(-2 * portable_log(s) / s);
    spare_ = v * f;
    have_spare_ = true;
    return u * f;
  }

 private:
  static constexpr std::uint64_t golden = 0x9e3779b97f4a7c15ULL;
  std::uint64_t state_;
  double spare_ = 0;
  bool have_spare_ = false;
};

// A faster generator for choices that no result depends on: samples, and the order in which a walk
// tests facets.

/// Marsaglia's xorshift generator ("Xorshift RNGs", 2003): period 2^64 - 1, three shifts a number,
/// the same numbers on every machine. The seed must not be 0.
class XorShift {
 public:
  static constexpr std::uint64_t golden = 0x9E3779B97F4A7C15ULL;

  explicit XorShift(std::uint64_t seed = golden) : state_(seed) {}

  std::uint64_t next() {
    state_ ^= state_ << 13;
    state_ ^= state_ >> 7;
    state_ ^= state_ << 17;
    return state_;
  }
  /// An integer in [0, n) for n < 2^32.
  std::uint32_t below(std::uint32_t n) {
    return static_cast<std::uint32_t>((next() >> 32) * n >> 32);
  }

 private:
  std::uint64_t state_;
};

}  // namespace cullhull::internal
