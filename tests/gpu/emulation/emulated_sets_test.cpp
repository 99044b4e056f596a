// Random batches on the emulated device: sizes, kinds of sets, layouts, streams, threads, what
// fails and when. Each ends with the CPU's batch, bit for bit, or with an error that the failure
// explains. CULLHULL_RANDOM_RUNS is how many; a failing one names its seed.
#include <cuda_runtime_api.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <utility>
#include <vector>

#include "emulation.hpp"
#include "random_work.hpp"
#include "tests/gpu/same_batch.hpp"
#include "tests/rates.hpp"
#include "tests/thrown.hpp"

namespace cullhull::testing {
namespace emulated_sets_test {

class RandomBatch : public RandomWork<RandomBatch> {
 public:
  using RandomWork::RandomWork;

 private:
  friend RandomWork;

  template <class T>
  Sets<T> sets() {
    Sets<T> s(one_in(8) ? 1 + 3 * static_cast<unsigned>(below(2))
                        : 2 + static_cast<unsigned>(below(2)));
    const std::uint64_t count = one_in(8) ? below(3) : below(90);
    for (std::uint64_t i = 0; i < count; ++i) {
      const std::size_t n = one_in(100) ? below(1500) : one_in(6) ? below(200) : below(70);
      if (one_in(8)) {
        s.add_lattice(n, 2 + static_cast<unsigned>(below(5)), random_());
        continue;
      }
      s.add_ball(n, random_());
      if (one_in(10)) s.stretch_last(n, static_cast<unsigned>(below(s.d)), 0);
      if (one_in(10)) s.stretch_last(n, 0, 0x1p-30);
      if (one_in(10)) s.flatten_last(n, one_in(2) ? 0x1p-25 : 0x1p-45);
      if (one_in(10)) s.repeat_last_points(below(n + 1));
    }
    return s;
  }

  Options options() {
    Options o;
    const Backend backends[] = {Backend::automatic, Backend::cuda, Backend::cuda, Backend::cpu};
    o.backend = backends[below(4)];
    o.threads = 1 + static_cast<unsigned>(below(3));
    if (one_in(3)) o.memory_budget = std::uint64_t{1} << (18 + below(6));
    return o;
  }

  void choose_failures() {
    RandomWork::choose_failures(16, 3);
    const emulation::Settings& s = emulation::settings();
    fails_ = s.failing_allocation != 0 || s.failing_allocations_from != 0;
  }

  template <class T>
  void run_as() {
    SCOPED_TRACE("seed " + std::to_string(seed_));
    const Sets<T> s = sets<T>();
    const unsigned d = s.d;
    Options o = options();
    emulation::settings().devices = 2;
    const int holder = static_cast<int>(below(2));
    check(cudaSetDevice(holder));
    {
      const Laid<T> laid(*this, s.rows, d);
      const OnDevice offsets_there(s.offsets);
      const std::size_t n = laid.n;
      const std::uint64_t* offsets =
          one_in(2) ? s.offsets.data() : offsets_there.data<std::uint64_t>();
      std::string problem;
      HullBatch expected;
      try {  // with little memory a set may be too large for the CPU, too
        Options plain = o;
        plain.backend = Backend::cpu;
        expected = convex_hulls(PointView::row_major(s.rows.data(), n, d), s.offsets, plain);
      } catch (const Error& e) {
        problem = e.what();
      }
      emulation::restart(seed_ + 1);
      choose_failures();
      emulation::settings().devices = 2;
      if (laid.which != 0 && n > 0) check(cudaSetDevice(static_cast<int>(below(2))));
      const bool to_host = one_in(2);
      try {
        if (to_host) {
          expect_same(convex_hulls(laid.view, offsets, s.count(), o), expected);
        } else {
          DeviceBatchOptions wanted;
          wanted.planes = one_in(2);
          wanted.measures = one_in(2);
          wanted.padded = one_in(2);
          const DeviceHullBatch batch =
              convex_hulls_on_device(laid.view, offsets, s.count(), o, wanted);
          emulation::settings() = {};
          emulation::settings().devices = 2;
          expect_same_lists(batch, expected);
        }
        EXPECT_EQ(problem, "");
      } catch (const Error& e) {
        if (e.what() != problem) {
          EXPECT_TRUE(fails_) << e.what();
          EXPECT_EQ(e.code(), ErrorCode::out_of_budget) << e.what();
          EXPECT_TRUE(!to_host || o.backend == Backend::cuda) << e.what();
        }
      }
      emulation::settings() = {};
      emulation::settings().devices = 2;
      check(cudaSetDevice(holder));
    }
  }

