// The bodies of our kernels for the data-parallel primitives, as plain functions of the place of a
// thread: all but the launch. A loop over blocks and threads executes them on the host (the tests
// do), a launch on a device (cuda_executor.cuh). Between the phases of a body all threads of a
// block wait for one another.
#pragma once

#include <cstdint>

#include "parallel/host_device.hpp"
#include "parallel/primitives.hpp"

namespace cullhull::internal {

/// Where a thread is in a grid of blocks.
struct GridThread {
  std::uint32_t block, thread, block_size, blocks;

  CULLHULL_HD std::uint64_t first() const { return std::uint64_t{block} * block_size + thread; }
  CULLHULL_HD std::uint64_t stride() const { return std::uint64_t{blocks} * block_size; }
};

/// What threads do to the same word at the same time. A look spares most of the costly operations:
/// the maximum of n items in random order rises ln n times. The look must not come from a cache
/// of the thread's own, which might never see it rise.
struct DeviceAtomics {
  CULLHULL_HD static void raise(std::uint64_t& target, std::uint64_t value) {
#if defined(__CUDA_ARCH__)
    static_assert(sizeof(unsigned long long) == sizeof(std::uint64_t));
    if (value > *const_cast<const volatile std::uint64_t*>(&target))
      atomicMax(reinterpret_cast<unsigned long long*>(&target), value);
#else
    if (value > target) target = value;
#endif
  }
  CULLHULL_HD static void lower(std::uint32_t& target, std::uint32_t value) {
#if defined(__CUDA_ARCH__)
    if (value < *const_cast<const volatile std::uint32_t*>(&target)) atomicMin(&target, value);
#else
    if (value < target) target = value;
#endif
  }
};

template <class Body>
struct ForEachKernel {
  Body body;
  std::uint32_t count;

  CULLHULL_HD void run(const GridThread& at) const {
    for (std::uint64_t i = at.first(); i < count; i += at.stride())
      body(static_cast<std::uint32_t>(i));
  }
};

/// `best` must be zero. Where there are few cells all threads of the device would meet at them, so
/// each block has a table of its own (in shared memory) and hands it over at the end; where there
/// are many, they write to `best` at once.
template <class Body>
struct ScatterMaxKernel {
  /// Cells that fit a block's table: 16 KB.
  static constexpr std::uint32_t table_cells = 2048;

  Body body;
  std::uint32_t count, cells;
  std::uint64_t* best;

  CULLHULL_HD bool has_table() const { return cells <= table_cells; }

  // Phase 1, with a table.
  CULLHULL_HD void clear(const GridThread& at, std::uint64_t* table) const {
    for (std::uint32_t c = at.thread; c < cells; c += at.block_size) table[c] = 0;
  }
  // Phase 2: into the table, or `best`. Returns this thread's offers to no_item.
  CULLHULL_HD std::uint32_t collect(const GridThread& at, std::uint64_t* into) const {
    std::uint32_t none = 0;
    for (std::uint64_t i = at.first(); i < count; i += at.stride()) {
      const Offer offer = body(static_cast<std::uint32_t>(i));
      none += static_cast<std::uint32_t>(offer.cell == no_item);
      if (offer.value != 0) DeviceAtomics::raise(into[offer.cell], offer.value);
    }
    return none;
  }
  // Phase 3, with a table.
  CULLHULL_HD void flush(const GridThread& at, const std::uint64_t* table) const {
    for (std::uint32_t c = at.thread; c < cells; c += at.block_size)
      if (table[c] != 0) DeviceAtomics::raise(best[c], table[c]);
  }
};

}  // namespace cullhull::internal
