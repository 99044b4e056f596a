// The CUDA GaugeMap's kernel, played by a loop over its blocks, warps and lanes on the host: the
// same text as on a device but for the launch and the exchange of bits between lanes. It must keep
// the points the CPU's kernel keeps.
#include "filter/gauge/gauge_lanes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "cullhull/options.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "parallel/threads/run.hpp"
#include "tests/made_sets.hpp"

namespace cullhull::internal::gauge_lanes_test {

using namespace testing_support;

constexpr unsigned words_of_group = 4;  // at most

/// store_words of gauge_kernel.cu: a lane's bits go to their points' places.
template <class Layout>
void store_words(std::uint32_t bits, std::uint64_t group, unsigned lane, std::uint32_t* words) {
  for (unsigned k = 0; k < Layout::lane_points; ++k) {
    const std::uint64_t i = Layout::point(group, lane, k) - group * Layout::group_points;
    words[i / 32] |= (bits >> k & 1) << i % 32;
  }
}

/// mask_kernel for `blocks` blocks.
template <class Layout, class C>
std::vector<std::uint32_t> play(const GaugeTable& table, const Layout& layout, std::uint64_t count,
                                unsigned blocks) {
  const auto t = gauge_constants<Layout::D, C>(table);
  constexpr unsigned block_warps = 512 / warp_lanes;
  const std::uint64_t groups = group_count<Layout>(count);
  std::vector<std::uint32_t> mask((count + 127) / 128 * words_of_group, 0xDEADBEEF);
  std::vector<int> visits(groups, 0);
  for (unsigned block = 0; block < blocks; ++block)
    for (unsigned warp = 0; warp < block_warps; ++warp)
      for (std::uint64_t group = std::uint64_t{block} * block_warps + warp; group < groups;
           group += std::uint64_t{blocks} * block_warps) {
        std::uint32_t words[words_of_group] = {};
        for (unsigned lane = 0; lane < warp_lanes; ++lane)
          store_words<Layout>(lane_survivors(t, table.nodes.data(), layout, group, lane, count),
                              group, lane, words);
        constexpr unsigned n = Layout::group_points / 32;
        std::copy_n(words, n, &mask.at((group + 1) * n - 1) - (n - 1));
        ++visits[group];
      }
  EXPECT_TRUE(std::all_of(visits.begin(), visits.end(), [](int v) { return v == 1; }));
  return mask;
}

std::vector<std::uint64_t> listed(const std::vector<std::uint32_t>& mask, std::uint64_t count) {
  std::vector<std::uint64_t> ids;
  for (std::uint64_t i = 0; i < (count + 31) / 32 * 32; ++i)
    if ((mask[i / 32] >> i % 32 & 1) != 0) ids.push_back(i);
  return ids;
}

std::vector<std::uint64_t> twin(const GaugeMap& map, const PointView& v, unsigned blocks = 3) {
  std::vector<std::uint64_t> ids;
  with_types(map.table(), v.scalar, [&]<unsigned D, class T, class C>() {
    with_layout<D, T>(v.data, v.point_stride, v.coordinate_stride, [&](const auto& layout) {
      using Layout = std::decay_t<decltype(layout)>;
      ids = listed(play<Layout, C>(map.table(), layout, v.count, blocks), v.count);
    });
  });
  return ids;
}

std::vector<std::uint64_t> cpu(const GaugeMap& map, const PointView& v) {
  const auto ids = map.survivors(v, internal::short_run());
  return {ids.begin(), ids.end()};
}

std::vector<double> uniform(unsigned d, std::size_t n, double centre, std::uint64_t seed) {
  return uniform_points(d, n, centre, 1.2 / d + 0.2, seed);
}

struct Case {
  std::vector<double> doubles;
  std::vector<float> floats;
};

/// Points inside and outside, with every kind of special value strewn in.
Case strewn(unsigned d, std::size_t n, double centre) {
  const double bad[] = {NAN,   INFINITY, -INFINITY, 1e308, -1e308, 1e39,   -1e39, 3e38,
                        -3e38, 9e37,     0x1p126,   0,     -0.0,   1e-310, 1e-44};
  Case c;
  c.doubles = uniform(d, n, centre, d);
  for (std::size_t e = 0; e * 7 < c.doubles.size() / 2; ++e)
    c.doubles[e * 7] = bad[e % std::size(bad)];
  c.floats.assign(c.doubles.begin(), c.doubles.end());
  return c;
}

void expect_some(const std::vector<std::uint64_t>& kept, std::size_t n) {
  EXPECT_GT(kept.size(), n / 100);
  EXPECT_LT(kept.size(), n);
}

TEST(GaugeLanes, KeepWhatTheCpuKeeps) {
  constexpr std::size_t n = 20011;
  for (unsigned d = 2; d <= 6; ++d) {
    const auto map = GaugeMap::build(cross_polytope(d, 0.125, 1));
    ASSERT_TRUE(map);
    ASSERT_TRUE(map->table().single_precision);
    const Case c = strewn(d, n, 0.125);
    const auto doubles = PointView::row_major(c.doubles.data(), n, d);
    const auto floats = PointView::row_major(c.floats.data(), n, d);
    expect_some(cpu(*map, doubles), n);
    EXPECT_EQ(twin(*map, doubles), cpu(*map, doubles)) << d;
    EXPECT_EQ(twin(*map, floats), cpu(*map, floats)) << d;
  }
}

TEST(GaugeLanes, FloatsAreDoublesWhereTheCentreIsNone) {
  const auto map = GaugeMap::build(cross_polytope(3, 0x1p23 + 0.75, 1));
  ASSERT_TRUE(map);
  ASSERT_FALSE(map->table().single_precision);
  const auto rows = uniform(3, 4000, 0x1p23, 3);
  const std::vector<float> single(rows.begin(), rows.end());
  const auto view = PointView::row_major(single.data(), 4000, 3);
  EXPECT_EQ(twin(*map, view), cpu(*map, view));
}

TEST(GaugeLanes, EveryLayout) {
  constexpr std::size_t n = 1237;
  for (unsigned d = 2; d <= 6; ++d) {
    const auto map = GaugeMap::build(cross_polytope(d, 0.125, 1));
    const Case c = strewn(d, n, 0.125);
    const auto expected = cpu(*map, PointView::row_major(c.floats.data(), n, d));
    expect_some(expected, n);

    // Off the 16 bytes that vectors need, by one scalar.
    std::vector<float> shifted(n * d + 8);
    float* odd = shifted.data();
    while (reinterpret_cast<std::uintptr_t>(odd) % 16 != 4) ++odd;
    std::copy(c.floats.begin(), c.floats.end(), odd);
    EXPECT_EQ(twin(*map, PointView::row_major(odd, n, d)), expected) << d;

    const std::vector<float> columns = transposed(c.floats, d);
    EXPECT_EQ(twin(*map, PointView::column_major(columns.data(), n, d)), expected) << d;

    // Records with other members, points in falling order.
    const std::size_t record = d + 3;
    std::vector<float> records(n * record, NAN);
    for (std::size_t i = 0; i < n; ++i)
      std::copy_n(&c.floats[i * d], d, &records[(n - 1 - i) * record + 2]);
    PointView backwards = PointView::row_major(&records[(n - 1) * record + 2], n, d);
    backwards.point_stride = -static_cast<std::ptrdiff_t>(record * sizeof(float));
    EXPECT_EQ(twin(*map, backwards), expected) << d;
  }
}

// Around the borders of words, lanes, groups and blocks: no point is missed, none is invented.
TEST(GaugeLanes, EveryCount) {
  for (const unsigned d : {2U, 3U}) {
    const auto map = GaugeMap::build(cross_polytope(d, 0, 1));
    constexpr std::size_t most = 5000;
    const auto rows = uniform(d, most, 0, 70 + d);
    const std::vector<float> single(rows.begin(), rows.end());
    const auto all = cpu(*map, PointView::row_major(rows.data(), most, d));
    const auto all_single = cpu(*map, PointView::row_major(single.data(), most, d));
    const auto below = [](const std::vector<std::uint64_t>& ids, std::uint64_t n) {
      return std::vector<std::uint64_t>(ids.begin(), std::lower_bound(ids.begin(), ids.end(), n));
    };
    std::vector<std::size_t> counts;
    for (std::size_t n = 0; n < 300; ++n) counts.push_back(n);
    for (const std::size_t n : {2047U, 2048U, 2049U, 4096U, 4097U, 5000U}) counts.push_back(n);
    for (const std::size_t n : counts) {
      for (const unsigned blocks : {1U, 2U, 5U}) {
        EXPECT_EQ(twin(*map, PointView::row_major(rows.data(), n, d), blocks), below(all, n)) << n;
        EXPECT_EQ(twin(*map, PointView::row_major(single.data(), n, d), blocks),
                  below(all_single, n))
            << n;
      }
    }
  }
}

// What the shifted sum does on a device: rounded downward it is the floor.
TEST(GaugeLanes, FloorOfAPlace) {
  for (const float v : {0.0F, 0.25F, 0.99999994F, 1.0F, 1.5F, 100.99999F, 8388606.5F}) {
    EXPECT_EQ(lanes::floor_and_shift(v), std::floor(v) + 0x1p23F) << v;
    EXPECT_EQ(lanes::bits_of(lanes::floor_and_shift(v)) - 0x4B000000U,
              static_cast<std::uint32_t>(v))
        << v;
  }
}

// A map for a device holds no more nodes than its shared memory does.
TEST(GaugeLanes, NodesAreLimited) {
  for (unsigned d = 2; d <= 6; ++d) {
    const auto map = GaugeMap::build(cross_polytope(d, 0, 1), 0, 12288);
    ASSERT_TRUE(map);
    EXPECT_LE(map->table().nodes.size(), 12288U) << d;
    const auto few = GaugeMap::build(cross_polytope(d, 0, 1), 0, 1000);
    EXPECT_LE(few->table().nodes.size(), d < 4 ? 1000U : 12288U) << d;
  }
}

}  // namespace cullhull::internal::gauge_lanes_test
