// Extreme points by linear programs against the vertices of the hull, and against rational
// arithmetic alone.
#include "cullhull/extreme_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "all_paths.hpp"
#include "cullhull/generate.hpp"
#include "exact/orientation/orientation.hpp"
#include "extreme/hull_membership.hpp"
#include "extreme/point_columns.hpp"
#include "geometry/local_frame.hpp"
#include "parallel/threads/run.hpp"
#include "point_sets.hpp"

namespace cullhull::extreme_points_test {

using namespace testing_support;

void expect_hull_vertices(const PointSet& set) {
  const PointView view = view_of(set);
  Options options;
  const Ids expected = sorted_vertices(convex_hull(view, options));
  for (const unsigned threads : {1U, 2U, 3U}) {
    options.threads = threads;
    const ExtremePoints found = extreme_points(view, options);
    EXPECT_EQ(found.ids, expected)
        << set.name << " in dimension " << set.dimension << ", " << threads << " threads";
  }
}

TEST(ExtremePoints, GeneralPosition) {
  for (const unsigned d : {1U, 2U, 3U, 4U, 5U, 6U, 7U})
    for (const char* shape : {"ball", "gauss", "cube", "sphere"}) {
      if (d == 1 && std::string(shape) == "sphere") continue;
      expect_hull_vertices(generated(shape, d < 6 ? 400 : 60, d, d));
    }
}

TEST(ExtremePoints, ManyNonExtreme) {
  expect_hull_vertices(generated("gauss", 4000, 4, 3));
  expect_hull_vertices(generated("cube", 2000, 5, 4));
}

TEST(ExtremePoints, Degenerate) {
  for (const unsigned d : {4U, 5U, 6U}) {
    expect_hull_vertices(cube_with_centres(d));
    expect_hull_vertices(cross_polytope_with_middles(d));
  }
  expect_hull_vertices(cyclic(24, 4));
  expect_hull_vertices(cyclic(20, 6));
  expect_hull_vertices(cospherical(4, 30));
  expect_hull_vertices(flat(200, 4, 6, 5, 1));
  expect_hull_vertices(flat(200, 2, 6, 5, 2));
  expect_hull_vertices(all_magnitudes(40, 4, 5));
}

// The first simplex of some chunks is of five points of one facet, and has no inverse.
TEST(ExtremePoints, NearlyAllOnTwoFacets) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> place(-512, 512);
  for (unsigned run = 0; run < 100; ++run) {
    PointSet s = named("two facets", 4);
    for (unsigned i = 0; i < 56; ++i)
      s.add({place(random) * 0x1p-9, place(random) * 0x1p-9, place(random) * 0x1p-9,
             (i % 2 == 0 ? -1.0 : 1.0) + (i % 7 == 0 ? place(random) * 0x1p-49 : 0)});
    expect_hull_vertices(s);
  }
}

TEST(ExtremePoints, DuplicatesGiveTheLowestId) {
  PointSet s = generated("ball", 100, 7, 2);
  const std::vector<double> once = s.coordinates;
  s.coordinates.insert(s.coordinates.end(), once.begin(), once.end());
  const ExtremePoints found = extreme_points(view_of(s));
  ASSERT_FALSE(found.ids.empty());
  EXPECT_LT(found.ids.back(), 100U);
  expect_hull_vertices(s);
}

TEST(ExtremePoints, Few) {
  PointSet s = named("one point", 7);
  s.add(std::vector<double>(7, 3.0));
  EXPECT_EQ(extreme_points(view_of(s)).ids, (Ids{0}));
  EXPECT_EQ(extreme_points(view_of(s)).affine_dimension, 0);
  s.add(std::vector<double>(7, 4.0));
  s.add(std::vector<double>(7, 3.5));
  EXPECT_EQ(extreme_points(view_of(s)).ids, (Ids{0, 1}));
  EXPECT_TRUE(extreme_points(PointView::row_major(s.coordinates.data(), 0, 7)).ids.empty());
}

/// Points straight into the frame, for what works below it.
internal::LocalFrame frame_of(const PointSet& set) {
  return {Array<double>(set.coordinates.begin(), set.coordinates.end()),
          static_cast<std::uint32_t>(set.count()), set.dimension, internal::short_run()};
}

