// Indices into short lists, and the index that stands for none.
#pragma once

#include <algorithm>
#include <cstdint>

namespace cullhull::internal::inline parallel {

/// Stands for no item where indices of items are stored.
inline constexpr std::uint32_t no_index = 0xffffffff;

/// The place of an item in a list, for instance of a cell among the neighbours of another; the
/// length of the list if it is absent.
template <class List, class Item>
inline unsigned place_in(const List& list, const Item& item) {
  return static_cast<unsigned>(std::find(list.begin(), list.end(), item) - list.begin());
}

}  // namespace cullhull::internal::inline parallel
