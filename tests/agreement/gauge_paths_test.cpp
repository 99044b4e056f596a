// Every way through the GaugeMap's kernel keeps the same points: instruction sets, layouts, scalar
// types, thread counts, and counts around every border.
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <cmath>
#include <cstring>
#include <random>
#include <string>

#include "cullhull/options.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "filter/gauge/gauge_table.hpp"
#include "parallel/threads/run.hpp"
#include "tests/made_sets.hpp"

namespace cullhull::internal::gauge_paths_test {

using namespace testing_support;

Array<std::uint64_t> run(const GaugeMap& map, const PointView& view, unsigned threads = 1) {
  return map.survivors(view, internal::short_run().with_threads(threads));
}

/// Share of the octahedron in its cube: nobody may keep all or nothing.
void expect_some(const Array<std::uint64_t>& kept, std::size_t n) {
  EXPECT_GT(kept.size(), n / 100);
  EXPECT_LT(kept.size(), n);
}

TEST(GaugePaths, InstructionSetsAgree) {
  const double bad[] = {NAN, INFINITY, -INFINITY, 1e308, -1e308, 1e39, 0, -0.0, 1e-310};
  for (unsigned d = 2; d <= 6; ++d) {
    const auto map = GaugeMap::build(cross_polytope(d, 0.125, 1));
    ASSERT_TRUE(map);
    std::vector<double> rows = uniform_points(d, 20011, 0.125, 1.2 / d + 0.2, d);
    for (std::size_t e = 0; e < 300; ++e) rows[e * 7] = bad[e % std::size(bad)];
    const std::vector<float> single(rows.begin(), rows.end());
    const auto doubles = PointView::row_major(rows.data(), 20011, d);
    const auto floats = PointView::row_major(single.data(), 20011, d);
    const auto expected = run(*map, doubles);
    const auto expected_single = run(*map, floats);
    expect_some(expected, 20011);
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      hwy::SetSupportedTargetsForTest(target);
      EXPECT_EQ(run(*map, doubles), expected) << d << "D " << hwy::TargetName(target);
      EXPECT_EQ(run(*map, floats), expected_single) << d << "D " << hwy::TargetName(target);
    }
    hwy::SetSupportedTargetsForTest(0);
  }
}

TEST(GaugePaths, LayoutsAgree) {
  for (unsigned d = 2; d <= 6; ++d) {
    constexpr std::size_t n = 1237;
    const auto map = GaugeMap::build(cross_polytope(d, 0.125, 1));
    const auto rows = uniform_points(d, n, 0.125, 1.2 / d + 0.2, 40 + d);
    const auto expected = run(*map, PointView::row_major(rows.data(), n, d));
    expect_some(expected, n);

    const std::vector<double> columns = transposed(rows, d);
    EXPECT_EQ(run(*map, PointView::column_major(columns.data(), n, d)), expected) << d;

    // Records of odd size, at an odd address, coordinates in falling order.
    const std::size_t record = 8 * d + 5;
    std::vector<std::byte> bytes(1 + record * n);
    for (std::size_t i = 0; i < n; ++i)
      for (unsigned j = 0; j < d; ++j)
        std::memcpy(&bytes[1 + i * record + 8 * (d - 1 - j)], &rows[i * d + j], 8);
    const PointView strided{
        &bytes[1 + 8 * (d - 1)], ScalarType::f64, d, n, static_cast<std::ptrdiff_t>(record), -8};
    EXPECT_EQ(run(*map, strided), expected) << d;

    std::vector<std::byte> shifted(1 + 8 * rows.size());  // packed, but unaligned
    std::memcpy(&shifted[1], rows.data(), 8 * rows.size());
    const PointView packed{
        &shifted[1], ScalarType::f64, d, n, static_cast<std::ptrdiff_t>(8 * d), 8};
    EXPECT_TRUE(packed.packed_rows());
    EXPECT_EQ(run(*map, packed), expected) << d;

    std::vector<float> single_rows(rows.begin(), rows.end());
    std::vector<float> single_columns(columns.begin(), columns.end());
    EXPECT_EQ(run(*map, PointView::row_major(single_rows.data(), n, d)),
              run(*map, PointView::column_major(single_columns.data(), n, d)))
        << d;
  }
}

