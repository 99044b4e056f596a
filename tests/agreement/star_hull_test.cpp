// The surface that a device grows and flips, without a device: two executors must agree on all of
// it, and the hull that comes of it must be the engine's, bit for bit.
#include "filter/star_hull/star_hull.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <tuple>
#include <vector>

#include "agreement/canonical_hash.hpp"
#include "agreement/hard_sets.hpp"
#include "agreement/random_seeds.hpp"
#include "call_options.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/options.hpp"
#include "flow/pipeline.hpp"
#include "parallel/threads/run.hpp"
#include "reference/emulated_executor.hpp"
#include "result/write/star_result.hpp"

namespace cullhull::internal::star_hull_test {

using namespace testing_support;

struct Found {
  StarCounts counts;
  std::vector<std::uint64_t> left;
  TriangleLists triangles;
};

/// What a hull finds, which it may have kept a surface for.
template <class T, class Executor>
Found found_by(StarHull<Executor, RowsInPlace<3, T>>& hull, const PointView& view,
               std::vector<PseudoHullRound>& rounds, unsigned most_rounds = 64) {
  Found found;
  const auto points = rows_in_place<3, T>(view, {view.count, 0, 1});
  const auto count = static_cast<std::uint32_t>(view.count);
  found.counts = hull.run(points, count, most_rounds, Control(Options{}), rounds);
  for (std::uint64_t i = 0; i < view.count; ++i)
    if (hull.culled()[i] == 0) found.left.push_back(i);
  const Options options;
  StarResult<Executor, RowsInPlace<3, T>> result;
  if (result.compute(hull, points, count, found.counts))
    if (auto lists = result.fetch(hull.executor(), Run(options), StarWanted::vertices)) {
      EXPECT_TRUE(std::ranges::equal(lists->rows, found.left));
      for (std::size_t i = 0; i < lists->coordinates.size(); ++i)
        EXPECT_EQ(lists->coordinates[i],
                  view.at(found.left[i / 3], static_cast<std::uint32_t>(i % 3)));
      found.triangles = std::move(lists->triangles);
    }
  return found;
}

template <class T, class Executor>
Found surface_of_points(const PointView& view, Executor executor, unsigned most_rounds = 64) {
  StarHull<Executor, RowsInPlace<3, T>> hull(std::move(executor));
  std::vector<PseudoHullRound> rounds;
  return found_by<T>(hull, view, rounds, most_rounds);
}

/// What was tried and what held.
struct Tally {
  unsigned sets = 0, whole = 0, held = 0, with_points_aside = 0, with_uncertain_edges = 0;
  unsigned with_reflex_edges = 0;
  std::uint64_t vertices = 0, flips = 0, rounds = 0;
};

/// The hull that the flow makes of what was found.
Hull hull_of_left(const PointView& view, const Found& found) {
  Filtered filtered;
  filtered.survivors.ids = found.left;
  for (const std::uint64_t i : found.left)
    for (unsigned j = 0; j < 3; ++j) filtered.rows.push_back(view.at(i, j));
  filtered.triangles = found.triangles;
  DevicePointView shape;
  shape.scalar = view.scalar;
  shape.dimension = 3;
  shape.count = view.count;
  return hull_of_rows(std::move(filtered), shape, options_of(1));
}

/// Whether two executors found the same, bit for bit.
void expect_same(const Found& a, const Found& b, const std::string& name) {
  EXPECT_EQ(a.left, b.left) << name;
  EXPECT_EQ(a.counts.end.reflex, b.counts.end.reflex) << name;
  EXPECT_EQ(a.counts.end.uncertain, b.counts.end.uncertain) << name;
  EXPECT_EQ(a.triangles.vertices, b.triangles.vertices) << name;
  EXPECT_EQ(a.triangles.neighbours, b.triangles.neighbours) << name;
  EXPECT_EQ(a.triangles.planes, b.triangles.planes) << name;
  EXPECT_EQ(a.triangles.exponent, b.triangles.exponent) << name;
  for (const auto sum : {&Share<3, DoubleDouble>::volume, &Share<3, DoubleDouble>::area}) {
    EXPECT_EQ((a.triangles.sums.*sum).high, (b.triangles.sums.*sum).high) << name;
    EXPECT_EQ((a.triangles.sums.*sum).low, (b.triangles.sums.*sum).low) << name;
  }
}

template <class T>
void expect_the_engines(const std::vector<T>& points, const std::string& name, Tally& tally) {
  const PointView view = PointView::row_major(points.data(), points.size() / 3, 3);
  const Found found = surface_of_points<T>(view, SerialExecutor{});
  expect_same(found, surface_of_points<T>(view, EmulatedExecutor(5, 32)), name);
  if (tally.sets % 4 == 0) expect_same(found, surface_of_points<T>(view, ThreadExecutor(3)), name);
  EXPECT_EQ(found.counts.left, found.left.size()) << name;
  EXPECT_EQ(canonical_hash(hull_of_left(view, found)),
            canonical_hash(convex_hull(view, options_of(1, CullMethod::none))))
      << name;
  ++tally.sets;
  tally.whole += found.counts.whole();
  tally.held += !found.triangles.empty();
  tally.with_points_aside += found.counts.aside > 0;
  tally.with_uncertain_edges += found.counts.end.uncertain > 0;
  tally.with_reflex_edges += found.counts.end.reflex > 0;
  tally.vertices += found.counts.vertices;
  tally.flips += found.counts.flips;
  tally.rounds += found.counts.flip_rounds;
}

std::string said(const Tally& t) {
  return std::to_string(t.sets) + " sets, " + std::to_string(t.whole) + " whole, of them " +
         std::to_string(t.held) + " written; with points aside " +
         std::to_string(t.with_points_aside) + ", uncertain edges " +
         std::to_string(t.with_uncertain_edges) + ", reflex edges " +
         std::to_string(t.with_reflex_edges) + "; vertices " + std::to_string(t.vertices) +
         ", flips " + std::to_string(t.flips) + ", rounds " + std::to_string(t.rounds);
}

TEST(StarHull, PointsInGeneralPosition) {
  Tally tally;
  for (std::uint64_t seed = 0; seed < 40; ++seed)
    for (const char* shape : {"ball", "sphere", "cube", "octahedron", "gauss"})
      for (const unsigned n : {5U, 12U, 60U, 400U}) {
        const PointSet set = testing_support::random_set(shape, n, 3, seed);
        expect_the_engines(set.coordinates, set.name, tally);
        std::vector<float> narrow(set.coordinates.begin(), set.coordinates.end());
        expect_the_engines(narrow, set.name + ", f32", tally);
      }
  RecordProperty("tally", said(tally));
  EXPECT_EQ(tally.sets, 1600U);
  EXPECT_EQ(tally.held, tally.sets) << said(tally);
}

// The grid of leaders: whatever its size, a closed surface of its cells, each seen from outside.
TEST(StarHull, LeadersFormASphere) {
  for (const std::uint32_t m : {2U, 3U, 4U, 7U, 16U}) {
    const LeaderGrid3 grid{m};
    std::vector<unsigned> facets_of(grid.cells(), 0);
    const double centre[3] = {1.0 * m, 1.0 * m, 1.0 * m};
    for (std::uint32_t f = 0; f < grid.facets(); ++f) {
      const StarFacet facet = grid.facet(f);
      double at[3][3];
      for (unsigned k = 0; k < 3; ++k) {
        ASSERT_LT(facet.vertex[k], grid.cells());
        ++facets_of[facet.vertex[k]];
        const LeaderGrid3::Node c = grid.middle(facet.vertex[k]);
        std::copy_n(c.at, 3, at[k]);
        const StarSide beyond = facet.across[k];
        ASSERT_LT(beyond.facet(), grid.facets());
        const StarFacet other = grid.facet(beyond.facet());
        EXPECT_EQ(other.across[beyond.corner()].code, side_of_facet(f, k).code) << m << ", " << f;
        EXPECT_EQ(other.vertex[next_corner(beyond.corner())], facet.vertex[last_corner(k)]);
        EXPECT_EQ(other.vertex[last_corner(beyond.corner())], facet.vertex[next_corner(k)]);
      }
      EXPECT_EQ(star_sign(centre, at[0], at[1], at[2]), 1) << m << ", " << f;
      EXPECT_EQ(grid.first_facet(grid.node_of(f)), f - (f % 2 == 1 && f < grid.facets() - 8));
    }
    // A vertex has as many facets as neighbours, and there are 3 V - 6 edges.
    std::uint64_t sum = 0;
    for (const unsigned n : facets_of) {
      EXPECT_GE(n, 3U);
      sum += n;
    }
    EXPECT_EQ(sum, 3 * std::uint64_t{grid.facets()});
  }
}

// Counted beside a simplex: 12 rounds, 3.5 n points in all rounds and 47 rounds of flips for the
// ball, 18, 15 n and 48 for the sphere, 11, 2.8 n and 80 for the cube.
TEST(StarHull, LeadersSaveRounds) {
  const std::tuple<const char*, std::uint32_t, unsigned, double, unsigned> expected[] = {
      {"ball", 384, 6, 1.1, 32}, {"sphere", 384, 11, 6.5, 40}, {"cube", 4, 11, 1.3, 80}};
  for (const auto& [shape, leaders, most_rounds, most_points, most_flip_rounds] : expected) {
    const std::vector<double> points = generate(shape, 65536, 3, 1);
    StarHull<SerialExecutor, RowsInPlace<3, double>> hull(SerialExecutor{});
    std::vector<PseudoHullRound> rounds;
    const StarCounts counts = hull.run(
        rows_in_place<3, double>(PointView::row_major(points.data(), 65536, 3), {65536, 0, 1}),
        65536, 64, Control(Options{}), rounds);
    double exterior = 0;
    for (const PseudoHullRound& r : rounds) exterior += static_cast<double>(r.exterior);
    EXPECT_EQ(counts.leaders, leaders) << shape;
    EXPECT_LE(rounds.size() - 1, most_rounds) << shape;
    EXPECT_LE(exterior, most_points * 65536) << shape;
    EXPECT_LE(counts.flip_rounds, most_flip_rounds) << shape;
    EXPECT_TRUE(counts.whole()) << shape;
  }
}

// Frames that follow one another, that break off (a sudden turn, another number of points, a point
// that dies), and that come back.
TEST(StarHull, MovingPointsKeepTheSurface) {
  for (const auto& [shape, motion] :
       {std::pair{"bumpy", "twist"}, std::pair{"ball", "fracture"}, std::pair{"cube", "explode"},
        std::pair{"ball", "teleport"}}) {
    const std::uint64_t n = 6000;
    const MovingPoints moving(shape, motion, n, 3, 200, 4);
    StarHull<SerialExecutor, RowsInPlace<3, double>> serial(SerialExecutor{});
    StarHull<EmulatedExecutor, RowsInPlace<3, double>> emulated(EmulatedExecutor(5, 32));
    unsigned moved = 0;
    for (const std::uint64_t index : {50, 51, 52, 53, 150, 151, 152, 152, 153}) {
      std::vector<double> points(3 * n);
      moving.frame(index, points.data());
      const bool fewer = index == 53;
      if (fewer) points.resize(3 * (n - 1));
      if (index == 151) points[300] = std::numeric_limits<double>::quiet_NaN();
      const PointView view = PointView::row_major(points.data(), points.size() / 3, 3);
      std::vector<PseudoHullRound> rounds, rounds_there;
      const Found found = found_by<double>(serial, view, rounds);
      const Found there = found_by<double>(emulated, view, rounds_there);
      if (found.counts.whole()) serial.keep(found.counts);
      if (there.counts.whole()) emulated.keep(there.counts);
      expect_same(found, there, motion + std::to_string(index));
      EXPECT_EQ(found.counts.moved, there.counts.moved) << motion << index;
      moved += found.counts.moved;
      if (found.counts.moved) {
        EXPECT_LE(rounds.size() - 1, 4U) << motion << index;
        EXPECT_LE(found.counts.flip_rounds, 40U) << motion << index;
      }
      if (index == 151) {
        EXPECT_FALSE(found.counts.whole());
        EXPECT_TRUE(std::ranges::binary_search(found.left, 100U));
        continue;
      }
      EXPECT_EQ(canonical_hash(hull_of_left(view, found)),
                canonical_hash(convex_hull(view, options_of(1, CullMethod::none))))
          << motion << index;
    }
    // Frames 51, 52, and of 150 to 153 those that follow one of the same points.
    EXPECT_GE(moved, std::string_view(motion) == "teleport" ? 1U : 4U) << motion;
  }
}

// Errors are bounded by the box of the frame before, unless this one is more than twice as long.
// Around a centre outside of it no surface is star-shaped, however far the points have moved.
TEST(StarHull, AFrameFarFromTheLastBeginsAnew) {
  const std::vector<double> ball = generate("ball", 2000, 3, 4);
  StarHull<EmulatedExecutor, RowsInPlace<3, double>> hull(EmulatedExecutor(5, 32));
  const std::tuple<double, double, bool> frames[] = {
      {1, 0, false},  {1.5, 0, true}, {6, 0, false},   {7, 1, true},
      {7, 20, false}, {7, 21, true},  {7, 1e6, false}, {7, -1e9, false}};
  for (const auto& [factor, shift, moved] : frames) {
    std::vector<double> points = ball;
    for (double& x : points) x = factor * x + shift;
    const PointView view = PointView::row_major(points.data(), 2000, 3);
    std::vector<PseudoHullRound> rounds;
    const Found found = found_by<double>(hull, view, rounds);
    EXPECT_EQ(found.counts.moved, moved) << factor << ", " << shift;
    ASSERT_TRUE(found.counts.whole()) << factor << ", " << shift;
    EXPECT_EQ(canonical_hash(hull_of_left(view, found)),
              canonical_hash(convex_hull(view, options_of(1, CullMethod::none))));
    hull.keep(found.counts);
  }
}

// A ring between two apexes that winds twice in the next frame, convex at every edge: the last
// surface is closed and seen from inside everywhere, but not the hull.
TEST(StarHull, ASurfaceThatWindsTwiceIsNotKept) {
  constexpr unsigned ring = 15;
  StarHull<SerialExecutor, RowsInPlace<3, double>> hull(SerialExecutor{});
  for (const unsigned turns : {1U, 2U}) {
    std::vector<double> points = {0, 0, 1, 0, 0, -1};
    for (unsigned i = 0; i < ring; ++i) {
      const double angle = 2 * std::numbers::pi * turns * i / ring;
      points.insert(points.end(), {std::cos(angle), std::sin(angle), 0.01 * std::sin(5 * angle)});
    }
    const PointView view = PointView::row_major(points.data(), ring + 2, 3);
    std::vector<PseudoHullRound> rounds;
    const Found found = found_by<double>(hull, view, rounds);
    EXPECT_FALSE(found.counts.moved);
    EXPECT_TRUE(found.counts.whole());
    EXPECT_EQ(canonical_hash(hull_of_left(view, found)),
              canonical_hash(convex_hull(view, options_of(1, CullMethod::none))));
    hull.keep(found.counts);
  }
}

// Flips come to an end at reflex edges that none of them can take: vertices are doomed, and
// removed.
TEST(StarHull, FlipsThatComeToAnEndTooEarly) {
  Tally tally;
  const std::tuple<const char*, unsigned, unsigned> sets[] = {
      {"ball", 2000, 57}, {"ball", 2000, 300}, {"ball", 8000, 148}, {"gauss", 8000, 163},
      {"cube", 2000, 67}, {"cube", 2000, 134}, {"cube", 8000, 0},   {"cube", 8000, 14}};
  unsigned doomed = 0;
  for (const auto& [shape, n, seed] : sets) {
    const std::vector<double> points = generate(shape, n, 3, seed);
    expect_the_engines(points, shape, tally);
    doomed += surface_of_points<double>(PointView::row_major(points.data(), n, 3), SerialExecutor{})
                  .counts.dooms > 0;
  }
  EXPECT_EQ(doomed, tally.sets);
  EXPECT_EQ(tally.held, tally.sets) << said(tally);
}

TEST(StarHull, HostileSets) {
  Tally tally;
  Random random(20261126);
  const std::uint64_t sets = testing_support::share_of(2000);
  while (tally.sets < sets) {
    PointSet set = testing_support::hard_set(random);
    if (set.dimension != 3 || set.count() > 20000) continue;
    expect_the_engines(set.coordinates, set.name, tally);
    if (HasFailure()) break;
  }
  RecordProperty("tally", said(tally));
  // Of the others some planes need exact arithmetic, or the coordinates span too many powers of
  // two.
  EXPECT_GT(4 * tally.held, 3 * tally.whole) << said(tally);
  EXPECT_GT(20 * tally.with_points_aside, sets) << said(tally);
  EXPECT_GT(20 * tally.with_uncertain_edges, sets) << said(tally);
}

// Vertices that flips must remove, and a set in which every point is a vertex.
TEST(StarHull, LargerSets) {
  Tally tally;
  for (const char* shape : {"ball", "sphere", "cube", "gauss"}) {
    const PointSet set = testing_support::random_set(shape, 20000, 3, 5);
    expect_the_engines(set.coordinates, set.name, tally);
  }
  EXPECT_EQ(tally.held, 4U) << said(tally);
  // Without rounds the points outside of the simplex are left.
  const PointSet set = testing_support::random_set("ball", 2000, 3, 6);
  const PointView view = PointView::row_major(set.coordinates.data(), 2000, 3);
  const Found cut_off = surface_of_points<double>(view, SerialExecutor{}, 0);
  EXPECT_GT(cut_off.counts.aside, 1000U);
  EXPECT_FALSE(cut_off.counts.whole());
}

TEST(StarHull, ScaledAndOffCentre) {
  Tally tally;
  for (const char* shape : {"ball", "sphere", "cube"})
    for (const double scale : {1e-100, 1e-30, 1.0, 1e30, 1e100})
      for (const double offset : {-3.0, 1e3, 1e6}) {
        PointSet set = testing_support::random_set(shape, 500, 3, 12);
        for (double& v : set.coordinates) v = (v + offset) * scale;
        const std::string name = std::string(shape) + " times " + std::to_string(scale);
        expect_the_engines(set.coordinates, name, tally);
        if (scale > 1e-40 && scale < 1e31)
          expect_the_engines(std::vector<float>(set.coordinates.begin(), set.coordinates.end()),
                             name + ", f32", tally);
      }
  EXPECT_GT(4 * tally.held, 3 * tally.sets) << said(tally);
}

TEST(StarHull, FlatTinyHugeAndNotFinite) {
  Tally tally;
  for (const double scale : {1e-322, 1e-300, 1e-150, 1e150, 1e307}) {
    PointSet set = testing_support::random_set("gauss", 500, 3, 9);
    for (double& v : set.coordinates) v *= scale;
    expect_the_engines(set.coordinates, std::to_string(scale), tally);
  }
  PointSet flat = testing_support::random_set("gauss", 500, 3, 10);
  for (std::size_t i = 0; i < flat.count(); ++i)
    flat.coordinates[3 * i + 2] = flat.coordinates[3 * i] + flat.coordinates[3 * i + 1];
  expect_the_engines(flat.coordinates, "flat", tally);
  expect_the_engines(std::vector<double>(300, 0.5), "equal", tally);
  std::vector<double> bad = testing_support::random_set("ball", 500, 3, 11).coordinates;
  bad[700] = std::numeric_limits<double>::quiet_NaN();
  bad[901] = std::numeric_limits<double>::infinity();
  const Found found =
      surface_of_points<double>(PointView::row_major(bad.data(), 500, 3), SerialExecutor{});
  EXPECT_TRUE(std::ranges::binary_search(found.left, 700 / 3));
  EXPECT_TRUE(std::ranges::binary_search(found.left, 901 / 3));
  EXPECT_FALSE(found.counts.whole());
}

}  // namespace cullhull::internal::star_hull_test
