// Positions in short lists, and the index that means "no item".
#pragma once

#include <algorithm>
#include <cstdint>

namespace cullhull::internal {

/// Stored in place of an item's index where there is no item.
inline constexpr std::uint32_t no_index = 0xffffffff;

/// Returns the first position of an item in a list, for instance of a cell among the neighbours of
/// another cell, or the length of the list if the item is absent.
template <class List, class Item>
inline unsigned place_in(const List& list, const Item& item) {
  return static_cast<unsigned>(std::find(list.begin(), list.end(), item) - list.begin());
}

}  // namespace cullhull::internal
