// What goes on around the kernels, on the emulated device: streams, threads, several devices,
// errors of the caller's own, memory that runs out.
#include <cuda_runtime_api.h>
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstring>
#include <functional>
#include <iostream>
#include <map>
#include <memory>
#include <new>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "cuda/gauge.hpp"
#include "cullhull/device_hull.hpp"
#include "device_sets.hpp"
#include "emulation.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "tests/made_sets.hpp"
#include "tests/rates.hpp"
#include "tests/thrown.hpp"

namespace cullhull::testing {
namespace emulated_edges_test {

using testing_support::canonical_hash;
using testing_support::error_of;

class EmulatedEdges : public ::testing::Test {
 protected:
  void SetUp() override {
    emulation::settings() = {};
    emulation::restart();
  }
  void TearDown() override { emulation::settings() = {}; }
};

/// Points that come to the device on a stream, late.
class ArrivingPoints {
 public:
  ArrivingPoints(const std::vector<float>& rows, unsigned d) : d_(d), n_(rows.size() / d) {
    const std::size_t bytes = rows.size() * sizeof(float);
    check(cudaMallocHost(&pinned_, bytes));
    std::memcpy(pinned_, rows.data(), bytes);
    check(cudaMalloc(&there_, bytes));
    check(cudaMemset(there_, 0, bytes));
    check(cudaDeviceSynchronize());
  }
  ~ArrivingPoints() {
    (void)cudaFree(there_);
    (void)cudaFreeHost(pinned_);
  }
  void send(cudaStream_t stream) const {
    check(
        cudaMemcpyAsync(there_, pinned_, n_ * d_ * sizeof(float), cudaMemcpyHostToDevice, stream));
  }
  DevicePointView view(cudaStream_t stream) const {
    return DevicePointView::row_major(static_cast<const float*>(there_), n_, d_, stream);
  }

