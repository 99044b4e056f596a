#include "cull/planner.hpp"

#include <gtest/gtest.h>

namespace cullhull::internal {
namespace {

TEST(Planner, SurfacesAreNotCulled) {
  for (unsigned d = 2; d <= 6; ++d) {
    for (const std::uint64_t n : {100000U, 1000000U, 1000000000U}) {
      const std::uint64_t m = probe_sample_size(n, d);
      EXPECT_FALSE(cull_pays(n, d, m, m)) << d;
      EXPECT_FALSE(cull_pays(n, d, m, m - m / 20)) << d;
    }
  }
}

// Vertices of the hull of a sample of a ball, as measured: 1000 points in 2D and 3D, 500 in 4D.
TEST(Planner, BallsAreCulled) {
  EXPECT_TRUE(cull_pays(10000000, 2, 1000, 33));
  EXPECT_TRUE(cull_pays(8000000, 3, 1000, 132));
  EXPECT_TRUE(cull_pays(8000000, 4, 500, 189));
  EXPECT_TRUE(cull_pays(8000000, 5, 250, 174));
}

TEST(Planner, FewPointsAreNotCulled) {
  for (unsigned d = 2; d <= 6; ++d) {
    const std::uint64_t n = smallest_worth_culling(d);
    EXPECT_FALSE(cull_pays(n, d, probe_sample_size(n, d), d + 1)) << d;
    EXPECT_TRUE(cull_pays(200 * n, d, probe_sample_size(200 * n, d), d + 1)) << d;
    EXPECT_LT(n, smallest_worth_refining(d));
  }
}

TEST(Planner, SamplesFitTheirPoints) {
  for (unsigned d = 2; d <= 6; ++d) {
    for (std::uint64_t n = 1; n < (std::uint64_t{1} << 40); n = 3 * n + 1) {
      const std::uint64_t m = probe_sample_size(n, d);
      EXPECT_GE(m, 1U);
      EXPECT_LE(m, n);
      for (const std::uint64_t v : {std::uint64_t{0}, m / 2, m}) {
        const std::uint64_t size = map_sample_size(n, d, m, v);
        EXPECT_GE(size, m);
        EXPECT_LE(size, n);
        EXPECT_LE(size, 50000U);
      }
    }
  }
}

// More points deserve a larger sample, but fewer per point.
TEST(Planner, SamplesGrowSlowerThanPoints) {
  for (unsigned d = 2; d <= 4; ++d) {
    const std::uint64_t small = map_sample_size(1000000, d, 1000, 150);
    const std::uint64_t large = map_sample_size(2000000, d, 1000, 150);
    EXPECT_GT(large, small) << d;
    EXPECT_LT(large, 2 * small) << d;
  }
}

}  // namespace
}  // namespace cullhull::internal
