// The PseudoHull by hand: every step of the paper's Algorithm 1, and the facet stream's addresses.
#include "filter/pseudo_hull/pseudo_hull.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "cullhull/options.hpp"
#include "exact/orientation/orientation.hpp"
#include "filter/pseudo_hull/pseudo_hull_growth.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::pseudo_hull_test {

using Ids = std::vector<std::uint64_t>;

// Facets 0 ... k become 0 ... d (k + 1) - 1. In 3D the paper writes j, k + 2 j + 1, k + 2 j + 2.
TEST(FacetStream, AddressesArePapers) {
  for (std::uint32_t k = 0; k < 20; ++k)
    for (std::uint32_t j = 0; j <= k; ++j) {
      EXPECT_EQ(child_address<3>(k + 1, j, 0), j);
      EXPECT_EQ(child_address<3>(k + 1, j, 1), k + 2 * j + 1);
      EXPECT_EQ(child_address<3>(k + 1, j, 2), k + 2 * j + 2);
    }
  // d = 5, three facets: 1 stays in cell 1, its four others follow those of facet 0.
  EXPECT_EQ(child_address<5>(3, 0, 1), 3U);
  EXPECT_EQ(child_address<5>(3, 0, 4), 6U);
  EXPECT_EQ(child_address<5>(3, 1, 0), 1U);
  EXPECT_EQ(child_address<5>(3, 1, 1), 7U);
  EXPECT_EQ(child_address<5>(3, 2, 4), 14U);
}

template <unsigned D>
void expect_every_cell_once() {
  for (std::uint32_t facets = 1; facets < 12; ++facets) {
    std::vector<int> times(std::size_t{facets} * D, 0);
    for (std::uint32_t j = 0; j < facets; ++j)
      for (unsigned i = 0; i < D; ++i) ++times.at(child_address<D>(facets, j, i));
    EXPECT_EQ(std::count(times.begin(), times.end(), 1), facets * D) << D << "D, " << facets;
  }
}

TEST(FacetStream, EveryCellIsWrittenOnce) {
  expect_every_cell_once<2>();
  expect_every_cell_once<3>();
  expect_every_cell_once<4>();
  expect_every_cell_once<5>();
  expect_every_cell_once<6>();
  expect_every_cell_once<7>();
  expect_every_cell_once<8>();
}

TEST(PseudoHullMath, PlaneOfAnEdgeAndOfATriangle) {
  const double a[] = {0, 0}, b[] = {0.5, 0}, above[] = {0.25, 0.5};
  const double* edge[] = {a, b};
  PseudoPlane<2> f;
  ASSERT_TRUE(make_plane<2>(edge, above, f));
  EXPECT_EQ(f.normal[0], 0);
  EXPECT_EQ(f.normal[1], -1);
  EXPECT_EQ(pseudo_distance<2>(f.normal, a, above), -0.5);
  EXPECT_GT(f.error, 0);
  EXPECT_LT(f.error, 1e-14);

  const double o[] = {0, 0, 0.25}, x[] = {1, 0, 0.25}, y[] = {0, 1, 0.25}, below[] = {0, 0, 0};
  const double* triangle[] = {o, x, y};
  PseudoPlane<3> t;
  ASSERT_TRUE(make_plane<3>(triangle, below, t));
  EXPECT_EQ(t.normal[2], 1);
  const double up[] = {0.5, 0.5, 0.75};
  EXPECT_EQ(pseudo_distance<3>(t.normal, o, up), 0.5);
}

TEST(PseudoHullMath, UncertainPlanesProveNothing) {
  const double a[] = {0.1, 0.1}, b[] = {0.2, 0.2}, on[] = {0.3, 0.3}, far[] = {-5, 5};
  const double* edge[] = {a, b};
  PseudoPlane<2> f;
  EXPECT_FALSE(make_plane<2>(edge, on, f));
  PlaceSearch search;
  search.offer(0, pseudo_distance<2>(f.normal, a, far), f.error);
  EXPECT_EQ(search.result().facet, place_uncertain);
  const double* point[] = {a, a};
  EXPECT_FALSE(make_plane<2>(point, far, f));
  EXPECT_EQ(f.error, INFINITY);
}

Place placed(std::vector<double> distances, double error = 0.125) {
  PlaceSearch search;
  for (std::uint32_t i = 0; i < distances.size(); ++i) search.offer(i, distances[i], error);
  return search.result();
}

