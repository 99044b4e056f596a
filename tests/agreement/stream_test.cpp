// Points that come in pieces against all of them at once: the same bits, whatever the blocks, their
// order, the threads that push and the tree by which states merge. CULLHULL_RANDOM_RUNS (120 if
// unset) says how many random partitions, CULLHULL_RANDOM_SEED which.
#include "cullhull/stream.hpp"

#include <gtest/gtest.h>

#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <thread>
#include <utility>

#include "agreement/all_paths.hpp"
#include "agreement/point_sets.hpp"
#include "agreement/random_seeds.hpp"
#include "agreement/sets_in_pieces.hpp"
#include "call_options.hpp"
#include "cullhull/extreme_points.hpp"
#include "cullhull/generate.hpp"
#include "thrown.hpp"

namespace cullhull::testing_support::stream_test {

struct Block {
  std::uint64_t begin, end;
};

/// Blocks of 1 to n points, empty ones among them, in any order.
std::vector<Block> random_blocks(std::uint64_t n, Random& r) {
  std::vector<Block> blocks;
  const int style = r.integer(0, 3);
  for (std::uint64_t at = 0; at < n;) {
    const auto rest = static_cast<int>(n - at);
    int length = style == 0   ? rest
                 : style == 1 ? r.integer(1, rest)
                 : style == 2 ? r.integer(0, std::max(1, static_cast<int>(n / 20)))
                              : r.integer(1, 5000);
    if (style == 3 && n < 200) length = 1;
    length = std::min(length, rest);
    blocks.push_back({at, at + static_cast<std::uint64_t>(length)});
    at += static_cast<std::uint64_t>(length);
  }
  if (r.integer(0, 1))
    for (std::size_t i = blocks.size(); i > 1; --i)
      std::swap(blocks[i - 1],
                blocks[static_cast<std::size_t>(r.integer(0, static_cast<int>(i) - 1))]);
  return blocks;
}

Options few_threads(Random& r) { return options_of(static_cast<unsigned>(r.integer(1, 2))); }

/// All blocks by several threads, each taking the next one.
HullState pushed(const PointView& whole, const std::vector<Block>& blocks, unsigned threads,
                 const Options& options) {
  HullStream stream(options);
  std::atomic<std::size_t> next{0};
  const auto work = [&] {
    for (std::size_t i; (i = next++) < blocks.size();)
      stream.push(part_of(whole, blocks[i].begin, blocks[i].end), blocks[i].begin);
  };
  std::vector<std::thread> others;
  for (unsigned t = 1; t < threads; ++t) others.emplace_back(work);
  work();
  for (std::thread& t : others) t.join();
  return stream.state();
}

/// Blocks dealt out to several streams, some of whose states travel as bytes, merged two by two.
HullState merged(const PointView& whole, const std::vector<Block>& blocks, Random& r) {
  std::vector<std::vector<Block>> hands(static_cast<std::size_t>(r.integer(1, 6)));
  for (const Block& b : blocks)
    hands[static_cast<std::size_t>(r.integer(0, static_cast<int>(hands.size()) - 1))].push_back(b);
  std::vector<HullState> states;
  for (const auto& hand : hands) states.push_back(pushed(whole, hand, 1, few_threads(r)));
  while (states.size() > 1) {
    std::swap(states.back(),
              states[static_cast<std::size_t>(r.integer(0, static_cast<int>(states.size()) - 1))]);
    HullState one = std::move(states.back());
    states.pop_back();
    if (r.integer(0, 1)) one = HullState::from_bytes(one.to_bytes());
    HullState& other =
        states[static_cast<std::size_t>(r.integer(0, static_cast<int>(states.size()) - 1))];
    if (r.integer(0, 3) == 0) {
      HullStream stream;
      stream.push(one);
      stream.push(other);
      other = stream.state();
    } else {
      other.merge(one, few_threads(r));
    }
  }
  return states[0];
}

void expect_same(const HullState& state, const PointView& whole, const Hull& hull) {
  EXPECT_EQ(state.point_count(), whole.count);
  EXPECT_EQ(state.ids(), sorted_vertices(hull));
  if (state.dimension() == 0) return;
  const Hull found = state.hull();
  EXPECT_EQ(canonical_hash(found), canonical_hash(hull));
  EXPECT_EQ(found.scalar, hull.scalar);
  const std::size_t row = whole.dimension * scalar_size(whole.scalar);
  for (std::uint64_t i = 0; i < state.points().count; ++i)
    for (std::uint32_t j = 0; j < whole.dimension; ++j)
      ASSERT_EQ(std::memcmp(state.points().address(i, j), whole.address(state.ids()[i], j),
                            row / whole.dimension),
                0)
          << "coordinates of " << state.ids()[i];
}

/// One block of the partition alone: certified against its points.
void expect_certified_part(const PointView& whole, const Block& b) {
  const PointView part = part_of(whole, b.begin, b.end);
  HullState state(part, b.begin);
  const auto global = state.ids();
  Hull hull = state.hull();
  hull.rename([&](std::uint64_t id) { return id - b.begin; });
  const Certificate c = certify(part, hull);
  EXPECT_TRUE(c.valid) << c.reason;
}

void run_partitions(const PointView& whole, Random& r) {
  const Hull hull = convex_hull(whole, options_of(1));
  const std::vector<Block> blocks = random_blocks(whole.count, r);
  if (blocks.empty()) return;
  const auto threads = static_cast<unsigned>(r.integer(1, 8));
  SCOPED_TRACE(std::to_string(blocks.size()) + " blocks, " + std::to_string(threads) + " threads");
  const HullState direct = pushed(whole, blocks, threads, few_threads(r));
  expect_same(direct, whole, hull);
  const HullState tree = merged(whole, blocks, r);
  expect_same(tree, whole, hull);
  EXPECT_EQ(tree, direct);
  expect_certified_part(
      whole, blocks[static_cast<std::size_t>(r.integer(0, static_cast<int>(blocks.size()) - 1))]);
}

TEST(Stream, RandomPartitionsGiveTheBitsOfTheWhole) {
  for_random_seeds(120, [&](std::uint64_t seed) {
    Random r(seed);
    const PointSet s = stream_set(r);
    SCOPED_TRACE(s.name + " of " + std::to_string(s.count()) +
                 ", CULLHULL_RANDOM_SEED=" + std::to_string(seed));
    std::vector<float> singles(s.coordinates.begin(), s.coordinates.end());
    std::vector<std::int32_t> integers;
    const bool fit =
        std::all_of(singles.begin(), singles.end(), [](float v) { return std::isfinite(v); });
    if (converted(s, integers) && r.integer(0, 1))
      run_partitions(PointView::row_major(integers.data(), s.count(), s.dimension), r);
    else if (fit && r.integer(0, 1))
      run_partitions(PointView::row_major(singles.data(), s.count(), s.dimension), r);
    else if (r.integer(0, 3) == 0)
      run_partitions(PointView::column_major(transposed(s.coordinates, s.dimension).data(),
                                             s.count(), s.dimension),
                     r);
    else
      run_partitions(view_of(s), r);
  });
}

// Large enough for several maps, in blocks as files are read.
TEST(Stream, LaysMapsAndHoldsFewPoints) {
  const struct {
    const char* shape;
    unsigned n, d;
  } cases[] = {{"ball", 400000, 2}, {"ball", 400000, 3}, {"gauss", 150000, 4}, {"cube", 400000, 3}};
  for (const auto& c : cases) {
    const PointSet s = generated(c.shape, c.n, c.d, 7);
    HullStream stream;
    std::uint64_t most = 0;
    for (std::uint64_t at = 0; at < c.n; at += 20000) {
      stream.push(part_of(view_of(s), at, std::min<std::uint64_t>(at + 20000, c.n)));
      const StreamReport report = stream.report();
      EXPECT_EQ(report.point_count, std::min<std::uint64_t>(at + 20000, c.n));
      if (at > 0) most = std::max(most, report.extreme + report.waiting);
    }
    EXPECT_GT(stream.report().maps, 0U) << s.name;
    EXPECT_LT(most, c.n / 4) << s.name;
    EXPECT_EQ(canonical_hash(stream.hull()), canonical_hash(convex_hull(view_of(s)))) << s.name;
  }
}

// More threads than the machine has, too, and blocks that end up in the lists out of order.
TEST(Stream, AnyNumberOfThreadsGivesTheSameState) {
  const PointSet s = generated("ball", 300000, 3, 11);
  std::vector<Block> blocks;
  for (std::uint64_t at = 0; at < s.count(); at += 10000) blocks.push_back({at, at + 10000});
  const HullState one = pushed(view_of(s), blocks, 1, options_of(1));
  EXPECT_EQ(one.ids(), sorted_vertices(convex_hull(view_of(s))));
  std::reverse(blocks.begin(), blocks.end());
  for (const unsigned pushing : {1U, 3U, 16U})
    for (const unsigned threads : {1U, 2U, 3U, 16U, 64U})
      EXPECT_EQ(pushed(view_of(s), blocks, pushing, options_of(threads)), one)
          << pushing << " threads push, " << threads << " each";
}

// hull() computes the hull and the extreme points at once, from all points held.
TEST(Stream, TheHullIsThatOfTheState) {
  const struct {
    const char* shape;
    unsigned n, d;
    bool flat = false;
  } cases[] = {{"ball", 200000, 2},      {"ball", 300000, 3},  {"sphere", 40000, 3},
               {"ball", 50000, 3, true}, {"gauss", 100000, 4}, {"ball", 60000, 4},
               {"cube", 60000, 5},       {"sphere", 40, 7}};
  for (const auto& c : cases) {
    PointSet s = generated(c.shape, c.n, c.d, 13);
    for (std::size_t i = 0; c.flat && i < s.coordinates.size(); i += c.d) s.coordinates[i] = 3;
    const PointView half = part_of(view_of(s), 0, c.n / 2);
    SCOPED_TRACE(s.name);
    for (const unsigned threads : {1U, 2U, 3U, 16U, 64U}) {
      Options options = options_of(threads);
      options.with_coordinates = true;
      HullStream stream(options);
      for (unsigned at = 0; at < c.n / 2; at += 10000)
        stream.push(part_of(view_of(s), at, std::min(at + 10000, c.n / 2)));
      const Hull of_half = stream.hull();
      EXPECT_EQ(canonical_hash(of_half), canonical_hash(convex_hull(half, options)));
      EXPECT_EQ(stream.report().extreme, of_half.vertices.size());
      EXPECT_EQ(stream.report().waiting, 0U);
      EXPECT_EQ(canonical_hash(stream.hull()), canonical_hash(of_half));
      stream.push(part_of(view_of(s), c.n / 2, c.n));
      stream.skip(c.n, 5);
      const Hull all = stream.hull();
      EXPECT_EQ(all.point_count, c.n + 5);
      const HullState state = stream.state();
      const Hull again = state.hull(options);
      EXPECT_EQ(canonical_hash(all), canonical_hash(again));
      EXPECT_EQ(all.vertex_coordinates, again.vertex_coordinates);
      EXPECT_EQ(state.ids(), sorted_vertices(convex_hull(view_of(s))));
    }
  }
}

// Points of which leaders are found in few directions, and tiles, whose blocks lie beside the map.
TEST(Stream, ScansAndTilesInOrder) {
  PointSet ground = generated("cube", 300000, 3, 14);
  for (std::uint64_t i = 0; i < ground.count(); ++i) {
    double* const p = ground.coordinates.data() + 3 * i;
    p[2] = 0.02 * (std::sin(9 * p[0]) + std::cos(7 * p[1])) + 1e-4 * p[2];
  }
  const PointSet ball = generated("ball", 300000, 3, 15);
  for (const PointSet& s : {ground, ball}) {
    std::vector<std::array<double, 3>> rows(s.count());
    std::memcpy(rows.data(), s.coordinates.data(), s.coordinates.size() * sizeof(double));
    std::sort(rows.begin(), rows.end());
    for (const double* const first :
         {std::as_const(s.coordinates).data(), std::as_const(rows)[0].data()}) {
      const PointView whole = PointView::row_major(first, s.count(), 3);
      std::vector<Block> blocks;
      for (std::uint64_t at = 0; at < s.count(); at += 15000) blocks.push_back({at, at + 15000});
      const Hull hull = convex_hull(whole);
      for (const unsigned pushing : {1U, 3U, 16U})
        EXPECT_EQ(pushed(whole, blocks, pushing, options_of(1)).ids(), sorted_vertices(hull));
    }
  }
}

// A state is often the last thing that is asked for: the map waits for the next block.
TEST(Stream, APushBuildsTheMapThatAStateLeftOut) {
  const PointSet s = generated("ball", 60000, 3, 12);
  HullStream stream;
  stream.push(part_of(view_of(s), 0, 20000));
  EXPECT_EQ(stream.state().point_count(), 20000U);
  EXPECT_EQ(stream.report().maps, 0U);
  stream.push(part_of(view_of(s), 20000, 40000));
  EXPECT_EQ(stream.report().maps, 1U);
  EXPECT_EQ(stream.report().reductions, 1U);
  EXPECT_LT(stream.report().waiting, 5000U);
  stream.push(part_of(view_of(s), 40000, 60000));
  EXPECT_EQ(stream.report().maps, 1U);
  EXPECT_EQ(stream.state().ids(), sorted_vertices(convex_hull(view_of(s))));
}

TEST(Stream, NothingAndNextToNothing) {
  EXPECT_EQ(HullStream().state(), HullState());
  EXPECT_THROW(HullState().hull(), Error);
  EXPECT_THROW(HullState(0), Error);
  HullState none(3);
  EXPECT_EQ(none.hull().affine_dimension, -1);
  EXPECT_EQ(none.hull().dimension, 3U);
  none.merge(HullState());
  EXPECT_EQ(none, HullState(3));

  const double p[] = {1, 2, 3};
  const PointView one = PointView::row_major(p, 1, 3);
  const PointView empty = PointView::row_major<double>(nullptr, 0, 3);
  HullStream stream;
  stream.push(empty);
  EXPECT_EQ(stream.state().dimension(), 3U);
  stream.push(one, 41);
  stream.push(empty);
  stream.push(one, 7);
  EXPECT_EQ(stream.state().ids(), std::vector<std::uint64_t>{7});
  EXPECT_EQ(stream.state().point_count(), 2U);
  EXPECT_EQ(stream.hull().affine_dimension, 0);
  EXPECT_EQ(stream.hull().vertices, std::vector<std::uint64_t>{7});
}

TEST(Stream, StatesOfDecimalsAreForMerge) {
  const double p[] = {1, 2, 30, 4, 5, 7};
  HullState state(PointView::row_major(p, 3, 2));
  HullStream stream;
  stream.push(state);
  state.to_world(1);
  EXPECT_TRUE(has(error_of(ErrorCode::invalid_argument, [&] { stream.push(state); }), "merge()"));
  EXPECT_EQ(stream.state().point_count(), 3U);
}

// Of equal points the lowest id stays, with the bits that it had: here the sign of its zero.
TEST(Stream, EqualPointsKeepTheLowestIdAndItsBits) {
  const double early[] = {-0.0, 0, 1, 0, 0, 1}, late[] = {0.0, 0, 1, 0, 0, 1};
  for (const bool swapped : {false, true}) {
    HullState a(PointView::row_major(late, 3, 2), 100), b(PointView::row_major(early, 3, 2), 50);
    if (swapped) std::swap(a, b);
    a.merge(b);
    EXPECT_EQ(a.ids(), (std::vector<std::uint64_t>{50, 51, 52}));
    EXPECT_TRUE(std::signbit(a.points().at(0, 0)));
    EXPECT_EQ(a.point_count(), 6U);
  }
}

TEST(Stream, FlatsThatStopBeingFlat) {
  HullStream stream;
  const auto push = [&](std::vector<double> rows) {
    stream.push(PointView::row_major(rows.data(), rows.size() / 3, 3));
    return stream.hull().affine_dimension;
  };
  EXPECT_EQ(push({0, 0, 0}), 0);
  EXPECT_EQ(push({0, 0, 0}), 0);
  EXPECT_EQ(push({3, 0, 0, 1, 0, 0}), 1);
  EXPECT_EQ(push({0, 3, 0, 1, 1, 0, 5, 5, 0}), 2);
  EXPECT_EQ(push({1, 1, 1}), 3);
  EXPECT_EQ(stream.state().ids(), (std::vector<std::uint64_t>{0, 2, 4, 6, 7}));
}

TEST(Stream, IdsBeyond32BitsAndUpToTheLast) {
  const std::uint64_t far = std::uint64_t{1} << 45;
  const PointSet s = random_set("ball", 5000, 3, 1);
  HullState state(view_of(s), far);
  Hull hull = state.hull();
  hull.rename([&](std::uint64_t id) { return id - far; });
  EXPECT_EQ(canonical_hash(hull), canonical_hash(convex_hull(view_of(s))));
  HullState shifted(view_of(s));
  shifted.shift_ids(far);
  EXPECT_EQ(shifted, state);
  EXPECT_THROW(shifted.shift_ids(~std::uint64_t{0} - 10), Error);
  EXPECT_EQ(shifted, state);

  HullStream stream;
  const double row[] = {1, 2, 3, 4};
  EXPECT_NO_THROW(stream.push(PointView::row_major(row, 2, 2), ~std::uint64_t{0} - 1));
  EXPECT_THROW(stream.push(PointView::row_major(row, 2, 2), ~std::uint64_t{0}), Error);
}

// A block that fails is as if it had not come: the stream goes on.
TEST(Stream, NotFiniteNamesTheGlobalIdAndTakesNothing) {
  for (const unsigned n : {3U, 50000U}) {
    const PointSet s = random_set("ball", n, 3, 5);
    const std::uint64_t hash = canonical_hash(convex_hull(view_of(s)));
    HullStream stream;
    stream.push(view_of(s));
    for (const std::uint64_t bad : {std::uint64_t{0}, std::uint64_t{n / 2}, std::uint64_t{n - 1}}) {
      PointSet broken = s;
      broken.coordinates[3 * bad + 1] = std::numeric_limits<double>::quiet_NaN();
      broken.coordinates[3 * (n - 1) + 2] = std::numeric_limits<double>::infinity();
      EXPECT_TRUE(has(error_of(ErrorCode::not_finite, [&] { stream.push(view_of(broken)); }),
                      "point " + std::to_string(n + bad) + ", coordinate 1"));
    }
    EXPECT_EQ(stream.report().point_count, n);
    EXPECT_EQ(canonical_hash(stream.hull()), hash);
    stream.push(view_of(s));
    EXPECT_EQ(stream.state().point_count(), 2U * n);
  }
}

TEST(Stream, RefusesWhatDoesNotFitTogether) {
  const double row[] = {1, 2, 3, 4, 5, 6};
  HullStream stream;
  stream.push(PointView::row_major(row, 3, 2));
  EXPECT_THROW(stream.push(PointView::row_major(row, 2, 3)), Error);
  EXPECT_THROW(stream.push(PointView::row_major(row, 6, 0)), Error);
  EXPECT_THROW(stream.push(PointView::row_major<double>(nullptr, 3, 2)), Error);
  EXPECT_THROW(stream.push(HullState(3)), Error);
  EXPECT_EQ(stream.report().point_count, 3U);
  HullState state(PointView::row_major(row, 3, 2));
  const HullState before = state;
  EXPECT_THROW(state.merge(HullState(PointView::row_major(row, 2, 3))), Error);
  EXPECT_EQ(state, before);
}

TEST(Stream, ScalarTypesMeetInDoubles) {
  const float single[] = {0, 0, 1, 0, 0, 1};
  const std::int32_t whole[] = {5, 5, 0, 0};
  const PointView f = PointView::row_major(single, 3, 2), i = PointView::row_major(whole, 2, 2);
  const PointView no_doubles = PointView::row_major<double>(nullptr, 0, 2);
  HullStream stream;
  stream.push(no_doubles);
  stream.push(f);
  EXPECT_EQ(stream.state().scalar(), ScalarType::f32);
  stream.push(no_doubles);
  EXPECT_EQ(stream.state().scalar(), ScalarType::f32);
  stream.push(i);
  const HullState state = stream.state();
  EXPECT_EQ(state.scalar(), ScalarType::f64);
  EXPECT_EQ(state.ids(), (std::vector<std::uint64_t>{0, 1, 2, 3}));
  HullState other(i, 3);
  other.merge(HullState(f));
  EXPECT_EQ(other, state);
}

// Everything extreme and too much for the memory: told, and what was pushed is still there.
TEST(Stream, BudgetIsToldAndNothingLost) {
  const PointSet s = generated("sphere", 200000, 3, 1);
  Options options;
  options.memory_budget = 8 << 20;
  HullStream stream(options);
  std::uint64_t pushed = 0;
  const std::string why = error_of(ErrorCode::out_of_budget, [&] {
    for (; pushed < s.count(); pushed += 10000)
      stream.push(part_of(view_of(s), pushed, pushed + 10000));
  });
  EXPECT_TRUE(has(why, "holds " + std::to_string(pushed) + " points"));
  EXPECT_GT(pushed, 10000U);
  const StreamReport report = stream.report();
  EXPECT_EQ(report.point_count, pushed);
  EXPECT_EQ(report.extreme + report.waiting, pushed);
}

// Whatever the budget: an answer or a refusal, in each of several calls.
TEST(Stream, AnyBudgetIsKeptOrRefused) {
  const PointSet s = generated("sphere", 20000, 3, 1);
  const Ids expected = sorted_vertices(convex_hull(view_of(s)));
  for (std::uint64_t budget = 1; budget < (1U << 26); budget *= 3)
    for (const unsigned threads : {1U, 2U}) {
      Options options;
      options.memory_budget = budget;
      options.threads = threads;
      HullStream stream(options);
      try {
        for (std::uint64_t at = 0; at < s.count(); at += 1000)
          stream.push(part_of(view_of(s), at, at + 1000));
        EXPECT_EQ(stream.state().ids(), expected);
      } catch (const Error& e) {
        EXPECT_EQ(e.code(), ErrorCode::out_of_budget) << budget;
      }
      try {
        EXPECT_EQ(extreme_points(view_of(s), options).ids, expected);
      } catch (const Error& e) {
        EXPECT_EQ(e.code(), ErrorCode::out_of_budget) << budget;
      }
    }
}

TEST(Stream, CancelledAndTakenUpAgain) {
  const PointSet s = random_set("sphere", 30000, 3, 2);
  std::stop_source stop;
  Options options;
  options.stop = stop.get_token();
  HullStream stream(options);
  stream.push(view_of(s));
  stop.request_stop();
  EXPECT_THROW(stream.state(), Error);
  EXPECT_THROW(stream.push(view_of(s)), Error);
  EXPECT_EQ(stream.report().point_count, 30000U);
  EXPECT_EQ(stream.report().waiting, 30000U);
}

TEST(Stream, StatesWhileOthersPush) {
  const PointSet s = generated("ball", 200000, 3, 3);
  HullStream stream;
  std::atomic<bool> done{false};
  std::thread pusher([&] {
    for (std::uint64_t at = 0; at < s.count(); at += 2000)
      stream.push(part_of(view_of(s), at, at + 2000));
    done = true;
  });
  int states = 0;
  while (!done || states == 0) {
    const HullState state = stream.state();
    const std::uint64_t n = state.point_count();
    ASSERT_EQ(n % 2000, 0U);
    if (n > 0 && ++states % 8 == 1) {
      ASSERT_EQ(state.ids(), sorted_vertices(convex_hull(part_of(view_of(s), 0, n))));
    }
  }
  pusher.join();
  EXPECT_EQ(stream.state().ids(), sorted_vertices(convex_hull(view_of(s))));
}

// The first block comes while hull() is under way: the stream has its dimension from then on.
TEST(Stream, TheFirstBlockWhileAHullIsAsked) {
  const PointSet ball = generated("ball", 600, 3, 9);
  const PointView whole = view_of(ball);
  HullStream* pushes = nullptr;
  const auto push = [&] {
    if (HullStream* const stream = std::exchange(pushes, nullptr))
      std::thread([&] { stream->push(part_of(whole, 0, 300), 0); }).join();
  };
  Options options = options_of(1);
  options.poll = push;
  HullStream stream(options);
  pushes = &stream;
  EXPECT_THROW(stream.hull(), Error);
  push();
  stream.push(part_of(whole, 300, 600), 300);
  EXPECT_EQ(canonical_hash(stream.hull()), canonical_hash(convex_hull(whole)));
}

TEST(Stream, BytesAreReadBackAndNothingElseIs) {
  const PointSet s = random_set("ball", 300, 3, 4);
  std::vector<float> singles(s.coordinates.begin(), s.coordinates.end());
  const HullState state(PointView::row_major(singles.data(), s.count(), 3), 12);
  const std::vector<std::byte> bytes = state.to_bytes();
  EXPECT_EQ(HullState::from_bytes(bytes), state);
  for (const HullState& empty : {HullState(), HullState(5, ScalarType::u8)})
    EXPECT_EQ(HullState::from_bytes(empty.to_bytes()), empty);
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    std::vector<std::byte> changed = bytes;
    changed[i] ^= std::byte{1};
    EXPECT_THROW(HullState::from_bytes(changed), Error) << i;
    if (i % 7 == 0) {
      EXPECT_THROW(HullState::from_bytes(std::span(bytes).first(i)), Error) << i;
    }
  }
  std::vector<std::byte> longer = bytes;
  longer.resize(bytes.size() + 8);
  EXPECT_THROW(HullState::from_bytes(longer), Error);
  // A promise of more points than any file has.
  std::vector<std::byte> lying = bytes;
  for (std::size_t i = 32; i < 40; ++i) lying[i] = std::byte{0xFF};
  EXPECT_THROW(HullState::from_bytes(lying), Error);
}

}  // namespace cullhull::testing_support::stream_test
