// Leaders among all points, found over the executors as a device finds them, and the map that the
// CPU makes of them.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "filter/gauge/gauge_map.hpp"
#include "filter/gauge/outermost_offers.hpp"
#include "filter/pseudo_hull/pseudo_hull_rows.hpp"
#include "flow/sample_map.hpp"
#include "geometry/gather.hpp"
#include "parallel/dispatch.hpp"
#include "parallel/threads/run.hpp"
#include "tests/agreement/outermost_of_cells.hpp"
#include "tests/made_sets.hpp"

namespace cullhull::internal::leaders_of_all_test {

using namespace testing_support;
using Ids = std::vector<std::uint64_t>;

/// What outermost_there() does.
template <class Executor>
Ids outermost(Executor executor, const GaugeTable& map, unsigned cells, const PointView& v) {
  Ids ids;
  with_types(map, v.scalar, [&]<unsigned D, class T, class C>() {
    const auto rows = rows_in_place<D, T>(v, {v.count, 0, 1});
    const auto n = static_cast<std::uint32_t>(v.count);
    GaugeTable grid;
    if (!leader_cells<D>(executor, rows, n, map, cells, grid)) return;
    const auto corners = 2 * D * static_cast<std::uint32_t>(grid.face_stride);
    Ids best(corners);
    ids.resize(corners);
    const OfferOutermost<D, C, RowsInPlace<D, T>> offer{
        rows, gauge_constants<D, C>(map), gauge_constants<D, C>(grid), map.nodes.data()};
    ids.resize(list_outermost(executor, offer, n, corners, best.data(), ids.data()));
  });
  return ids;
}

TEST(LeadersOfAll, AreTheOutermostOfTheirCells) {
  for (unsigned d = 4; d <= 6; ++d) {
    const auto map = GaugeMap::build(cross_polytope(d, 0.125, 1));
    for (const std::uint32_t n : {1U, 10U, 2000U, 20011U}) {
      auto rows = uniform_points<double>(d, n, 0.125, 1.2 / d + 0.2, d + n);
      for (const bool strewn : {false, true}) {
        const double others[] = {NAN, INFINITY, -INFINITY, 0.125, 1e-310, -0.0, 3, 1e30};
        for (std::size_t e = 0; strewn && e < rows.size(); e += 11)
          rows[e] = others[e / 11 % std::size(others)];
        const auto view = PointView::row_major(rows.data(), n, d);
        const std::vector<float> single(rows.begin(), rows.end());
        const auto floats = PointView::row_major(single.data(), n, d);
        const Ids found = outermost(SerialExecutor(), map->table(), 5, view);
        const Ids expected = with_dimension<4, 5, 6>(
            d, [&](auto D) { return outermost_of_cells<D()>(map->table(), 5, rows); });
        EXPECT_EQ(found, expected) << d << "D " << n;
        EXPECT_TRUE(n < 2000 || found.size() > 100) << found.size();
        EXPECT_EQ(outermost(ThreadExecutor(3), map->table(), 5, view), found);
        EXPECT_EQ(outermost(ThreadExecutor(3), map->table(), 5, floats),
                  outermost(SerialExecutor(), map->table(), 5, floats));
      }
    }
    const auto none = PointView::row_major(static_cast<const float*>(nullptr), 0, d);
    EXPECT_TRUE(outermost(SerialExecutor(), map->table(), 5, none).empty());
  }
}

TEST(LeadersOfAll, OfEqualPointsTheLowest) {
  const auto map = GaugeMap::build(cross_polytope(4, 0, 1));
  auto rows = uniform_points<double>(4, 500, 0, 0.5, 3);
  rows.resize(1000 * 4);
  std::copy_n(rows.begin(), 500 * 4, rows.begin() + 500 * 4);
  const Ids found =
      outermost(ThreadExecutor(3), map->table(), 3, PointView::row_major(rows.data(), 1000, 4));
  EXPECT_GT(found.size(), 100U);
  for (const std::uint64_t i : found) EXPECT_LT(i, 500U);
}

/// Points as a device samples them.
SampledPoints as_on_a_device(const PointView& v, const Run& run, bool lead) {
  SampledPoints points{v.count, v.dimension, [&](std::span<const std::uint64_t> ids) {
                         return gather_points(v, ids.data(), ids.size(), run);
                       }};
  if (lead)
    points.lead = [&](const GaugeMap& before, const LeaderCells& cells) {
      const Ids ids = outermost(ThreadExecutor(2), before.table(), cells.leaders, v);
      return GaugeMap::of_leaders(gather_points(v, ids.data(), ids.size(), run), before, cells,
                                  run);
    };
  return points;
}

// One map of all points' leaders leaves fewer than two, of a sample's and of what that leaves: of
// a cube too, whose axes differ a little in their reach, so that a frame of theirs may stretch it.
TEST(LeadersOfAll, LeaveFewerThanTwoMapsDo) {
  const Options options;
  const internal::Run whole(options);
  const internal::Run run = whole.with_threads(2);
  for (const auto& [shape, d] : {std::pair{"ball", 4U}, {"cube", 4U}, {"gauss", 5U}}) {
    const std::uint64_t n = 200000;
    const auto rows = made<float>(shape, n, d, d);
    const auto view = PointView::row_major(rows.data(), n, d);
    const SampledMap all = map_of_sample(as_on_a_device(view, run, true), Insist::no, 12288, run);
    ASSERT_TRUE(all.map) << all.reason;
    EXPECT_TRUE(all.of_all);
    EXPECT_NE(all.reason.find("the leaders of all points"), std::string::npos) << all.reason;
    const SampledMap first =
        map_of_sample(as_on_a_device(view, run, false), Insist::no, 12288, run);
    ASSERT_TRUE(first.map) << first.reason;
    EXPECT_FALSE(first.of_all);
    const auto left = first.map->survivors(view, run);
    const auto left_rows = gather_points(view, left.data(), left.size(), run);
    const auto left_view = PointView::row_major(left_rows.data(), left.size(), d);
    const SampledMap second =
        map_of_left(as_on_a_device(left_view, run, true), first.map.get(), 12288, run);
    ASSERT_TRUE(second.map) << second.reason;
    EXPECT_NE(second.reason.find("of the leaders of all"), std::string::npos) << second.reason;
    const auto kept = all.map->survivors(view, run).size();
    const auto twice = second.map->survivors(left_view, run).size();
    EXPECT_LT(kept, twice) << shape;
    EXPECT_LT(twice, left.size()) << shape;
  }
}

}  // namespace cullhull::internal::leaders_of_all_test
