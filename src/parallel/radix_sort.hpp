// A stable parallel radix sort, least significant digit first.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "parallel/scan.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

/// Up to so many items are one thread's: sharing them takes longer than it saves.
inline constexpr std::uint32_t radix_alone = 1 << 14;

/// Sorts n < 2^32 items by key(item), stably. Only the `bits` low bits of a key may be set.
/// `scratch` has room for n items. The function may exchange the two pointers; afterwards `items`
/// points to the sorted items. An item's place is computed from the counts of all chunks, so the
/// order does not depend on threads.
template <class Item, class Key>
void radix_sort(Item*& items, Item*& scratch, std::uint32_t n, unsigned bits, const Run& run,
                const Key& key) {
  if (bits == 0 || n < 2) return;
  // Below about 50 items comparisons are faster than counting: with random keys of 32 bits, 32
  // items take 1.0 us by comparisons and 1.2 us by counting, 64 take 2.8 and 1.4 us, 192 take 13
  // and 3.5 us.
  if (n < 48) {
    std::stable_sort(items, items + n,
                     [&](const Item& a, const Item& b) { return key(a) < key(b); });
    return;
  }
  // Fewer buckets for few items: clearing and summing them must not cost more than moving the
  // items.
  const unsigned widest = n < 4096 ? 8 : 12;
  const unsigned passes = (bits + widest - 1) / widest;
  const unsigned digit_bits = (bits + passes - 1) / passes, buckets = 1U << digit_bits;
  // At most about 64 chunks, since each needs counts of its own; few where nobody shares them.
  const std::uint64_t least = run.threads < 2 ? 1 << 20 : n <= radix_alone ? radix_alone : 1 << 12;
  const std::uint64_t chunk_size = std::max<std::uint64_t>(least, n / 64);
  std::vector<std::uint32_t> places(chunk_count(n, chunk_size) * buckets);
  for (unsigned pass = 0; pass < passes; ++pass) {
    const unsigned shift = pass * digit_bits;
    const auto digit = [&](const Item& k) {
      return static_cast<std::uint32_t>(key(k) >> shift) & (buckets - 1);
    };
    std::fill(places.begin(), places.end(), 0U);
    run.each_chunk(n, chunk_size, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
      std::uint32_t* counts = places.data() + c * buckets;
      for (std::uint64_t i = begin; i < end; ++i) ++counts[digit(items[i])];
    });
    scan_buckets(places, buckets);
    run.each_chunk(n, chunk_size, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
      std::uint32_t* place = places.data() + c * buckets;
      for (std::uint64_t i = begin; i < end; ++i) scratch[place[digit(items[i])]++] = items[i];
    });
    std::swap(items, scratch);
  }
}

/// An item's id and the key to sort it by.
struct KeyedId {
  std::uint32_t key, id;
};
inline void radix_sort(KeyedId*& items, KeyedId*& scratch, std::uint32_t n, unsigned bits,
                       const Run& run) {
  radix_sort(items, scratch, n, bits, run, [](const KeyedId& k) { return k.key; });
}

}  // namespace cullhull::internal
