// Random calls on the emulated device: sizes, layouts, methods, streams, threads, what fails and
// when. Each ends with the CPU's hull, bit for bit, or with an error that the failure explains.
// CULLHULL_RANDOM_RUNS is how many; a failing one names its seed.
#include <cuda_runtime_api.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <initializer_list>
#include <optional>
#include <string>
#include <vector>

#include "cullhull/device_hull.hpp"
#include "cullhull/track.hpp"
#include "device_sets.hpp"
#include "emulation.hpp"
#include "gpu/same_batch.hpp"
#include "random_work.hpp"
#include "tests/rates.hpp"

namespace cullhull::testing {
namespace emulated_calls_test {

using testing_support::canonical_hash;

class RandomCall : public RandomWork<RandomCall> {
 public:
  using RandomWork::RandomWork;

 private:
  friend RandomWork;

  template <class T>
  std::vector<T> points(unsigned d) {
    const std::size_t n = one_in(4) ? below(12) : one_in(4) ? 5000 + below(20000) : below(3000);
    std::vector<T> rows = ball<T>(d, n, random_());
    if (one_in(4))  // a lattice: many equal and coplanar points
      for (T& v : rows) v = static_cast<T>(static_cast<int>(v * 4));
    if (one_in(6))  // a flat
      for (std::size_t i = 0; i < n; ++i) rows[i * d + d - 1] = T(0.5);
    if (one_in(6))
      for (T& v : rows) v = v * T(0x1p-100);
    return rows;
  }

  Options options() {
    Options o;
    const CullMethod methods[] = {CullMethod::automatic, CullMethod::gauge, CullMethod::pseudo_hull,
                                  CullMethod::none};
    o.cull = methods[below(4)];
    o.backend = one_in(3) ? Backend::automatic : Backend::cuda;
    o.threads = 1 + static_cast<unsigned>(below(3));
    rates_.reset();
    if (one_in(2)) rates_.emplace(internal::Rates{.link = 1});
    return o;
  }

  void choose_failures() {
    RandomWork::choose_failures(12, 4);
    emulation::Settings& s = emulation::settings();
    s.devices = 1 + static_cast<int>(below(2));
    fails_ =
        s.failing_allocation != 0 || s.failing_allocations_from != 0 || s.failing_pinned_from != 0;
    no_way_here_ = s.failing_allocations_from != 0 && s.failing_pinned_from != 0;
  }

  template <class T>
  void run_as() {
    const unsigned d = 2 + static_cast<unsigned>(below(4));
    const std::vector<T> rows = points<T>(d);
    std::vector<T> moved = rows;
    const T share = T(1) / static_cast<T>(below(400) + 1);
    if (!one_in(4))  // else a second frame like the first
      for (T& v : moved) v += v * share * static_cast<T>(below(1000)) / 1000;
    const std::uint64_t expected = plain_hash(rows, d), expected_moved = plain_hash(moved, d);
    const Options o = options();
    const int holder = static_cast<int>(below(2));
    emulation::settings().devices = 2;
    check(cudaSetDevice(holder));
    const Laid<T> laid(*this, rows, d), later(*this, moved, d);
    emulation::restart(seed_ + 1);
    choose_failures();
    emulation::settings().devices = 2;
    const bool may_fail = o.backend == Backend::cuda || no_way_here_;
    if (laid.which != 0 && later.which != 0) check(cudaSetDevice(static_cast<int>(below(2))));
    const auto host = PointView::row_major(rows.data(), laid.n, d);
    if (one_in(4))
      outcome(expected, true,
              [&] { return fetched_hull(convex_hull_on_device(laid.view, o), host); });
    else if (one_in(3))
      outcome(expected_moved, may_fail, [&] { return last_hull({laid.view, later.view}, o); });
    else
      outcome(expected, may_fail,
              [&] { return below(4) == 0 ? convex_hull(host, o) : convex_hull(laid.view, o); });
    emulation::settings() = {};
    emulation::settings().devices = 2;
    check(cudaSetDevice(holder));
  }

  /// That of the last of two frames of points that move, or stay.
  static Hull last_hull(std::initializer_list<DevicePointView> frames, const Options& options) {
    HullTracker tracker(options);
    for (const DevicePointView& frame : frames) tracker.update(frame);
    return tracker.hull();
  }

  /// The CPU's hull with what a hull on the device has in place of its own.
  static Hull fetched_hull(const DeviceHull& there, const PointView& points) {
    Hull hull = convex_hull(points);
    const auto corners = hull.simplices.size();
    const auto ids = [](const auto& list) {
      return std::vector<std::uint64_t>(list.begin(), list.end());
    };
    hull.vertices = ids(fetched(there.vertices, there.vertex_count));
    std::ranges::copy(ids(fetched(there.simplices, corners)), hull.simplices.edit().begin());
    std::ranges::copy(fetched(there.neighbours, corners), hull.simplex_neighbours.begin());
    hull.volume = there.volume;
    return hull;
  }

  /// `may_fail`: where the device's memory is full; the CPU goes on elsewhere.
  template <class Call>
  void outcome(std::uint64_t expected, bool may_fail, const Call& call) const {
    const std::string what = "seed " + std::to_string(seed_);
    try {
      EXPECT_EQ(canonical_hash(call()), expected) << what;
    } catch (const Error& e) {
      EXPECT_TRUE(fails_) << what << ": " << e.what();
      EXPECT_EQ(e.code(), ErrorCode::out_of_budget) << what << ": " << e.what();
      EXPECT_TRUE(may_fail) << what << ": " << e.what();
    }
  }

  bool fails_ = false;
  /// Rows with gaps come to the host through pinned memory or, packed, through the device's own.
  bool no_way_here_ = false;
  std::optional<testing_support::WithRates> rates_;
};

TEST(EmulatedCalls, EndWithTheHullOrAnErrorThatExplains) {
  testing_support::for_random_seeds(200, [](std::uint64_t seed) { RandomCall(seed).run(); });
  EXPECT_EQ(emulation::counters().live_bytes, 0U) << "memory of a device was not freed";
}

}  // namespace emulated_calls_test
}  // namespace cullhull::testing
