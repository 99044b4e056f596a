// Grids of decimals: which scans have one, and that coordinates lead back to their numbers.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>
#include <string>

#include "cullhull/error.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/io.hpp"
#include "cullhull/placement.hpp"
#include "io/certify_file.hpp"
#include "io/grid_axes.hpp"
#include "io/json/json.hpp"
#include "io/source.hpp"

namespace cullhull::io_placement_test {

Placement placement(double scale, double offset) { return {{scale, scale}, {offset, offset}}; }

int decimals_of(const std::vector<Placement>& placements) {
  return common_grid(placements).decimals();
}

TEST(IoPlacement, TheCommonGridHasTheFinestDecimals) {
  EXPECT_EQ(decimals_of({placement(0.01, 0)}), 2);
  EXPECT_EQ(decimals_of({placement(0.25, 484683.1)}), 2);
  EXPECT_EQ(decimals_of({placement(10, 484683)}), 0);
  EXPECT_EQ(decimals_of({placement(0.01, 7), placement(0.1, 0.125)}), 3);
  EXPECT_EQ(decimals_of({{{0.01, 0.001}, {-12.5, 1e6}}}), 3);
  EXPECT_EQ(decimals_of({placement(1e-7, 0)}), 7);
}

TEST(IoPlacement, GridsOfBinaryFractionsAreDoublesAsTheyAre) {
  const std::vector<std::pair<Placement, double>> some = {
      {placement(0.25, 0), 0.25},
      {placement(0.5, 0.125), 0.125},
      {{{0.125, 0.0625}, {16, -32.03125}}, 0.03125},
      {placement(0x1p-20, 0x1p20), 0x1p-20}};
  for (const auto& [p, unit] : some) {
    const Grid grid = common_grid({p});
    EXPECT_EQ(grid, Grid::binary(-std::ilogb(unit)));
    EXPECT_FALSE(grid.empty());
    EXPECT_EQ(grid.decimals(), -1);
    EXPECT_EQ(grid.power(), 1);
    EXPECT_EQ(grid.unit(), unit);
    const internal::GridAxes axes(p, grid);
    for (const double x : {0.0, 1.0, -7.0, 2147483647.0, -2147483648.0})
      for (const std::size_t j : {0U, 1U}) {
        EXPECT_EQ(axes.at(j, x), p.at(j, x));
        EXPECT_EQ(grid.to_world(axes.at(j, x)), p.at(j, x));
        EXPECT_EQ(grid.number_of(p.at(j, x)), p.at(j, x));
      }
    EXPECT_TRUE(std::isnan(grid.number_of(unit / 2)));
    EXPECT_EQ(grid.measure_to_world(7, 3), 7);
  }
  // Beside a decimal that is none, and where a double would need more bits than there are.
  EXPECT_EQ(common_grid({placement(0.25, 0), placement(0.01, 0)}), Grid(2));
  EXPECT_EQ(common_grid({placement(0.25, 0.1)}), Grid(2));
  EXPECT_TRUE(common_grid({placement(0x1p-20, 1e15)}).empty());
  EXPECT_TRUE(common_grid({placement(1.0 / 3, 0.5)}).empty());
  HullState state(PointView::row_major(std::vector<double>{0.25, 0.5}.data(), 1, 2));
  const HullState same = state;
  to_world(state, Grid::binary(2));
  EXPECT_EQ(state.places(), 2);
  EXPECT_EQ(HullState::from_bytes(state.to_bytes()), state);
  EXPECT_EQ(state.to_bytes().size(), same.to_bytes().size());
  EXPECT_EQ(state.ids(), same.ids());
  EXPECT_THROW(state.set_binary_grid(101), Error);
}

TEST(IoPlacement, WhatDoublesDoNotHoldHasNoGrid) {
  EXPECT_TRUE(common_grid(std::vector<Placement>()).empty());
  EXPECT_TRUE(common_grid({placement(0.01, 0), Placement()}).empty());
  EXPECT_TRUE(common_grid({placement(1.0 / 3, 0)}).empty());
  EXPECT_TRUE(common_grid({placement(0.01, 0.12345678901234567)}).empty());
  // Numbers of 32 bits by steps of 10^6 need 51 bits; an offset alone may be too far.
  EXPECT_FALSE(common_grid({{{0.1, 1e-6}, {0, 0}}}).empty());
  EXPECT_TRUE(common_grid({{{1, 1e-6}, {0, 0}}}).empty());
  EXPECT_TRUE(common_grid({placement(0.01, 1e14)}).empty());
  EXPECT_TRUE(common_grid({placement(1e300, 0)}).empty());
  EXPECT_TRUE(common_grid({placement(1e-300, 0)}).empty());
  EXPECT_TRUE(common_grid({placement(0.01, 1e300)}).empty());
  EXPECT_TRUE(common_grid({placement(5e-324, 0)}).empty());
}

TEST(IoPlacement, CoordinatesLeadBackToTheirNumbers) {
  std::mt19937_64 random(3);
  for (const int decimals : {0, 1, 2, 3, 7, 11, 15}) {
    const Grid grid(decimals);
    for (int i = 0; i < 100000; ++i) {
      const auto number = static_cast<double>(static_cast<std::int64_t>(random()) >> (13 + i % 40));
      const double x = grid.to_world(number);
      ASSERT_EQ(grid.number_of(x), number) << decimals;
      const double other = std::nextafter(x, INFINITY);
      ASSERT_TRUE(std::isnan(grid.number_of(other)) ||
                  grid.to_world(grid.number_of(other)) == other);
    }
  }
  EXPECT_TRUE(std::isnan(Grid(2).number_of(0.123)));
  EXPECT_EQ(Grid().number_of(0.123), 0.123);
}

TEST(IoPlacement, NumbersOnAGridAreExact) {
  const Placement p{{0.25, 0.001}, {484683.1, -12.5}};
  const Grid grid = common_grid({p});
  const internal::GridAxes axes(p, grid);
  for (const double x : {0.0, 1.0, -7.0, 2147483647.0, -2147483648.0}) {
    EXPECT_EQ(axes.at(0, x), 250 * x + 484683100);
    EXPECT_EQ(axes.at(1, x), x - 12500);
  }
  EXPECT_THROW(internal::GridAxes(p, Grid(1)), Error);
  EXPECT_THROW(internal::GridAxes(p, Grid()), Error);
}

TEST(IoPlacement, HullsGoToTheWorldAndBack) {
  std::vector<double> rows;
  for (const double v : generate("ball", 300, 3, 1)) rows.push_back(std::round(v * 1e6) + 4e9);
  const PointView points = PointView::row_major(rows.data(), 300, 3);
  const Hull on_grid = convex_hull(points);
  Hull hull = on_grid;
  const Grid grid(3);
  to_world(hull, grid);
  EXPECT_DOUBLE_EQ(hull.volume * 1e9, on_grid.volume);
  EXPECT_DOUBLE_EQ(hull.area * 1e6, on_grid.area);
  EXPECT_EQ(hull.facet_planes[0], on_grid.facet_planes[0]);
  EXPECT_EQ(hull.facet_planes[3], on_grid.facet_planes[3] / 1000);
  to_grid(hull, grid);
  EXPECT_TRUE(certify(points, hull).valid);
}

/// Files of hulls on a decimal grid: points, segments, polygons and polytopes of any flat, a few
/// units wide, near the origin and far from it. Their numbers are rounded to world coordinates and
/// back.
TEST(IoPlacement, FilesOfHullsOnDecimalGridsAreCertified) {
  std::mt19937_64 random(7);
  for (unsigned set = 0; set < 4000; ++set) {
    const auto d = static_cast<std::uint32_t>(1 + random() % 4);
    const std::uint64_t n = 1 + random() % 40, spanned = random() % (d + 1);
    const Grid grid(1 + static_cast<int>(random() % 4));
    const double width = std::round(grid.power() * std::array{0.7, 3.0, 40.0}[random() % 3]);
    const double offset = grid.power() * std::array{0.0, 10'000.0, 484'683.0}[random() % 3];
    std::vector<double> at(d), rows, world;
    for (double& x : at)
      x = std::round(offset * (random() % 3 == 0 ? -1 : 1)) + static_cast<double>(random() % 1000);
    for (std::uint64_t i = 0; i < n; ++i)
      for (unsigned j = 0; j < d; ++j) {
        const auto step = static_cast<double>(random() % static_cast<std::uint64_t>(width + 1));
        rows.push_back(at[j] + (j < spanned ? step : 0));
        // Another axis in step with the first: a flat that is not parallel to the axes.
        if (j > 0 && j == spanned && set % 2 == 0) rows.back() += rows[rows.size() - j - 1] - at[0];
      }
    for (const double x : rows) world.push_back(grid.to_world(x));
    const PointView points = PointView::row_major(rows.data(), n, d);
    Hull hull = convex_hull(points);
    to_world(hull, grid);
    std::string text;
    internal::write_result_json(PointView::row_major(world.data(), n, d), hull,
                                [&](const std::string& piece) { text += piece; });
    const Certificate found =
        internal::certify_source(points, {"F", text.data(), text.size()}, {}, grid);
    EXPECT_EQ(found.reason, "") << "set " << set;
    std::vector<double> vertices;
    Hull again = internal::read_hull_json({"F", text.data(), text.size()}, &vertices, {}, 0);
    to_grid(again, vertices, grid);
    CertifyStream check(again, vertices);
    check.push(points, 0);
    EXPECT_EQ(check.finish().reason, "") << "set " << set << " in pieces";
  }
}

TEST(IoPlacement, StatesRememberTheirGrid) {
  std::vector<double> rows;
  for (const double v : generate("ball", 600, 3, 1)) rows.push_back(std::round(v * 1000) + 4e9);
  HullState all(PointView::row_major(rows.data(), 600, 3));
  HullState first(PointView::row_major(rows.data(), 300, 3));
  HullState second(PointView::row_major(rows.data() + 900, 300, 3), 300);
  for (HullState* state : {&all, &first, &second}) state->to_world(3);
  EXPECT_EQ(HullState::from_bytes(first.to_bytes()), first);
  first.merge(second);
  EXPECT_EQ(first, all);
  EXPECT_EQ(first.decimals(), 3);
  first.to_grid();
  EXPECT_EQ(first, HullState(PointView::row_major(rows.data(), 600, 3)));
  HullState world(PointView::row_major(rows.data(), 3, 3), 600);
  first.merge(world);
  EXPECT_EQ(first.decimals(), -1);
  const HullState nothing(3);
  first.to_world(3);
  first.merge(nothing);
  EXPECT_EQ(first.decimals(), 3);
  EXPECT_THROW(first.merge(world), Error);  // it was rounded
  EXPECT_THROW(world.merge(first), Error);
  EXPECT_THROW(first.to_world(16), Error);
  std::vector<std::byte> bytes = all.to_bytes();
  bytes[20] = std::byte{17};  // and a check sum that is wrong besides
  EXPECT_THROW(HullState::from_bytes(bytes), Error);
}

/// States of parts on grids of their own, merged in any order, are the state of all points on the
/// common grid, or refused.
TEST(IoPlacement, StatesOfDifferentGridsMergeOnTheCommonOne) {
  std::mt19937_64 random(11);
  unsigned refused = 0;
  for (unsigned set = 0; set < 1000; ++set) {
    constexpr double scales[] = {0.001, 0.01, 0.1, 0.25, 0.5, 1, 10, 0.05, 1e-7};
    constexpr double offsets[] = {0, 10'000.1, 0.25, 484'683.001};
    std::vector<Placement> placements;
    std::vector<HullState> states;
    std::vector<std::vector<double>> parts;
    std::uint64_t n = 0;
    for (unsigned part = 0; part < 3; ++part) {
      Placement p = placement(scales[random() % 9], offsets[random() % 4]);
      const Grid own = common_grid({p});
      const internal::GridAxes axes(p, own);
      std::vector<double> numbers, rows;
      for (unsigned i = 0; i < 40; ++i)
        numbers.push_back(
            std::round(static_cast<double>(random() % 5) / std::min(p.scale[0], 1.0)));
      for (const double x : numbers) rows.push_back(axes.at(0, x));
      states.emplace_back(PointView::row_major(rows.data(), 20, 2), n);
      to_world(states.back(), own);
      placements.push_back(std::move(p));
      parts.push_back(std::move(numbers));
      n += 20;
    }
    const Grid grid = common_grid(placements);
    std::swap(states[0], states[random() % 3]);
    try {
      for (const unsigned i : {1U, 2U})
        states[0].merge(HullState::from_bytes(states[i].to_bytes()));
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
      ++refused;
      continue;
    }
    ASSERT_FALSE(grid.empty()) << "set " << set;
    std::vector<double> all;
    for (unsigned part = 0; part < 3; ++part)
      for (const double x : parts[part])
        all.push_back(internal::GridAxes(placements[part], grid).at(0, x));
    HullState whole(PointView::row_major(all.data(), n, 2));
    to_world(whole, grid);
    EXPECT_EQ(states[0].ids(), whole.ids()) << "set " << set;
    EXPECT_EQ(states[0].decimals(), whole.decimals());
    EXPECT_EQ(states[0].places(), whole.places());
  }
  EXPECT_LT(refused, 400U);
}

}  // namespace cullhull::io_placement_test