 private:
  unsigned d_;
  std::size_t n_;
  void* pinned_ = nullptr;
  void* there_ = nullptr;
};

TEST_F(EmulatedEdges, WorkIsOrderedBehindEveryKindOfStream) {
  const auto rows = ball(3, 20000, 7);
  const std::uint64_t expected = plain_hash(rows, 3);
  const Stream own;
  for (cudaStream_t stream :
       {cudaStream_t{own}, cudaStream_t{nullptr}, cudaStreamLegacy, cudaStreamPerThread}) {
    const ArrivingPoints points(rows, 3);
    points.send(stream);
    EXPECT_EQ(canonical_hash(convex_hull(points.view(stream), on_device())), expected);
  }
}

// The per-thread default stream means the calling thread's: a binding that computes on another
// thread waits for it first.
TEST_F(EmulatedEdges, AStreamIsWaitedForOnTheThreadThatNamesIt) {
  const auto rows = ball(3, 20000, 8);
  const ArrivingPoints points(rows, 3);
  points.send(cudaStreamPerThread);
  wait_for_cuda_stream(cudaStreamPerThread);
  std::uint64_t found = 0;
  std::thread([&] {
    found = canonical_hash(convex_hull(points.view(cudaStreamPerThread), on_device()));
  }).join();
  EXPECT_EQ(found, plain_hash(rows, 3));
}

// For arrays whose maker does not say on which stream they come.
TEST_F(EmulatedEdges, AllWorkOfTheirDeviceIsWaitedForWhereNoStreamIsSaid) {
  emulation::settings().devices = 2;
  check(cudaSetDevice(1));
  const auto rows = ball(3, 20000, 9);
  const ArrivingPoints points(rows, 3);
  const Stream side;
  points.send(side);
  check(cudaSetDevice(0));
  wait_for_cuda_device_of(points.view(nullptr).data);
  EXPECT_EQ(canonical_hash(convex_hull(points.view(nullptr), on_device())), plain_hash(rows, 3));
  int current = -1;
  check(cudaGetDevice(&current));
  EXPECT_EQ(current, 0);
}

TEST_F(EmulatedEdges, MapsOfManySizesOnThreadsBesideOneAnother) {
  emulation::settings().order = emulation::Order::shuffled;
  std::vector<std::unique_ptr<internal::GaugeMap>> maps;
  for (const unsigned cells : {16U, 44U, 58U, 80U})
    maps.push_back(internal::GaugeMap::build(testing_support::cross_polytope(3, 0.125, 1), cells));
  std::atomic<int> wrong{0};
  std::vector<std::thread> threads;
  for (const auto& map : maps)
    threads.emplace_back([&] {
      const auto rows = ball(3, 2000, 3);
      const Options options;
      const internal::Run run(options);
      const auto expected =
          map->survivors(PointView::row_major(rows.data(), 2000, 3), run.with_threads(1));
      const Stream stream;
      const OnDevice there(rows);
      const auto view = DevicePointView::row_major(there.data<float>(), 2000, 3, stream);
      for (int i = 0; i < 40; ++i) try {
          const auto found = internal::survivors_of_device_points(map->table(), view);
          Array<std::uint64_t> ids(found.count);
          internal::download(ids.data(), found.ids.data(), found.count, stream);
          if (ids != expected) ++wrong;
        } catch (const Error&) {
          ++wrong;
        }
    });
  for (std::thread& t : threads) t.join();
  EXPECT_EQ(wrong, 0);
}

// The limit of a kernel's shared memory is the process's: a smaller table on another thread must
// not lower it between this thread's asking and its launch.
TEST_F(EmulatedEdges, ASmallerTableOnAnotherThreadJustBeforeALaunch) {
  const auto build = [](unsigned cells) {
    return internal::GaugeMap::build(testing_support::cross_polytope(3, 0.125, 1), cells);
  };
  const auto small = build(8), large = build(58);
  const auto rows = ball(3, 2000, 3);
  const OnDevice there(rows);
  const auto view = DevicePointView::row_major(there.data<float>(), 2000, 3);
  const auto count = [&](const internal::GaugeMap& map) {
    return internal::survivors_of_device_points(map.table(), view).count;
  };
  const std::uint64_t expected = count(*large);
  bool met = false;
  emulation::settings().before_launch = [&] {
    std::thread([&] { met = count(*small) >= expected; }).join();
  };
  EXPECT_EQ(count(*large), expected);
  EXPECT_TRUE(met);
}

TEST_F(EmulatedEdges, AnErrorThatTheCallerLeftUnreadIsReportedAndStays) {
  const auto rows = ball(3, 20000, 5);
  const OnDevice there(rows);
  const auto view = DevicePointView::row_major(there.data<float>(), 20000, 3);
  const std::uint64_t expected = plain_hash(rows, 3);
  const auto here = PointView::row_major(rows.data(), 20000, 3);
  void* none = nullptr;
  ASSERT_NE(cudaMalloc(&none, std::size_t{1} << 60), cudaSuccess);
  for (const std::string& said : {error_of([&] { convex_hull(view, on_device()); }), error_of([&] {
                                    convex_hull(view, on_device(CullMethod::pseudo_hull));
                                  }),
                                  error_of([&] { convex_hull(here, on_device()); })})
    EXPECT_NE(said.find("nobody read its error"), std::string::npos) << said;
  {  // to the device, were it not for the error
    const testing_support::WithRates fast_link({.host_read = 1, .link = 1e15});
    EXPECT_EQ(canonical_hash(convex_hull(here)), expected);
  }
  EXPECT_EQ(cudaGetLastError(), cudaErrorMemoryAllocation) << "it is still the caller's to read";
  for (const CullMethod method : {CullMethod::gauge, CullMethod::pseudo_hull})
    EXPECT_EQ(canonical_hash(convex_hull(view, on_device(method))), expected);
  EXPECT_EQ(cudaPeekAtLastError(), cudaSuccess);
}

/// How often the device has nothing to do until a call goes on, and what the call copies between
/// host and device.
struct Cost {
  std::uint64_t waits, link_bytes;
};
template <class Call>
Cost cost_of(const char* what, const Call& call) {
  const emulation::Counters before = emulation::counters();
  call();
  const emulation::Counters after = emulation::counters();
  const Cost cost{after.waits - before.waits, after.link_bytes - before.link_bytes};
  std::cout << what << ": " << cost.waits << " waits, " << cost.link_bytes
            << " bytes over the link\n";
  return cost;
}

// Each wait takes some 10 us of a device's time, as a round of flips does.
TEST_F(EmulatedEdges, CallsWaitSeldom) {
  const auto rows = ball(3, 20000, 5);
  const OnDevice there(rows);
  const auto view = DevicePointView::row_major(there.data<float>(), 20000, 3);
  const Options options = on_device(CullMethod::automatic);
  // The hull, with coordinates, and some words a round: of the points' 240,000 bytes nothing.
  constexpr std::uint64_t hull_bytes = 120000, few_bytes = 26000;
  const Cost hull = cost_of("hull", [&] { convex_hull(view, options); });
  EXPECT_LE(hull.waits, 4U);
  EXPECT_LE(hull.link_bytes, hull_bytes);
  const Cost left = cost_of("hull left there", [&] { convex_hull_on_device(view, options); });
  EXPECT_LE(left.waits, 6U);
  EXPECT_LE(left.link_bytes, few_bytes);
  HullTracker tracker(options);
  tracker.update(view);
  const Cost frame = cost_of("frame", [&] { tracker.update(view); });
  EXPECT_LE(frame.waits, 2U);
  EXPECT_LE(frame.link_bytes, hull_bytes);
  EXPECT_TRUE(testing_support::has(tracker.hull().statistics.cull_reason, "the last frame's"));
}

// Its first surface is refined, and checked twice. In the larger one many facets are replaced in a
// round, and the lists of the result are copied in several pieces.
TEST_F(EmulatedEdges, ASphereWaitsOnceMore) {
  for (const std::size_t n : {25000U, 100000U}) {
    const auto rows = testing_support::made<float>("sphere", n, 3, 5);
    const OnDevice there(rows);
    const auto view = DevicePointView::row_major(there.data<float>(), n, 3);
    const Cost cost =
        cost_of("sphere", [&] { convex_hull(view, on_device(CullMethod::automatic)); });
    EXPECT_LE(cost.waits, 5U) << n;
    EXPECT_LE(cost.link_bytes, n * 150) << n;
  }
}

// Nor is memory lost where a result is freed while the caller has an unread error.
TEST_F(EmulatedEdges, AResultIsFreedDespiteAnUnreadError) {
  const auto rows = ball(3, 1000, 5);
  const std::vector<std::uint64_t> offsets{0, 50, 100};
  const OnDevice there(rows);
  const auto view = DevicePointView::row_major(there.data<float>(), 1000, 3);
  const std::size_t before = emulation::counters().live_bytes;
  DeviceHullBatch batch = convex_hulls_on_device(view, offsets.data(), 2);
  EXPECT_GT(emulation::counters().live_bytes, before);
  void* none = nullptr;
  ASSERT_NE(cudaMalloc(&none, std::size_t{1} << 60), cudaSuccess);
  batch = {};
  EXPECT_EQ(cudaGetLastError(), cudaErrorMemoryAllocation);
  check(cudaDeviceSynchronize());
  EXPECT_EQ(emulation::counters().live_bytes, before);
}

// A driver may keep a part of a block's memory, under tools that watch kernels for one.
TEST_F(EmulatedEdges, ADriverThatDoesNotGrantAllSharedMemory) {
  const auto build = [](unsigned cells) {
    return internal::GaugeMap::build(testing_support::cross_polytope(3, 0.125, 1), cells);
  };
  const auto small = build(50), large = build(58);
  const auto rows = ball(3, 2000, 3);
  const OnDevice there(rows);
  const auto view = DevicePointView::row_major(there.data<float>(), 2000, 3);
  const auto count = [&](const internal::GaugeMap& map) {
    return internal::survivors_of_device_points(map.table(), view).count;
  };
  const std::uint64_t expected = count(*large), of_small = count(*small);
  const std::size_t needed = large->table().nodes.size() * sizeof(float);
  ASSERT_GT(small->table().nodes.size() * sizeof(float), std::size_t{48} << 10);
  emulation::settings().most_dynamic_shared = static_cast<long>(needed);
  emulation::forget_shared_limits();
  std::uint64_t met = 0;  // a smaller table must not lower the limit before this launch
  emulation::settings().before_launch = [&] { std::thread([&] { met = count(*small); }).join(); };
  EXPECT_EQ(count(*large), expected);
  EXPECT_EQ(met, of_small);
  emulation::settings().most_dynamic_shared = static_cast<long>(needed) - 4;
  EXPECT_THROW((void)count(*large), Error);
}

// A call waits for its results, which a capture does not allow: it must say so, and end no capture.
TEST_F(EmulatedEdges, AStreamThatIsBeingCapturedIsRefused) {
  const auto rows = ball(3, 20000, 6);
  const std::vector<std::uint64_t> offsets{0, 50, 100};
  const OnDevice there(rows);
  const Stream stream;
  const auto view = DevicePointView::row_major(there.data<float>(), 20000, 3, stream);
  const HullQuery query(PointView::row_major(rows.data(), 100, 3),
                        convex_hull(PointView::row_major(rows.data(), 100, 3)));
  std::vector<Side> sides(20000);
  const std::uint64_t id = 7;
  emulation::settings().captured_stream = stream;
  const std::function<void()> calls[] = {
      [&] { convex_hull(view); },
      [&] { convex_hull(view, on_device(CullMethod::pseudo_hull)); },
      [&] { cull(view); },
      [&] { HullTracker(on_device()).update(view); },
      [&] { convex_hulls(view, offsets.data(), 2); },
      [&] { convex_hulls_on_device(view, offsets.data(), 2); },
      [&] { query.sides(view, sides.data()); },
      [&] {
    fetch_points(view, {&id, 1});
      },
      [&] { wait_for_cuda_stream(stream); },
  };
  for (const auto& call : calls) {
    const std::string said = error_of(call);
    EXPECT_NE(said.find("CUDA graph is being captured"), std::string::npos) << said;
  }
  emulation::settings().captured_stream = nullptr;
  EXPECT_EQ(canonical_hash(convex_hull(view)), plain_hash(rows, 3));
}

// Offsets in pinned memory that the stream of the points writes.
TEST_F(EmulatedEdges, OffsetsThatTheHostCanReadAreWaitedFor) {
  const auto rows = ball(3, 1000, 5);
  const std::vector<std::uint64_t> offsets{0, 50, 400, 1000};
  const OnDevice there(rows), offsets_there(offsets);
  const Stream stream;
  const auto view = DevicePointView::row_major(there.data<float>(), 1000, 3, stream);
  void* pinned = nullptr;
  const std::size_t bytes = offsets.size() * sizeof(std::uint64_t);
  check(cudaMallocHost(&pinned, bytes));
  std::memset(pinned, 0, bytes);
  check(cudaMemcpyAsync(pinned, offsets_there.data<std::uint64_t>(), bytes, cudaMemcpyDeviceToHost,
                        stream));
  const HullBatch found = convex_hulls(view, static_cast<std::uint64_t*>(pinned), 3);
  EXPECT_EQ(
      found.vertices.items.size(),
      convex_hulls(PointView::row_major(rows.data(), 1000, 3), offsets).vertices.items.size());
  check(cudaFreeHost(pinned));
}

TEST_F(EmulatedEdges, ThePoolOfADeviceIsTrimmed) {
  const auto rows = ball(3, 20000, 6);
  const OnDevice there(rows);
  (void)convex_hull(DevicePointView::row_major(there.data<float>(), 20000, 3), on_device());
  emulation::restart();
  keep_memory(std::size_t{1} << 20);
  EXPECT_EQ(emulation::counters().trims, 0U);
  keep_memory(0);
  EXPECT_GE(emulation::counters().trims, 1U);
}

// While the caller records a graph, asking the default stream fails; that is no broken device.
TEST_F(EmulatedEdges, AnErrorThatDoesNotStayDoesNotEndTheProcess) {
  const auto rows = ball(3, 20000, 6);
  const OnDevice there(rows);
  const auto view = DevicePointView::row_major(there.data<float>(), 20000, 3);
  emulation::settings().default_stream_error = cudaErrorStreamCaptureUnsupported;
  EXPECT_THROW(convex_hull(view, on_device()), Error);
  emulation::settings().default_stream_error = 0;
  EXPECT_EQ(canonical_hash(convex_hull(view, on_device())), plain_hash(rows, 3));
}

TEST_F(EmulatedEdges, PinnedMemoryIsKeptBetweenCalls) {
  const auto rows = ball(3, 100000, 2);
  const auto points = PointView::row_major(rows.data(), 100000, 3);
  (void)convex_hull(points, on_device());
  const std::uint64_t first = emulation::counters().pinned_allocations;
  EXPECT_GT(first, 0U);
  for (int i = 0; i < 3; ++i) (void)convex_hull(points, on_device());
  EXPECT_EQ(emulation::counters().pinned_allocations, first);
}

/// A view of the first three of four columns, and a copy that is packed.
struct Records {
  explicit Records(std::size_t n) : wide(n * 4), packed(ball(3, n, 1)) {
    for (std::size_t i = 0; i < n; ++i)
      for (unsigned j = 0; j < 3; ++j) wide[i * 4 + j] = packed[i * 3 + j];
  }
  std::vector<float> wide, packed;
};

TEST_F(EmulatedEdges, RowsOfWiderRecordsComeBackFromAFullDevice) {
  const std::size_t n = 30000;
  const Records records(n);
  const std::uint64_t expected = plain_hash(records.packed, 3);
  const OnDevice wide(records.wide), turned(testing_support::transposed(records.packed, 3)),
      there(records.packed);
  auto view = DevicePointView::row_major(wide.data<float>(), n, 3);
  view.point_stride = 4 * sizeof(float);
  emulation::restart();
  emulation::settings().failing_allocations_from = 1;
  for (const DevicePointView& points :
       {view, DevicePointView::column_major(turned.data<float>(), n, 3),
        DevicePointView::row_major(there.data<float>(), n, 3)})
    for (const CullMethod method : {CullMethod::automatic, CullMethod::gauge, CullMethod::none}) {
      Options options;
      options.cull = method;
      EXPECT_EQ(canonical_hash(convex_hull(points, options)), expected);
    }
}

// In space the CPU is left one map of a small sample and the hull of few points.
TEST_F(EmulatedEdges, APseudoHullTakesThePlaceOfASecondMap) {
  const std::size_t n = 500000;
  const auto rows = ball(3, n, 4);
  Options here;
  here.backend = Backend::cpu;
  here.cull = CullMethod::gauge;
  const Hull expected = convex_hull(PointView::row_major(rows.data(), n, 3), here);
  const OnDevice there(rows);
  const auto view = DevicePointView::row_major(there.data<float>(), n, 3);
  emulation::restart();
  const Hull found = convex_hull(view, on_device());
  EXPECT_EQ(canonical_hash(found), canonical_hash(expected));
  EXPECT_EQ(found.statistics.filter, UsedFilter::gauge_pseudo_hull);
  EXPECT_LT(2 * found.statistics.survivors, expected.statistics.survivors * 3 / 2);
  EXPECT_EQ(emulation::counters().launches["count_kernel"], 1U) << "one map";
}

// Its memory is full where the pseudo-hull begins: the CPU's second filter takes over.
TEST_F(EmulatedEdges, APseudoHullThatFindsNoMemoryIsReplaced) {
  const std::size_t n = 300000;
  const auto rows = ball(3, n, 4);
  const std::uint64_t expected = plain_hash(rows, 3);
  const OnDevice there(rows);
  const auto view = DevicePointView::row_major(there.data<float>(), n, 3);
  emulation::restart();
  EXPECT_EQ(convex_hull(view, on_device()).statistics.filter, UsedFilter::gauge_pseudo_hull);
  const long before = static_cast<long>(emulation::counters().allocations);
  for (const long failing : {before / 3, before / 2, before - 2}) {
    emulation::restart();
    emulation::settings().failing_allocations_from = failing;
    Options options = on_device();
    options.backend = Backend::automatic;
    const testing_support::WithRates slow_link({.link = 1});
    EXPECT_EQ(canonical_hash(convex_hull(view, options)), expected) << failing;
  }
}

// Where the device is slow, they are copied, and the ways are those of points on the host.
TEST_F(EmulatedEdges, PointsThatAreTheCpusGoTheHostsWay) {
  const testing_support::WithRates slow_device({.device_copy = 1});
  Options cpu;
  cpu.backend = Backend::cpu;
  for (const std::size_t n : {1U, 10U, 500U, 5000U, 20000U}) {
    const auto rows = ball<double>(3, n, 7);
    const OnDevice there(rows);
    const auto here = PointView::row_major(rows.data(), n, 3);
    const auto view = DevicePointView::row_major(there.data<double>(), n, 3);
    const Hull expected = convex_hull(here, cpu), found = convex_hull(view);
    EXPECT_EQ(canonical_hash(found), canonical_hash(expected)) << n;
    EXPECT_EQ(found.statistics.cull_reason.find(expected.statistics.cull_reason), 0U)
        << found.statistics.cull_reason << " for " << expected.statistics.cull_reason;
    EXPECT_EQ(found.statistics.survivors, expected.statistics.survivors) << n;
    EXPECT_EQ(cull(view).ids, cull(here, cpu).ids) << n;
  }
}

// They are uploaded at the first call that needs them, once for each device, and are read by
// threads whose streams did not upload them.
TEST_F(EmulatedEdges, TablesOfAHullStayOnTheDevice) {
  const auto rows = ball(3, 3000, 5);
  const OnDevice there(rows);
  check(cudaDeviceSynchronize());
  const std::size_t before = emulation::counters().live_bytes;
  std::size_t kept = 0;
  {
    const auto points = PointView::row_major(rows.data(), 200, 3);
    const HullQuery query(points, convex_hull(points));
    std::vector<Side> expected(3000), sides(3000);
    std::vector<std::uint64_t> supports(3000);
    query.sides(PointView::row_major(rows.data(), 3000, 3), expected.data());
    std::uint64_t copies = 0;
    for (int i = 0; i < 3; ++i) {
      const Stream stream;
      const auto view = DevicePointView::row_major(there.data<float>(), 3000, 3, stream);
      emulation::restart();
      query.sides(view, sides.data(), on_device(CullMethod::automatic));
      EXPECT_EQ(sides, expected);
      query.supports(view, supports.data(), on_device(CullMethod::automatic));
      check(cudaDeviceSynchronize());
      const emulation::Counters seen = emulation::counters();
      if (i == 0) {
        kept = seen.live_bytes;
        copies = seen.copies;
      } else {
        EXPECT_EQ(seen.live_bytes, kept);
        EXPECT_EQ(seen.copies + 3, copies) << "simplices, vertices, ids";
      }
    }
    EXPECT_GT(kept, before);
  }
  check(cudaDeviceSynchronize());
  EXPECT_EQ(emulation::counters().live_bytes, before);
}

// All points are copied at once or, where that fails, in pieces. A surface is one of all points.
TEST_F(EmulatedEdges, PointsOfTheHostAreFilteredAsThoseOfTheDevice) {
  struct Case {
    const char* shape;
    std::size_t n;
    std::size_t memory;  // of the device
    bool fits;
  };
  std::uint64_t survivors = 0;
  for (const Case& c : {Case{"sphere", 8000, std::size_t{1} << 34, true},
                        {"ball", 70000, std::size_t{1} << 34, true},
                        {"ball", 150000, 6 << 20, false}}) {  // for the points alone 1.8 MB
    auto rows = testing_support::made<float>(c.shape, c.n, 3, 4);
    const auto here = PointView::row_major(rows.data(), c.n, 3);
    const std::uint64_t expected = plain_hash(rows, 3);
    const auto hull = [&] {
      emulation::restart();
      emulation::settings().memory = c.memory;
      return convex_hull(here, on_device(CullMethod::automatic));
    };
    const Hull found = hull();
    const std::string reason = found.statistics.cull_reason;
    EXPECT_EQ(canonical_hash(found), expected) << reason;
    EXPECT_EQ(found.statistics.backend, Backend::cuda);
    EXPECT_EQ(reason.find("which is the hull") != std::string::npos, c.fits) << reason;
    EXPECT_EQ(reason.find("in pieces") != std::string::npos, !c.fits) << reason;
    EXPECT_TRUE(c.fits || found.statistics.survivors < 3 * survivors) << "each piece's surface";
    survivors = found.statistics.survivors;
    for (const std::size_t bad : {c.n - 1, c.n / 2}) {
      rows[3 * bad + 1] = NAN;
      EXPECT_TRUE(testing_support::has(error_of(ErrorCode::not_finite, hull),
                                       "point " + std::to_string(bad) + ","));
    }
  }
  const auto rows = testing_support::made<float>("sphere", 8000, 3, 4);
  emulation::restart();
  emulation::settings().failing_allocation = 1;
  error_of(ErrorCode::out_of_budget,
           [&] { convex_hull(PointView::row_major(rows.data(), 8000, 3), on_device()); });
}

/// Runs `call` with the n-th step failing for n = 1, 2, ... until none fails any more.
void fail_at_every_step(long emulation::Settings::*which, const std::function<void()>& call) {
  for (long n = 1;; ++n) {
    emulation::restart();
    emulation::settings().*which = n;
    call();
    emulation::settings().*which = 0;
    const emulation::Counters seen = emulation::counters();
    const std::uint64_t steps = which == &emulation::Settings::failing_pinned_from
                                    ? seen.pinned_allocations + 1
                                    : seen.allocations + 1;
    if (static_cast<std::uint64_t>(n) > steps) break;
    ASSERT_LT(n, 10000);
  }
}

TEST_F(EmulatedEdges, EveryAllocationMayFail) {
  const auto rows = ball(3, 8000, 5);
  const std::uint64_t expected = plain_hash(rows, 3);
  const OnDevice there(rows);
  const auto on_it = DevicePointView::row_major(there.data<float>(), 8000, 3);
  const auto here = PointView::row_major(rows.data(), 8000, 3);
  const auto outcome = [&](const std::function<Hull()>& call, Backend backend) {
    try {
      EXPECT_EQ(canonical_hash(call()), expected);
    } catch (const Error& e) {
      EXPECT_EQ(backend, Backend::cuda) << "automatic has the CPU to fall back on: " << e.what();
      EXPECT_EQ(e.code(), ErrorCode::out_of_budget) << e.what();
    }
  };
  for (const auto which :
       {&emulation::Settings::failing_allocation, &emulation::Settings::failing_allocations_from,
        &emulation::Settings::failing_pinned_from})
    for (const CullMethod method : {CullMethod::gauge, CullMethod::pseudo_hull})
      for (const Backend backend : {Backend::automatic, Backend::cuda}) {
        Options options;
        options.backend = backend;
        options.cull = method;
        {
          const testing_support::WithRates stay_there({.link = 1});
          fail_at_every_step(which, [&] {
            keep_memory(0);
            outcome([&] { return convex_hull(on_it, options); }, backend);
          });
        }
        if (method == CullMethod::pseudo_hull) continue;
        const testing_support::WithRates go_there(
            {.host_read = 1, .host_copy = 1e15, .link = 1e15});
        fail_at_every_step(which, [&] {
          keep_memory(0);
          outcome([&] { return convex_hull(here, options); }, backend);
        });
      }
}

/// A caller's allocator: the run-time library's memory, counted.
struct CountedMemory {
  std::map<void*, std::size_t> live;
  std::uint64_t allocations = 0, fails_from = ~std::uint64_t{0};
  bool throws = false;  ///< where there is no memory

