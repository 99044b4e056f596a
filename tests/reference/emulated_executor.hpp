// The device's executor without a device: the same kernel bodies in loops over blocks and threads,
// in an order that no plain loop has, so that what depends on the order of work shows.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "parallel/device_kernels.hpp"
#include "parallel/primitives.hpp"

namespace cullhull::internal {

class EmulatedExecutor : public HostMemory {
 public:
  static constexpr std::uint32_t grain = 1;  // as on the device

  explicit EmulatedExecutor(std::uint32_t blocks = 3, std::uint32_t block_size = 64)
      : blocks_(blocks), block_size_(block_size) {}

  template <class Body>
  void for_each(std::uint32_t count, Body body) const {
    const ForEachKernel<Body> kernel{body, count};
    for_threads([&](const GridThread& at) { kernel.run(at); });
  }

  template <class T, class Map, class Combine>
  T reduce(std::uint32_t count, T identity, Map map, Combine combine) const {
    // As a tree of devices' blocks may: pairs from both ends, each the other way round.
    std::vector<T> items(count, identity);
    for (std::uint32_t i = 0; i < count; ++i) items[i] = map(i);
    while (items.size() > 1) {
      const std::size_t half = (items.size() + 1) / 2;
      for (std::size_t i = half; i < items.size(); ++i)
        items[i - half] = combine(items[i], items[i - half]);
      items.resize(half);
    }
    return items.empty() ? identity : combine(items[0], identity);
  }

  template <class Keep, class Emit>
  std::uint32_t select(std::uint32_t count, Keep keep, Emit emit) const {
    std::vector<std::uint32_t> kept;
    for (std::uint32_t i = 0; i < count; ++i)
      if (keep(i)) kept.push_back(i);
    for (std::size_t k = kept.size(); k-- > 0;) emit(kept[k], static_cast<std::uint32_t>(k));
    return static_cast<std::uint32_t>(kept.size());
  }

  template <class Keep>
  std::uint32_t enumerate(std::uint32_t count, Keep keep, std::uint32_t* number) const {
    return SerialExecutor{}.enumerate(count, keep, number);
  }

  template <class Body>
  std::uint32_t scatter_max(std::uint32_t count, std::uint32_t cells, Body body,
                            std::uint64_t* best) const {
    std::fill_n(best, cells, 0);
    const ScatterMaxKernel<Body> kernel{body, count, cells, best};
    std::vector<std::vector<std::uint64_t>> tables(
        blocks_, std::vector<std::uint64_t>(kernel.has_table() ? cells : 0, 77));
    std::uint32_t none = 0;
    if (kernel.has_table())
      for_threads([&](const GridThread& at) { kernel.clear(at, tables[at.block].data()); });
    for_threads([&](const GridThread& at) {
      none += kernel.collect(at, kernel.has_table() ? tables[at.block].data() : best);
    });
    if (kernel.has_table())
      for_threads([&](const GridThread& at) { kernel.flush(at, tables[at.block].data()); });
    return none;
  }

  static void lower(std::uint32_t& target, std::uint32_t value) {
    DeviceAtomics::lower(target, value);
  }

 private:
  template <class Run>
  void for_threads(Run run) const {
    for (std::uint32_t b = blocks_; b-- > 0;)
      for (std::uint32_t t = block_size_; t-- > 0;) run({b, t, block_size_, blocks_});
  }
  std::uint32_t blocks_, block_size_;
};

}  // namespace cullhull::internal
