// The kernels that ask a hull about points, as functions that launch them on a stream; each returns
// the status of its launch.
#pragma once

#include <driver_types.h>

#include <cstdint>

#include "cuda/hull_questions.hpp"

namespace cullhull::internal::inline cuda {

/// HullTables on the device.
struct TablesThere {
  double low[HullTables::most_dimensions], high[HullTables::most_dimensions];
  const double* simplices;
  const double* planes;  ///< null: no distances are wanted
  const double* vertices;
  double vertex_reach;
  std::uint32_t simplex_count, plane_count, vertex_count;
};

/// What underflows in a determinant of six differences of at most 2^100.
inline constexpr double side_tiny = 0x1p-540;

/// sides[i] (and distances[i], of those inside) for point i = ids[k], k < count; `ids` null: for
/// all i < count.
cudaError_t ask_sides(const DevicePointView& points, const std::uint64_t* ids, std::uint64_t count,
                      const TablesThere& hull, PointAnswer* sides, double* distances,
                      cudaStream_t stream);
cudaError_t ask_supports(const DevicePointView& directions, const TablesThere& hull,
                         std::uint32_t* out, cudaStream_t stream);

}  // namespace cullhull::internal::inline cuda
