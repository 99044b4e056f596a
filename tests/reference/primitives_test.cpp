// The data-parallel primitives: each executor against plain loops.
#include "parallel/primitives.hpp"

#include <gtest/gtest.h>

#include <numeric>
#include <random>

namespace cullhull::internal {
namespace {

constexpr std::uint32_t sizes[] = {0, 1, 2, 63, 64, 65, 4095, 4096, 4097, 30011};

template <class Executor>
void expect_as_plain_loops(Executor executor) {
  std::mt19937 random(7);
  for (const std::uint32_t n : sizes) {
    std::vector<std::uint32_t> v(n);
    for (auto& x : v) x = static_cast<std::uint32_t>(random() % 5);

    std::vector<std::uint32_t> touched(n, 0);
    executor.for_each(n, [&](std::uint32_t i) { touched[i] += i + 1; });
    for (std::uint32_t i = 0; i < n; ++i) ASSERT_EQ(touched[i], i + 1);

    // Not commutative: the order of items matters.
    using Pair = std::pair<std::uint32_t, std::uint32_t>;  // x -> a x + b, composed
    const auto compose = [](const Pair& f, const Pair& g) {
      return Pair{f.first * g.first, f.second * g.first + g.second};
    };
    const auto map = [&](std::uint32_t i) { return Pair{2 * v[i] + 1, i}; };
    Pair expected{1, 0};
    for (std::uint32_t i = 0; i < n; ++i) expected = compose(expected, map(i));
    EXPECT_EQ(executor.reduce(n, Pair{1, 0}, map, compose), expected);

    std::vector<std::uint32_t> wanted, got(n);
    for (std::uint32_t i = 0; i < n; ++i)
      if (v[i] == 3) wanted.push_back(i);
    const auto kept = executor.select(
        n, [&](std::uint32_t i) { return v[i] == 3; },
        [&](std::uint32_t i, std::uint32_t k) { got.at(k) = i; });
    got.resize(kept);
    EXPECT_EQ(got, wanted);

    std::vector<std::uint32_t> scanned = v, sums(n);
    std::exclusive_scan(v.begin(), v.end(), sums.begin(), 0U);
    EXPECT_EQ(executor.exclusive_scan(scanned.data(), n), std::accumulate(v.begin(), v.end(), 0U));
    EXPECT_EQ(scanned, sums);

    // Segment 4 of 6 is empty; few values, so that ties are the rule.
    const auto segment = [&](std::uint32_t i) { return v[i] == 4 ? 5 : v[i]; };
    const auto value = [&](std::uint32_t i) { return i % 7 == 0 ? 0.0 : 0.25 * (i % 3); };
    std::vector<std::uint32_t> winner(6, 77), best(6, no_item);
    for (std::uint32_t i = 0; i < n; ++i) {
      std::uint32_t& b = best[segment(i)];
      if (b == no_item || value(i) > value(b)) b = i;
    }
    executor.segmented_argmax(n, 6, segment, value, winner.data());
    EXPECT_EQ(winner, best);
  }
}

TEST(Primitives, SerialEqualsPlainLoops) { expect_as_plain_loops(SerialExecutor{}); }

TEST(Primitives, TbbEqualsPlainLoops) {
  for (const unsigned threads : {1U, 2U, 3U}) expect_as_plain_loops(TbbExecutor(threads));
}

TEST(Primitives, ExceptionsPassThrough) {
  const auto fail = [](std::uint32_t i) {
    if (i == 9000) throw std::runtime_error("nine thousand");
  };
  EXPECT_THROW(SerialExecutor{}.for_each(10000, fail), std::runtime_error);
  EXPECT_THROW(TbbExecutor(2).for_each(10000, fail), std::runtime_error);
}

}  // namespace
}  // namespace cullhull::internal
