#include "filter/planner.hpp"

#include <gtest/gtest.h>

#include "filter/ways.hpp"

namespace cullhull::internal::planner_test {

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
      for (const std::uint64_t v : {std::uint64_t{0}, m / 2, m})
        for (const bool leaders : {false, true}) {
          if (leaders && d == 2) continue;
          const std::uint64_t size = map_sample_size(n, d, m, v, leaders);
          EXPECT_GE(size, m);
          EXPECT_LE(size, n);
          EXPECT_LE(size, leaders ? 1000000U : 50000U);
        }
    }
  }
}

// More points deserve a larger sample, but fewer per point.
TEST(Planner, SamplesGrowSlowerThanPoints) {
  for (unsigned d = 2; d <= 4; ++d) {
    const std::uint64_t small = map_sample_size(1000000, d, 1000, 150, false);
    const std::uint64_t large = map_sample_size(2000000, d, 1000, 150, false);
    EXPECT_GT(large, small) << d;
    EXPECT_LT(large, 2 * small) << d;
  }
}

// Once the map's own sample is hulled only the pass and the laying of the map are left to pay.
TEST(Planner, MapsAreWeighedAgain) {
  for (unsigned d = 2; d <= 6; ++d) {
    EXPECT_FALSE(map_pays(1000000, d, 1000, 1000)) << d;  // all would be kept
    EXPECT_FALSE(map_pays(smallest_worth_culling(d), d, 1000, 100)) << d;
    EXPECT_TRUE(map_pays(100 * smallest_worth_culling(d), d, 1000, 100)) << d;
  }
}

PlaceQuestion hundred_million(bool on_device, unsigned threads) {
  PlaceQuestion q;
  q.count = 100000000;
  q.dimension = 3;
  q.point_bytes = 12;
  q.threads = threads;
  q.on_device = on_device;
  return q;
}

// 64 cores read faster than any link; one core does not; points on a device stay there; on a device
// with a slow link and a small memory bus they still do.
TEST(Planner, PointsAreCulledWhereThatIsSooner) {
  Rates large;
  large.host_read = 300e9;
  large.host_copy = 100e9;
  large.link = 50e9;
  large.device_copy = 4e12;
  Rates small;  // the defaults
  struct Case {
    const char* what;
    const Rates* rates;
    bool on_device;
    unsigned threads;
    bool started;
    bool expected;
  };
  const Case cases[] = {
      {"many cores", &large, false, 64, false, false},
      {"many cores, driver started", &large, false, 64, true, false},
      {"one core, driver to be started", &large, false, 1, false, true},
      {"one core of a small machine, driver started", &small, false, 1, true, true},
      {"on the device", &large, true, 64, true, true},
      {"on a small device", &small, true, 2, true, true},
  };
  for (const Case& c : cases) {
    PlaceQuestion q = hundred_million(c.on_device, c.threads);
    q.device_started = c.started;
    const Placement p = choose_place(q, *c.rates);
    EXPECT_EQ(p.device, c.expected) << c.what << ": " << p.reason;
    EXPECT_NE(p.reason.find(c.on_device ? "on the device" : "on the host"), std::string::npos);
  }
}

// Starting the driver is only worth it for long passes; many threads read sooner than a link.
TEST(Planner, PlacesDependOnCountsAndThreads) {
  Rates m;
  PlaceQuestion q = hundred_million(false, 1);
  m.link = m.host_copy = 50e9;
  EXPECT_TRUE(choose_place(q, m).device);
  q.count = 10000000;
  EXPECT_FALSE(choose_place(q, m).device);
  q.device_started = true;
  EXPECT_TRUE(choose_place(q, m).device);
  q.threads = 64;
  m.host_read = 300e9;
  EXPECT_FALSE(choose_place(q, m).device);
}

