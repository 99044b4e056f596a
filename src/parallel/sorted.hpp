// A sorted copy.
#pragma once

#include <algorithm>
#include <utility>
#include <vector>

namespace cullhull::internal::inline parallel {

/// Ascending; linear for sorted input.
template <class T>
std::vector<T> sorted(std::vector<T> items) {
  if (!std::is_sorted(items.begin(), items.end())) std::sort(items.begin(), items.end());
  return items;
}

}  // namespace cullhull::internal::inline parallel
