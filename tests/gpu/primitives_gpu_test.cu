// The data-parallel primitives on the device, each against the serial reference.
#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <vector>

#include "cuda/kernels/executor.cuh"
#include "cullhull/options.hpp"
#include "gpu/device.hpp"
#include "reference/count_down.hpp"

namespace cullhull::internal {
namespace {

using testing::OnDevice;
using testing::Stream;

struct Touch {
  const std::uint32_t* v;
  std::uint32_t* out;
  CULLHULL_HD void operator()(std::uint32_t i) const { out[i] += v[i] + i; }
};

struct Halve {
  const std::uint32_t* v;
  std::uint32_t* out;
  CULLHULL_HD void operator()(std::uint32_t i) const { out[i] = v[i / 2]; }
};

struct Best {
  std::uint32_t value, item;
};
struct BestOf {
  const std::uint32_t* v;
  CULLHULL_HD Best operator()(std::uint32_t i) const { return {v[i] + 1, i}; }
};
struct Better {
  CULLHULL_HD Best operator()(const Best& a, const Best& b) const {
    return b.value > a.value || (b.value == a.value && b.item < a.item) ? b : a;
  }
};

struct IsThree {
  const std::uint32_t* v;
  CULLHULL_HD bool operator()(std::uint32_t i) const { return v[i] == 3; }
};
struct Place {
  std::uint32_t* out;
  CULLHULL_HD void operator()(std::uint32_t i, std::uint32_t k) const { out[k] = i; }
};

struct OfferTo {
  std::uint32_t cells;
  CULLHULL_HD Offer operator()(std::uint32_t i) const {
    const std::uint32_t c = i * 2654435761U % (cells + 2);
    if (c == cells) return {no_item, 0};
    if (c == cells + 1) return {no_item - 1, 0};
    return {c, (std::uint64_t{i} * 40503 % 65521 + 1) << 30};
  }
};

template <class Executor>
struct Lowest {
  const std::uint32_t* v;
  std::uint32_t* least;
  CULLHULL_HD void operator()(std::uint32_t i) const { Executor::lower(least[v[i]], i ^ 21U); }
};

constexpr std::uint32_t sizes[] = {0,   1,   2,    31,   32,   33,    255,
                                   256, 257, 4095, 4096, 4097, 70001, 1'200'003};

std::vector<std::uint32_t> few_values(std::uint32_t n) {
  std::mt19937 random(7);
  std::vector<std::uint32_t> v(n);
  for (auto& x : v) x = static_cast<std::uint32_t>(random() % 5);
  return v;
}

template <class T>
std::vector<T> fetched(CudaExecutor& executor, const T* from, std::size_t n) {
  std::vector<T> v(n);
  if (n != 0) executor.fetch(from, n, v.data());
  return v;
}

TEST(PrimitivesGpu, ForEachAndReduce) {
  CULLHULL_NEEDS_DEVICE();
  const Stream stream;
  CudaExecutor executor(stream);
  for (const std::uint32_t n : sizes) {
    std::vector<std::uint32_t> v = few_values(n), out(n, 5);
    const OnDevice dv(v), dout(out);
    SerialExecutor{}.for_each(n, Touch{v.data(), out.data()});
    executor.for_each(n, Touch{dv.data<std::uint32_t>(), dout.data<std::uint32_t>()});
    EXPECT_EQ(fetched(executor, dout.data<std::uint32_t>(), n), out);

    const Best expected = SerialExecutor{}.reduce(n, Best{0, no_item}, BestOf{v.data()}, Better{});
    const Best got =
        executor.reduce(n, Best{0, no_item}, BestOf{dv.data<std::uint32_t>()}, Better{});
    EXPECT_EQ(got.value, expected.value);
    EXPECT_EQ(got.item, expected.item);
  }
}

TEST(PrimitivesGpu, SelectAndEnumerate) {
  CULLHULL_NEEDS_DEVICE();
  const Stream stream;
  CudaExecutor executor(stream);
  for (const std::uint32_t n : sizes) {
    const std::vector<std::uint32_t> v = few_values(n);
    std::vector<std::uint32_t> wanted(n + 1), number(n + 1);
    const OnDevice dv(v), got(wanted), dnumber(number);
    const auto kept = SerialExecutor{}.select(n, IsThree{v.data()}, Place{wanted.data()});
    EXPECT_EQ(
        executor.select(n, IsThree{dv.data<std::uint32_t>()}, Place{got.data<std::uint32_t>()}),
        kept);
    wanted.resize(kept);
    EXPECT_EQ(fetched(executor, got.data<std::uint32_t>(), kept), wanted);

    std::vector<std::uint32_t> out(n, 5);
    const OnDevice dout(out);
    SerialExecutor{}.enumerate(n, IsThree{v.data()}, number.data(),
                               Touch{number.data(), out.data()});
    EXPECT_EQ(
        executor.enumerate(n, IsThree{dv.data<std::uint32_t>()}, dnumber.data<std::uint32_t>(),
                           Touch{dnumber.data<std::uint32_t>(), dout.data<std::uint32_t>()}),
        kept);
    number.resize(n);
    EXPECT_EQ(fetched(executor, dnumber.data<std::uint32_t>(), n), number);
    EXPECT_EQ(fetched(executor, dout.data<std::uint32_t>(), n), out);

    const OnDevice appended(wanted), doubled(std::vector<std::uint32_t>(2 * n));
    const CudaExecutor::Count there = executor.append(n, IsThree{dv.data<std::uint32_t>()},
                                                      Place{appended.data<std::uint32_t>()});
    // What is not known on the host yet can be the number of items for another.
    executor.for_each(CudaExecutor::times(there, 2),
                      Halve{appended.data<std::uint32_t>(), doubled.data<std::uint32_t>()});
    EXPECT_EQ(there, kept);
    std::vector<std::uint32_t> any_order = fetched(executor, appended.data<std::uint32_t>(), kept);
    std::vector<std::uint32_t> copies = fetched(executor, doubled.data<std::uint32_t>(), 2 * kept);
    for (std::size_t i = 0; i < copies.size(); ++i) EXPECT_EQ(copies[i], any_order[i / 2]);
    std::ranges::sort(any_order);
    EXPECT_EQ(any_order, wanted);
  }
}

TEST(PrimitivesGpu, Rounds) {
  CULLHULL_NEEDS_DEVICE();
  const Stream stream;
  CudaExecutor executor(stream);
  for (const std::uint32_t n : sizes) {
    std::vector<std::uint32_t> value = few_values(n), odd(n), count(601, 0);
    std::iota(odd.begin(), odd.end(), 0U);
    for (std::uint32_t i = 0; i < n; ++i) value[i] += 1 + (i % 1000 == 7 ? 300 : 0);
    const std::uint32_t rounds = n == 0 ? 0 : *std::ranges::max_element(value);
    const OnDevice values(value), even(odd), odds(odd), zeros(std::vector<std::uint32_t>(n, 0)),
        counts(count);
    const CountDown<CudaExecutor> steps{values.data<std::uint32_t>(),
                                        {even.data<std::uint32_t>(), odds.data<std::uint32_t>()},
                                        zeros.data<std::uint32_t>(),
                                        counts.data<std::uint32_t>()};
    EXPECT_EQ(executor.rounds(steps, 1, 599, n, Control(Options{})), rounds);
    EXPECT_EQ(fetched(executor, values.data<std::uint32_t>(), n), std::vector<std::uint32_t>(n, 0));
  }
}

TEST(PrimitivesGpu, ScatterMaxAndLower) {
  CULLHULL_NEEDS_DEVICE();
  const Stream stream;
  CudaExecutor executor(stream);
  for (const std::uint32_t n : sizes) {
    for (const std::uint32_t cells : {1U, 3U, 2047U, 40000U, 200000U}) {
      std::vector<std::uint64_t> best(cells, 9);
      const OnDevice got(best);
      const auto none = SerialExecutor{}.scatter_max(n, cells, OfferTo{cells}, best.data());
      EXPECT_EQ(executor.scatter_max(n, cells, OfferTo{cells}, got.data<std::uint64_t>()), none);
      EXPECT_EQ(fetched(executor, got.data<std::uint64_t>(), cells), best);
    }
    const std::vector<std::uint32_t> v = few_values(n);
    std::vector<std::uint32_t> least(5, no_item);
    const OnDevice dv(v), dleast(least);
    SerialExecutor{}.for_each(n, Lowest<SerialExecutor>{v.data(), least.data()});
    executor.for_each(n,
                      Lowest<CudaExecutor>{dv.data<std::uint32_t>(), dleast.data<std::uint32_t>()});
    EXPECT_EQ(fetched(executor, dleast.data<std::uint32_t>(), 5), least);
  }
}

}  // namespace
}  // namespace cullhull::internal
