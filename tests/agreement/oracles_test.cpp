// The oracles themselves, on answers known by hand and against one another.
#include "oracles.hpp"

#include <gtest/gtest.h>

#include "point_sets.hpp"

namespace cullhull::testing_support::oracles_test {

TEST(Oracles, KnownAnswers) {
  PointSet s = named("hand", 2);
  s.coordinates = {1, 1, 0, 0, 4, 0, 0, 4, 2, 2, 4, 0, -0.0, 0.0, 2, 0};
  EXPECT_EQ(exact_extreme_points(s), (Ids{1, 2, 3}));
  s.coordinates = {5, 5, 5, 5};
  EXPECT_EQ(exact_extreme_points(s), (Ids{0}));
  s.coordinates = {1, 1, 0, 0, 3, 3, 2, 2};
  EXPECT_EQ(exact_extreme_points(s), (Ids{1, 2}));
  // The last point is off the line by less than rounding shows.
  s.coordinates = {0, 0, 1, 1, 0.5, 0.5 + 0x1p-53};
  EXPECT_EQ(exact_extreme_points(s), (Ids{0, 1, 2}));
  s.coordinates = {0, 0, 1, 1, 0.5, 0.5};
  EXPECT_EQ(exact_extreme_points(s), (Ids{0, 1}));
  s.coordinates = {1e308, 5e-324, -1e308, 0, 0, 1e-308, 3, 4e-324};
  EXPECT_EQ(exact_extreme_points(s), (Ids{0, 1, 2}));
}

TEST(Oracles, KnownFamilies) {
  for (unsigned d = 2; d <= 4; ++d)
    EXPECT_EQ(exact_extreme_points(full_grid(d, 3, 0)), full_grid_corners(d, 3));
  for (unsigned d = 2; d <= 6; ++d) {
    const PointSet s = cross_polytope_with_middles(d);
    Ids last;
    for (std::uint64_t i = s.count() - 2 * d; i < s.count(); ++i) last.push_back(i);
    EXPECT_EQ(exact_extreme_points(s), last);
    EXPECT_EQ(exact_extreme_points(cyclic(d + 5, d)).size(), d + 5);
  }
}

#if defined(CULLHULL_QCONVEX)
TEST(Oracles, QhullAgreesInGeneralPosition) {
  for (unsigned d = 2; d <= 5; ++d) {
    const PointSet s = random_set("gauss", 120, d, d);
    EXPECT_EQ(exact_extreme_points(s), qconvex_extreme_points(CULLHULL_QCONVEX, s));
  }
}
#endif

#if defined(CULLHULL_LRS)
TEST(Oracles, LrsAgreesOnGrids) {
  for (unsigned d = 2; d <= 5; ++d) {
    const PointSet s = random_grid(60, d, 4, 0, d);
    EXPECT_EQ(exact_extreme_points(s), lrs_extreme_points(CULLHULL_LRS, s));
  }
}

TEST(Oracles, LrsCountsTheFacetsOfACube) {
  for (unsigned d = 2; d <= 5; ++d)
    EXPECT_EQ(lrs_facet_count(CULLHULL_LRS, cube_with_centres(d)), 2 * d);
}
#endif

}  // namespace cullhull::testing_support::oracles_test
