// HullTracker: every frame is the static hull, bit for bit, whatever moves how.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <limits>

#include "call_options.hpp"
#include "canonical_hash.hpp"
#include "cullhull/cullhull.hpp"
#include "cullhull/io.hpp"
#include "flow/pipeline.hpp"
#include "parallel/threads/run.hpp"
#include "tests/counted_memory.hpp"
#include "tests/made_sets.hpp"
#include "tests/rates.hpp"
#include "thrown.hpp"

namespace cullhull::tracker_test {

using namespace testing_support;
using Rows = std::vector<double>;

constexpr CullMethod methods[] = {CullMethod::automatic, CullMethod::gauge, CullMethod::pseudo_hull,
                                  CullMethod::none};

std::uint64_t static_hash(const PointView& points) {
  return canonical_hash(convex_hull(points, options_of(1, CullMethod::none)));
}

/// Trackers of every method over the same frames; each must give the static hull.
class Trackers {
 public:
  Trackers() {
    for (const CullMethod method : methods)
      for (const unsigned threads : {1U, 2U}) {
        trackers_.emplace_back(options_of(threads, method));
      }
  }
  void expect_frame(const PointView& points, const std::string& what) {
    const std::uint64_t expected = static_hash(points);
    for (std::size_t t = 0; t < trackers_.size(); ++t) {
      EXPECT_EQ(canonical_hash(trackers_[t].update(points)), expected)
          << what << ", tracker " << t << ": " << trackers_[t].report().method;
      expect_vertices_among_survivors(trackers_[t], points.count);
    }
  }
  static void expect_vertices_among_survivors(const HullTracker& tracker, std::uint64_t count) {
    const Survivors& left = tracker.survivors();
    EXPECT_EQ(left.size(count), tracker.report().survivors);
    for (const std::uint64_t v : tracker.hull().vertices)
      EXPECT_TRUE(left.all || std::binary_search(left.ids.begin(), left.ids.end(), v)) << v;
  }
  HullTracker& operator[](std::size_t t) { return trackers_[t]; }
  std::size_t size() const { return trackers_.size(); }

