// The kernels of the CUDA GaugeMap as functions that launch them on a stream. Callers handle memory
// and errors (gauge.cpp); each function returns the status of its launch.
#pragma once

#include <driver_types.h>

#include <cstddef>
#include <cstdint>

#include "cullhull/device_points.hpp"
#include "filter/gauge/gauge_table.hpp"

namespace cullhull::internal::inline cuda {

struct Device;

/// The most nodes of a table with which this device runs two blocks of the kernel at a time and has
/// a quarter of the memory left as cache for the points (docs/gpu.md).
std::uint32_t most_gauge_nodes(const Device& device);

/// Words of the mask of `count` points, and how many of them gauge_mask may write.
constexpr std::uint64_t mask_words(std::uint64_t count) { return (count + 31) / 32; }
constexpr std::uint64_t mask_room(std::uint64_t count) { return (count + 127) / 128 * 4; }

/// mask[i / 32] bit i % 32: point i is not provably inside; bits of points beyond the last are 0.
/// `nodes`: the table's, on the device.
cudaError_t gauge_mask(const GaugeTable& table, const float* nodes, const DevicePointView& points,
                       std::uint32_t* mask, const Device& device, cudaStream_t stream);

/// Words of a mask that one block converts to ids.
inline constexpr std::uint32_t tile_words = 1024;

/// counts[t]: the number of set bits in tile t.
cudaError_t count_bits(const std::uint32_t* mask, std::uint64_t words, std::uint64_t* counts,
                       cudaStream_t stream);
/// offsets[i] = sum of counts[0 .. i). `scratch` null: only sets `scratch_bytes`.
cudaError_t sum_counts(void* scratch, std::size_t& scratch_bytes, const std::uint64_t* counts,
                       std::uint64_t* offsets, std::uint64_t items, cudaStream_t stream);
/// Writes the positions of the set bits, ascending: those of tile t from ids[offsets[t]] on.
cudaError_t list_bits(const std::uint32_t* mask, std::uint64_t words, const std::uint64_t* offsets,
                      std::uint64_t* ids, cudaStream_t stream);

/// rows[i] = point ids[i] (`ids` null: point i), packed, in the points' scalar.
cudaError_t gather_rows(const DevicePointView& points, const std::uint64_t* ids,
                        std::uint64_t count, void* rows, cudaStream_t stream);
/// out[i] = of[at[i]].
cudaError_t gather_ids(const std::uint64_t* of, const std::uint64_t* at, std::uint64_t count,
                       std::uint64_t* out, cudaStream_t stream);
/// *first = the lowest id of a point with a NaN or an infinity; unchanged if there is none.
cudaError_t first_not_finite(const DevicePointView& points, unsigned long long* first,
                             cudaStream_t stream);

}  // namespace cullhull::internal::inline cuda
