// Extreme points by linear programs against the vertices of the hull, and against rational
// arithmetic alone.
#include "cullhull/extreme_points.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "all_paths.hpp"
#include "control.hpp"
#include "cullhull/generate.hpp"
#include "extreme/hull_membership.hpp"
#include "point_sets.hpp"
#include "points/local_frame.hpp"

namespace cullhull {
namespace {

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

PointSet generated(const char* shape, std::uint64_t n, unsigned d, std::uint64_t seed) {
  PointSet s = named(shape, d);
  s.coordinates = generate(shape, n, d, seed);
  return s;
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

/// The rational simplex method on every point: it must agree on points in faces, where floating
/// point gives up, and elsewhere.
TEST(ExtremePoints, RationalSimplexAgrees) {
  for (const PointSet& set :
       {cube_with_centres(4), cross_polytope_with_middles(4), generated("gauss", 60, 5, 9)}) {
    const unsigned d = set.dimension;
    const Ids expected = sorted_vertices(convex_hull(view_of(set)));
    const Options options;
    const internal::Control control(options);
    const internal::LocalFrame frame(Array<double>(set.coordinates.begin(), set.coordinates.end()),
                                     static_cast<std::uint32_t>(set.count()), d, 1, control);
    std::vector<std::uint32_t> all(set.count());
    for (std::uint32_t i = 0; i < all.size(); ++i) all[i] = i;
    for (std::uint32_t i = 0; i < all.size(); ++i)
      EXPECT_EQ(!internal::inside_exact(frame.points(), i, all, control),
                std::binary_search(expected.begin(), expected.end(), i))
          << set.name << " point " << i;
  }
}

}  // namespace
}  // namespace cullhull
