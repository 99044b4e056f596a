// Delaunay and regular triangulations against their definition in rational numbers, permutations of
// the input, scalar types, threads; each is certified.
#include "cullhull/triangulation.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>

#include "agreement/random_seeds.hpp"
#include "cullhull/error.hpp"
#include "delaunay/brute_triangulation.hpp"
#include "delaunay/lifted_sets.hpp"
#include "delaunay/same_triangulation.hpp"
#include "thrown.hpp"

namespace cullhull {
namespace triangulation_test {

using namespace testing_support;

Certificate certified(const LiftedSet& s, const Triangulation& t) {
  return s.weights.empty() ? certify(view_of(s), t) : certify(view_of(s), s.weights, t);
}

void expect_brute(const LiftedSet& s, const Triangulation& t, int sign = 1) {
  const BruteTriangulation b = BruteForce(s.rows, s.dimension, s.weights, sign).run();
  ASSERT_EQ(t.affine_dimension, b.affine_dimension) << s.name;
  std::set<CellIds> cells;
  std::map<std::uint32_t, std::set<std::uint32_t>> members;
  for (std::uint64_t c = 0; c < t.size(); ++c) {
    CellIds ids(t.cell(c).begin(), t.cell(c).end());
    members[t.group(c)].insert(ids.begin(), ids.end());
    std::sort(ids.begin(), ids.end());
    cells.insert(ids);
  }
  EXPECT_EQ(cells.size(), t.size()) << s.name;
  EXPECT_EQ(cells, b.cells) << s.name;
  std::set<CellIds> groups;
  for (const auto& [number, ids] : members) groups.insert(CellIds(ids.begin(), ids.end()));
  EXPECT_EQ(groups, b.groups) << s.name;
  EXPECT_EQ(CellIds(t.hidden.begin(), t.hidden.end()), b.hidden) << s.name;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> duplicates;
  for (const DuplicatePoint& p : t.duplicates) duplicates.emplace_back(p.id, p.representative);
  EXPECT_EQ(duplicates, b.duplicates) << s.name;
}

void check(const LiftedSet& s) {
  const Triangulation t = triangulate(s);
  expect_brute(s, t);
  const Certificate c = certified(s, t);
  EXPECT_TRUE(c.valid) << s.name << ": " << c.reason;
}

TEST(Triangulation, SmallSetsAreAsDefined) {
  for (unsigned d = 1; d <= 6; ++d)
    for (const LiftedSet& s : sampled(small_lifted_sets(d, 7))) check(s);
}

TEST(Triangulation, RandomSmallSetsAreAsDefined) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed)
    for (unsigned d = 1; d <= 4; ++d) check(random_lifted_set(d, seed));
}

TEST(Triangulation, FurthestSiteIsTheUpperHull) {
  TriangulationOptions o;
  o.furthest_site = true;
  for (unsigned d = 1; d <= 4; ++d)
    for (const LiftedSet& s : sampled(small_lifted_sets(d, 11))) {
      const Triangulation t = triangulate(s, o);
      EXPECT_TRUE(t.furthest_site);
      expect_brute(s, t, -1);
      const Certificate c = certified(s, t);
      EXPECT_TRUE(c.valid) << s.name << ": " << c.reason;
    }
}

/// Of equal points the highest in the lift is a vertex of the upper hull: that of smallest weight.
TEST(Triangulation, FurthestSiteOfEqualPointsOfDifferentWeights) {
  TriangulationOptions o;
  o.furthest_site = true;
  const LiftedSet named{"corners", 2, {0, 0, 4, 0, 0, 4, 4, 0}, {0, 0, 0, 2}};
  const Triangulation t = triangulate(named, o);
  EXPECT_EQ(t.duplicates, (std::vector<DuplicatePoint>{{3, 1}}));
  std::vector<LiftedSet> sets{named};
  for (unsigned seed = 0; seed < 60; ++seed)
    sets.push_back(with_weights(drawn_grid(1 + seed % 3, 9, 2, 1, 0, seed), 2, seed, true));
  for (const LiftedSet& s : sets) {
    for (const bool furthest : {false, true}) {
      o.furthest_site = furthest;
      Triangulation found = triangulate(s, o);
      expect_brute(s, found, furthest ? -1 : 1);
      const Certificate c = certified(s, found);
      EXPECT_TRUE(c.valid) << s.name << ": " << c.reason;
      if (found.duplicates.empty()) continue;
      std::swap(found.duplicates[0].id, found.duplicates[0].representative);
      EXPECT_FALSE(certified(s, found).valid) << s.name;
    }
  }
}

TEST(Triangulation, LargerSetsAreCertified) {
  for (unsigned d = 1; d <= 7; ++d)
    for (const LiftedSet& s : sampled(large_lifted_sets(d, d <= 3   ? 3000
                                                           : d == 4 ? 400
                                                           : d == 5 ? 90
                                                                    : 30))) {
      const Triangulation t = triangulate(s);
      const Certificate c = certified(s, t);
      EXPECT_TRUE(c.valid) << s.name << ": " << c.reason;
      EXPECT_EQ(c.points_checked, s.count());
      for (const unsigned threads : {1U, 2U, 3U, 8U}) {
        TriangulationOptions o;
        o.threads = threads;
        expect_same(triangulate(s, o), t, s.name + ", " + std::to_string(threads) + " threads");
      }
    }
}

