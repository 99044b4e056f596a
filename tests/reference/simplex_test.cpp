// Simplices sorted with the sign of the permutation, facets of cells, ridges paired by sums.
#include "geometry/simplex.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

#include "geometry/insertion_rounds.hpp"

namespace cullhull::internal::simplex_test {

/// Whether the number of pairs out of order is odd.
bool odd_permutation(const std::vector<std::uint32_t>& ids) {
  bool odd = false;
  for (std::size_t i = 0; i < ids.size(); ++i)
    for (std::size_t j = i + 1; j < ids.size(); ++j) odd ^= ids[i] > ids[j];
  return odd;
}

template <unsigned N>
void check_all_permutations() {
  std::vector<std::uint32_t> ids(N);
  std::iota(ids.begin(), ids.end(), 5U);
  const std::vector<std::uint32_t> ascending = ids;
  do {
    const bool odd = odd_permutation(ids);
    std::vector<std::uint32_t> sorted = ids, along = ids, again = ids, even = ids, moved = ids;
    EXPECT_EQ(sort_simplex<N>(sorted.data(), along.data(), N), odd);
    EXPECT_EQ(sorted, ascending);
    EXPECT_EQ(along, ascending);
    EXPECT_EQ(sort_simplex<0>(again.data(), nullptr, N), odd);
    EXPECT_EQ(again, ascending);
    EXPECT_EQ((sort_simplex<N, true>(even.data(), moved.data(), N)), odd);
    EXPECT_EQ(odd_permutation(even), odd);
    EXPECT_EQ(moved, even);
  } while (std::next_permutation(ids.begin(), ids.end()));
}

TEST(Simplex, EveryPermutation) {
  check_all_permutations<2>();
  check_all_permutations<3>();
  check_all_permutations<4>();
  check_all_permutations<5>();
}

/// In the plane a positive cell is counterclockwise, and so are its facets as edges from the first
/// id to the second: the cell is on their left.
TEST(Simplex, FacetsOfATriangle) {
  const std::vector<std::uint32_t> cell{4, 9, 6};
  std::uint32_t facet[2];
  outward_facet(cell, 0, facet);
  EXPECT_EQ(std::vector<std::uint32_t>(facet, facet + 2), (std::vector<std::uint32_t>{9, 6}));
  outward_facet(cell, 1, facet);
  EXPECT_EQ(std::vector<std::uint32_t>(facet, facet + 2), (std::vector<std::uint32_t>{6, 4}));
  outward_facet(cell, 2, facet);
  EXPECT_EQ(std::vector<std::uint32_t>(facet, facet + 2), (std::vector<std::uint32_t>{4, 9}));
}

TEST(Simplex, RidgeSumsTellPairsFromAllOthers) {
  constexpr std::uint32_t large = 0xfffffffe;
  std::uint64_t slot = RidgeSums::entry(large);
  EXPECT_FALSE(RidgeSums::is_pair(slot));
  slot += RidgeSums::entry(large - 1);
  EXPECT_TRUE(RidgeSums::is_pair(slot));
  EXPECT_EQ(RidgeSums::other(slot, large), large - 1);
  EXPECT_EQ(RidgeSums::other(slot, large - 1), large);
  for (std::size_t entries = 2; entries + 1 < RidgeSums::max_entries; ++entries) {
    slot += RidgeSums::entry(large);
    ASSERT_FALSE(RidgeSums::is_pair(slot)) << entries;
  }
}

TEST(InsertionRounds, EachIsAMultipleOfAllBefore) {
  EXPECT_EQ(InsertionRounds(1024, 1024, 3).count, 1U);
  const InsertionRounds rounds(1 << 20, 1024, 3);
  EXPECT_EQ(rounds.count, 5U);
  EXPECT_EQ(rounds.round_of(1), 4U);
  EXPECT_EQ(rounds.round_of(8), 3U);
  EXPECT_EQ(rounds.round_of(std::uint64_t{1} << 63), 0U);
  EXPECT_EQ(rounds.round_of(0), 0U);
}

}  // namespace cullhull::internal::simplex_test
