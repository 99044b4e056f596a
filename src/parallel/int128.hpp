// Int128, a signed integer of 128 bits: the compiler's type if it has one, else PortableInt128, two
// words of 64 bits. Both give the same results. PortableInt128 is compiled on every machine so that
// every machine can test it.
#pragma once

#include <bit>
#include <cmath>
#include <cstdint>

namespace cullhull::internal {

/// Returns the low word of the 128-bit product a b and stores the high word in `high`.
constexpr std::uint64_t multiply_words(std::uint64_t a, std::uint64_t b, std::uint64_t& high) {
  const std::uint64_t al = a & 0xFFFFFFFF, ah = a >> 32, bl = b & 0xFFFFFFFF, bh = b >> 32;
  const std::uint64_t low = al * bl, m1 = ah * bl + (low >> 32), m2 = al * bh + (m1 & 0xFFFFFFFF);
  high = ah * bh + (m1 >> 32) + (m2 >> 32);
  return m2 << 32 | (low & 0xFFFFFFFF);
}

/// A signed integer of 128 bits in two's complement. Results that overflow wrap around.
class PortableInt128 {
 public:
  constexpr PortableInt128() = default;
  constexpr PortableInt128(std::int64_t v)  // implicit, as between built-in integers
      : low_(static_cast<std::uint64_t>(v)), high_(v < 0 ? ~std::uint64_t{0} : 0) {}

  constexpr PortableInt128 operator-() const {
    return {~low_ + 1, ~high_ + static_cast<std::uint64_t>(low_ == 0)};
  }
  friend constexpr PortableInt128 operator+(PortableInt128 a, PortableInt128 b) {
    const std::uint64_t low = a.low_ + b.low_;
    return {low, a.high_ + b.high_ + static_cast<std::uint64_t>(low < a.low_)};
  }
  friend constexpr PortableInt128 operator-(PortableInt128 a, PortableInt128 b) { return a + -b; }
  friend constexpr PortableInt128 operator*(PortableInt128 a, PortableInt128 b) {
    std::uint64_t high = 0;
    const std::uint64_t low = multiply_words(a.low_, b.low_, high);
    return {low, high + a.low_ * b.high_ + a.high_ * b.low_};
  }
  friend constexpr bool operator==(PortableInt128 a, PortableInt128 b) = default;
  friend constexpr bool operator<(PortableInt128 a, PortableInt128 b) {
    const std::uint64_t sign = std::uint64_t{1} << 63;
    return a.high_ != b.high_ ? (a.high_ ^ sign) < (b.high_ ^ sign) : a.low_ < b.low_;
  }
  friend constexpr bool operator>(PortableInt128 a, PortableInt128 b) { return b < a; }

  /// Rounded to the nearest double, ties to even.
  explicit operator double() const {
    if (*this < PortableInt128()) return -(-*this).magnitude();
    return magnitude();
  }

 private:
  constexpr PortableInt128(std::uint64_t low, std::uint64_t high) : low_(low), high_(high) {}

  /// The value, read as unsigned, rounded to a double. A double has 53 bits, so rounding the 64
  /// leading bits gives the same as rounding all 128, provided that the last of the 64 is set if
  /// any lower bit is (a sticky bit).
  double magnitude() const {
    if (high_ == 0) return static_cast<double>(low_);
    const int zeros = std::countl_zero(high_);
    const std::uint64_t rest = low_ << zeros;
    std::uint64_t leading = high_ << zeros;
    if (zeros > 0) leading |= low_ >> (64 - zeros);
    return std::ldexp(static_cast<double>(leading | static_cast<std::uint64_t>(rest != 0)),
                      64 - zeros);
  }

  std::uint64_t low_ = 0, high_ = 0;
};

/// (a b + c) mod n for n > 0, without 128-bit integers: long division, one bit a step.
constexpr std::uint64_t portable_multiply_add_modulo(std::uint64_t a, std::uint64_t b,
                                                     std::uint64_t c, std::uint64_t n) {
  std::uint64_t high = 0, low = multiply_words(a, b, high);
  low += c;
  high += static_cast<std::uint64_t>(low < c);
  std::uint64_t rest = high % n;
  for (int bit = 63; bit >= 0; --bit) {
    const bool carry = rest >> 63 != 0;
    rest = rest << 1 | (low >> bit & 1);
    if (carry || rest >= n) rest -= n;
  }
  return rest;
}

#if defined(__SIZEOF_INT128__)
__extension__ typedef __int128 Int128;
__extension__ typedef unsigned __int128 Uint128;
/// (a b + c) mod n for n > 0.
constexpr std::uint64_t multiply_add_modulo(std::uint64_t a, std::uint64_t b, std::uint64_t c,
                                            std::uint64_t n) {
  return static_cast<std::uint64_t>((Uint128{a} * b + c) % n);
}
#else
using Int128 = PortableInt128;
constexpr std::uint64_t multiply_add_modulo(std::uint64_t a, std::uint64_t b, std::uint64_t c,
                                            std::uint64_t n) {
  return portable_multiply_add_modulo(a, b, c, n);
}
#endif

}  // namespace cullhull::internal
