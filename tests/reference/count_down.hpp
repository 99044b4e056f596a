// Rounds over lists that grow shorter: for the tests of `rounds`, `next` and `is_first`.
#pragma once

#include <cstdint>

#include "parallel/host_device.hpp"

namespace cullhull::internal {

/// Every listed item is lowered by 1 in a round, and is listed for the next one until it is 0;
/// twice where its number is odd, of which `is_first` takes one.
template <class Executor>
struct CountDown {
  std::uint32_t* value;
  std::uint32_t* list[2];
  std::uint32_t* listed_for;
  std::uint32_t* count;

  CULLHULL_HD static std::uint32_t items_of(std::uint32_t listed) { return listed; }
  CULLHULL_HD std::uint32_t items(std::uint32_t round) const { return count[round]; }
  CULLHULL_HD void first(std::uint32_t round, std::uint32_t i) const {
    --value[list[round % 2][i]];
  }
  CULLHULL_HD void second(std::uint32_t round, std::uint32_t i) const {
    const std::uint32_t item = list[round % 2][i];
    for (unsigned k = 0; k <= item % 2 && value[item] != 0; ++k)
      if (Executor::is_first(listed_for[item], round + 1))
        list[(round + 1) % 2][Executor::next(count[round + 1], 1)] = item;
  }
};

}  // namespace cullhull::internal