TEST(PseudoHullMath, APointGoesToTheNearestFacetItIsOutsideOf) {
  EXPECT_EQ(placed({3, 1, 2}).facet, 1U);
  EXPECT_EQ(placed({3, 1, 2}).distance, 1);
  EXPECT_EQ(placed({-3, 2, -1}).facet, 1U);
  EXPECT_EQ(placed({2, 1, 1}).facet, 1U);     // the first on ties
  EXPECT_EQ(placed({0.1, 1, -1}).facet, 1U);  // within the error of facet 0: not outside of it
  EXPECT_EQ(placed({-1, -1, -0.126}).facet, place_inside);
  EXPECT_EQ(placed({-1, -1, -0.125}).facet, place_uncertain);
  EXPECT_EQ(placed({-1, 0, -1}).facet, place_uncertain);
  EXPECT_EQ(placed({-1, NAN, -1}).facet, place_uncertain);
  EXPECT_EQ(placed({NAN, NAN, NAN}).facet, place_uncertain);
}

// Twelve points on a sheet of squared paper.
class ByHand : public ::testing::Test {
 protected:
  static constexpr double points[][2] = {
      {-8, 0},  {8, 0}, {0, -8},  // the simplex: lowest and highest x, lowest y
      {0, 8},                     // 3: highest y, farthest above the edge (0 1)
      {0, -1},                    // 4: in the simplex
      {0, 4},                     // 5: above the edge (0 1), below its two successors
      {5, 5},                     // 6: above (0 1) and above (3 1)
      {-5, -5},                   // 7: beyond the edge (0 2)
      {-4, -4},                   // 8: on that edge
      {6, -1},                    // 9: in the simplex
      {5, -4},  {4, -5}};         // 10, 11: equally far beyond the edge (1 2)

  void run(unsigned rounds) {
    rows_.assign(&points[0][0], &points[0][0] + 24);
    growth_.run({rows_.data()}, 12, rounds, Control(Options{}), rounds_);
  }
  void expect_facet(std::uint32_t f, unsigned a, unsigned b, unsigned apex) {
    EXPECT_EQ(growth_.facets().at(f).vertex[0], a);
    EXPECT_EQ(growth_.facets().at(f).vertex[1], b);
    EXPECT_EQ(growth_.apexes().at(f), apex);
  }
  void expect_exterior(std::uint32_t i, std::uint32_t row, std::uint32_t facet) {
    EXPECT_EQ(growth_.exterior().at(i).row, row);
    EXPECT_EQ(growth_.exterior().at(i).facet, facet) << "of point " << row;
  }

  std::vector<double> rows_;
  PseudoHullGrowth<2, SerialExecutor, StoredRows<2>> growth_{SerialExecutor{}};
  std::vector<PseudoHullRound> rounds_;
};

TEST_F(ByHand, TheStartIsASimplexWithExteriorSets) {
  run(0);
  // 16 squares wide: scaled by 1/32.
  for (unsigned i = 0; i < 12; ++i) EXPECT_EQ(rows_[2 * i], points[i][0] / 32);
  ASSERT_EQ(growth_.facets().size(), 3U);
  expect_facet(0, 1, 2, 10);  // of equally far ones the first
  expect_facet(1, 0, 2, 7);
  expect_facet(2, 0, 1, 3);
  ASSERT_EQ(growth_.exterior().size(), 6U);
  expect_exterior(0, 3, 2);
  expect_exterior(1, 5, 2);
  expect_exterior(2, 6, 2);
  expect_exterior(3, 7, 1);
  expect_exterior(4, 10, 0);
  expect_exterior(5, 11, 0);
  ASSERT_EQ(rounds_.size(), 1U);
  EXPECT_EQ(rounds_[0].exterior, 12U);
  EXPECT_EQ(rounds_[0].culled, 2U);  // 4 and 9
  EXPECT_EQ(rounds_[0].kept, 4U);    // the corners, and 8, which is on an edge
}

TEST_F(ByHand, ARoundReplacesEveryFacetThroughItsFarthestPoint) {
  run(1);
  // Apexes 10, 7 and 3. Cells: facet 0 -> 0 3, 1 -> 1 4, 2 -> 2 5. Point
  // 11 is beyond (10 2) in cell 0, point 6 beyond (3 1) in cell 2: the other cells are null.
  ASSERT_EQ(growth_.facets().size(), 2U);
  expect_facet(0, 10, 2, 11);  // 5 y - 4 x = -40, at (4, -5): -41
  expect_facet(1, 3, 1, 6);
  ASSERT_EQ(growth_.exterior().size(), 2U);
  expect_exterior(0, 6, 1);
  expect_exterior(1, 11, 0);
  ASSERT_EQ(rounds_.size(), 2U);
  EXPECT_EQ(rounds_[1].facets, 3U);
  EXPECT_EQ(rounds_[1].exterior, 6U);
  EXPECT_EQ(rounds_[1].culled, 1U);  // 5
  EXPECT_EQ(rounds_[1].kept, 3U);
}

