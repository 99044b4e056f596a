// The kernels of the gauge map on CUDA devices. Each function launches a kernel on a stream and
// returns the status of the launch, but for list_bits(). The callers (gauge.cpp) handle memory and
// errors.
#pragma once

#include <driver_types.h>

#include <cstddef>
#include <cstdint>

#include "cuda/gauge.hpp"
#include "cullhull/device_points.hpp"
#include "filter/gauge/gauge_table.hpp"

namespace cullhull::internal {

struct Device;

/// Words of 32 bits in the mask of `count` points.
constexpr std::uint64_t mask_words(std::uint64_t count) { return (count + 31) / 32; }
/// Words that gauge_mask may write, and for which a mask needs room: at least mask_words().
constexpr std::uint64_t mask_room(std::uint64_t count) { return (count + 127) / 128 * 4; }

/// Sets bit i % 32 of mask[i / 32] to 1 if point i is not provably inside, else to 0. Bits beyond
/// the last point become 0. `nodes`: the table's nodes on the device.
cudaError_t gauge_mask(const GaugeTable& table, const float* nodes, const DevicePointView& points,
                       std::uint32_t* mask, const Device& device, cudaStream_t stream);

/// The positions of the set bits, ascending. Allocates, waits for their number, and throws.
DeviceIds list_bits(const std::uint32_t* mask, std::uint64_t words, cudaStream_t stream);

/// Copies point ids[i] (point i if `ids` is null) to row i of packed rows of the points' scalar
/// type.
cudaError_t gather_rows(const DevicePointView& points, const std::uint64_t* ids,
                        std::uint64_t count, void* rows, cudaStream_t stream);
/// out[i] = of[at[i]].
cudaError_t gather_ids(const std::uint64_t* of, const std::uint64_t* at, std::uint64_t count,
                       std::uint64_t* out, cudaStream_t stream);

}  // namespace cullhull::internal
