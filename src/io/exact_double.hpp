// 64-bit integers as the doubles that equal them.
#pragma once

#include <cmath>
#include <limits>

namespace cullhull::internal::inline io {

/// The double of the same value, or false.
template <class T>
bool exact_double(T v, double& out) {
  out = static_cast<double>(v);
  // 2^63 and 2^64 are doubles that T cannot hold: converting them back would be undefined.
  const double limit = std::ldexp(1.0, std::numeric_limits<T>::digits);
  return out < limit && static_cast<T>(out) == v;
}

}  // namespace cullhull::internal::inline io
