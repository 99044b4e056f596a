// Lists by key.
#include "parallel/adjacency.hpp"

#include <gtest/gtest.h>

#include <vector>

namespace cullhull::internal::adjacency_test {

std::vector<std::uint32_t> list(const Adjacency<std::uint32_t>& lists, std::uint64_t key) {
  return {lists[key].begin(), lists[key].end()};
}
using List = std::vector<std::uint32_t>;

TEST(Adjacency, ListsKeepTheOrderOfTheCalls) {
  const Adjacency<std::uint32_t> lists(4, [](const auto& add) {
    add(3, 7U);
    add(1, 9U);
    add(3, 2U);
    add(0, 5U);
    add(3, 7U);
  });
  EXPECT_EQ(lists.size(), 4U);
  EXPECT_EQ(list(lists, 0), List{5});
  EXPECT_EQ(list(lists, 1), List{9});
  EXPECT_EQ(list(lists, 2), List{});
  EXPECT_EQ(list(lists, 3), (List{7, 2, 7}));
  EXPECT_EQ(lists.items().size(), 5U);
}

TEST(Adjacency, NoKeysAndNoItems) {
  EXPECT_TRUE(Adjacency<std::uint32_t>().empty());
  const auto nothing = [](const auto&) {};
  EXPECT_TRUE(Adjacency<std::uint32_t>(0, nothing).empty());
  const Adjacency<std::uint32_t> lists(3, nothing);
  EXPECT_EQ(lists.size(), 3U);
  for (unsigned key = 0; key < 3; ++key) EXPECT_TRUE(lists[key].empty());
}

TEST(Adjacency, SortedWithoutRepetitions) {
  Adjacency<std::uint32_t> lists(3, [](const auto& add) {
    for (const std::uint32_t item : {4U, 1U, 4U, 1U, 1U}) add(0, item);
    for (const std::uint32_t item : {3U, 2U}) add(2, item);
  });
  unsigned checks = 0;
  lists.sort_and_unique([&] { ++checks; });
  EXPECT_EQ(checks, 1U);
  EXPECT_EQ(list(lists, 0), (List{1, 4}));
  EXPECT_EQ(list(lists, 1), List{});
  EXPECT_EQ(list(lists, 2), (List{2, 3}));
  EXPECT_EQ(lists.items().size(), 4U);
}

TEST(Adjacency, RowsOfATable) {
  const std::vector<std::uint64_t> table{0, 2, 1, 3, 2, 1};  // two triangles
  const auto rows = rows_by_id(table, 3, 5);
  EXPECT_EQ(list(rows, 0), List{0});
  EXPECT_EQ(list(rows, 1), (List{0, 1}));
  EXPECT_EQ(list(rows, 2), (List{0, 1}));
  EXPECT_EQ(list(rows, 3), List{1});
  EXPECT_EQ(list(rows, 4), List{});
}

}  // namespace cullhull::internal::adjacency_test