template <class T>
void expect_integers_agree() {
  for (unsigned d = 2; d <= 6; ++d) {
    const auto map = GaugeMap::build(cross_polytope(d, 60, 50));
    std::mt19937_64 random(d);
    std::vector<T> integers(5000 * d);
    for (T& v : integers) v = static_cast<T>(random() % (90 / d) + 60 - 45 / d);
    std::vector<double> doubles(integers.begin(), integers.end());
    const auto expected = run(*map, PointView::row_major(doubles.data(), 5000, d));
    EXPECT_LT(expected.size(), 5000U);
    EXPECT_EQ(run(*map, PointView::row_major(integers.data(), 5000, d)), expected)
        << d << "D " << scalar_name(scalar_type_of<T>());
  }
}

TEST(GaugePaths, ScalarsAgree) {
  expect_integers_agree<std::int8_t>();
  expect_integers_agree<std::uint8_t>();
  expect_integers_agree<std::int16_t>();
  expect_integers_agree<std::uint16_t>();
  expect_integers_agree<std::int32_t>();
  expect_integers_agree<std::uint32_t>();
  expect_integers_agree<float>();  // small integers: f32 arithmetic is exact too
}

// Where f32 cannot hold the centre, f32 points are computed in double.
TEST(GaugePaths, FloatsFarFromTheOriginAreDoubles) {
  const auto map = GaugeMap::build(cross_polytope(3, 0x1p23 + 0.75, 1));
  ASSERT_TRUE(map);
  const auto rows = uniform_points(3, 4000, 0x1p23, 2, 3);
  const std::vector<float> single(rows.begin(), rows.end());
  const std::vector<double> doubles(single.begin(), single.end());
  EXPECT_EQ(run(*map, PointView::row_major(single.data(), 4000, 3)),
            run(*map, PointView::row_major(doubles.data(), 4000, 3)));
}

TEST(GaugePaths, CountsAndThreads) {
  for (unsigned d = 2; d <= 6; ++d) {
    const auto map = GaugeMap::build(cross_polytope(d, 0, 1));
    const std::size_t most = 3 * gauge_chunk + 9;
    const auto rows = uniform_points(d, most, 0, 1.2 / d + 0.2, 70 + d);
    const auto all = run(*map, PointView::row_major(rows.data(), most, d));
    for (const std::size_t n : {std::size_t{0}, std::size_t{1}, std::size_t{7}, std::size_t{8},
                                std::size_t{9}, std::size_t{63}, std::size_t{64}, std::size_t{65},
                                std::size_t{255}, std::size_t{257}, std::size_t{gauge_chunk} - 1,
                                std::size_t{gauge_chunk}, std::size_t{gauge_chunk} + 1, most}) {
      const Array<std::uint64_t> expected(all.begin(), std::lower_bound(all.begin(), all.end(), n));
      for (const unsigned threads : {1U, 2U, 3U})
        EXPECT_EQ(run(*map, PointView::row_major(rows.data(), n, d), threads), expected)
            << d << "D, " << n << " points, " << threads << " threads";
    }
  }
}

// A hundred thousand points at the centre: 0 / 0 must not keep them.
TEST(GaugePaths, CentreIsInside) {
  for (unsigned d = 2; d <= 6; ++d) {
    const auto map = GaugeMap::build(cross_polytope(d, 0, 1));
    const std::vector<double> rows(1000 * d, -0.0);
    EXPECT_TRUE(run(*map, PointView::row_major(rows.data(), 1000, d)).empty());
    const std::vector<double> tiny(1000 * d, 1e-310);
    EXPECT_TRUE(run(*map, PointView::row_major(tiny.data(), 1000, d)).empty());
  }
}

}  // namespace cullhull::internal::gauge_paths_test
