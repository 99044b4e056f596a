// The kernels for queries to a hull about points. Each function launches a kernel on a stream and
// returns the status of the launch.
#pragma once

#include <driver_types.h>

#include <cstdint>

#include "cuda/hull_questions.hpp"

namespace cullhull::internal::inline cuda {

/// HullTables in the device's memory.
struct TablesThere {
  double low[HullTables::most_dimensions], high[HullTables::most_dimensions];
  const double* simplices;
  const double* planes;  ///< null: distances are not needed
  const double* vertices;
  double vertex_reach;
  std::uint32_t simplex_count, plane_count, vertex_count;
};

/// A bound of the underflow in a determinant of order 6 of differences of at most 2^100.
inline constexpr double side_tiny = 0x1p-540;

/// Writes sides[i], and distances[i] for points inside, of the points i = ids[k], k < count. If
/// `ids` is null, of all points i < count.
cudaError_t ask_sides(const DevicePointView& points, const std::uint64_t* ids, std::uint64_t count,
                      const TablesThere& hull, PointAnswer* sides, double* distances,
                      cudaStream_t stream);
/// Writes the index of the support vertex of each direction, or open_vertex.
cudaError_t ask_supports(const DevicePointView& directions, const TablesThere& hull,
                         std::uint32_t* out, cudaStream_t stream);

}  // namespace cullhull::internal::inline cuda
