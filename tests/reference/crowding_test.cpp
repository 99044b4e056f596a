// Helpers that have no processor: nobody is asked for a while, and all work is done without them.
#include "parallel/threads/crowding.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include "agreement/canonical_hash.hpp"
#include "call_options.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/hull.hpp"
#include "parallel/threads/helpers.hpp"
#include "parallel/threads/parallel.hpp"

namespace cullhull::internal::crowding_test {

using namespace testing_support;
using namespace std::chrono_literals;

class Crowding : public ::testing::Test {
 protected:
  void SetUp() override { forget_crowding(); }
  void TearDown() override { forget_crowding(); }
};

TEST_F(Crowding, LongWaitsInARowAreRememberedShortOnesAreNot) {
  note_wait(1ms, 2ms);  // a chunk that took a little longer than the others
  EXPECT_FALSE(crowded());
  note_wait(10us, 300us);
  EXPECT_FALSE(crowded());
  note_wait(100us, 1s);  // perhaps for an item that was long itself
  EXPECT_FALSE(crowded());
  note_wait(100us, 1s);
  EXPECT_TRUE(crowded());
  forget_crowding();
  EXPECT_FALSE(crowded());
}

TEST_F(Crowding, NobodyIsAskedAndAllIsDone) {
  note_wait(100us, 1s);
  note_wait(100us, 1s);
  const std::thread::id caller = std::this_thread::get_id();
  std::vector<int> hits(200, 0);
  while (crowded())
    for_each_chunk(200, 1, 4, [&](std::uint64_t i, std::uint64_t, std::uint64_t) {
      EXPECT_TRUE(!crowded() || std::this_thread::get_id() == caller);
      ++hits[i];
    });
  for (const int h : hits) EXPECT_EQ(h, hits[0]);
  EXPECT_GT(hits[0], 0);
}

/// Takes all helpers and keeps them until it is let go.
class Kidnapper : public SharedWork {
 public:
  void join(unsigned) noexcept override {
    while (!over) std::this_thread::sleep_for(100us);
  }
  std::atomic<bool> over{false};
};

TEST_F(Crowding, HelpersThatNeverComeChangeNothing) {
  const std::vector<double> rows = generate("sphere", 12000, 4), ball = generate("ball", 3000, 5);
  const PointView views[] = {PointView::row_major(rows.data(), 12000, 4),
                             PointView::row_major(ball.data(), 3000, 5)};
  for (const PointView& points : views) {
    Options options = options_of(1);
    const std::uint64_t alone = canonical_hash(convex_hull(points, options));
    const auto kidnapper = std::make_shared<Kidnapper>();
    {
      const OpenWork open(8, kidnapper);
      std::this_thread::sleep_for(2ms);
      for (const unsigned threads : {2U, 3U, 8U}) {
        options.threads = threads;
        const Hull hull = convex_hull(points, options);
        EXPECT_EQ(canonical_hash(hull), alone) << threads;
      }
    }
    kidnapper->over = true;
    forget_crowding();
    options.threads = 2;
    const Hull hull = convex_hull(points, options);
    EXPECT_EQ(canonical_hash(hull), alone);
    EXPECT_TRUE(certify(points, hull).valid);
  }
}

}  // namespace cullhull::internal::crowding_test
