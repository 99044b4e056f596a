// The estimate of the number of facets against hulls that were built, and what is refused.
#include "hull/general/facet_estimate.hpp"

#include <gtest/gtest.h>

#include <string>

#include "cullhull/error.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/hull.hpp"
#include "geometry/local_frame.hpp"
#include "parallel/threads/run.hpp"
#include "thrown.hpp"

namespace cullhull::facet_estimate_test {

using namespace testing_support;

struct Case {
  const char* shape;
  unsigned dimension;
  std::uint32_t count;
};

class FacetEstimateTest : public ::testing::TestWithParam<Case> {};

TEST_P(FacetEstimateTest, WithinAFactorOfThree) {
  const Case& c = GetParam();
  const std::vector<double> x = generate(c.shape, c.count, c.dimension);
  const auto view = PointView::row_major(x.data(), c.count, c.dimension);
  const auto facets = static_cast<double>(convex_hull(view).facet_count());
  const internal::Run& run = internal::short_run();
  const internal::LocalFrame frame(Array<double>(x.begin(), x.end()), c.count, c.dimension, run);
  for (const unsigned threads : {1U, 2U}) {
    const auto estimate = internal::estimate_facets(frame.points(), run.with_threads(threads));
    EXPECT_LT(estimate.facets, 3 * facets);
    EXPECT_GT(estimate.facets, facets / 3);
  }
}

INSTANTIATE_TEST_SUITE_P(Bodies, FacetEstimateTest,
                         ::testing::Values(Case{"sphere", 6, 2000}, Case{"ball", 6, 4000},
                                           Case{"gauss", 6, 20000}, Case{"cube", 6, 5000},
                                           Case{"ball", 8, 300}, Case{"gauss", 8, 400},
                                           Case{"sphere", 4, 5000}, Case{"cube", 9, 50},
                                           Case{"sphere", 9, 60}, Case{"gauss", 12, 30},
                                           Case{"cube", 16, 27}, Case{"cube", 20, 25}));

TEST(FacetEstimateTest, RefusedBeforeTheWork) {
  const std::vector<double> x = generate("ball", 20000, 8);
  Options options;
  options.memory_budget = std::uint64_t{1} << 30;
  const std::string what = error_of(ErrorCode::out_of_budget, [&] {
    convex_hull(PointView::row_major(x.data(), 20000, 8), options);
  });
  EXPECT_TRUE(has(what, "facets is expected"));
  EXPECT_TRUE(has(what, "memory budget is 1024 MiB"));
}

TEST(FacetEstimateTest, RefusedInManyDimensionsBeforeTheWork) {
  // Hulls of 1.5 million facets, of more than 10^9, and of more than any memory holds.
  for (const auto& [count, dimension] : {std::pair{60U, 12U}, {60U, 20U}, {100U, 30U}}) {
    const std::vector<double> x = generate("cube", count, dimension);
    const PointView points = PointView::row_major(x.data(), count, dimension);
    Options options;
    options.memory_budget = 100 << 20;
    EXPECT_TRUE(has(error_of(ErrorCode::out_of_budget, [&] { convex_hull(points, options); }),
                    "facets is expected"));
  }
}

TEST(FacetEstimateTest, UpperBoundTheorem) {
  EXPECT_EQ(internal::most_facets(5, 4), 5);   // the simplex
  EXPECT_EQ(internal::most_facets(8, 4), 20);  // cyclic: n (n - 3) / 2
  EXPECT_EQ(internal::most_facets(10, 6), 50);
  EXPECT_EQ(internal::most_facets(7, 3), 10);  // 2 n - 4
  EXPECT_EQ(internal::most_facets(4, 4), 0);
}

}  // namespace cullhull::facet_estimate_test
