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
  const auto rows = rows_by_id(table, 3, 5, short_run());
  EXPECT_EQ(list(rows, 0), List{0});
  EXPECT_EQ(list(rows, 1), (List{0, 1}));
  EXPECT_EQ(list(rows, 2), (List{0, 1}));
  EXPECT_EQ(list(rows, 3), List{1});
  EXPECT_EQ(list(rows, 4), List{});
}

TEST(Adjacency, RowsOfALongTableInBuckets) {
  for (const std::uint64_t ids : {5000ULL, 1ULL << 16, 300000ULL}) {
    std::vector<std::uint32_t> table;  // rows of three distinct ids; 17 and the last id have none
    for (std::uint32_t row = 0; row < 50000; ++row)
      for (std::uint32_t j = 0; j < 3; ++j) {
        const std::uint64_t id = (row * 7919ULL + j * (ids / 3)) % (ids - 1);
        table.push_back(static_cast<std::uint32_t>(id == 17 ? 18 : id));
      }
    const Adjacency<std::uint32_t> expected(ids, [&](const auto& add) {
      for (std::uint32_t i = 0; i < table.size(); ++i) add(table[i], i / 3);
    });
    for (const unsigned threads : {1U, 2U, 3U, 16U, 64U}) {
      const Options options{.threads = threads};
      const auto rows = rows_by_id(table, 3, ids, internal::Run(options));
      ASSERT_EQ(rows.size(), ids);
      for (std::uint64_t id = 0; id < ids; ++id)
        ASSERT_EQ(list(rows, id), list(expected, id)) << id << " of " << ids;
    }
  }
}

}  // namespace cullhull::internal::adjacency_test
