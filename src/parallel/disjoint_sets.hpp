// Disjoint sets (union-find) that several threads update at once, without locks.
#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "parallel/memory/raw_array.hpp"
#include "parallel/prefetch.hpp"

namespace cullhull::internal {

/// A partition of the numbers below n into sets. Any number of threads may call root() and join()
/// at the same time. A set's root is its lowest member, so it does not depend on the order of the
/// calls.
class DisjointSets {
 public:
  explicit DisjointSets(std::size_t n) : parent_(n) {}
  /// Makes each number of [begin, end) a set of its own. Call it for every number before use.
  void clear(std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) parent_[i] = static_cast<std::uint32_t>(i);
  }
  void prefetch(std::uint32_t i) const { prefetch_line(&parent_[i]); }
  /// Returns the lowest member of i's set. While other threads join sets, it may instead return
  /// another member that is at most i.
  std::uint32_t root(std::uint32_t i) {
    for (;;) {
      const std::uint32_t up = at(i).load(std::memory_order_relaxed);
      if (up == i) return i;
      const std::uint32_t over = at(up).load(std::memory_order_relaxed);
      at(i).store(over, std::memory_order_relaxed);  // path halving
      i = over;
    }
  }
  /// Merges the sets of a and b: the higher root becomes a child of the lower one.
  void join(std::uint32_t a, std::uint32_t b) {
    for (;;) {
      a = root(a);
      b = root(b);
      if (a == b) return;
      if (a < b) std::swap(a, b);
      std::uint32_t expected = a;
      if (at(a).compare_exchange_strong(expected, b, std::memory_order_relaxed)) return;
    }
  }

 private:
  std::atomic_ref<std::uint32_t> at(std::uint32_t i) { return std::atomic_ref(parent_[i]); }
  BigArray<std::uint32_t> parent_;
};

}  // namespace cullhull::internal
