// The tracker's text for points it cannot read in place: a frame that, as one on a device, hands
// out only the rows asked for, as they are, leads to the static hull bit for bit.
#include "tracker/frame_points.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "call_options.hpp"
#include "canonical_hash.hpp"
#include "cullhull/cullhull.hpp"
#include "flow/pipeline.hpp"
#include "geometry/gather.hpp"
#include "parallel/sort_few.hpp"
#include "parallel/threads/run.hpp"
#include "thrown.hpp"
#include "tracker/simplex_memory.hpp"

namespace cullhull::internal::frame_points_test {

using namespace testing_support;
using Rows = std::vector<double>;

/// Counts the rows that leave it.
class FarFrame final : public FramePoints {
 public:
  FarFrame(const PointView& points, const Run& run)
      : FramePoints(points.count, points.dimension), points_(points), run_(run) {}
  const PointView* on_host() const override { return nullptr; }
  Array<double> gather(const std::vector<std::uint64_t>& ids) override {
    fetched += ids.size();
    return HostFrame(points_, run_).gather(ids);
  }
  std::uint32_t most_nodes() override { return 12288; }
  void scan(const GaugeMap& map, Survivors& result) override {
    const auto ids = map.survivors(points_, run_);
    result.ids.assign(ids.begin(), ids.end());
    result.all = false;
    result.backend = Backend::cuda;
  }
  void fetch(Filtered& result) override {
    const auto& ids = result.survivors.ids;
    fetched += result.pass_survivors = ids.size();
    result.rows.resize(ids.size() * dimension);
    for (std::size_t i = 0; i < ids.size(); ++i)
      load_row(points_, ids[i], result.rows.data() + i * dimension);
    check_rows_finite(result.rows.data(), ids.size(), dimension, ids.data(), run_);
  }
  Filtered filter_afresh() override { return HostFrame(points_, run_).filter_afresh(); }
  Hull hull(Filtered&& filtered) override {
    DevicePointView shape;
    shape.scalar = points_.scalar;
    shape.dimension = dimension;
    shape.count = count;
    return hull_of_rows(std::move(filtered), shape, run_.options);
  }

  std::uint64_t fetched = 0;

 private:
  const PointView points_;
  const Run& run_;
};

/// Each frame led by the one before; how many of them had a map.
template <class T>
int expect_led_frames(const std::vector<std::vector<T>>& frames, unsigned d) {
  const Options options;
  const internal::Run run(options);
  Hull last;
  int led = 0;
  for (const std::vector<T>& rows : frames) {
    const auto points = PointView::row_major(rows.data(), rows.size() / d, d);
    Hull expected = convex_hull(points, options_of(0, CullMethod::none));
    if (last.dimension != 0) {
      FarFrame far(points, run);
      Filtered filtered;
      double seconds = 0;
      if (filter_by_leaders(far, last, sorted(last.vertices), run, filtered, seconds)) {
        ++led;
        EXPECT_LT(far.fetched, points.count / 2);
        const std::uint64_t left = filtered.survivors.ids.size();
        const Hull hull = far.hull(std::move(filtered));
        EXPECT_EQ(canonical_hash(hull), canonical_hash(expected));
        EXPECT_EQ(hull.scalar, expected.scalar);
        EXPECT_EQ(hull.statistics.survivors, left);
        EXPECT_EQ(hull.statistics.backend, Backend::cuda);
        EXPECT_EQ(hull.statistics.filter, UsedFilter::gauge);
      }
    }
    last = std::move(expected);
  }
  return led;
}

template <class T>
std::vector<std::vector<T>> moving(const char* shape, std::uint64_t n, unsigned d) {
  const MovingPoints points(shape, "twist", n, d, 4, 7);
  std::vector<std::vector<T>> all;
  Rows rows(n * d);
  for (std::uint64_t f = 0; f < 4; ++f) {
    points.frame(f, rows.data());
    for (double& x : rows)
      if (x > -0.01 && x < 0.01) x = -0.0;  // rows come as they are, zeros with their signs
    all.emplace_back(rows.begin(), rows.end());
  }
  return all;
}

TEST(FramePoints, RowsAloneLeadToTheStaticHull) {
  EXPECT_EQ(expect_led_frames(moving<double>("bumpy", 20000, 3), 3), 3);
  EXPECT_EQ(expect_led_frames(moving<float>("bumpy", 20000, 3), 3), 3);
  EXPECT_EQ(expect_led_frames(moving<double>("ball", 20000, 2), 2), 3);
  EXPECT_EQ(expect_led_frames(moving<float>("ball", 20000, 4), 4), 3);
}

TEST(FramePoints, WhatIsNotFiniteIsNamedByItsId) {
  auto frames = moving<double>("bumpy", 20000, 3);
  const Options options;
  const internal::Run run(options);
  const Hull last = convex_hull(PointView::row_major(frames[0].data(), 20000, 3));
  frames[1][3 * 4321 + 1] = std::numeric_limits<double>::quiet_NaN();
  frames[1][3 * 15000] = std::numeric_limits<double>::infinity();
  FarFrame far(PointView::row_major(frames[1].data(), 20000, 3), run);
  Filtered filtered;
  double seconds = 0;
  const std::string message = error_of(ErrorCode::not_finite, [&] {
    filter_by_leaders(far, last, sorted(last.vertices), run, filtered, seconds);
  });
  EXPECT_TRUE(message.starts_with("point 4321, coordinate 1 is NaN")) << message;
}

}  // namespace cullhull::internal::frame_points_test
