// The order of the engine for d >= 4: its curve visits cell after neighbouring cell; every point is
// taken once, the outermost first, whatever is dropped between rounds.
#include "geometry/norm_order.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <vector>

#include "cullhull/generate.hpp"
#include "cullhull/options.hpp"
#include "geometry/curve_frame.hpp"

namespace cullhull::internal::norm_order_test {

TEST(CurveKeys, NeighboursInOrderAreNeighboursInSpace) {
  for (const auto& [d, bits] : std::vector<std::pair<unsigned, unsigned>>{
           {4, 1}, {4, 2}, {4, 4}, {5, 2}, {5, 3}, {6, 1}, {6, 2}, {7, 2}, {9, 1}}) {
    SCOPED_TRACE(std::to_string(d) + "D, bits " + std::to_string(bits));
    const std::uint32_t count = 1U << (d * bits), mask = (1U << bits) - 1;
    std::vector<std::uint32_t> cell_at(count, count);
    for (std::uint32_t first = 0; first < count; first += curve_block) {
      std::vector<std::uint32_t> cells(d * curve_block, 0);
      std::uint32_t keys[curve_block];
      for (std::uint32_t k = 0; k < curve_block; ++k)
        for (unsigned j = 0; j < d; ++j)
          cells[j * curve_block + k] = (first + k) % count >> (j * bits) & mask;
      curve_keys(d, bits, cells.data(), keys);
      for (std::uint32_t k = 0; k < std::min<std::uint32_t>(curve_block, count - first); ++k) {
        ASSERT_LT(keys[k], count);
        ASSERT_EQ(cell_at[keys[k]], count) << "a key comes twice";
        cell_at[keys[k]] = first + k;
      }
    }
    for (std::uint32_t i = 1; i < count; ++i) {
      unsigned steps = 0;
      for (unsigned j = 0; j < d; ++j) {
        const auto a = static_cast<int>(cell_at[i - 1] >> (j * bits) & mask);
        const auto b = static_cast<int>(cell_at[i] >> (j * bits) & mask);
        steps += static_cast<unsigned>(std::abs(a - b));
      }
      ASSERT_EQ(steps, 1U) << "step " << i;
    }
  }
}

struct Points {
  Points(const char* shape, std::uint32_t count, unsigned d) : rows(generate(shape, count, d)) {
    local.dimension = d;
    local.count = count;
    local.coordinates = local.exact = rows.data();
  }
  double norm(std::uint32_t i) const {
    double sum = 0;
    for (unsigned j = 0; j < local.dimension; ++j) sum += local.row(i)[j] * local.row(i)[j];
    return sum;
  }
  std::vector<double> rows;
  LocalPoints local;
};

/// Takes all rounds, `most` at a time.
std::vector<std::uint32_t> all_rounds(NormOrder& order, std::vector<std::uint32_t>& ends,
                                      std::size_t most) {
  std::vector<std::uint32_t> taken;
  while (order.left() > 0) order.take_rounds(most, taken, ends);
  return taken;
}

TEST(NormOrder, TakesEveryPointOnceForAnyNumberOfThreads) {
  const internal::Run& run = internal::short_run();
  for (const unsigned d : {4U, 5U, 6U, 8U, 11U})
    for (const std::uint32_t n : {1U, 7U, 8U, 9U, 64U, 65U, 96U, 97U, 1023U, 5000U, 40000U}) {
      const Points points("ball", n, d);
      std::vector<std::uint32_t> without;
      for (std::uint32_t i = 0; i < std::min(n, d + 1); ++i)
        without.push_back(n - 1 - i * (n / (d + 1)));
      std::sort(without.begin(), without.end());
      without.erase(std::unique(without.begin(), without.end()), without.end());
      std::vector<std::uint32_t> first, first_ends;
      for (const unsigned threads : {1U, 2U, 3U, 16U, 64U}) {
        NormOrder order(points.local, without, run.with_threads(threads));
        // One round after another, or many at once.
        std::vector<std::uint32_t> ends, taken = all_rounds(order, ends, threads % 2 == 1 ? 1 : 50);
        if (threads == 1) {
          first = taken;
          first_ends = ends;
        } else {
          EXPECT_EQ(taken, first) << n << " points in " << d;
          EXPECT_EQ(ends, first_ends) << n << " points in " << d;
        }
        taken.insert(taken.end(), without.begin(), without.end());
        std::sort(taken.begin(), taken.end());
        std::vector<std::uint32_t> all(n);
        std::iota(all.begin(), all.end(), 0U);
        ASSERT_EQ(taken, all) << n << " points in " << d;
      }
    }
}

TEST(NormOrder, TheOutermostComeFirstWhateverIsDropped) {
  const internal::Run& run = internal::short_run();
  const Points points("ball", 30000, 4);
  for (const bool thin : {false, true}) {
    NormOrder order(points.local, {}, run.with_threads(2));
    std::vector<std::uint32_t> taken, dropped, ends;
    order.take_rounds(1, taken, ends);
    ASSERT_EQ(taken.size(), 64U);
    if (thin) {
      std::vector<std::uint8_t> drop(order.left());
      for (std::uint32_t k = 0; k < order.left(); ++k) {
        drop[k] = points.norm(order.left_at(k)) < 0.8;
        if (drop[k]) dropped.push_back(order.left_at(k));
      }
      order.drop(drop.data());
    }
    ends.clear();
    const std::vector<std::uint32_t> rest = all_rounds(order, ends, 50);
    EXPECT_EQ(taken.size() + rest.size() + dropped.size(), 30000U);
    // The norm takes the covariance of some points for the unit, so only nearly a ball's.
    double lowest = 2;
    for (const std::uint32_t i : taken) lowest = std::min(lowest, points.norm(i));
    EXPECT_GT(lowest, 0.9);
    std::size_t at = 0;
    for (const std::uint32_t end : ends) {
      double inner = 2, outer = 0;
      for (; at < end; ++at) {
        inner = std::min(inner, points.norm(rest[at]));
        outer = std::max(outer, points.norm(rest[at]));
      }
      EXPECT_LT(outer, lowest * 1.25);
      lowest = inner;
    }
    std::vector<std::uint32_t> all = rest;
    all.insert(all.end(), taken.begin(), taken.end());
    all.insert(all.end(), dropped.begin(), dropped.end());
    std::sort(all.begin(), all.end());
    EXPECT_EQ(std::unique(all.begin(), all.end()), all.end());
  }
}

}  // namespace cullhull::internal::norm_order_test
