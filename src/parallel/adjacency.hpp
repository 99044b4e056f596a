// Lists of items by key, stored one after another in a single array.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "cullhull/array.hpp"
#include "parallel/scan.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal {

/// A list of items for each key 0, 1, ..., for instance the cells around each vertex. `Offset`: an
/// unsigned type that holds the number of items.
template <class Item, class Offset = std::uint64_t>
class Adjacency {
 public:
  /// An Adjacency without keys.
  Adjacency() = default;
  /// List k is items[starts[k], starts[k + 1]).
  Adjacency(Array<Offset> starts, Array<Item> items)
      : starts_(std::move(starts)), items_(std::move(items)) {}

  /// Builds lists for the keys below `keys` by counting, in time and memory O(keys + items).
  /// each_item(add) calls add(key, item) for every item. It runs twice, first to count and then to
  /// store, and must make the same calls both times. A list keeps the order of the calls.
  template <class EachItem>
  Adjacency(std::uint64_t keys, const EachItem& each_item) : starts_(keys + 2) {
    std::fill(starts_.begin(), starts_.end(), Offset{0});
    each_item([&](std::uint64_t key, const Item&) { ++starts_[key + 2]; });
    for (std::size_t i = 2; i < starts_.size(); ++i) starts_[i] += starts_[i - 1];
    items_.resize(starts_.back());
    // Until now starts_[k + 1] is the beginning of list k. Storing advances it to the end of
    // list k, which is the beginning of list k + 1: the final layout.
    each_item([&](std::uint64_t key, const Item& item) { items_[starts_[key + 1]++] = item; });
    starts_.pop_back();
  }

  /// The number of lists.
  std::size_t size() const { return starts_.empty() ? 0 : starts_.size() - 1; }
  bool empty() const { return size() == 0; }
  std::span<const Item> operator[](std::uint64_t key) const {
    return {items_.data() + starts_[key], items_.data() + starts_[key + 1]};
  }
  /// The same list, writable.
  std::span<Item> list(std::uint64_t key) {
    return {items_.data() + starts_[key], items_.data() + starts_[key + 1]};
  }
  /// All items, list after list.
  const Array<Item>& items() const { return items_; }
  Array<Item> take_items() && { return std::move(items_); }

  /// Sorts each list and removes repeated items. Calls check() every 4096 lists.
  template <class Check>
  void sort_and_unique(const Check& check) {
    Offset kept = 0;
    for (std::size_t key = 0; key < size(); ++key) {
      if (key % 4096 == 0) check();
      const std::span<Item> own = list(key);
      std::sort(own.begin(), own.end());
      const auto last = std::unique(own.begin(), own.end());
      starts_[key] = kept;
      kept =
          static_cast<Offset>(std::copy(own.begin(), last, items_.begin() + kept) - items_.begin());
    }
    if (!starts_.empty()) starts_.back() = kept;
    items_.resize(kept);
  }

 private:
  Array<Offset> starts_;
  Array<Item> items_;
};

// Why buckets: items that go straight to the lists of a million ids each touch another line of
// memory. Chunks of rows first deal them to buckets of consecutive ids, which are then put in order
// within the cache, each by one thread.

/// For each id below `id_count` the ascending indices of the rows that contain it. `table` holds
/// rows of `width` distinct ids, one after another; fewer than 2^32 rows.
template <class Table>
Adjacency<std::uint32_t> rows_by_id(const Table& table, std::size_t width, std::uint64_t id_count,
                                    const Run& run) {
  if (table.size() < 2 * light_grain)
    return {id_count, [&](const auto& add) {
              for (std::size_t i = 0; i < table.size(); ++i)
                add(table[i], static_cast<std::uint32_t>(i / width));
            }};
  constexpr std::uint64_t most_chunks = 64, most_buckets = 1024;  // each chunk counts all buckets
  unsigned shift = 8;
  while (shift < 16 && id_count >> shift >= most_buckets) ++shift;
  const std::uint64_t rows = table.size() / width, buckets = (id_count >> shift) + 1,
                      grain = std::max(light_grain / width, rows / most_chunks + 1);
  std::vector<std::uint64_t> places(chunk_count(rows, grain) * buckets), firsts;
  run.each_chunk(rows, grain, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    std::uint64_t* const counts = places.data() + c * buckets;
    for (std::size_t i = begin * width; i < end * width; ++i) ++counts[table[i] >> shift];
  });
  scan_buckets(places, buckets, &firsts);
  Array<std::uint64_t> starts(id_count + 1);
  Array<std::uint32_t> items(firsts.back());
  Array<std::uint16_t> ids(items.size());  // of the items, within their bucket
  clear_pages_early(items.data(), items.size() * 4, run.threads, [&] { run.check(); });
  run.each_chunk(rows, grain, [&](std::uint64_t c, std::uint64_t begin, std::uint64_t end) {
    std::uint64_t* const place = places.data() + c * buckets;
    for (std::size_t row = begin, i = row * width; row < end; ++row)
      for (std::size_t j = 0; j < width; ++j, ++i) {
        const std::uint64_t to = place[table[i] >> shift]++;
        items[to] = static_cast<std::uint32_t>(row);
        ids[to] = static_cast<std::uint16_t>(table[i] & ((1U << shift) - 1));
      }
  });
  run.each_item(buckets, [&](std::uint64_t b) {
    const std::uint64_t first = firsts[b], last = firsts[b + 1], first_id = b << shift;
    const std::vector<std::uint32_t> own(items.data() + first, items.data() + last);
    std::vector<std::uint64_t> at(std::uint64_t{1} << shift);  // of each id: its count, its place
    for (std::uint64_t i = first; i < last; ++i) ++at[ids[i]];
    std::uint64_t next = first;
    for (std::uint64_t i = 0; i < at.size() && first_id + i < id_count; ++i) {
      starts[first_id + i] = next;
      next += std::exchange(at[i], next);
    }
    for (std::uint64_t i = first; i < last; ++i) items[at[ids[i]]++] = own[i - first];
  });
  starts[id_count] = items.size();
  return {std::move(starts), std::move(items)};
}

}  // namespace cullhull::internal
