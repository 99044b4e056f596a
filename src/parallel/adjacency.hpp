// Lists of items by key, stored one after another in a single array.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <utility>

#include "cullhull/array.hpp"

namespace cullhull::internal {

/// A list of items for each key 0, 1, ..., for instance the cells around each vertex. `Offset`: an
/// unsigned type that holds the number of items.
template <class Item, class Offset = std::uint64_t>
class Adjacency {
 public:
  /// An Adjacency without keys.
  Adjacency() = default;

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

/// For each id below `id_count` the ascending indices of the rows that contain it. `table` holds
/// rows of `width` ids, one after another.
template <class Table>
Adjacency<std::uint32_t> rows_by_id(const Table& table, std::size_t width, std::uint64_t id_count) {
  return {id_count, [&](const auto& add) {
            for (std::size_t i = 0; i < table.size(); ++i)
              add(table[i], static_cast<std::uint32_t>(i / width));
          }};
}

}  // namespace cullhull::internal
