// The bodies of the kernels for the data-parallel primitives, as plain functions of a thread's
// place in the grid. On a device a launch runs them (executor.cuh); on the host a loop over blocks
// and threads can, as in the tests. If a body has phases, all threads of a block must be
// synchronised between them.
#pragma once

#include <cstdint>

#include "filter/pseudo_hull/primitives.hpp"
#include "parallel/host_device.hpp"

namespace cullhull::internal {

/// The place of a thread in a grid of blocks.
struct GridThread {
  std::uint32_t block, thread, block_size, blocks;

  CULLHULL_HD std::uint64_t first() const { return std::uint64_t{block} * block_size + thread; }
  CULLHULL_HD std::uint64_t stride() const { return std::uint64_t{blocks} * block_size; }
};

/// Atomic updates of words that several threads access. Reading the word first avoids most atomic
/// operations: the maximum of n items in random order changes only about ln n times. The read must
/// bypass the thread's own cache, which might never see a change.
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
  CULLHULL_HD static bool is_first(std::uint32_t& target, std::uint32_t value) {
#if defined(__CUDA_ARCH__)
    return atomicMax(&target, value) < value;
#else
    return SerialExecutor::is_first(target, value);
#endif
  }
  CULLHULL_HD static std::uint32_t next(std::uint32_t& counter, std::uint32_t n) {
#if defined(__CUDA_ARCH__)
    return atomicAdd(&counter, n);
#else
    return SerialExecutor::next(counter, n);
#endif
  }
};

template <class Body>
struct ForEachKernel {
  Body body;
  ItemCount items;

  CULLHULL_HD void run(const GridThread& at) const {
    const std::uint32_t count = items.get();
    for (std::uint64_t i = at.first(); i < count; i += at.stride())
      body(static_cast<std::uint32_t>(i));
  }
};

/// Items that are kept, found tile by tile: a block lists those of a tile in shared memory, so that
/// then all of its threads have work; with `appended`, they are placed there by one atomic
/// operation a tile. Tiles of items that lie apart, which share the work more evenly, were slower:
/// the flips of a sphere of 1M points took 9.8 ms for 7.4 (H200).
template <class Keep, class Body>
struct TileKernel {
  static constexpr std::uint32_t items_a_thread = 4;
  Keep keep;
  Body body;  ///< body(i) or, with `appended`, body(i, k)
  ItemCount items;
  std::uint32_t* appended;

  struct Shared {
    std::uint32_t count, first;
  };
  CULLHULL_HD std::uint32_t tiles(std::uint32_t block_size) const {
    const std::uint32_t of_tile = items_a_thread * block_size;
    return static_cast<std::uint32_t>((std::uint64_t{items.get()} + of_tile - 1) / of_tile);
  }
  /// Lists a thread's items of a tile.
  CULLHULL_HD void find(std::uint32_t tile, const GridThread& at, std::uint32_t* list,
                        Shared& shared) const {
    const std::uint32_t count = items.get();
    const std::uint64_t first = std::uint64_t{tile} * items_a_thread * at.block_size + at.thread;
    bool kept[items_a_thread];
    for (std::uint32_t k = 0; k < items_a_thread; ++k) {
      const std::uint64_t i = first + std::uint64_t{k} * at.block_size;
      kept[k] = i < count && keep(static_cast<std::uint32_t>(i));
    }
    for (std::uint32_t k = 0; k < items_a_thread; ++k)
      if (kept[k])
        list[DeviceAtomics::next(shared.count, 1)] =
            static_cast<std::uint32_t>(first + std::uint64_t{k} * at.block_size);
  }
  CULLHULL_HD void place(Shared& shared) const {
    shared.first = DeviceAtomics::next(*appended, shared.count);
  }
  CULLHULL_HD void use(const GridThread& at, const std::uint32_t* list,
                       const Shared& shared) const {
    for (std::uint32_t j = at.thread; j < shared.count; j += at.block_size) {
      if constexpr (requires { body(0U, 0U); })
        body(list[j], shared.first + j);
      else
        body(list[j]);
    }
  }
};

/// A thread's items of one of the steps of a round; how many there are is in the device's memory.
template <bool First, class Steps>
CULLHULL_HD_INLINE void run_step(const Steps& steps, std::uint32_t round, const GridThread& at) {
  const std::uint32_t items = steps.items(round);
  for (std::uint64_t i = at.first(); i < items; i += at.stride()) {
    if constexpr (First)
      steps.first(round, static_cast<std::uint32_t>(i));
    else
      steps.second(round, static_cast<std::uint32_t>(i));
  }
}

/// The maximum of the values offered to each cell. If there are few cells, all threads of the
/// device would contend for them; so there are several copies of the cells, and each block writes
/// to one. All copies must be zero at the beginning.
template <class Body>
struct ScatterMaxKernel {
  Body body;
  ItemCount items;
  std::uint32_t cells, copies;
  std::uint64_t* best;  ///< the copies, `cells` values each

  /// Returns how many of this thread's items have no cell (no_item).
  CULLHULL_HD std::uint32_t run(const GridThread& at) const {
    std::uint64_t* mine = best + std::size_t{at.block % copies} * cells;
    const std::uint32_t count = items.get();
    std::uint32_t none = 0;
    for (std::uint64_t i = at.first(); i < count; i += at.stride()) {
      const Offer offer = body(static_cast<std::uint32_t>(i));
      none += static_cast<std::uint32_t>(offer.cell == no_item);
      if (offer.value != 0) DeviceAtomics::raise(mine[offer.cell], offer.value);
    }
    return none;
  }
};

/// The number of copies: up to 64, so that contention is rare, in at most one megabyte. Both
/// numbers are guesses, not tuned.
CULLHULL_HD constexpr std::uint32_t scatter_copies(std::uint32_t cells) {
  constexpr std::uint32_t words = 1U << 17, most = 64;
  const std::uint32_t fit = words / (cells == 0 ? 1 : cells);
  return fit < 1 ? 1 : fit > most ? most : fit;
}

/// Combines the copies of each cell into one value.
struct FoldCopies {
  const std::uint64_t* copied;
  std::uint32_t cells, copies;
  std::uint64_t* best;

  CULLHULL_HD void operator()(std::uint32_t c) const {
    std::uint64_t most = 0;
    for (std::uint32_t k = 0; k < copies; ++k) {
      const std::uint64_t v = copied[std::size_t{k} * cells + c];
      most = v > most ? v : most;
    }
    best[c] = most;
  }
};

}  // namespace cullhull::internal
