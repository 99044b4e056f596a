// A hull grown batch by batch against the hull of all points at once.
#include "cullhull/growing_hull.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <limits>
#include <stop_token>
#include <thread>

#include "agreement/canonical_hash.hpp"
#include "agreement/point_sets.hpp"
#include "call_options.hpp"
#include "cullhull/batch.hpp"
#include "cullhull/error.hpp"
#include "thrown.hpp"

namespace cullhull::growing_hull_test {

using namespace testing_support;

PointView part_of(const PointSet& s, std::uint64_t begin, std::uint64_t end) {
  return PointView::row_major(s.coordinates.data() + begin * s.dimension, end - begin, s.dimension);
}

TEST(GrowingHull, equals_the_hull_of_all_points_after_every_batch) {
  std::vector<PointSet> sets;
  for (unsigned d = 1; d <= 5; ++d) {
    sets.push_back(random_set("gauss", 150, d, d));
    sets.push_back(random_grid(150, d, 3, 0.1, d));
    sets.push_back(full_grid(d, d < 4 ? 5 : 3, 0));
  }
  sets.push_back(flat(80, 2, 4, 5, 1));
  sets.push_back(all_magnitudes(60, 3, 1));
  sets.push_back(cylinder(200, 3));
  unsigned unchanged = 0;
  for (const PointSet& set : sets) {
    const std::uint64_t n = set.coordinates.size() / set.dimension;
    Random r(n);
    GrowingHull grown(set.dimension);
    std::uint64_t done = 0;
    while (done < n) {
      const std::uint64_t next =
          std::min(n, done + static_cast<std::uint64_t>(r.integer(0, done < 5 ? 2 : 30)));
      const std::uint64_t before = grown.hull().vertices.size();
      const std::uint64_t outside = grown.add(part_of(set, done, next));
      if (outside == 0 && next > done) {
        ++unchanged;
        EXPECT_EQ(grown.hull().vertices.size(), before);
      }
      done = next;
      if (done == 0) continue;
      ASSERT_EQ(canonical_hash(grown.hull()), canonical_hash(convex_hull(part_of(set, 0, done))))
          << set.name << ", " << done << " points";
    }
  }
  EXPECT_GT(unchanged, 5U);
}

TEST(GrowingHull, a_refused_batch_changes_nothing) {
  const PointSet set = random_set("ball", 100, 3, 1);
  GrowingHull grown(3);
  grown.add(part_of(set, 0, 100));
  const std::uint64_t before = canonical_hash(grown.hull());
  PointSet bad = random_set("sphere", 20, 3, 2);
  bad.coordinates[3 * 7 + 2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(
      has(error_of(ErrorCode::not_finite, [&] { grown.add(part_of(bad, 0, 20)); }), "point 7"));
  EXPECT_EQ(canonical_hash(grown.hull()), before);
  const double flat_point[] = {1, 2};
  EXPECT_THROW(grown.add(PointView::row_major(flat_point, 1, 2)), Error);
  EXPECT_EQ(grown.add(part_of(bad, 8, 20)), 12U);  // usable afterwards
}

TEST(GrowingHull, goes_on_from_a_hull) {
  for (const PointSet& set : {random_set("ball", 200, 3, 3), random_grid(200, 2, 4, 0.1, 5),
                              flat(120, 2, 4, 5, 2), random_set("sphere", 80, 5, 4)}) {
    const std::uint64_t half = set.count() / 2;
    GrowingHull first(set.dimension);
    first.add(part_of(set, 0, half));
    GrowingHull next(first.hull(), first.vertex_coordinates());
    EXPECT_EQ(canonical_hash(next.hull()), canonical_hash(first.hull()));
    next.add(part_of(set, half, set.count()));
    EXPECT_EQ(canonical_hash(next.hull()),
              canonical_hash(convex_hull(part_of(set, 0, set.count()))));
    EXPECT_EQ(first.hull().point_count, half);
    std::vector<double> short_by_one = first.vertex_coordinates();
    short_by_one.pop_back();
    EXPECT_THROW(GrowingHull(first.hull(), short_by_one), Error);
  }
  GrowingHull from_nothing(GrowingHull(2).hull(), {});
  EXPECT_EQ(from_nothing.hull().affine_dimension, -1);
  EXPECT_THROW(GrowingHull(Hull{}, {}), Error);  // of no dimension
}

TEST(Poll, is_called_on_the_calling_thread_and_may_stop_the_call) {
  const PointSet set = random_set("sphere", 20'000, 3, 1);
  for (const unsigned threads : {1U, 2U}) {
    Options options = options_of(threads);
    std::atomic<unsigned> calls{0}, elsewhere{0};
    const std::thread::id here = std::this_thread::get_id();
    options.poll = [&] {
      ++calls;
      if (std::this_thread::get_id() != here) ++elsewhere;
    };
    const std::uint64_t hash = canonical_hash(convex_hull(part_of(set, 0, set.count()), options));
    EXPECT_EQ(hash, canonical_hash(convex_hull(part_of(set, 0, set.count()))));
    EXPECT_GT(calls, 10U);
    const std::vector<std::uint64_t> offsets{0, 5'000, 20'000};
    convex_hulls(part_of(set, 0, set.count()), offsets, options);
    EXPECT_EQ(elsewhere, 0U);

    std::stop_source stop;
    options.stop = stop.get_token();
    options.poll = [&] { stop.request_stop(); };
    error_of(ErrorCode::cancelled, [&] { convex_hull(part_of(set, 0, set.count()), options); });
  }
}

TEST(GrowingHull, knows_what_its_points_are) {
  const float single[] = {0, 0, 1, 0, 0, 1};
  const double wide[] = {0.25, 0.25, 3, 3};
  GrowingHull grown(2);
  EXPECT_EQ(grown.hull().point_count, 0U);
  EXPECT_EQ(grown.add(PointView::row_major(single, 3, 2)), 3U);
  EXPECT_EQ(grown.hull().scalar, ScalarType::f32);
  EXPECT_EQ(grown.add(PointView::row_major(wide, 1, 2)), 0U);
  EXPECT_EQ(grown.hull().scalar, ScalarType::f64);
  EXPECT_EQ(grown.add(PointView::row_major(wide, 2, 2)), 1U);
  EXPECT_EQ(grown.hull().vertices, (std::vector<std::uint64_t>{0, 1, 5, 2}));
  EXPECT_EQ(grown.hull().point_count, 6U);
}

}  // namespace cullhull::growing_hull_test