  bool fails_ = false;
};

TEST(EmulatedSets, EndWithTheBatchOrAnErrorThatExplains) {
  testing_support::for_random_seeds(200, [](std::uint64_t seed) { RandomBatch(seed).run(); });
  EXPECT_EQ(emulation::counters().live_bytes, 0U) << "memory of a device was not freed";
}

// Questions about points on a device: every allocation fails once, and from some on all do.
TEST(EmulatedQuestions, WhateverAllocationFails) {
  emulation::settings() = {};
  emulation::restart();
  Sets<double> sets(3);
  sets.add_ball(100, 1);
  sets.add_ball(3000, 2);
  const auto base = PointView::row_major(sets.rows.data(), 100, 3);
  const HullQuery query(base, convex_hull(base));
  const auto here = PointView::row_major(sets.rows.data(), 3100, 3);
  std::vector<Side> sides(3100);
  std::vector<double> distances(3100);
  std::vector<std::uint64_t> vertices(3100);
  query.sides(here, sides.data());
  query.signed_distances(here, distances.data());
  query.supports(here, vertices.data());
  for (const Backend backend : {Backend::automatic, Backend::cuda})
    for (const bool all : {false, true})
      for (long n = 0; n < 14; ++n) {
        SCOPED_TRACE(std::to_string(n) + (all ? " and all later ones" : ""));
        const OnDevice copy(sets.rows);
        const auto there = DevicePointView::row_major(copy.data<double>(), 3100, 3);
        Options options;
        options.backend = backend;
        Options by_cells = options;
        by_cells.backend = Backend::cuda;  // and where memory is short the error says so
        const internal::Rates stay_there{.link = 1}, use_cells{.link = 1e15, .device_copy = 10};
        const auto ask = [&](auto&& question, bool must = false, bool cells = false) {
          const testing_support::WithRates rates(cells ? use_cells : stay_there);
          emulation::restart();
          (all ? emulation::settings().failing_allocations_from
               : emulation::settings().failing_allocation) = n;
          try {
            question();
          } catch (const Error& e) {
            EXPECT_EQ(e.code(), ErrorCode::out_of_budget);
            EXPECT_TRUE(backend == Backend::cuda || must);
          }
          emulation::settings() = {};
        };
        ask([&] {
          std::vector<Side> found(3100);
          query.sides(there, found.data(), options);
          EXPECT_EQ(found, sides);
          if (n == 0) {
            EXPECT_EQ(emulation::counters().launches["ask_hull<SideByFacets, D, T>"], 1U);
          }
        });
        ask(
            [&] {
          std::vector<Side> found(3100);
          query.sides(there, found.data(), by_cells);
          EXPECT_EQ(found, sides);
          if (n == 0) {
            EXPECT_EQ(emulation::counters().launches["ask_hull<SideByCells, D, T>"], 1U);
          }
            },
            true, true);
        for (const bool cells : {false, true}) {
          const Options& way = cells ? by_cells : options;
          const OnDevice found(std::vector<Side>(3100));
          ask(
              [&] {
            query.sides_on_device(there, found.data<Side>(), way);
            EXPECT_EQ(fetched(found.data<Side>(), 3100), sides);
              },
              way.backend == Backend::cuda, cells);
        }
        ask([&] {
          std::vector<double> found(3100);
          query.signed_distances(there, found.data(), options);
          expect_same_bits(found, distances, "distances");
        });
        ask([&] {
          std::vector<std::uint64_t> found(3100);
          query.supports(there, found.data(), options);
          expect_same_bits(found, vertices, "supports");
        });
      }
}

// By testing all facets for each point, by cells of directions, or, with Backend::automatic, on the
// CPU.
TEST(EmulatedQuestions, AreAskedWhereThatIsEstimatedToBeSooner) {
  emulation::settings() = {};
  Sets<double> sets(3);
  sets.add_sphere(300, 1);
  sets.add_ball(3000, 2);
  const auto base = PointView::row_major(sets.rows.data(), 300, 3);
  const HullQuery query(base, convex_hull(base));
  const OnDevice copy(sets.rows);
  const auto there = DevicePointView::row_major(copy.data<double>(), 3300, 3);
  std::vector<Side> sides(3300), found(3300);
  query.sides(PointView::row_major(sets.rows.data(), 3300, 3), sides.data());
  const auto launches = [&](double link, double device, Backend backend) {
    Options options;
    options.backend = backend;
    options.threads = 1;
    const testing_support::WithRates rates({.link = link, .device_copy = device});
    emulation::restart();
    query.sides(there, found.data(), options);
    EXPECT_EQ(found, sides);
    auto launched = emulation::counters().launches;
    return std::pair(launched["ask_hull<SideByFacets, D, T>"],
                     launched["ask_hull<SideByCells, D, T>"]);
  };
  using Launches = decltype(launches(0, 0, Backend::cuda));
  EXPECT_EQ(launches(1, 1e15, Backend::automatic), (Launches{1, 0}));
  EXPECT_EQ(launches(1e15, 1e9, Backend::automatic), (Launches{0, 0})) << "596 facets";
  EXPECT_EQ(launches(1e15, 1e11, Backend::cuda), (Launches{1, 0})) << "cells take 4 ms to build";
  EXPECT_EQ(launches(1e15, 1e8, Backend::cuda), (Launches{0, 1}));
  EXPECT_EQ(launches(1e15, 1e11, Backend::cuda), (Launches{0, 1})) << "they are built";
}

// The kernels for the next piece are launched before the CPU begins with one, its lists are packed
// when the CPU has done half.
TEST(EmulatedSets, TheNextPieceIsFoundWhileTheCpuCompletesOne) {
  emulation::settings() = {};
  emulation::restart();
  check(cudaSetDevice(0));
  Sets<float> sets(2);
  for (std::size_t i = 0; i < 750; ++i) sets.add_ball(20, i);
  const OnDevice there(sets.rows);
  const auto view = DevicePointView::row_major(there.data<float>(), 15000, 2);
  const HullBatch expected =
      convex_hulls(PointView::row_major(sets.rows.data(), 15000, 2), sets.offsets);
  emulation::restart();
  using Launches = std::pair<std::uint64_t, std::uint64_t>;
  std::vector<Launches> launches;  // whenever the CPU begins with half a piece, and at the end
  Options options;
  options.backend = Backend::cuda;
  options.memory_budget = std::uint64_t{1} << 19;  // pieces of 5,461 points
  options.progress = [&](const char*, double) {
    auto launched = emulation::counters().launches;
    launches.emplace_back(launched["set_hulls<D, T, Near>"], launched["pack_lists<D, T, Id>"]);
  };
  expect_same(convex_hulls(view, sets.offsets.data(), sets.count(), options), expected);
  EXPECT_EQ(launches,
            (std::vector<Launches>{{2, 1}, {2, 2}, {3, 2}, {3, 3}, {3, 3}, {3, 3}, {3, 3}}));
}

// A result outlives the stream of its call, and its last copy frees it.
TEST(EmulatedSets, AResultIsFreedBehindAllWork) {
  emulation::settings() = {};
  emulation::restart();
  check(cudaSetDevice(0));
  Sets<float> sets(3);
  for (std::size_t i = 0; i < 40; ++i) sets.add_ball(30, i);
  {
    const OnDevice there(sets.rows);
    const std::size_t before = emulation::counters().live_bytes;
    DeviceHullBatch copy;
    {
      const Stream stream;
      const auto view = DevicePointView::row_major(there.data<float>(), 1200, 3, stream);
      const DeviceHullBatch batch = convex_hulls_on_device(view, sets.offsets.data(), 40);
      EXPECT_EQ(batch.device, 0);
      copy = batch;
    }
    EXPECT_GT(emulation::counters().live_bytes, before);
    std::vector<std::int32_t> ids(copy.vertex_count);
    const Stream reader;
    check(cudaMemcpyAsync(ids.data(), copy.vertices, ids.size() * sizeof(std::int32_t),
                          cudaMemcpyDeviceToHost, reader));
    copy = {};  // waits for the reader
    EXPECT_EQ(ids[0], 0);
    check(cudaDeviceSynchronize());
    EXPECT_EQ(emulation::counters().live_bytes, before);
  }
}

// It breaks the device for the process, so it is the last test here.
TEST(EmulatedSetsLast, AFailedLaunchIsAnError) {
  emulation::settings() = {};
  emulation::restart();
  Sets<float> sets(2);
  for (std::size_t i = 0; i < 40; ++i) sets.add_ball(30, i);
  const OnDevice there(sets.rows);
  emulation::restart();
  emulation::settings().failing_launch = 1;
  const auto view = DevicePointView::row_major(there.data<float>(), 1200, 2);
  for (int call = 0; call < 2; ++call)
    testing_support::error_of(ErrorCode::backend_unavailable,
                              [&] { convex_hulls(view, sets.offsets.data(), 40); });
}

}  // namespace emulated_sets_test
}  // namespace cullhull::testing
