// A double as an integer times a power of two.
#pragma once

#include <bit>
#include <cstdint>

namespace cullhull::internal {

// Example: 0.75 = 3 * 2^-2 has the lowest bit exponent -2 and the parts {3, -2}; 1e-320, a
// subnormal number, is 2024 * 2^-1074, so {253, -1071}.

/// Returns the exponent of the lowest set bit; v is finite and not zero.
inline int lowest_bit_exponent(double v) {
  const auto bits = std::bit_cast<std::uint64_t>(v);
  const int biased = static_cast<int>((bits >> 52) & 0x7FF);
  std::uint64_t m = bits & ((std::uint64_t{1} << 52) - 1);
  if (biased != 0) m |= std::uint64_t{1} << 52;
  return (biased != 0 ? biased - 1075 : -1074) + std::countr_zero(m);
}

/// The number mantissa 2^exponent.
struct DoubleParts {
  std::int64_t mantissa;  ///< odd, or zero
  int exponent;
};

/// Returns the parts of a finite double; {0, 0} for zero.
inline DoubleParts double_parts(double v) {
  const auto bits = std::bit_cast<std::uint64_t>(v);
  const int biased = static_cast<int>((bits >> 52) & 0x7FF);
  auto m = static_cast<std::int64_t>(bits & ((std::uint64_t{1} << 52) - 1));
  if (biased != 0) m |= std::int64_t{1} << 52;
  if (m == 0) return {0, 0};
  const int zeros = std::countr_zero(static_cast<std::uint64_t>(m));
  m >>= zeros;
  return {(bits >> 63) != 0 ? -m : m, (biased != 0 ? biased - 1075 : -1074) + zeros};
}

}  // namespace cullhull::internal
