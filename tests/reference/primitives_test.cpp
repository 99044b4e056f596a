// The data-parallel primitives: each executor against plain loops.
#include "filter/pseudo_hull/primitives.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

#include "cullhull/options.hpp"
#include "reference/count_down.hpp"
#include "reference/emulated_executor.hpp"

namespace cullhull::internal::primitives_test {

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

    // The largest value and the first item that has it.
    using Best = std::pair<std::uint32_t, std::uint32_t>;
    const auto better = [](const Best& a, const Best& b) {
      return b.first > a.first || (b.first == a.first && b.second < a.second) ? b : a;
    };
    const auto map = [&](std::uint32_t i) { return Best{v[i] + 1, i}; };
    Best expected{0, no_item};
    for (std::uint32_t i = 0; i < n; ++i) expected = better(expected, map(i));
    EXPECT_EQ(executor.reduce(n, Best{0, no_item}, map, better), expected);

    std::vector<std::uint32_t> wanted, got(n);
    for (std::uint32_t i = 0; i < n; ++i)
      if (v[i] == 3) wanted.push_back(i);
    const auto kept = executor.select(
        n, [&](std::uint32_t i) { return v[i] == 3; },
        [&](std::uint32_t i, std::uint32_t k) { got.at(k) = i; });
    got.resize(kept);
    EXPECT_EQ(got, wanted);

    std::vector<std::uint32_t> appended(n);
    EXPECT_EQ(executor.append(
                  n, [&](std::uint32_t i) { return v[i] == 3; },
                  [&](std::uint32_t i, std::uint32_t k) { appended.at(k) = i; }),
              kept);
    appended.resize(kept);
    std::ranges::sort(appended);
    EXPECT_EQ(appended, wanted);

    std::vector<std::uint32_t> numbers(n + 1), sums(n + 1), after(n, 0);
    std::uint32_t sum = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      sums[i] = sum;
      sum += v[i] >= 2 ? 1 : 0;
    }
    EXPECT_EQ(executor.enumerate(
                  n, [&](std::uint32_t i) { return v[i] >= 2; }, numbers.data(),
                  [&](std::uint32_t i) { after[i] = numbers[i]; }),
              sum);
    sums.resize(n);
    EXPECT_EQ(after, sums);

    // Cells 1 and 5 of 6 get nothing; some offers are to no cell.
    const auto offer = [&](std::uint32_t i) {
      if (i % 11 == 3) return Offer{no_item, 0};
      if (i % 11 == 7) return Offer{no_item - 1, 0};
      return Offer{v[i] == 1 ? 0 : v[i], 1 + i % 7 * (std::uint64_t{1} << 40)};
    };
    std::vector<std::uint64_t> best(6, 77), most(6, 0);
    std::uint32_t none = 0;
    for (std::uint32_t i = 0; i < n; ++i) {
      const Offer o = offer(i);
      none += o.cell == no_item ? 1 : 0;
      if (o.cell < 6) most[o.cell] = std::max(most[o.cell], o.value);
    }
    EXPECT_EQ(executor.scatter_max(n, 6, offer, best.data()), none);
    EXPECT_EQ(best, most);

    std::vector<std::uint32_t> least(5, no_item), lowest(5, no_item);
    executor.for_each(n, [&](std::uint32_t i) { Executor::lower(least[v[i]], i ^ 21U); });
    for (std::uint32_t i = 0; i < n; ++i) lowest[v[i]] = std::min(lowest[v[i]], i ^ 21U);
    EXPECT_EQ(least, lowest);

    std::vector<std::uint32_t> value(v), odd(n), even(n), listed_for(n, 0), count(10, 0);
    std::iota(odd.begin(), odd.end(), 0U);
    for (auto& x : value) ++x;
    const std::uint32_t rounds = n == 0 ? 0 : *std::ranges::max_element(value);
    const CountDown<Executor> steps{
        value.data(), {even.data(), odd.data()}, listed_for.data(), count.data()};
    EXPECT_EQ(executor.rounds(steps, 1, 9, n, Control(Options{})), rounds);
    EXPECT_EQ(value, std::vector<std::uint32_t>(n, 0));
  }
}

TEST(Primitives, SerialEqualsPlainLoops) { expect_as_plain_loops(SerialExecutor{}); }

TEST(Primitives, ThreadsEqualPlainLoops) {
  for (const unsigned threads : {1U, 2U, 3U}) expect_as_plain_loops(ThreadExecutor(threads));
}

TEST(Primitives, KernelBodiesEqualPlainLoops) {
  for (const std::uint32_t blocks : {1U, 3U, 200U})
    for (const std::uint32_t size : {1U, 32U, 256U})
      expect_as_plain_loops(EmulatedExecutor(blocks, size));
}

TEST(Primitives, ScatterMaxWithAnyNumberOfCopies) {
  EXPECT_EQ(scatter_copies(4), 64U);
  EXPECT_EQ(scatter_copies(1U << 15), 4U);
  EXPECT_EQ(scatter_copies(3U << 29), 1U);
  for (const std::uint32_t cells : {1U, 2047U, 2049U, 40000U, 200000U}) {
    const auto offer = [&](std::uint32_t i) {
      const std::uint32_t c = i * 2654435761U % (cells + 1);
      return c < cells ? Offer{c, std::uint64_t{i} * 40503 % 65521 + 1} : Offer{no_item, 0};
    };
    std::vector<std::uint64_t> wanted(cells), got(cells, 5);
    const auto none = SerialExecutor{}.scatter_max(30000, cells, offer, wanted.data());
    EXPECT_EQ(EmulatedExecutor(99, 8).scatter_max(30000, cells, offer, got.data()), none);
    EXPECT_EQ(got, wanted) << cells;
  }
}

TEST(Primitives, ExceptionsPassThrough) {
  const auto fail = [](std::uint32_t i) {
    if (i == 9000) throw std::runtime_error("nine thousand");
  };
  EXPECT_THROW(SerialExecutor{}.for_each(10000, fail), std::runtime_error);
  EXPECT_THROW(ThreadExecutor(2).for_each(10000, fail), std::runtime_error);
}

}  // namespace cullhull::internal::primitives_test
