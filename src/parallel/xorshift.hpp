// Pseudo-random choices that no result depends on: samples, and the order of tests in a walk.
#pragma once

#include <cstdint>

namespace cullhull::internal::inline parallel {

/// Marsaglia's xorshift ("Xorshift RNGs", 2003), period 2^64 - 1: three shifts a number, the same
/// on every machine.
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
  /// [0, n) for n < 2^32.
  std::uint32_t below(std::uint32_t n) {
    return static_cast<std::uint32_t>((next() >> 32) * n >> 32);
  }

 private:
  std::uint64_t state_;
};

}  // namespace cullhull::internal::inline parallel
