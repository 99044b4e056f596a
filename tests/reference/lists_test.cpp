#include "cullhull/lists.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <ranges>
#include <span>
#include <vector>

#include "cullhull/generate.hpp"
#include "cullhull/hull.hpp"

namespace cullhull::lists_test {

TEST(SharedArray, CopiesShareUntilOneIsEdited) {
  SharedArray<int> a = {1, 2, 3};
  const SharedArray<int> b = a;
  EXPECT_TRUE(a.shares(b));
  a.edit()[1] = 7;
  EXPECT_FALSE(a.shares(b));
  EXPECT_EQ(a, (SharedArray<int>{1, 7, 3}));
  EXPECT_EQ(b, (SharedArray<int>{1, 2, 3}));
  const int* before = a.data();
  a.edit()[0] = 5;  // alone: in place
  EXPECT_EQ(a.data(), before);
  EXPECT_NE(a, b);
}

TEST(SharedArray, EmptyOnes) {
  SharedArray<int> a;
  EXPECT_TRUE(a.empty());
  EXPECT_EQ(a.begin(), a.end());
  EXPECT_EQ(a, SharedArray<int>(Array<int>()));
  a.edit().push_back(4);
  EXPECT_EQ(a.back(), 4);
  SharedArray<int> moved = std::move(a);
  EXPECT_EQ(moved.size(), 1U);
}

TEST(Lists, AreRangesOfSpans) {
  Lists<int> lists;
  EXPECT_TRUE(lists.empty());
  EXPECT_EQ(lists.begin(), lists.end());
  lists.items = {1, 2, 3, 4, 5, 6};
  for (const std::uint64_t end : {2, 2, 6}) lists.offsets.push_back(end);
  static_assert(std::ranges::random_access_range<Lists<int>>);
  std::vector<std::vector<int>> seen;
  for (const std::span<const int> list : lists) seen.emplace_back(list.begin(), list.end());
  EXPECT_EQ(seen, (std::vector<std::vector<int>>{{1, 2}, {}, {3, 4, 5, 6}}));
  EXPECT_EQ(std::ranges::count_if(lists, [](std::span<const int> l) { return l.empty(); }), 1);
}

TEST(Lists, AreEmptyAfterAMove) {
  for (const std::uint64_t second : {4, 5}) {  // spaced evenly, so not stored, and unevenly
    Lists<int> lists;
    lists.items = {1, 2, 3, 4, 5};
    lists.offsets.push_back(2);
    lists.offsets.push_back(second);
    const Lists<int> moved = std::move(lists);
    EXPECT_EQ(moved.size(), 2U);
    EXPECT_EQ(moved[1].size(), second - 2);
    EXPECT_EQ(lists.size(), 0U);            // NOLINT: what a move leaves is the subject
    EXPECT_EQ(lists.begin(), lists.end());  // NOLINT
  }
}

TEST(Lists, OfAHull) {
  const std::vector<double> cube = generate("grid", 27, 3);
  const Hull hull = convex_hull(PointView::row_major(cube, 3));
  std::uint64_t f = 0;
  for (const auto facet : hull.facets) {
    EXPECT_EQ(facet.data(), hull.facet(f).data());
    EXPECT_EQ(hull.plane(f).size(), 4U);
    ++f;
  }
  EXPECT_EQ(f, hull.facet_count());
  EXPECT_EQ(hull.simplex(1).data(), hull.simplices.data() + 3);
  EXPECT_EQ(hull.simplex(1).size(), 3U);
}

TEST(EvenArray, SpacingStaysEvenWhileItCan) {
  EvenArray<std::uint64_t> a{0};
  for (const std::uint64_t v : {3, 6, 9}) a.push_back(v);
  ASSERT_NE(a.step(), nullptr);
  EXPECT_EQ(*a.step(), 3U);
  EXPECT_EQ(a.data(), nullptr);
  EXPECT_EQ(a, EvenArray<std::uint64_t>::of_step(4, 3));
  a.push_back(13);
  EXPECT_EQ(a.step(), nullptr);
  EXPECT_EQ(std::vector<std::uint64_t>(a.begin(), a.end()),
            (std::vector<std::uint64_t>{0, 3, 6, 9, 13}));
  EXPECT_EQ(a, (EvenArray<std::uint64_t>(Array<std::uint64_t>{0, 3, 6, 9, 13})));
  EXPECT_NE(a, (EvenArray<std::uint64_t>::of_step(5, 3)));
}

TEST(EvenArray, IsTheArrayItStandsFor) {
  // Whatever is pushed: zeros, an odd start, a change of step.
  const std::vector<std::vector<std::uint32_t>> cases = {
      {}, {0}, {5}, {0, 0}, {0, 0, 0, 1}, {0, 1, 2, 3}, {0, 2, 3}, {1, 2, 3}, {0, 4, 8, 0}};
  for (const auto& items : cases) {
    EvenArray<std::uint32_t> a;
    for (const std::uint32_t v : items) a.push_back(v);
    ASSERT_EQ(a.size(), items.size());
    EXPECT_EQ(a.empty(), items.empty());
    EXPECT_TRUE(std::equal(a.begin(), a.end(), items.begin()));
    for (std::size_t i = 0; i < items.size(); ++i) EXPECT_EQ(a[i], items[i]);
    const EvenArray<std::uint32_t> stored(Array<std::uint32_t>(items.begin(), items.end()));
    EXPECT_EQ(stored.step(), nullptr);
    EXPECT_EQ(a, stored);
    EvenArray<std::uint32_t> edited = a;
    edited.edit().push_back(99);
    EXPECT_EQ(edited.size(), items.size() + 1);
    EXPECT_EQ(a.size(), items.size());
    EXPECT_EQ(edited.back(), 99U);
  }
}

TEST(Lists, OfOneLengthAndOfMany) {
  const auto pairs = Lists<int>::of_length(2, {1, 2, 3, 4});
  ASSERT_EQ(pairs.size(), 2U);
  EXPECT_EQ(pairs[1][0], 3);
  EXPECT_EQ(pairs[1].size(), 2U);
  Lists<int> many;
  EXPECT_EQ(many.size(), 0U);
  many.items = {1, 2, 3, 4};
  many.offsets.push_back(2);
  many.offsets.push_back(4);
  EXPECT_EQ(many, pairs);
  many.offsets.push_back(4);
  EXPECT_EQ(many.size(), 3U);
  EXPECT_TRUE(many[2].empty());
}

/// What a hull of many facets must not hold twice, and that a copy is a copy all the same.
TEST(Lists, FacetsOfASimplicialHullAreItsSimplices) {
  const std::vector<double> rows = generate("sphere", 200, 3, 1);
  Hull hull = convex_hull(PointView::row_major(rows.data(), 200, 3));
  ASSERT_EQ(hull.facet_count(), hull.simplex_count());
  EXPECT_TRUE(hull.facets.items.shares(hull.simplices));
  EXPECT_NE(hull.facets.offsets.step(), nullptr);
  EXPECT_NE(hull.simplex_facets.step(), nullptr);
  const Hull copy = hull;
  hull.rename([](std::uint64_t id) { return id + 1000; });
  EXPECT_TRUE(hull.facets.items.shares(hull.simplices));
  for (std::size_t i = 0; i < copy.simplices.size(); ++i) {
    ASSERT_EQ(hull.facets.items[i], copy.facets.items[i] + 1000);
    ASSERT_LT(copy.simplices[i], 200U);
  }
  hull.simplices.edit()[0] = 7;
  EXPECT_EQ(hull.facets.items[0], copy.facets.items[0] + 1000);
}

}  // namespace cullhull::lists_test
