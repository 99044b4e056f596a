// Stretches: every item once, the owner from the front and thieves from the back.
#include "parallel/threads/stretches.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <utility>
#include <vector>

namespace cullhull::internal::stretches_test {

TEST(Stretches, OneLaneTakesItsOwnInOrderAndThenTheLastOfOthers) {
  Stretches stretches(20, 2, 4);
  std::vector<std::pair<std::uint32_t, std::uint32_t>> taken;
  stretches.work(0,
                 [&](std::uint32_t begin, std::uint32_t end) { taken.emplace_back(begin, end); });
  const std::vector<std::pair<std::uint32_t, std::uint32_t>> expected{{0, 4},   {4, 8},   {8, 10},
                                                                      {16, 20}, {12, 16}, {10, 12}};
  EXPECT_EQ(taken, expected);
  stretches.work(1, [&](std::uint32_t, std::uint32_t) { ADD_FAILURE() << "nothing is left"; });
}

TEST(Stretches, EveryItemOnce) {
  for (const unsigned lanes : {1U, 2U, 3U, 16U, 64U})
    for (const std::uint64_t count : {0U, 1U, 17U, 5000U}) {
      Stretches stretches(count, lanes, 3);
      std::vector<std::atomic<int>> hits(count);
      for_each_chunk(lanes, 1, lanes, [&](std::uint64_t lane, std::uint64_t, std::uint64_t) {
        stretches.work(lane, [&](std::uint32_t begin, std::uint32_t end) {
          for (std::uint32_t i = begin; i < end; ++i) ++hits[i];
        });
      });
      for (std::uint64_t i = 0; i < count; ++i) ASSERT_EQ(hits[i], 1) << i << " of " << count;
    }
}

}  // namespace cullhull::internal::stretches_test