/// Vertices of merged cells, by coordinates.
std::set<std::set<std::vector<double>>> merged_cells(const LiftedSet& s, const Triangulation& t) {
  std::map<std::uint32_t, std::set<std::vector<double>>> groups;
  for (std::uint64_t c = 0; c < t.size(); ++c)
    for (const std::uint32_t v : t.cell(c)) {
      const double* r = s.rows.data() + std::size_t{v} * s.dimension;
      groups[t.group(c)].insert(std::vector<double>(r, r + s.dimension));
    }
  std::set<std::set<std::vector<double>>> all;
  for (const auto& [number, rows] : groups) all.insert(rows);
  return all;
}

/// Ties go by id: merged cells are the same in any order of points, and where there are no ties all
/// is, but for names.
TEST(Triangulation, OrderOfPointsDoesNotMatter) {
  for (unsigned d = 1; d <= 4; ++d)
    for (const LiftedSet& s : large_lifted_sets(d, d <= 3 ? 600 : 120)) {
      std::vector<std::uint32_t> order(s.count());
      std::iota(order.begin(), order.end(), 0U);
      std::shuffle(order.begin(), order.end(), std::mt19937_64(d));
      LiftedSet moved = s;
      for (std::uint32_t i = 0; i < s.count(); ++i) {
        std::copy_n(s.rows.data() + std::size_t{order[i]} * d, d,
                    moved.rows.data() + std::size_t{i} * d);
        if (!s.weights.empty()) moved.weights[i] = s.weights[order[i]];
      }
      EXPECT_TRUE(merged_cells(s, triangulate(s)) == merged_cells(moved, triangulate(moved)))
          << s.name;
    }
}

template <class T>
void expect_scalar(const LiftedSet& s, const Triangulation& expected) {
  std::vector<T> rows;
  for (const double v : s.rows) rows.push_back(static_cast<T>(v));
  const PointView points = PointView::row_major(rows.data(), s.count(), s.dimension);
  const Triangulation t = delaunay(points);
  EXPECT_EQ(t.scalar, scalar_type_of<T>());
  expect_same(t, expected, s.name);
  EXPECT_TRUE(certify(points, t).valid);
}

TEST(Triangulation, ScalarTypesOfEqualValueAgree) {
  for (unsigned d = 1; d <= 4; ++d) {
    LiftedSet s;
    s.dimension = d;
    std::mt19937_64 random(d);
    for (unsigned i = 0; i < 200 * d; ++i) s.rows.push_back(static_cast<double>(random() % 90));
    const Triangulation t = triangulate(s);
    expect_scalar<float>(s, t);
    expect_scalar<std::uint8_t>(s, t);
    expect_scalar<std::int16_t>(s, t);
    expect_scalar<std::uint32_t>(s, t);
  }
}

TEST(Triangulation, FewPoints) {
  for (unsigned d = 1; d <= 5; ++d) {
    LiftedSet s;
    s.dimension = d;
    const Triangulation none = triangulate(s);
    EXPECT_EQ(none.affine_dimension, -1);
    EXPECT_EQ(none.size(), 0U);
    EXPECT_TRUE(certified(s, none).valid);
    std::mt19937_64 random(d);
    for (unsigned n = 1; n <= d + 3; ++n) {
      for (unsigned j = 0; j < d; ++j) s.rows.push_back(static_cast<double>(random() % 1000));
      s.name = std::to_string(n) + " points in " + std::to_string(d) + "D";
      check(s);
    }
    for (double& v : s.rows) v = 0.5;
    s.name = "all equal";
    check(s);
    EXPECT_EQ(triangulate(s).duplicates.size(), s.count() - 1);
  }
}

TEST(Triangulation, WeightsHidePoints) {
  // The middle of an edge whose lifted point is above, on and below the edge's.
  LiftedSet s;
  s.dimension = 2;
  s.rows = {0, 0, 2, 0, 0, 2, 1, 0};
  for (const double w : {-1.5, -1.0, -0.5}) {
    s.weights = {0, 0, 0, w};
    check(s);
    const Triangulation t = triangulate(s);
    EXPECT_EQ(t.hidden.size(), w < -0.5 ? 1U : 0U) << w;
    EXPECT_EQ(t.size(), w < -0.5 ? 1U : 2U) << w;
  }
}

