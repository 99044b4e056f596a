// Positions of points along a Hilbert curve, a block of points at a time.
#pragma once

#include <cstddef>
#include <cstdint>

namespace cullhull::internal::inline geometry {

/// Points of one call.
inline constexpr std::size_t curve_block = 16;

/// Point k has the cell cells[j * curve_block + k] < 2^bits along axis j < d, d * bits <= 32.
/// keys[k] becomes its position on a d-dimensional Hilbert curve (Skilling 2004). Overwrites
/// `cells`. Time: about 5 ns a point for 8 bits in 4D.
void curve_keys(unsigned d, unsigned bits, std::uint32_t* cells, std::uint32_t* keys);

}  // namespace cullhull::internal::inline geometry