/// The scan over boxes against one over all points, in any order of adding.
TEST(ExtremePoints, ColumnsFindTheLeast) {
  for (const unsigned d : {4U, 7U, 9U}) {
    const internal::LocalFrame frame = frame_of(generated("gauss", 2500, d, d));
    const internal::LocalPoints& points = frame.points();
    std::mt19937_64 rng(d);
    std::normal_distribution<double> gauss;
    internal::PointColumns columns(points);
    for (std::uint32_t i = 0; i < points.count; ++i) {
      columns.add(points.count - 1 - i);
      if (i % 97 != 0) continue;
      std::vector<float> w(d);
      double size = 0;
      for (float& v : w) size += std::abs(v = static_cast<float>(gauss(rng)));
      const std::uint32_t except = i % 2 == 0 ? points.count - 1 - i / 2 : 0;
      for (const std::size_t prefix : {std::size_t{64}, std::size_t{points.count}}) {
        const auto found = columns.least(w.data(), except, prefix);
        double least = HUGE_VAL, value = HUGE_VAL;
        for (std::size_t k = 0; k < std::min(prefix, columns.ids().size()); ++k) {
          const std::uint32_t id = columns.ids()[k];
          if (id == except) continue;
          double sum = 0;
          for (unsigned j = 0; j < d; ++j) sum += double{w[j]} * points.row(id)[j];
          least = std::min(least, sum);
          if (id == found.id) value = sum;
        }
        if (least == HUGE_VAL) {
          EXPECT_EQ(found.id, internal::no_index);
          continue;
        }
        const double bound = (d + 2) * 0x1p-24 * size + 0x1p-120;
        EXPECT_LE(std::abs(found.value - least), bound) << i;
        EXPECT_LE(value, least + 2 * bound) << i;
        EXPECT_LT(value, HUGE_VAL) << i;
      }
    }
  }
}

/// What an inverse proves to be inside is inside, exactly; points well inside are proved to be.
TEST(ExtremePoints, SimplexInversesAreRight) {
  for (const unsigned d : {4U, 6U, 8U}) {
    // d + 1 corners, then points from the middle of the simplex out, some a rounding from a facet.
    PointSet set = generated("gauss", d + 1, d, d);
    std::mt19937_64 rng(d);
    for (int k = 0; k < 600; ++k) {
      std::vector<double> share(d + 1), x(d, 0.0);
      double sum = 0;
      for (double& v : share) sum += v = static_cast<double>(rng() % 1000 + 1);
      if (k % 3 == 1) share[k % d] = sum * (k % 2 == 0 ? 0x1p-53 : -0x1p-53);
      if (k % 3 == 2) share[k % d] = -share[k % d];
      sum = 0;
      for (const double v : share) sum += v;
      for (unsigned i = 0; i <= d; ++i)
        for (unsigned j = 0; j < d; ++j)
          x[j] += share[i] / sum * set.coordinates[std::size_t{i} * d + j];
      set.add(x);
    }
    const internal::LocalFrame frame = frame_of(set);
    const internal::LocalPoints& points = frame.points();
    std::vector<std::uint32_t> corners(d + 1);
    for (std::uint32_t i = 0; i <= d; ++i) corners[i] = i;
    internal::SimplexInverse inverse;
    EXPECT_FALSE(inverse.surely_inside(points.row(0)));
    ASSERT_TRUE(inverse.set(points, corners.data()));
    int proved = 0;
    for (std::uint32_t i = 0; i < points.count; ++i) {
      std::vector<const double*> q(d + 1);
      for (unsigned k = 0; k <= d; ++k) q[k] = points.row(k);
      const internal::Sign whole = internal::orientation(d, q.data());
      bool inside = true;
      for (unsigned k = 0; k <= d; ++k) {
        q[k] = points.row(i);
        inside &= internal::orientation(d, q.data()) == whole;
        q[k] = points.row(k);
      }
      const bool sure = inverse.surely_inside(points.row(i));
      EXPECT_TRUE(inside || !sure) << "point " << i << " in dimension " << d;
      proved += sure;
      if (i > d && (i - d - 1) % 3 == 0) {
        EXPECT_TRUE(sure) << "point " << i << " in dimension " << d;
      }
    }
    EXPECT_GE(proved, 200);
    std::vector<std::uint32_t> flat = corners;  // twice the same corner
    flat[0] = flat[1];
    EXPECT_FALSE(inverse.set(points, flat.data()));
    EXPECT_FALSE(inverse.surely_inside(points.row(d + 1)));
  }
}

/// The rational simplex method on every point: it must agree on points in faces, where floating
/// point gives up, and elsewhere.
TEST(ExtremePoints, RationalSimplexAgrees) {
  for (const PointSet& set :
       {cube_with_centres(4), cross_polytope_with_middles(4), generated("gauss", 60, 5, 9)}) {
    const unsigned d = set.dimension;
    const Ids expected = sorted_vertices(convex_hull(view_of(set)));
    const internal::Run& run = internal::short_run();
    const internal::LocalFrame frame(Array<double>(set.coordinates.begin(), set.coordinates.end()),
                                     static_cast<std::uint32_t>(set.count()), d, run);
    std::vector<std::uint32_t> all(set.count());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    for (std::uint32_t i = 0; i < all.size(); ++i)
      EXPECT_EQ(!internal::inside_exact(frame.points(), i, all, run.control),
                std::binary_search(expected.begin(), expected.end(), i))
          << set.name << " point " << i;
  }
}

}  // namespace cullhull::extreme_points_test
