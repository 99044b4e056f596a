// Factorials in bounds of bits.
#pragma once

namespace cullhull::internal::inline exact {

/// n! is at most 2 to this, n <= 8.
inline constexpr int factorial_bits[] = {0, 0, 1, 3, 5, 7, 10, 13, 16};

}  // namespace cullhull::internal::inline exact
