// Points in general position: vertex sets equal Qhull's, which is exact there; where qconvex is not
// installed, those of exact linear programs on fewer points.
#include <cmath>

#include "all_paths.hpp"
#include "call_options.hpp"
#include "geometry/gather.hpp"
#include "geometry/local_frame.hpp"
#include "hull/engine.hpp"
#include "parallel/threads/run.hpp"
#include "point_sets.hpp"

namespace cullhull::testing_support::general_position_test {

class GeneralPosition : public ::testing::TestWithParam<const char*> {};

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
                         ::testing::Values("ball", "cube", "octahedron", "gauss", "sphere"),
                         [](const auto& shape) { return std::string(shape.param); });

TEST(GeneralPositionLarge, BallsThatTheFilterThins) {
  // Enough points for the filter to work, more than one chunk, and a second map.
  for (unsigned d = 2; d <= 4; ++d) {
    const PointSet s = random_set("ball", 300000, d, d);
    Options options = options_of(1, CullMethod::none);
    const Hull reference = convex_hull(view_of(s), options);
    const Certificate c = certify(view_of(s), reference);
    EXPECT_TRUE(c.valid) << s.name << ": " << c.reason;
    for (const CullMethod cull : {CullMethod::gauge, CullMethod::pseudo_hull}) {
      std::uint64_t survivors = 0;
      for (unsigned threads : {1U, 2U, 3U}) {
        options.cull = cull;
        options.threads = threads;
        const Hull h = convex_hull(view_of(s), options);
        EXPECT_EQ(canonical_hash(h), canonical_hash(reference))
            << s.name << ", cull " << static_cast<int>(cull) << ", threads " << threads;
        // A 4-ball of 60000 points has few inside: a third may stay.
        EXPECT_LT(h.statistics.survivors, s.count() / (d == 4 ? 3 : 4)) << s.name;
        if (threads == 1) survivors = h.statistics.survivors;
        EXPECT_EQ(h.statistics.survivors, survivors) << s.name;
      }
    }
  }
}

TEST(GeneralPositionLarge, TheSameForAnyNumberOfThreads) {
  const unsigned counts[] = {20000, 3000, 700, 200};  // of 4D to 7D: many rounds each
  for (unsigned d = 4; d <= 7; ++d)
    for (const char* shape : {"sphere", "ball"}) {
      const PointSet s = random_set(shape, counts[d - 4], d, d);
      Options options = options_of(1);
      const std::uint64_t expected = canonical_hash(convex_hull(view_of(s), options));
      for (const unsigned threads : {2U, 3U, 16U, 64U}) {
        options.threads = threads;
        EXPECT_EQ(canonical_hash(convex_hull(view_of(s), options)), expected)
            << s.name << " in dimension " << d << ", threads " << threads;
      }
    }
}

/// The engine's own facets, in general position and where one thread must begin again because
/// points lie in the hyperplanes of facets.
TEST(GeneralPositionLarge, TheSameFacetsForAnyNumberOfThreadsIfTheyAreAskedFor) {
  using namespace internal;
  const unsigned counts[] = {20000, 3000, 700};
  for (unsigned d = 4; d <= 6; ++d)
    for (const double places : {0.0, 12.0}) {
      PointSet s = random_set("sphere", counts[d - 4], d, d);
      if (places > 0)
        for (double& x : s.coordinates) x = std::round(x * places);
      Boundary expected;
      for (const unsigned threads : {1U, 2U, 3U, 16U, 64U}) {
        const Options options = options_of(threads);
        const internal::Run run(options);
        const LocalFrame frame(gather_points(view_of(s), nullptr, s.count(), run),
                               static_cast<std::uint32_t>(s.count()), d, run);
        Boundary found = hull_nd(frame.points(), frame.simplex().data(), run, true);
        if (threads == 1) {
          expected = std::move(found);
          continue;
        }
        EXPECT_EQ(found.vertices, expected.vertices) << d << "D, " << places << ", " << threads;
        EXPECT_EQ(found.neighbours, expected.neighbours) << d << "D, " << places << ", " << threads;
      }
    }
}

}  // namespace cullhull::testing_support::general_position_test
