// How much memory a triangulation takes: what is known before the work, and while cells are made.
//
// Sizes are those of what is allocated at once, so that a budget is refused before the work and not
// by a failed allocation in the middle.
#pragma once

#include <cstdint>

namespace cullhull::internal {

/// Bytes of a cell in the store: vertices, neighbours and a mark.
constexpr std::uint64_t store_bytes_per_cell(unsigned k) { return (2 * (k + 1) + 1) * 4; }

/// Bytes that each cell of a triangulation in dimension k needs at once, an eighth to a third more
/// than the lists take. While cells are made, these are the store and, in 3 to 6 dimensions, planes
/// (CellPlanes); while they are written, the store, the result and four numbers. What is added is
/// for cells that were deleted, and for memory that steps free and the next cannot use: measured
/// with 2,000 to 400,000 points of a ball in 2 to 6 dimensions, one and two threads.
constexpr std::uint64_t bytes_per_cell(unsigned k) {
  const std::uint64_t store = store_bytes_per_cell(k);
  const std::uint64_t made = store + 8 + (k >= 3 && k <= 6 ? 8 * (k + 1) + 8 : 0);
  const std::uint64_t written = store + 8 * (k + 1) + 16;
  const std::uint64_t most = made > written ? made : written;
  return k <= 2 ? most + most / 8 : most + most / 3;
}

/// Bytes that each point needs beside the cells: its row, its id and its place in the order.
constexpr std::uint64_t bytes_per_point(unsigned d) { return 8 * d + 24; }

}  // namespace cullhull::internal
