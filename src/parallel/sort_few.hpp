// Branchless sorting of a few items, whose number is known at compile time. The items arrive in
// random order, so the branches of an ordinary sort would often be mispredicted.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <utility>
#include <vector>

namespace cullhull::internal {

/// The sorting network for n items: the comparators of Batcher's merge exchange, in order (Knuth,
/// TAOCP 3, 5.2.2, Algorithm M).
template <unsigned n>
struct MergeExchange {
  struct Pair {
    unsigned low, high;
  };
  /// Calls with(i, j), i < j, for every comparator, in order.
  template <class With>
  static constexpr void walk(const With& with) {
    if (n < 2) return;
    constexpr unsigned top = std::bit_ceil(n) / 2;
    for (unsigned p = top; p > 0; p /= 2) {
      unsigned q = top, r = 0;
      for (unsigned d = p;; d = q - p, q /= 2, r = p) {
        for (unsigned i = 0; i + d < n; ++i)
          if ((i & p) == r) with(i, i + d);
        if (q == p) break;
      }
    }
  }
  static constexpr unsigned count = [] {
    unsigned pairs = 0;
    walk([&](unsigned, unsigned) { ++pairs; });
    return pairs;
  }();
  static constexpr std::array<Pair, count> pairs = [] {
    std::array<Pair, count> list{};
    unsigned at = 0;
    walk([&](unsigned i, unsigned j) { list[at++] = {i, j}; });
    return list;
  }();
};

/// Sorts n items ascending. Returns whether the number of exchanges was odd, which for distinct
/// items is whether the sorting permutation is odd.
template <unsigned n, class T>
inline bool sort_few(T* items) {
  unsigned odd = 0;
  const auto order = [&](unsigned i, unsigned j) {
    const T x = items[i], y = items[j];
    const bool swap = y < x;
    items[i] = swap ? y : x;
    items[j] = swap ? x : y;
    odd ^= static_cast<unsigned>(swap);
  };
  // Elsewhere than in the caller the items are in memory: hulls of 10 points in 6D took 6 % more.
  [&]<std::size_t... k>(std::index_sequence<k...>) __attribute__((always_inline)) {
    (order(MergeExchange<n>::pairs[k].low, MergeExchange<n>::pairs[k].high), ...);
  }
  (std::make_index_sequence<MergeExchange<n>::count>());
  return odd != 0;
}

/// Returns the items in ascending order; takes linear time if they are sorted already.
template <class T>
std::vector<T> sorted(std::vector<T> items) {
  if (!std::is_sorted(items.begin(), items.end())) std::sort(items.begin(), items.end());
  return items;
}

}  // namespace cullhull::internal