 private:
  std::vector<HullTracker> trackers_;
};

template <class T>
PointView rows_of(const std::vector<T>& rows, unsigned d) {
  return PointView::row_major(rows.data(), rows.size() / d, d);
}

void expect_sequence(const std::string& name, unsigned d, const std::vector<Rows>& frames) {
  SCOPED_TRACE(name);
  Trackers trackers;
  for (std::size_t f = 0; f < frames.size(); ++f)
    trackers.expect_frame(rows_of(frames[f], d), name + ", frame " + std::to_string(f));
}

Rows mapped(const Rows& rows, unsigned d, const std::function<void(std::uint64_t, double*)>& map) {
  Rows out = rows;
  for (std::uint64_t i = 0; i < rows.size() / d; ++i) map(i, &out[i * d]);
  return out;
}

TEST(HullTracker, EveryMotionOfABumpySurface) {
  for (const Shape& motion : motions())
    expect_sequence(motion.name, 3, moving_frames("bumpy", motion.name, 15000, 3, 5));
}

TEST(HullTracker, EveryDimension) {
  constexpr std::uint64_t counts[] = {0, 0, 20000, 9000, 1000, 200, 60, 30, 20};
  for (unsigned d = 2; d <= 8; ++d)
    for (const char* motion : {"twist", "explode", "teleport"})
      expect_sequence(motion + std::to_string(d), d,
                      moving_frames("ball", motion, counts[d], d, 4));
}

TEST(HullTracker, CollapseAndBack) {
  for (const unsigned d : {2U, 3U, 4U}) {
    const Rows rest = generate("gauss", d == 4 ? 800 : 9000, d, 3);
    std::vector<Rows> frames{rest};
    for (unsigned kept = d; kept-- > 0;) {  // to a hyperplane, ..., a line, a point
      frames.push_back(mapped(rest, d, [&](std::uint64_t, double* x) {
        for (unsigned j = kept; j < d; ++j) x[j] = 2;
      }));
      frames.push_back(rest);
    }
    frames.push_back(frames[1]);  // from flat to flat, and a slanted one
    frames.push_back(mapped(rest, d, [&](std::uint64_t, double* x) { x[d - 1] = x[0]; }));
    frames.push_back(rest);
    expect_sequence("collapse " + std::to_string(d), d, frames);
  }
}

TEST(HullTracker, BodiesThroughOneAnotherAndPointsThatLeave) {
  const Rows rest = generate("bumpy", 16000, 3, 5);
  std::vector<Rows> passing, leaving;
  for (int f = 0; f <= 6; ++f) {
    passing.push_back(mapped(
        rest, 3, [&](std::uint64_t i, double* x) { x[0] += (i % 2 == 0 ? 1 : -1) * (f - 3.0); }));
    leaving.push_back(mapped(rest, 3, [&](std::uint64_t i, double* x) {
      if (i % 97 == 0)
        for (int j = 0; j < 3; ++j) x[j] *= 1 + 0.5 * std::abs(f % 4 - 2);
    }));
  }
  expect_sequence("passing", 3, passing);
  expect_sequence("leaving", 3, leaving);
}

TEST(HullTracker, LatticesAndDuplicates) {
  std::vector<Rows> frames;
  const Rows grid = generate("grid:12", 12000, 3, 2);
  for (int f = 0; f < 5; ++f)
    frames.push_back(mapped(grid, 3, [&](std::uint64_t i, double* x) {
      x[0] += f;
      if (f >= 2) x[1] = std::floor(x[1] / f);
      if (f == 3 && i > 100) x[2] = grid[2];
    }));
  expect_sequence("grid", 3, frames);
}

TEST(HullTracker, HugeAndTinyMagnitudes) {
  const Rows rest = generate("ball", 9000, 3, 4);
  std::vector<Rows> frames{rest};
  for (const double factor : {1e300, 1e-300, 0x1p-1060, 1.0})
    frames.push_back(mapped(rest, 3, [&](std::uint64_t i, double* x) {
      for (int j = 0; j < 3; ++j) x[j] *= j == 1 || i % 5 == 0 ? factor : 1;
    }));
  expect_sequence("magnitudes", 3, frames);
}

TEST(HullTracker, ScalarsAndLayouts) {
  Trackers trackers;
  for (int f = 0; f < 3; ++f) {
    const Rows rows = mapped(generate("gauss", 9000, 3, 8), 3, [&](std::uint64_t, double* x) {
      for (int j = 0; j < 3; ++j) x[j] = std::floor(x[j] * (10 + f));
    });
    const std::vector<float> f32(rows.begin(), rows.end());
    const std::vector<std::int16_t> i16(rows.begin(), rows.end());
    trackers.expect_frame(rows_of(f32, 3), "f32");
    trackers.expect_frame(rows_of(i16, 3), "i16");
    const std::vector<double> columns = transposed(rows, 3);
    trackers.expect_frame(PointView::column_major(columns.data(), 9000, 3), "columns");
    std::vector<std::byte> records(9000 * 15 + 1);
    for (std::size_t i = 0; i < 9000; ++i) std::memcpy(&records[1 + 15 * i], &f32[3 * i], 12);
    trackers.expect_frame({records.data() + 1, ScalarType::f32, 3, 9000, 15, 4}, "records");
  }
}

TEST(HullTracker, AnotherCountOrDimensionStartsAfresh) {
  Trackers trackers;
  for (const auto& [n, d] : std::vector<std::pair<std::uint64_t, unsigned>>{
           {10000, 3}, {10000, 3}, {9000, 3}, {9000, 2}, {3, 3}, {0, 3}, {1, 3}, {9000, 3}}) {
    const Rows rows = generate("ball", n, d, n + d);
    trackers.expect_frame(rows_of(rows, d), std::to_string(n) + " x " + std::to_string(d));
  }
  for (std::size_t t = 0; t < trackers.size(); ++t)
    EXPECT_STREQ(trackers[t].report().method, "static");
}

TEST(HullTracker, ANanInFrame7IsNamedAndFrame8Follows) {
  const std::vector<Rows> frames = moving_frames("bumpy", "twist", 12000, 3, 10);
  Trackers trackers;
  for (std::size_t f = 0; f < frames.size(); ++f) {
    if (f != 7) {
      trackers.expect_frame(rows_of(frames[f], 3), "frame " + std::to_string(f));
      continue;
    }
    for (std::size_t t = 0; t < trackers.size(); ++t) {
      Rows bad = frames[f];
      const std::uint64_t vertex = trackers[t].hull().vertices.back();
      bad[3 * 4321 + 1] = std::numeric_limits<double>::quiet_NaN();
      if (vertex > 4321) bad[3 * vertex] = std::numeric_limits<double>::infinity();
      const std::string message =
          error_of(ErrorCode::not_finite, [&] { trackers[t].update(rows_of(bad, 3)); });
      EXPECT_TRUE(message.starts_with("frame 7: point 4321, coordinate 1 is NaN")) << message;
    }
  }
  EXPECT_EQ(trackers[0].report().index, 9U);
}

TEST(HullTracker, ReportsWhatCameAndWent) {
  Options options = options_of(0, CullMethod::gauge);
  for (const CullMethod method : {CullMethod::gauge, CullMethod::pseudo_hull}) {
    options.cull = method;
    HullTracker tracker(options);
    Rows rows = generate("gauss", 20000, 3, 1);
    const Hull first = tracker.update(rows_of(rows, 3));
    EXPECT_EQ(tracker.report().vertices_came, first.vertices.size());
    EXPECT_EQ(tracker.report().facets_came, first.facet_count());
    EXPECT_STREQ(tracker.report().method, "static");

    for (double& x : rows) x *= 0.5;  // the same hull, halved
    tracker.update(rows_of(rows, 3));
    const FrameReport still = tracker.report();
    EXPECT_STREQ(still.method, method == CullMethod::gauge ? "gauge" : "pseudo-hull");
    EXPECT_EQ(still.vertices_came + still.vertices_went, 0U);
    EXPECT_EQ(still.facets_came + still.facets_went, 0U);
    EXPECT_GE(still.scan_survivors, still.survivors);
    EXPECT_GE(still.survivors, first.vertices.size());
    EXPECT_LT(still.survivors, 20000U / 10);

    // One vertex leaves for the middle: it goes, no other does unless it is seen now.
    const std::uint64_t gone = first.vertices[first.vertices.size() / 2];
    for (int j = 0; j < 3; ++j) rows[3 * gone + static_cast<std::uint64_t>(j)] = 0;
    const Hull& last = tracker.update(rows_of(rows, 3));
    EXPECT_EQ(tracker.report().vertices_went, 1U);
    EXPECT_EQ(last.vertices.size(), first.vertices.size() - 1 + tracker.report().vertices_came);
    EXPECT_GT(tracker.report().facets_went, 2U);
    EXPECT_LT(tracker.report().facets_went, first.facet_count() / 4);
  }
}

TEST(HullTracker, ReportsOfFramesWhoseChangesNobodyAskedFor) {
  const std::vector<Rows> frames = moving_frames("bumpy", "twist", 3000, 3, 4);
  HullTracker asked, silent;
  for (std::size_t f = 0; f < 3; ++f) {
    const Hull& hull = asked.update(rows_of(frames[f], 3));
    EXPECT_EQ(canonical_hash(silent.update(rows_of(frames[f], 3))), canonical_hash(hull));
    EXPECT_GT(asked.report().facets_came, 0U);
  }
  Rows bad = frames[3];
  bad[7] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(silent.update(rows_of(bad, 3)), Error);  // what came in frame 2 is still known
  for (int again = 0; again < 2; ++again) {
    EXPECT_EQ(silent.report().index, 2U);
    EXPECT_EQ(silent.report().vertices_came, asked.report().vertices_came);
    EXPECT_EQ(silent.report().vertices_went, asked.report().vertices_went);
    EXPECT_EQ(silent.report().facets_came, asked.report().facets_came);
    EXPECT_EQ(silent.report().facets_went, asked.report().facets_went);
  }
  asked.update(rows_of(frames[3], 3));
  silent.update(rows_of(frames[3], 3));
  EXPECT_EQ(silent.report().facets_came, asked.report().facets_came);
  silent.reset();
  const Hull& fresh = silent.update(rows_of(frames[0], 3));
  EXPECT_EQ(silent.report().facets_came, fresh.facet_count());
}

TEST(HullTracker, AFrameWithoutLeadersIsOneStaticCall) {
  const Options options = options_of(1);
  for (const auto& [kind, n] : {std::pair{"sphere", 20000}, {"sphere", 1000}, {"gauss", 20000}}) {
    SCOPED_TRACE(std::string(kind) + ", " + std::to_string(n));
    const std::vector<Rows> frames =
        moving_frames(kind, "spin", static_cast<std::uint64_t>(n), 3, 6);
    HullTracker tracker(options);
    Hull fixed;
    std::int64_t tracked_bytes = 0, static_bytes = 0;
    for (const Rows& rows : frames) {
      const std::int64_t before = allocated_bytes;
      fixed = convex_hull(rows_of(rows, 3), options);
      const std::int64_t between = allocated_bytes;
      tracker.update(rows_of(rows, 3));
      static_bytes = between - before;
      tracked_bytes = allocated_bytes - between;
      // Where the last frame's triangles hold, no way finds the hull.
      EXPECT_TRUE(fixed.statistics.cull_reason.starts_with(tracker.hull().statistics.cull_reason));
    }
    EXPECT_LE(tracked_bytes, static_bytes + static_bytes / 50 + 2048);  // no copies of hulls
  }
}

TEST(HullTracker, LeadersAreUsedWhereAMapOfTheOutermostPointsLeavesMuch) {
  struct Case {
    const char *kind, *motion;
    bool led;
  };
  for (const auto& [kind, motion, led] :
       {Case{"bumpy", "twist", true}, {"bumpy", "teleport", false}, {"ball", "twist", false}}) {
    SCOPED_TRACE(std::string(kind) + ", " + motion);
    HullTracker tracker;
    int frames_led = 0;
    for (const Rows& rows : moving_frames(kind, motion, 40000, 3, 6)) {
      EXPECT_EQ(canonical_hash(tracker.update(rows_of(rows, 3))), static_hash(rows_of(rows, 3)));
      frames_led += std::string_view(tracker.report().method) == "gauge" ? 1 : 0;
    }
    if (led)
      EXPECT_EQ(frames_led, 5);
    else
      EXPECT_LE(frames_led, 2);  // a try each time that the pause is over
  }
}

Rows turned(const Rows& rows, double angle) {
  const double c = std::cos(angle), s = std::sin(angle);
  return mapped(rows, 3, [&](std::uint64_t, double* x) {
    const double first = c * x[0] - s * x[1], second = s * x[0] + c * x[1];
    x[0] = first;
    x[1] = c * second - s * x[2];
    x[2] = s * second + c * x[2];
  });
}

/// Expects the hull of `rows`, with the triangles of `last` tried; `holds`: whether they held.
void expect_by_known(const Rows& rows, const Hull& last, bool& holds) {
  const Options options;
  const internal::Run run(options);
  const internal::NearbyNumbers numbers(last);
  for (const auto* near : {&numbers, static_cast<const internal::NearbyNumbers*>(nullptr)}) {
    internal::Filtered all;
    all.survivors.all = true;
    internal::KnownHull known{.hull = &last, .numbers = near};
    const Hull hull = internal::hull_of_survivors(rows_of(rows, 3), std::move(all), run, &known);
    EXPECT_TRUE(known.tried);
    holds = known.holds;
    EXPECT_EQ(canonical_hash(hull), static_hash(rows_of(rows, 3)));
  }
}

/// Two cones over a ring of points, which goes round `times`.
Rows double_cone(int ring, int times) {
  Rows rows = {0, 0, 1, 0, 0, -1};
  for (int i = 0; i < ring; ++i) {
    const double t = 2 * std::acos(-1.0) * i * times / ring;
    rows.insert(rows.end(), {std::cos(t), std::sin(t), 0.01 * std::sin(5 * t)});
  }
  return rows;
}

TEST(HullTracker, TheLastHullsTrianglesHoldWhereTheHullIsTurned) {
  for (const std::uint64_t n : {20, 3000, 20000}) {
    const Rows rows = generate("sphere", n, 3, 5);
    const Hull last = convex_hull(rows_of(rows, 3));
    bool holds = false;
    expect_by_known(turned(rows, 0.3), last, holds);
    EXPECT_TRUE(holds) << n;
    const Rows mirrored = mapped(rows, 3, [](std::uint64_t, double* x) { x[0] = -x[0]; });
    expect_by_known(mirrored, last, holds);
    EXPECT_FALSE(holds) << n;
    expect_by_known(generate("sphere", n, 3, 6), last, holds);
    EXPECT_FALSE(holds) << n;
  }
}

TEST(HullTracker, TrianglesThatWindTwiceAreNotAHull) {
  // Every ridge is convex, and every triangle is seen from within from beneath.
  for (const int ring : {15, 6001}) {
    const Rows once = double_cone(ring, 1);
    const Hull last = convex_hull(rows_of(once, 3));
    ASSERT_EQ(last.vertices.size(), static_cast<std::size_t>(ring) + 2);
    bool holds = true;
    expect_by_known(turned(once, 0.1), last, holds);
    EXPECT_TRUE(holds) << ring;
    expect_by_known(double_cone(ring, 2), last, holds);
    EXPECT_FALSE(holds) << ring;
  }
}

TEST(HullTracker, TrianglesThatChangedAreMended) {
  for (const std::uint64_t n : {1500, 3000, 20000}) {
    const Rows sphere = generate("sphere", n, 3, 5), noise = generate("ball", n, 3, 6);
    const double step = 0.02 / static_cast<double>(n), inner = 1 - 8 / static_cast<double>(n);
    const auto frame = [&](unsigned inside, unsigned doubled) {
      Rows rows = mapped(sphere, 3, [&](std::uint64_t i, double* x) {
        for (unsigned j = 0; j < 3; ++j)
          x[j] = i % 40 == inside ? inner * x[j] : x[j] + step * noise[3 * i + j];
      });
      for (std::uint64_t i = doubled; i + 1 < n; i += 120)
        std::copy_n(&rows[3 * i + 3], 3, &rows[3 * i]);
      return rows;
    };
    const Hull last = convex_hull(rows_of(frame(3, 3), 3));
    // Some are new, some gone; of the new ones some are equal to another point.
    const Rows changed = frame(5, 3), other = generate("sphere", n, 3, 7);
    for (const unsigned threads : {1U, 2U, 3U, 16U, 64U}) {
      const Options options = options_of(threads, CullMethod::none);
      const internal::Run run(options);
      const auto by_known = [&](const Rows& rows) {
        internal::Filtered all;
        all.survivors.all = true;
        internal::KnownHull known{.hull = &last};
        const Hull hull =
            internal::hull_of_survivors(rows_of(rows, 3), std::move(all), run, &known);
        EXPECT_EQ(canonical_hash(hull), static_hash(rows_of(rows, 3))) << n << ' ' << threads;
        return known.mended;
      };
      EXPECT_TRUE(by_known(changed)) << n << ' ' << threads;
      EXPECT_FALSE(by_known(other)) << n << ' ' << threads;
    }
  }
}

TEST(HullTracker, FramesByTheLastHullsTriangles) {
  const Rows sphere = generate("sphere", 6000, 3, 8), lattice = generate("grid:30", 6000, 3, 8);
  std::vector<Rows> frames;
  for (int f = 0; f < 6; ++f) frames.push_back(turned(sphere, 0.1 * f));
  frames.push_back(generate("sphere", 6000, 3, 9));
  for (int f = 0; f < 8; ++f) frames.push_back(turned(sphere, 0.1 * f));
  frames.push_back(double_cone(5998, 1));
  frames.push_back(double_cone(5998, 1));
  frames.push_back(double_cone(5998, 3));
  frames.push_back(lattice);
  frames.push_back(lattice);
  frames.push_back(turned(lattice, 0.1));
  expect_sequence("triangles", 3, frames);
}

TEST(HullTracker, SteadyFramesKeepNoMoreMemory) {
  const std::vector<Rows> frames = moving_frames("bumpy", "spin", 20000, 3, 4);
  for (const CullMethod method : methods) {
    HullTracker tracker(options_of(1, method));
    std::int64_t after_warm_up = 0;
    for (int f = 0; f < 60; ++f) {
      tracker.update(rows_of(frames[static_cast<std::size_t>(f) % 4], 3));
      if (f == 19) after_warm_up = live_bytes;
    }
    EXPECT_LE(live_bytes, after_warm_up + 64 * 1024) << static_cast<int>(method);
  }
}

TEST(HullTracker, StopsAndGoesOn) {
  std::stop_source stop;
  Options options;
  options.stop = stop.get_token();
  HullTracker tracker(options);
  const Rows rows = generate("ball", 20000, 3, 1);
  const std::uint64_t expected = canonical_hash(tracker.update(rows_of(rows, 3)));
  stop.request_stop();
  EXPECT_THROW(tracker.update(rows_of(rows, 3)), Error);
  EXPECT_EQ(canonical_hash(tracker.hull()), expected);  // the last one is still whole
}

std::string refusal(const std::function<void()>& update) {
  return error_of(ErrorCode::backend_unavailable, update);
}

TEST(HullTracker, ADeviceThatIsAskedForAndNotThere) {
  const std::string reason = cuda_status().reason;
  if (reason.empty()) GTEST_SKIP() << "there is a CUDA device";
  const Rows rows = generate("ball", 20000, 3, 1);
  for (const CullMethod method : methods)
    for (const Backend backend : {Backend::automatic, Backend::cpu, Backend::cuda}) {
      Options options = options_of(0, method);
      options.backend = backend;
      HullTracker tracker(options);
      if (backend == Backend::cuda) {
        EXPECT_EQ(refusal([&] { tracker.update(rows_of(rows, 3)); }), "frame 0: " + reason);
      } else {
        EXPECT_EQ(canonical_hash(tracker.update(rows_of(rows, 3))), static_hash(rows_of(rows, 3)));
        EXPECT_EQ(tracker.hull().statistics.backend, Backend::cpu);
      }
      // Points in a device's memory need a device whatever the options say.
      const auto device = DevicePointView::row_major(rows.data(), 20000, 3);
      EXPECT_EQ(refusal([&] { tracker.update(device); }), "frame 1: " + reason);
      if (backend == Backend::cuda) continue;
      tracker.update(rows_of(rows, 3));  // the last hull is still known
      EXPECT_EQ(tracker.report().vertices_came, 0U);
      EXPECT_EQ(tracker.report().index, 2U);
    }
}

TEST(HullTracker, DeviceViewsAreChecked) {
  const float value = 0;
  DevicePointView integers = DevicePointView::row_major(&value, 1, 1);
  integers.scalar = ScalarType::i32;
  for (const DevicePointView& view :
       {DevicePointView::row_major(&value, 1, 0),
        DevicePointView::row_major(static_cast<const float*>(nullptr), 1, 3), integers}) {
    HullTracker tracker;
    error_of(ErrorCode::invalid_argument, [&] { tracker.update(view); });
  }
}

// A planner that believes in a miracle of a link is asked for led frames too. Without a device the
// CPU takes over and the reason says so.
TEST(HullTracker, AutomaticFallsBack) {
  const std::vector<Rows> frames = moving_frames("bumpy", "twist", 40000, 3, 3);
  const testing_support::WithRates miracle({.host_read = 1, .host_copy = 1e15, .link = 1e15});
  const Options lured = options_of(0, CullMethod::gauge);
  Options modest = lured;
  modest.backend = Backend::cpu;
  HullTracker tracker(lured), on_cpu(modest);
  const CudaStatus status = cuda_status();
  for (const Rows& rows : frames) {
    const Hull& hull = tracker.update(rows_of(rows, 3));
    EXPECT_EQ(canonical_hash(hull), static_hash(rows_of(rows, 3)));
    const std::string& reason = hull.statistics.cull_reason;
    EXPECT_EQ(hull.statistics.backend, status.available ? Backend::cuda : Backend::cpu);
    EXPECT_EQ(reason.find(", but " + status.reason) != std::string::npos, !status.available)
        << reason;
    on_cpu.update(rows_of(rows, 3));
    EXPECT_TRUE(has(on_cpu.hull().statistics.cull_reason, "CPU as asked"));
  }
  EXPECT_STREQ(tracker.report().method, "gauge");
  EXPECT_STREQ(on_cpu.report().method, "gauge");
}

TEST(HullTracker, ThePseudoHullStaysOnTheCpuAndSaysSo) {
  HullTracker tracker(options_of(0, CullMethod::pseudo_hull));
  for (const Rows& rows : moving_frames("bumpy", "spin", 9000, 3, 3)) {
    const Hull& hull = tracker.update(rows_of(rows, 3));
    EXPECT_EQ(hull.statistics.backend, Backend::cpu);
    EXPECT_TRUE(has(hull.statistics.cull_reason, "the pseudo-hull runs on the CPU"));
  }
}

TEST(HullTracker, AutoLeadsOnlyWhereFewPointsAreExtreme) {
  // A map of many leaders takes longer than a static run's: one point in 90 is extreme here. Of
  // points in a ball's inside hardly any is.
  constexpr std::size_t n = 140000;
  for (const bool many : {true, false}) {
    std::vector<double> rows;
    for (std::size_t i = 0; i < n; ++i) {
      const double turn = 2.399963229728653 * static_cast<double>(i),
                   z = 2 * (static_cast<double>(i) + 0.5) / n - 1, r = std::sqrt(1 - z * z);
      const double far = i % (many ? 90 : 2000) == 0 ? 1 : 0.5;
      rows.insert(rows.end(), {far * r * std::cos(turn), far * r * std::sin(turn), far * z});
    }
    HullTracker tracker;
    for (int frame = 0; frame < 2; ++frame) tracker.update(PointView::row_major(rows.data(), n, 3));
    EXPECT_STREQ(tracker.report().method, many ? "static" : "gauge");
  }
}

}  // namespace cullhull::tracker_test
