// On a CUDA device: HullTracker's frames are the static hulls bit for bit, wherever the points lie.
// Skipped, with the reason, where there is no device.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "cullhull/cullhull.hpp"
#include "tests/agreement/canonical_hash.hpp"
#include "tests/gpu/device.hpp"
#include "tests/made_sets.hpp"
#include "tests/rates.hpp"
#include "tests/thrown.hpp"

namespace cullhull {
namespace tracker_gpu_test {

using testing::OnDevice;
using testing_support::canonical_hash;
using testing_support::error_of;
using testing_support::moving_frames;
using Rows = std::vector<double>;

class GpuTracker : public ::testing::Test {
 protected:
  void SetUp() override { CULLHULL_NEEDS_DEVICE(); }
};

Options with(CullMethod method, Backend backend) {
  Options options;
  options.cull = method;
  options.backend = backend;
  return options;
}

template <class T>
void expect_static_hulls(const std::vector<Rows>& frames, unsigned d, const std::string& what) {
  std::vector<Hull> statics;
  for (const Rows& frame : frames) {
    const std::vector<T> rows(frame.begin(), frame.end());
    statics.push_back(convex_hull(PointView::row_major(rows.data(), rows.size() / d, d),
                                  with(CullMethod::none, Backend::cpu)));
  }
  for (const CullMethod method :
       {CullMethod::automatic, CullMethod::gauge, CullMethod::pseudo_hull, CullMethod::none})
    for (const Backend backend : {Backend::automatic, Backend::cpu, Backend::cuda}) {
      HullTracker there(with(method, backend)), here(with(method, backend)),
          by_turns(with(method, backend));
      for (std::size_t f = 0; f < frames.size(); ++f) {
        SCOPED_TRACE(what + ", frame " + std::to_string(f) + ", method " +
                     std::to_string(static_cast<int>(method)) + ", backend " +
                     std::to_string(static_cast<int>(backend)));
        const std::vector<T> rows(frames[f].begin(), frames[f].end());
        const std::size_t n = rows.size() / d;
        const OnDevice copy(rows);
        const auto host = PointView::row_major(rows.data(), n, d);
        const auto device = DevicePointView::row_major(copy.data<T>(), n, d);
        const Hull& expected = statics[f];
        EXPECT_EQ(canonical_hash(there.update(device)), canonical_hash(expected));
        EXPECT_EQ(there.hull().scalar, expected.scalar);
        EXPECT_EQ(canonical_hash(here.update(host)), canonical_hash(expected));
        EXPECT_EQ(canonical_hash(f % 2 == 0 ? by_turns.update(device) : by_turns.update(host)),
                  canonical_hash(expected));
        EXPECT_EQ(there.report().vertices_came, by_turns.report().vertices_came);
        EXPECT_EQ(there.report().facets_went, by_turns.report().facets_went);
      }
    }
}

TEST_F(GpuTracker, FramesAreTheStaticHulls) {
  const std::size_t n = testing::short_run() ? 16000 : 30000;
  const unsigned frames = testing::short_run() ? 6 : 10;
  expect_static_hulls<float>(moving_frames("bumpy", "twist", n, 3, frames), 3, "twist");
  expect_static_hulls<double>(moving_frames("bumpy", "fracture", n, 3, frames), 3, "fracture");
  if (testing::short_run()) return;
  expect_static_hulls<double>(moving_frames("ball", "teleport", 20000, 2, 10), 2, "teleport 2D");
  expect_static_hulls<float>(moving_frames("ball", "explode", 2000, 4, 10), 4, "explode 4D");
}

TEST_F(GpuTracker, LedFramesAreCulledOnTheDevice) {
  HullTracker there(with(CullMethod::gauge, Backend::cuda));
  HullTracker here(with(CullMethod::gauge, Backend::cuda));
  HullTracker cpu(with(CullMethod::gauge, Backend::cpu));
  for (const Rows& rows : moving_frames("bumpy", "spin", 50000, 3, 3)) {
    const OnDevice copy(rows);
    const auto host = PointView::row_major(rows.data(), 50000, 3);
    EXPECT_EQ(
        there.update(DevicePointView::row_major(copy.data<double>(), 50000, 3)).statistics.backend,
        Backend::cuda);
    EXPECT_EQ(here.update(host).statistics.backend, Backend::cuda);
    EXPECT_EQ(cpu.update(host).statistics.backend, Backend::cpu);
  }
  EXPECT_STREQ(there.report().method, "gauge");
  EXPECT_STREQ(here.report().method, "gauge");
  EXPECT_EQ(there.report().scan_survivors, here.report().scan_survivors);  // of one map
  EXPECT_EQ(there.report().survivors, here.report().survivors);
}

TEST_F(GpuTracker, FramesKeepTheSurface) {
  HullTracker tracker(with(CullMethod::automatic, Backend::cuda));
  unsigned kept = 0;
  for (const Rows& rows : moving_frames("bumpy", "spin", 20000, 3, 4)) {
    const OnDevice copy(rows);
    const Hull& hull = tracker.update(DevicePointView::row_major(copy.data<double>(), 20000, 3));
    EXPECT_EQ(canonical_hash(hull),
              canonical_hash(convex_hull(PointView::row_major(rows.data(), 20000, 3))));
    kept += testing_support::has(hull.statistics.cull_reason,
                                 "the last frame's pseudo-hull, which flips made convex");
  }
  EXPECT_EQ(kept, 3U);
  EXPECT_EQ(tracker.report().scan_survivors, tracker.report().survivors);
  EXPECT_STREQ(tracker.report().method, "pseudo-hull");
}

// A planner to which the link is slow leaves the points where they are, for led frames too.
TEST_F(GpuTracker, AutomaticStaysOnTheDevice) {
  Options options = with(CullMethod::gauge, Backend::automatic);
  const testing_support::WithRates slow_link({.link = 1});
  HullTracker tracker(options);
  for (const Rows& rows : moving_frames("bumpy", "spin", 30000, 3, 3)) {
    const OnDevice copy(rows);
    const Hull& hull = tracker.update(DevicePointView::row_major(copy.data<double>(), 30000, 3));
    EXPECT_EQ(canonical_hash(hull),
              canonical_hash(convex_hull(PointView::row_major(rows.data(), 30000, 3))));
    EXPECT_EQ(hull.statistics.backend, Backend::cuda);
  }
  EXPECT_STREQ(tracker.report().method, "gauge");
}

TEST_F(GpuTracker, FlatFramesAndOtherCounts) {
  std::vector<Rows> frames(6, generate("gauss", 20000, 3, 3));
  for (std::size_t i = 0; i < frames[1].size(); i += 3) frames[1][i] = frames[2][i] = -0.0;
  frames[4].resize(3 * 9000);
  frames[5].resize(3);
  frames.push_back(frames[0]);
  expect_static_hulls<double>(frames, 3, "flat");
}

TEST_F(GpuTracker, TheFirstBadPointOfAllIsNamed) {
  const std::vector<Rows> frames = moving_frames("bumpy", "twist", 20000, 3, 3);
  for (const CullMethod method :
       {CullMethod::automatic, CullMethod::gauge, CullMethod::pseudo_hull, CullMethod::none})
    for (const bool leader : {false, true}) {
      HullTracker tracker(with(method, Backend::cuda));
      const OnDevice first(frames[0]), last(frames[2]);
      tracker.update(DevicePointView::row_major(first.data<double>(), 20000, 3));
      Rows rows = frames[1];
      rows[3 * 123 + 1] = NAN;
      if (leader) rows[3 * tracker.hull().vertices.back()] = INFINITY;
      const std::uint64_t bad = leader
                                    ? std::min<std::uint64_t>(123, tracker.hull().vertices.back())
                                    : std::uint64_t{123};
      const OnDevice copy(rows);
      const std::string said = error_of(ErrorCode::not_finite, [&] {
        tracker.update(DevicePointView::row_major(copy.data<double>(), 20000, 3));
      });
      EXPECT_EQ(said.find("frame 1: point " + std::to_string(bad) + ","), 0U) << said;
      EXPECT_EQ(
          canonical_hash(tracker.update(DevicePointView::row_major(last.data<double>(), 20000, 3))),
          canonical_hash(convex_hull(PointView::row_major(frames[2].data(), 20000, 3))));
    }
}

TEST_F(GpuTracker, HostMemoryIsNoDeviceMemory) {
  const Rows rows(300, 0.0);
  HullTracker tracker;
  error_of(ErrorCode::invalid_argument,
           [&] { tracker.update(DevicePointView::row_major(rows.data(), 100, 3)); });
}

}  // namespace tracker_gpu_test
}  // namespace cullhull
