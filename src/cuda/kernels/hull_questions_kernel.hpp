// The kernels for queries to a hull about points. Each function launches a kernel on a stream and
// returns the status of the launch.
#pragma once

#include <driver_types.h>

#include <cstddef>
#include <cstdint>

#include "cuda/hull_questions.hpp"

namespace cullhull::internal {

/// HullTables in the device's memory.
struct TablesThere {
  double low[HullTables::most_dimensions], high[HullTables::most_dimensions];
  const double* simplices;
  const double* planes;    ///< read by ask_distances() alone
  const double* vertices;  ///< read by ask_supports() alone
  double vertex_reach;
  std::uint32_t simplex_count, plane_count, vertex_count;
};

/// Doubles from one normal to the next in CellsThere: 3D leaves one unused, so that a normal lies
/// in one sector of 32 bytes and is loaded by pairs.
constexpr unsigned normal_stride(unsigned dimension) { return dimension == 2 ? 2 : 4; }

/// A FacetCellTable in the device's memory.
struct CellsThere : FacetCellFrame {
  const double* normals = nullptr;  ///< normal_stride() doubles a facet
  const std::uint32_t* starts = nullptr;
  const std::uint32_t* facets = nullptr;
};

/// Where kernels list the points that they leave open: *count points, which begins as 0, in any
/// order. `points` has room for all points asked about.
struct OpenList {
  std::uint32_t* count;
  std::uint32_t* points;
};

/// A bound of the underflow in a determinant of order 6 of differences of at most 2^100.
inline constexpr double side_tiny = 0x1p-540;

/// Each writes out[i] of the points i < points.count, 0 if point i is open; fewer than 2^32 points.

/// If `ids` is not null, of the points i = ids[k], k < count, alone.
cudaError_t ask_sides(const DevicePointView& points, const std::uint64_t* ids, std::uint64_t count,
                      const TablesThere& hull, SideCodes codes, std::uint8_t* out,
                      const OpenList& open, cudaStream_t stream);
cudaError_t ask_sides_by_cells(const DevicePointView& points, const CellsThere& cells,
                               SideCodes codes, std::uint8_t* out, const OpenList& open,
                               cudaStream_t stream);
cudaError_t ask_distances(const DevicePointView& points, const TablesThere& hull, double* out,
                          const OpenList& open, cudaStream_t stream);
/// `ids`: those of the vertices, on the device.
cudaError_t ask_supports(const DevicePointView& directions, const TablesThere& hull,
                         const std::uint64_t* ids, std::uint64_t* out, const OpenList& open,
                         cudaStream_t stream);

/// out[ids[k]] = items[k] for items of `item` bytes, `bytes` in all.
cudaError_t scatter_items(const std::uint64_t* ids, const std::byte* items, std::size_t item,
                          std::uint64_t bytes, std::byte* out, cudaStream_t stream);

}  // namespace cullhull::internal
