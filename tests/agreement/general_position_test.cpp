// Points in general position: vertex sets equal Qhull's, which is exact there; where qconvex is not
// installed, those of exact linear programs on fewer points.
#include "all_paths.hpp"
#include "point_sets.hpp"

namespace cullhull::testing_support {
namespace {

class GeneralPosition : public testing::TestWithParam<const char*> {};

TEST_P(GeneralPosition, VerticesEqualQhulls) {
  const unsigned count[] = {0, 0, 6000, 4000, 900, 300, 90};
  for (unsigned d = 2; d <= 6; ++d) {
#if defined(CULLHULL_QCONVEX)
    const PointSet s = random_set(GetParam(), count[d], d, 40 + d);
    expect_everywhere(s, qconvex_extreme_points(CULLHULL_QCONVEX, s));
#endif
    expect_exact(random_set(GetParam(), std::min(count[d], 100U), d, 50 + d));
  }
}

INSTANTIATE_TEST_SUITE_P(Shapes, GeneralPosition,
                         testing::Values("ball", "cube", "octahedron", "gauss", "sphere"),
                         [](const auto& shape) { return std::string(shape.param); });

TEST(GeneralPositionLarge, BallsThatTheFilterThins) {
  // Enough points for the filter to work, more than one chunk, and a second map.
  for (unsigned d = 2; d <= 4; ++d) {
    const PointSet s = random_set("ball", 300000, d, d);
    Options options;
    options.threads = 1;
    options.cull = CullMethod::none;
    const Hull reference = convex_hull(view_of(s), options);
    const Certificate c = certify(view_of(s), reference);
    EXPECT_TRUE(c.valid) << s.name << ": " << c.reason;
    for (unsigned threads : {1U, 2U, 3U}) {
      options.cull = CullMethod::gauge;
      options.threads = threads;
      const Hull h = convex_hull(view_of(s), options);
      EXPECT_EQ(canonical_hash(h), canonical_hash(reference)) << s.name << " threads " << threads;
      EXPECT_LT(h.statistics.survivors, s.count() / 4) << s.name;
    }
  }
}

}  // namespace
}  // namespace cullhull::testing_support
