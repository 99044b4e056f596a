// Positions in short lists, and the index that means "no item".
#pragma once

#include <algorithm>

#include "cullhull/array.hpp"

namespace cullhull::internal {

using cullhull::no_index;

/// Returns the first position of an item in a list, for instance of a cell among the neighbours of
/// another cell, or the length of the list if the item is absent.
template <class List, class Item>
inline unsigned place_in(const List& list, const Item& item) {
  return static_cast<unsigned>(std::find(list.begin(), list.end(), item) - list.begin());
}

}  // namespace cullhull::internal
