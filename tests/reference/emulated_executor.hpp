// The device's executor without a device: the same kernel bodies in loops over blocks and threads,
// in an order that no plain loop has, so that what depends on the order of work shows.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "cuda/kernels/device_kernels.hpp"
#include "filter/pseudo_hull/primitives.hpp"

namespace cullhull::internal {

class EmulatedExecutor : public HostExecutor<EmulatedExecutor> {
 public:
  static constexpr std::uint32_t grain = 1;  // as on the device
  static constexpr bool many_threads = true;

  explicit EmulatedExecutor(std::uint32_t blocks = 3, std::uint32_t block_size = 64)
      : blocks_(blocks), block_size_(block_size) {}

  template <class Body>
  void for_each(std::uint32_t count, Body body) const {
    const ForEachKernel<Body> kernel{body, {nullptr, count}};
    for_threads([&](const GridThread& at) { kernel.run(at); });
  }

  template <class T, class Map, class Combine>
  T reduce(std::uint32_t count, T identity, Map map, Combine combine) const {
    std::vector<T> partial(blocks_, identity);
    for (std::uint32_t i = count; i-- > 0;)
      partial[i % blocks_] = combine(partial[i % blocks_], map(i));
    for (const T& p : partial) identity = combine(identity, p);
    return identity;
  }

  template <class Keep, class Emit>
  std::uint32_t select(std::uint32_t count, Keep keep, Emit emit) const {
    std::vector<std::uint32_t> kept;
    for (std::uint32_t i = 0; i < count; ++i)
      if (keep(i)) kept.push_back(i);
    for (std::size_t k = kept.size(); k-- > 0;) emit(kept[k], static_cast<std::uint32_t>(k));
    return static_cast<std::uint32_t>(kept.size());
  }

  template <class Keep, class Emit>
  std::uint32_t append(std::uint32_t count, Keep keep, Emit emit) const {
    std::uint32_t k = 0;
    tiles(TileKernel<Keep, Emit>{keep, emit, {nullptr, count}, &k});
    return k;
  }

  template <class Keep, class Body>
  void for_each_where(std::uint32_t count, Keep keep, Body body) const {
    tiles(TileKernel<Keep, Body>{keep, body, {nullptr, count}, nullptr});
  }

  template <class Keep, class Then>
  std::uint32_t enumerate(std::uint32_t count, Keep keep, std::uint32_t* number, Then then) const {
    const std::uint32_t kept = SerialExecutor{}.enumerate(count, keep, number, [](auto) {});
    for_each(count, then);
    return kept;
  }

  template <class Body>
  std::uint32_t scatter_max(std::uint32_t count, std::uint32_t cells, Body body,
                            std::uint64_t* best) const {
    const std::uint32_t copies = scatter_copies(cells);
    std::vector<std::uint64_t> copied(std::size_t{copies} * cells, 0);
    const ScatterMaxKernel<Body> kernel{body, {nullptr, count}, cells, copies, copied.data()};
    std::uint32_t none = 0;
    for_threads([&](const GridThread& at) { none += kernel.run(at); });
    for_each(cells, FoldCopies{copied.data(), cells, copies, best});
    return none;
  }

  static constexpr std::uint32_t rounds_at_once = 3, rounds_after_look = 2, few_items = 100;
  static void lower(std::uint32_t& target, std::uint32_t value) {
    DeviceAtomics::lower(target, value);
  }
  static void raise(std::uint64_t& target, std::uint64_t value) {
    DeviceAtomics::raise(target, value);
  }
  static bool is_first(std::uint32_t& target, std::uint32_t value) {
    return DeviceAtomics::is_first(target, value);
  }
  static std::uint32_t next(std::uint32_t& counter, std::uint32_t n) {
    return DeviceAtomics::next(counter, n);
  }

 private:
  template <class Kernel>
  void tiles(const Kernel& kernel) const {
    std::vector<std::uint32_t> list(std::size_t{Kernel::items_a_thread} * block_size_);
    const std::uint32_t tiles = kernel.tiles(block_size_);
    for (std::uint32_t tile = 0; tile < tiles; ++tile) {
      typename Kernel::Shared shared{};
      const auto for_block = [&](auto phase) {
        for (std::uint32_t t = block_size_; t-- > 0;) phase(GridThread{0, t, block_size_, 1});
      };
      for_block([&](const GridThread& at) { kernel.find(tile, at, list.data(), shared); });
      if (kernel.appended != nullptr) kernel.place(shared);
      for_block([&](const GridThread& at) { kernel.use(at, list.data(), shared); });
    }
  }
  template <class Run>
  void for_threads(Run run) const {
    for (std::uint32_t b = blocks_; b-- > 0;)
      for (std::uint32_t t = block_size_; t-- > 0;) run({b, t, block_size_, blocks_});
  }
  std::uint32_t blocks_, block_size_;
};

}  // namespace cullhull::internal