TEST_F(ByHand, ItEndsWhenNoPointIsOutside) {
  run(100);
  EXPECT_TRUE(growth_.exterior().empty());
  EXPECT_TRUE(growth_.facets().empty());
  ASSERT_EQ(rounds_.size(), 3U);
  EXPECT_EQ(rounds_[2].facets, 2U);
  EXPECT_EQ(rounds_[2].kept, 2U);
  const std::vector<unsigned char> expected = {0, 0, 0, 0, 1, 1, 0, 0, 0, 1, 0, 0};
  EXPECT_EQ(std::vector<unsigned char>(growth_.culled(), growth_.culled() + 12), expected);
}

TEST_F(ByHand, TheSameThroughTheFilterAndItsReport) {
  const auto view = PointView::row_major(&points[0][0], 12, 2);
  const Ids expected = {0, 1, 2, 3, 6, 7, 8, 10, 11};
  for (const unsigned threads : {1U, 2U, 3U}) {
    EXPECT_EQ(
        pseudo_hull_survivors(view, {}, internal::short_run().with_threads(threads), &rounds_),
        expected);
    ASSERT_EQ(rounds_.size(), 3U);
    EXPECT_EQ(rounds_[1].culled, 1U);
  }
  // At a cap of one round the points still outside stay.
  EXPECT_EQ(pseudo_hull_survivors(view, {1, 1}, internal::short_run()), expected);
  // Without any round only the simplex culls: 5 stays.
  const Ids by_simplex = {0, 1, 2, 3, 5, 6, 7, 8, 10, 11};
  EXPECT_EQ(pseudo_hull_survivors(view, {1, 0}, internal::short_run()), by_simplex);
}

/// After a round the facets must lie in the order of their cells, null ones removed.
template <unsigned D, class Executor>
void expect_stream_order(Executor executor) {
  constexpr std::uint32_t n = 3000;
  std::vector<double> rows(n * D);
  std::mt19937_64 random(D);
  for (double& v : rows) v = static_cast<double>(random() >> 11) * 0x1p-53;
  PseudoHullGrowth<D, Executor, StoredRows<D>> growth(std::move(executor));
  std::vector<PseudoHullRound> rounds;
  growth.run({rows.data()}, n, 1, Control(Options{}), rounds);
  const auto before = growth.facets();
  const auto apexes = growth.apexes();
  const auto facets = static_cast<std::uint32_t>(before.size());
  growth.round(2, rounds);
  ASSERT_GT(growth.facets().size(), D);
  std::uint32_t next = 0;
  for (const auto& f : growth.facets()) {
    const auto j = static_cast<std::uint32_t>(std::find(apexes.begin(), apexes.end(), f.vertex[0]) -
                                              apexes.begin());
    ASSERT_LT(j, facets);
    unsigned missing = D;
    for (unsigned i = 0; i < D; ++i)
      if (std::find(f.vertex + 1, f.vertex + D, before[j].vertex[i]) == f.vertex + D) missing = i;
    ASSERT_LT(missing, D);
    const std::uint32_t cell = child_address<D>(facets, j, missing);
    EXPECT_GE(cell, next);
    next = cell + 1;
  }
  // Every facet left has an exterior point, and every exterior point a facet.
  std::set<std::uint32_t> used;
  for (const ExteriorPoint& p : growth.exterior()) used.insert(p.facet);
  EXPECT_EQ(used.size(), growth.facets().size());
  EXPECT_EQ(*used.rbegin() + 1, growth.facets().size());
}

TEST(FacetStream, CompactionKeepsTheOrderOfCells) {
  expect_stream_order<2>(SerialExecutor{});
  expect_stream_order<3>(SerialExecutor{});
  expect_stream_order<3>(ThreadExecutor(2));
  expect_stream_order<5>(SerialExecutor{});
}

TEST(PseudoHullStart, ExtremePointsOnOneLine) {
  // Lowest and highest of both axes are the ends of the diagonal: the third corner is searched.
  const double rows[] = {0, 0, 4, 4, 1, 3, 1.25, 2.5, 3, 1, 2, 1.5};
  const auto view = PointView::row_major(rows, 6, 2);
  EXPECT_EQ(pseudo_hull_survivors(view, {}, internal::short_run()), (Ids{0, 1, 2, 4}));
}

TEST(PseudoHullStart, FlatPointsAllSurvive) {
  for (const double slope : {0.0, 1.0, 0.1}) {
    std::vector<double> rows;
    for (int i = 0; i < 50; ++i)
      for (const double v : {i * 0.3, i * 7 % 11 * 0.7, i * 0.3 * slope}) rows.push_back(v);
    const auto view = PointView::row_major(rows.data(), 50, 3);
    EXPECT_EQ(pseudo_hull_survivors(view, {}, internal::short_run().with_threads(2)).size(), 50U)
        << slope;
  }
  const std::vector<double> equal(300, 0.1);
  EXPECT_EQ(
      pseudo_hull_survivors(PointView::row_major(equal.data(), 100, 3), {}, internal::short_run())
          .size(),
      100U);
}