  std::shared_ptr<const DeviceAllocator> allocator() {
    return std::make_shared<DeviceAllocator>(
        DeviceAllocator{[this](std::size_t bytes, void*) { return allocate(bytes); },
                        [this](void* memory, std::size_t bytes, void*) {
      EXPECT_EQ(live[memory], bytes);
      live.erase(memory);
      check(cudaFree(memory));
                        }});
  }
  void* allocate(std::size_t bytes) {
    EXPECT_GT(bytes, 0U);
    if (++allocations >= fails_from) {
      if (throws) throw std::bad_alloc();
      void* none = nullptr;
      EXPECT_NE(cudaMalloc(&none, std::size_t{1} << 60), cudaSuccess);  // leaves its error unread
      return nullptr;
    }
    void* memory = nullptr;
    check(cudaMalloc(&memory, bytes));
    live[memory] = bytes;
    return memory;
  }
};

TEST_F(EmulatedEdges, ACallersAllocatorGivesAllDeviceMemory) {
  const auto rows = ball(3, 8000, 5), wide = testing_support::made<float>("gauss", 8000, 4, 5);
  const std::vector<std::uint64_t> offsets{0, 50, 54, 8000};
  const OnDevice there(rows), wide_there(wide), answers(std::vector<Side>(8000));
  const auto view = DevicePointView::row_major(there.data<float>(), 8000, 3);
  const auto here = PointView::row_major(rows.data(), 8000, 3);
  const std::uint64_t expected = plain_hash(rows, 3);
  Options options = on_device(CullMethod::automatic);
  std::vector<std::shared_ptr<void>> results;
  const auto keep = [&]<class Result>(Result&& result) {
    results.push_back(std::make_shared<Result>(std::move(result)));
  };
  const std::function<void()> calls[] = {
      [&] { EXPECT_EQ(canonical_hash(convex_hull(view, options)), expected); },
      [&] { EXPECT_EQ(canonical_hash(convex_hull(here, options)), expected); },
      [&] {
    Options map = options;
    map.cull = CullMethod::gauge;
    (void)convex_hull(DevicePointView::row_major(wide_there.data<float>(), 8000, 4), map);
      },
      [&] {
    Options paper = options;
    paper.cull = CullMethod::pseudo_hull;
    EXPECT_EQ(canonical_hash(convex_hull(view, paper)), expected);
  },
                              [&] { keep(convex_hull_on_device(view, options)); },
                              [&] {
    keep(convex_hull_on_device(DevicePointView::row_major(there.data<float>(), 10, 3), options));
  },
      [&] { (void)convex_hulls(view, offsets.data(), 3, options); },
      [&] {
    keep(convex_hulls_on_device(view, offsets.data(), 3, options,
                                {.planes = true, .measures = true}));
      },
      [&] {
    keep(convex_hulls_on_device(DevicePointView::row_major<float>(nullptr, 0, 3), offsets.data(), 0,
                                options));
      },
      [&] {
    HullTracker tracker(options);
    tracker.update(view);
    EXPECT_EQ(canonical_hash(tracker.update(view)), expected);
    keep(std::move(tracker));
      },
      [&] {
    HullQuery query(here, convex_hull(here));
    query.sides_on_device(view, answers.data<Side>(), options);
    keep(std::move(query));
      },
      };
  keep_memory(0);
  check(cudaDeviceSynchronize());
  const std::size_t before = emulation::counters().live_bytes;
  for (const auto& call : calls) {
    const auto which = &call - calls;
    CountedMemory memory;
    options.device_allocator = memory.allocator();
    emulation::restart();
    call();
    EXPECT_EQ(emulation::counters().allocations, memory.allocations) << which << ": its own pool";
    EXPECT_EQ(memory.live.empty(), results.empty()) << which;
    options.device_allocator = nullptr;
    results.clear();
    EXPECT_TRUE(memory.live.empty()) << which;
    EXPECT_EQ(emulation::counters().live_bytes, before) << which;
    const std::uint64_t steps = memory.allocations;
    EXPECT_GT(steps, 0U) << which;
    options.device_allocator = memory.allocator();
    for (memory.fails_from = 1; memory.fails_from <= steps; memory.fails_from += 1 + steps / 6) {
      memory.throws = !memory.throws;
      memory.allocations = 0;
      const std::string said = error_of(call);
      EXPECT_TRUE(said.empty() || testing_support::has(said, "the CUDA device ran out of memory"));
      EXPECT_EQ(cudaPeekAtLastError(), cudaSuccess) << which;
      results.clear();
      EXPECT_TRUE(memory.live.empty()) << which << ", " << memory.fails_from << " of " << steps;
    }
  }
}

// Without the memory to find the leaders of all points, the map is a sample's.
TEST_F(EmulatedEdges, LeadersMayFindNoMemory) {
  constexpr std::size_t n = 1 << 16;
  const auto rows = testing_support::made<float>("gauss", n, 4, 5);
  const std::uint64_t expected =
      canonical_hash(convex_hull(PointView::row_major(rows.data(), n, 4)));
  const OnDevice there(rows);
  std::uint64_t led = 0, sampled = 0;
  fail_at_every_step(&emulation::Settings::failing_allocation, [&] {
    keep_memory(0);
    try {
      const Hull hull =
          convex_hull(DevicePointView::row_major(there.data<float>(), n, 4), on_device());
      EXPECT_EQ(canonical_hash(hull), expected);
      const bool of_all =
          testing_support::has(hull.statistics.cull_reason, "the leaders of all points");
      (of_all ? led : sampled) += hull.statistics.filter == UsedFilter::gauge;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::out_of_budget) << e.what();
    }
  });
  EXPECT_GT(led, 0U);
  EXPECT_GT(sampled, 0U);
}

}  // namespace emulated_edges_test
}  // namespace cullhull::testing