TEST(Triangulation, RefusesWhatIsNone) {
  std::vector<double> rows{0, 0, 1, 0, 0, std::nan("")};
  const PointView points = PointView::row_major(rows.data(), 3, 2);
  EXPECT_NE(error_of(ErrorCode::not_finite, [&] { delaunay(points); }).find("point 2"),
            std::string::npos);
  rows[5] = 1;
  const double infinite = std::numeric_limits<double>::infinity();
  std::vector<double> weights{0, infinite, 0};
  EXPECT_EQ(error_of(ErrorCode::not_finite, [&] { regular_triangulation(points, weights); }),
            "the weight of point 1 is not finite");
  weights.pop_back();
  EXPECT_EQ(error_of(ErrorCode::invalid_argument, [&] { regular_triangulation(points, weights); }),
            "there are 3 points, but 2 weights");
  PointView many = points;
  many.count = 0xffffffff;
  many.point_stride = 0;
  EXPECT_EQ(error_of(ErrorCode::out_of_budget, [&] { delaunay(many); }),
            "a triangulation takes fewer than 4294967295 points, not 4294967295");
  many.dimension = 0;
  error_of(ErrorCode::invalid_argument, [&] { delaunay(many); });
  TriangulationOptions o;
  o.memory_budget = 100;
  error_of(ErrorCode::out_of_budget, [&] { delaunay(points, o); });
  std::stop_source stop;
  stop.request_stop();
  o = {};
  o.stop = stop.get_token();
  error_of(ErrorCode::cancelled, [&] { delaunay(points, o); });
}

// What is called while a check works, and what stops it, is the caller's to its end.
TEST(Triangulation, ChecksArePolledAndStopped) {
  for (unsigned d = 1; d <= 5; ++d) {
    const LiftedSet s = large_lifted_sets(d, d <= 3 ? 3000 : 60)[0];
    const Triangulation t = triangulate(s);
    TriangulationOptions o;
    o.threads = 1;
    unsigned calls = 0;
    o.poll = [&calls] { ++calls; };
    const Certificate checked = certify(view_of(s), t, o);
    EXPECT_TRUE(checked.valid) << s.name << ": " << checked.reason;
    EXPECT_GT(calls, 0U) << s.name;
    std::stop_source stop;
    o.stop = stop.get_token();
    o.poll = [&stop] { stop.request_stop(); };
    error_of(ErrorCode::cancelled, [&] { certify(view_of(s), t, o); });
  }
}

TEST(Triangulation, RungsAreAsDocumented) {
  // Few signs of random points need more than doubles; a grid far away none, as its differences are
  // small whole numbers of units.
  const LiftedSet s = large_lifted_sets(2, 2000)[0];
  const Triangulation t = triangulate(s);
  EXPECT_GT(t.statistics.rung_counts[0], 10000U);
  EXPECT_LT(t.statistics.rung_counts[1] + t.statistics.rung_counts[2], 10U);
  EXPECT_EQ(t.statistics.ties, 0U);
  LiftedSet grid;
  grid.dimension = 3;
  for (int i = 0; i < 1000; ++i)
    for (const int v : {i % 10, i / 10 % 10, i / 100}) grid.rows.push_back(std::ldexp(1.0, 40) + v);
  const Triangulation g = triangulate(grid);
  EXPECT_EQ(g.statistics.rung_counts[1] + g.statistics.rung_counts[2], 0U);
  EXPECT_GT(g.statistics.ties, 0U);
  EXPECT_EQ(g.cell_groups.back(), 9U * 9 * 9 - 1);
}

TEST(Triangulation, OneSubnormalCoordinateKeepsTheFilters) {
  for (unsigned d = 2; d <= 5; ++d) {
    LiftedSet zero = large_lifted_sets(d, d < 4 ? 2000 : 300)[0];
    for (double& x : zero.rows) x *= 7;
    zero.rows[d * 17 + 1] = 0;
    const Triangulation expected = triangulate(zero);
    for (const int by : {0, 55, 80}) {  // beyond 2^64 every sign is exact
      LiftedSet s = zero;
      for (double& x : s.rows) x = std::ldexp(x, by);
      s.rows[d * 17 + 1] = std::numeric_limits<double>::denorm_min();
      const Triangulation t = triangulate(s);
      EXPECT_EQ(t.cells, expected.cells) << d << " " << by;
      const auto& rungs = t.statistics.rung_counts;
      if (by < 64)
        EXPECT_LT(rungs[1] + rungs[2], rungs[0] / 100) << d << " " << by;
      else
        EXPECT_EQ(rungs[0] + rungs[1], 0U) << d;
    }
  }
}

TEST(Triangulation, OneSubnormalWeightKeepsTheFilters) {
  LiftedSet s = large_lifted_sets(3, 2000)[0];
  for (double& x : s.rows) x *= 7;
  s.weights.assign(s.count(), 0.0);
  const Triangulation expected = triangulate(s);
  s.weights[5] = -std::numeric_limits<double>::denorm_min();
  const Triangulation t = triangulate(s);
  EXPECT_EQ(t.cells, expected.cells);
  EXPECT_LT(t.statistics.rung_counts[2], t.statistics.rung_counts[0] / 100);
}

}  // namespace triangulation_test
}  // namespace cullhull