TEST(PseudoHullStart, FewOrNoPoints) {
  const double rows[] = {0, 0, 1, 0, 0, 1, 0.25, 0.25};
  for (unsigned n = 0; n <= 3; ++n)
    EXPECT_EQ(pseudo_hull_survivors(PointView::row_major(rows, n, 2), {},
                                    internal::short_run().with_threads(2))
                  .size(),
              n);
  EXPECT_EQ(pseudo_hull_survivors(PointView::row_major(rows, 4, 2), {},
                                  internal::short_run().with_threads(2)),
            (Ids{0, 1, 2}));
  // More subsets than points.
  EXPECT_EQ(pseudo_hull_survivors(PointView::row_major(rows, 4, 2), {9, 5},
                                  internal::short_run().with_threads(2)),
            (Ids{0, 1, 2}));
}

/// What one would write first: unit normals and offsets in f32, no allowance for rounding.
bool naive_inside(const float (*corner)[2], const float* x) {
  for (int i = 0; i < 3; ++i) {
    const float* a = corner[i];
    const float* b = corner[(i + 1) % 3];
    const float n[] = {b[1] - a[1], a[0] - b[0]};
    if (n[0] * x[0] + n[1] * x[1] >= n[0] * a[0] + n[1] * a[1]) return false;
  }
  return true;
}

TEST(PseudoHullFilter, KeepsExtremePointsThatANaiveFilterDrops) {
  std::mt19937 random(5);
  int dropped_by_the_naive = 0;
  for (int trial = 0; trial < 20000; ++trial) {
    // A triangle, counter-clockwise, and a point one step beyond the middle of its first edge.
    const auto unit = [&] { return static_cast<float>(random() >> 8) * 0x1p-24F; };
    float p[4][2] = {{100 + unit(), 200 + unit()},
                     {140 + unit(), 200 + unit()},
                     {120 + unit(), 250 + unit()},
                     {}};
    for (int k = 0; k < 2; ++k) p[3][k] = (p[0][k] + p[1][k]) / 2;
    p[3][1] = std::nextafter(p[3][1], 0.0F);
    const double exact[4][2] = {
        {p[0][0], p[0][1]}, {p[1][0], p[1][1]}, {p[2][0], p[2][1]}, {p[3][0], p[3][1]}};
    const double* turn[] = {exact[0], exact[1], exact[3]};
    if (orientation(2, turn) != Sign::negative || !naive_inside(p, p[3])) continue;
    ++dropped_by_the_naive;
    const auto view = PointView::row_major(&p[0][0], 4, 2);
    EXPECT_EQ(pseudo_hull_survivors(view, {}, internal::short_run()).size(), 4U)
        << "trial " << trial;
  }
  EXPECT_GT(dropped_by_the_naive, 20);
}

TEST(PseudoHullFilter, WhatIsNotFiniteSurvives) {
  std::mt19937_64 random(3);
  std::vector<double> rows(20000 * 3);
  for (double& v : rows) v = static_cast<double>(random() >> 11) * 0x1p-53;
  const double bad[] = {NAN, INFINITY, -INFINITY};
  Ids ids;
  for (std::uint64_t i = 17; i < 20000; i += 1999) {
    rows[3 * i + i % 3] = bad[i / 3 % 3];
    ids.push_back(i);
  }
  const std::vector<float> single(rows.begin(), rows.end());
  for (const unsigned threads : {1U, 2U})
    for (const unsigned subsets : {0U, 1U, 7U}) {
      const auto of_doubles =
          pseudo_hull_survivors(PointView::row_major(rows.data(), 20000, 3), {subsets, 100},
                                internal::short_run().with_threads(threads));
      EXPECT_TRUE(std::includes(of_doubles.begin(), of_doubles.end(), ids.begin(), ids.end()));
      EXPECT_LT(of_doubles.size(), 10000U);
      const auto of_floats =
          pseudo_hull_survivors(PointView::row_major(single.data(), 20000, 3), {subsets, 100},
                                internal::short_run().with_threads(threads));
      EXPECT_TRUE(std::includes(of_floats.begin(), of_floats.end(), ids.begin(), ids.end()));
    }
  const std::vector<double> none(30, NAN);
  EXPECT_EQ(
      pseudo_hull_survivors(PointView::row_major(none.data(), 10, 3), {}, internal::short_run())
          .size(),
      10U);
}

TEST(PseudoHullFilter, StopsWhenAsked) {
  const std::vector<double> rows(300, 0.5);
  std::stop_source source;
  Options options;
  options.stop = source.get_token();
  source.request_stop();
  EXPECT_THROW(pseudo_hull_survivors(PointView::row_major(rows.data(), 100, 3), {},
                                     internal::Run(options).with_threads(1)),
               Error);
}

}  // namespace cullhull::internal::pseudo_hull_test
