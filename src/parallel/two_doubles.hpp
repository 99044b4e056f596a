// Two doubles that the processor computes with at once, if the compiler has vectors; other
// compilers compute with one after the other, with the same results.
#pragma once

#include <bit>

namespace cullhull::internal {

#if defined(__GNUC__)
using TwoDoubles = double __attribute__((vector_size(16)));

/// Bit 0: a[0] < b[0]; bit 1: a[1] < b[1].
inline unsigned less_bits(const TwoDoubles& a, const TwoDoubles& b) {
  const auto less = a < b;
#if defined(__SSE2__)
  return static_cast<unsigned>(__builtin_ia32_movmskpd(std::bit_cast<TwoDoubles>(less)));
#else
  return static_cast<unsigned>((less[0] & 1) | (less[1] & 2));
#endif
}
#else
struct TwoDoubles {
  double of[2];

  double& operator[](int i) { return of[i]; }
  double operator[](int i) const { return of[i]; }
  friend TwoDoubles operator-(const TwoDoubles& a) { return {-a[0], -a[1]}; }
  friend TwoDoubles operator+(const TwoDoubles& a, const TwoDoubles& b) {
    return {a[0] + b[0], a[1] + b[1]};
  }
  friend TwoDoubles operator-(const TwoDoubles& a, const TwoDoubles& b) {
    return {a[0] - b[0], a[1] - b[1]};
  }
  friend TwoDoubles operator*(const TwoDoubles& a, const TwoDoubles& b) {
    return {a[0] * b[0], a[1] * b[1]};
  }
  friend TwoDoubles operator*(double a, const TwoDoubles& b) { return {a * b[0], a * b[1]}; }
};

inline unsigned less_bits(const TwoDoubles& a, const TwoDoubles& b) {
  return (a[0] < b[0] ? 1U : 0U) | (a[1] < b[1] ? 2U : 0U);
}
#endif

}  // namespace cullhull::internal