// The rates of an H200 and 16 cores beside it (docs/gpu.md): 240 MB are packed in 13.6 ms, while
// the link needs 4.4.
TEST(Planner, PointsOfTheHostArePackedAndUploaded) {
  const Rates measured{
      .host_read = 100e9, .host_copy = 17.6e9, .link = 54.7e9, .device_copy = 4.2e12};
  PlaceQuestion q;
  q.count = 20000000;
  q.dimension = 3;
  q.point_bytes = 12;
  q.device_started = true;
  q.pinned_bytes = 16 << 20;
  EXPECT_NE(choose_place(q, measured).reason.find(", 13.9 ms on a CUDA device"), std::string::npos)
      << choose_place(q, measured).reason;
}

// A first call for half a million points of the host pays for the pinned memory that they cross.
TEST(Planner, PinnedMemoryHasItsPrice) {
  Rates m;
  m.host_read = 15e9;
  m.link = m.host_copy = 50e9;
  PlaceQuestion q;
  q.count = 500000;
  q.dimension = 3;
  q.point_bytes = 24;
  q.device_started = true;
  EXPECT_FALSE(choose_place(q, m).device);
  q.pinned_bytes = 128 << 20;
  EXPECT_TRUE(choose_place(q, m).device);
}

// A device tests every facet for every point, the CPU a few.
TEST(Planner, QuestionsAreAnsweredWhereThatIsSooner) {
  Rates fast;
  fast.device_copy = 4.1e12;
  fast.link = 50e9;
  const auto way =
      [&](Question question, std::uint64_t count, std::uint64_t tests, unsigned threads = 1) {
    return choose_answerer({question, count, 3, 24, threads, tests}, fast);
  };
  EXPECT_EQ(way(Question::sides, 1'000'000, 300), Answerer::device);
  EXPECT_EQ(way(Question::sides, 1'000'000, 400'000), Answerer::cpu) << "458 ms there, 60 here";
  EXPECT_EQ(way(Question::sides, 100, 300), Answerer::cpu) << "a launch takes longer";
  EXPECT_EQ(way(Question::supports, 1'000'000, 1000), Answerer::device);
  EXPECT_EQ(way(Question::supports, 1'000'000, 1'000'000), Answerer::cpu);
  EXPECT_EQ(way(Question::distances, 1'000'000, 400'000), Answerer::device) << "22 us each";
  EXPECT_EQ(way(Question::sides, 1'000'000, 40'000, 16), Answerer::cpu) << "sixteen threads";
  EXPECT_EQ(way(Question::sides, 1'000'000, 0), Answerer::cpu) << "nothing that the device can";
}

// The cells cost the CPU's time once; then a point costs the device the same for any hull.
TEST(Planner, CellsAreBuiltForManyPoints) {
  Rates fast;
  fast.device_copy = 4.1e12;
  fast.link = 50e9;
  AskedPoints asked;
  asked.dimension = 3;
  asked.point_bytes = 12;
  asked.threads = 16;
  asked.tests = 10'000;
  asked.cells = 80'000;
  const auto way = [&](std::uint64_t count, bool built) {
    asked.count = count;
    asked.cells_built = built;
    return choose_answerer(asked, fast);
  };
  EXPECT_EQ(way(1'000, false), Answerer::cpu);
  EXPECT_EQ(way(1'000, true), Answerer::cpu);
  EXPECT_EQ(way(100'000, true), Answerer::device_by_cells);
  EXPECT_EQ(way(100'000, false), Answerer::cpu) << "by climbing, without cells";
  EXPECT_EQ(way(73'000, true), Answerer::cpu);
  asked.answers_stay = true;
  EXPECT_EQ(way(73'000, true), Answerer::device_by_cells) << "the CPU's answers are copied there";
  asked.answers_stay = false;
  EXPECT_EQ(way(10'000'000, false), Answerer::device_by_cells);
  asked.cpu_allowed = false;
  EXPECT_EQ(way(1'000, false), Answerer::device) << "cells take longer to build";
  EXPECT_EQ(way(100'000, true), Answerer::device_by_cells);
  asked.threads = 1;
  EXPECT_EQ(way(1'000'000, false), Answerer::device) << "11 ms there, 72 to build";
  asked.asked_before = 9'000'000;
  EXPECT_EQ(way(1'000'000, false), Answerer::device_by_cells) << "the tenth such call";
  asked.asked_before = 0;
  asked.threads = 16;
  asked.tests = 0;
  EXPECT_EQ(way(1'000, false), Answerer::device_by_cells) << "the only one that is left";
  asked.tests = 4;
  asked.cells = 2048;
  EXPECT_EQ(way(1'000'000, false), Answerer::device) << "four facets are a list of a cell";
}

TEST(Planner, FindingsAreSaid) {
  EXPECT_EQ(sample_finding(1000, 132), "132 of 1000 sampled points are extreme");
}

TEST(Planner, WaysTakeWhatTheirRowsSay) {
  for (const WayRow& r : ways) {
    const std::uint32_t d = r.least_dimension;
    WayQuestion q{.dimension = d};
    if (r.way == Way::pseudo_hull) q.cull = CullMethod::pseudo_hull;
    if (r.way == Way::gauge) q.cull = CullMethod::gauge;
    const auto of = [&](std::uint64_t count) {
      q.count = count;
      return refusal(r.way, q);
    };
    EXPECT_EQ(of(r.least), Refusal::none) << r.name;
    EXPECT_EQ(of(r.least - 1), Refusal::too_few) << r.name;
    EXPECT_EQ(of(r.most), Refusal::none) << r.name;
    EXPECT_EQ(why_not(r.way, q), "") << r.name;
    if (r.most != any_number) {
      EXPECT_EQ(of(r.most + 1), Refusal::too_many) << r.name;
    }
    q.left = true;
    EXPECT_EQ(of(r.most_left + 1), r.most_left < r.least ? Refusal::too_few : Refusal::too_many)
        << r.name;
    q.left = false;
    q.count = r.least;
    q.budget = 1;
    EXPECT_EQ(refusal(r.way, q), r.bytes > 0 ? Refusal::budget : Refusal::none) << r.name;
    q.dimension = r.least_dimension - 1;
    EXPECT_EQ(refusal(r.way, q), Refusal::dimension) << r.name;
    q.dimension = d;
    q.cull = CullMethod::none;
    EXPECT_EQ(refusal(r.way, q) == Refusal::options,
              r.unchosen || r.way == Way::pseudo_hull || r.way == Way::gauge)
        << r.name;
    ways_off = 1U << static_cast<unsigned>(r.way);
    EXPECT_EQ(refusal(r.way, q), Refusal::off) << r.name;
    ways_off = 0;
  }
  for (std::uint32_t d = 2; d <= 8; ++d) {
    EXPECT_EQ(row_of(few_way(d)).least_dimension, d);
    EXPECT_EQ(row_of(few_way(d)).most_dimension, d);
    EXPECT_TRUE(permits_few({.dimension = d, .count = 1 << 30}));
    EXPECT_FALSE(permits_few({.dimension = d, .backend = Backend::cuda}));
  }
  EXPECT_FALSE(permits_few({.dimension = 1}));
  EXPECT_FALSE(permits_few({.dimension = 9}));
  EXPECT_FALSE(takes_few({.dimension = 9, .count = 12}));
  EXPECT_EQ(why_no_filter({.dimension = 9, .count = 50, .cull = CullMethod::pseudo_hull}),
            "the pseudo-hull is for 2D to 8D");
  EXPECT_EQ(why_no_filter({.dimension = 7, .count = 50}), "the gauge map is for 2D to 6D");
}

TEST(Planner, FewPointsAreNotShared) {
  for (const std::uint64_t few : {0U, 10U, 1000U, 65535U}) {
    EXPECT_EQ(useful_threads(8, few, 2), 1U);
    EXPECT_EQ(useful_cull_threads(8, 2 * few, 2), 1U);
  }
  EXPECT_EQ(useful_threads(8, 1 << 20, 2), 8U);
  for (const unsigned d : {1U, 2U, 3U, 4U, 6U, 9U}) {
    EXPECT_EQ(useful_threads(8, 100'000'000, d), 8U);
    EXPECT_EQ(useful_threads(1, 100'000'000, d), 1U);
    EXPECT_EQ(useful_cull_threads(8, 100'000'000, d), 8U);
  }
}

}  // namespace cullhull::internal::planner_test
