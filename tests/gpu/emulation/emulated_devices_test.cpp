// What is remembered to the end of a process: devices that cannot be used, one that was lost. A
// program of its own, each test of which wants a process of its own.
#include <cuda_runtime_api.h>
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "device_sets.hpp"
#include "emulation.hpp"
#include "memory.hpp"
#include "tests/thrown.hpp"

namespace cullhull::testing {
namespace emulated_devices_test {

using testing_support::canonical_hash;

TEST(EmulatedDevices, PointsOnAnotherDeviceThanTheCurrentOne) {
  emulation::settings().devices = 3;
  emulation::settings().unusable_device = 0;  // too old: nothing of it may be asked
  const auto rows = ball(3, 20000, 4);
  const std::uint64_t expected = plain_hash(rows, 3);
  check(cudaSetDevice(2));
  const OnDevice there(rows);
  check(cudaSetDevice(0));
  const auto view = DevicePointView::row_major(there.data<float>(), 20000, 3);
  for (const CullMethod method : {CullMethod::gauge, CullMethod::pseudo_hull, CullMethod::none})
    EXPECT_EQ(canonical_hash(convex_hull(view, on_device(method))), expected);
  HullTracker tracker(on_device());
  EXPECT_EQ(canonical_hash(tracker.update(view)), expected);
  int current = -1;
  check(cudaGetDevice(&current));
  EXPECT_EQ(current, 0);
}

// Choosing a device without a context would make one, of some hundred MB.
TEST(EmulatedDevices, ADeviceWithoutAContextIsNotChosenAgain) {
  void* const driver = ::dlopen("libcuda.so.1", RTLD_LAZY);
  ASSERT_NE(driver, nullptr) << ::dlerror();
  auto* const unused = reinterpret_cast<void (*)(int)>(::dlsym(driver, "stub_driver_unused"));
  ASSERT_NE(unused, nullptr) << "not the test's driver";
  emulation::settings().devices = 3;
  check(cudaSetDevice(2));
  const auto rows = ball(3, 2000, 4);
  const OnDevice there(rows);
  const auto view = DevicePointView::row_major(there.data<float>(), 2000, 3);
  for (const int other : {-1, 0, 1}) {
    check(cudaSetDevice(0));
    unused(other);
    (void)convex_hull(view, on_device());
    int current = -1;
    check(cudaGetDevice(&current));
    EXPECT_EQ(current, other == 0 ? 2 : 0) << other;
  }
}

TEST(EmulatedDevices, HostPointsGoToTheDeviceThatTheOptionsName) {
  emulation::settings().devices = 2;
  emulation::settings().unusable_device = 0;
  const auto rows = ball(3, 20000, 4);
  Options options = on_device();
  const auto points = PointView::row_major(rows.data(), 20000, 3);
  EXPECT_THROW(convex_hull(points, options), Error);  // the current one
  options.device = 1;
  const Hull hull = convex_hull(points, options);
  EXPECT_EQ(hull.statistics.backend, Backend::cuda);
  EXPECT_EQ(canonical_hash(hull), plain_hash(rows, 3));
  check(cudaSetDevice(1));
  EXPECT_EQ(current_cuda_device(), 1);
  options.device = 2;
  EXPECT_THROW(convex_hull(points, options), Error);
}

// Where a map pays, each device filters a part; a part of fewer than 65,536 points is not worth
// one.
TEST(EmulatedDevices, EveryDeviceFiltersAPartOfTheHostsPoints) {
  emulation::settings().devices = 4;
  emulation::settings().unusable_device = 2;
  Options options = on_device();
  options.device = Options::every_device;
  options.threads = 3;
  const auto caller = std::this_thread::get_id();
  options.progress = [&](const char*, double) { EXPECT_EQ(std::this_thread::get_id(), caller); };
  std::mutex mutex;
  std::set<int> used;
  options.device_allocator = std::make_shared<DeviceAllocator>(DeviceAllocator{
      [&](std::size_t bytes, void*) {
    int device = -1;
    void* memory = nullptr;
    check(cudaGetDevice(&device));
    check(cudaMalloc(&memory, bytes));
    const std::lock_guard lock(mutex);
    used.insert(device);
    return memory;
      },
      [](void* memory, std::size_t, void*) { check(cudaFree(memory)); }});
  struct Case {
    const char* shape;
    std::size_t n, devices;
  };
  for (const Case& c :
       {Case{"ball", 0, 0}, Case{"ball", 1, 0}, Case{"ball", 10, 1}, Case{"ball", 100'000, 1},
        Case{"ball", 140'001, 2}, Case{"ball", 200'000, 3}, Case{"sphere", 8000, 1}}) {
    const auto rows = testing_support::made<float>(c.shape, c.n, 3, 6);
    options.cull = c.shape[0] == 'b' ? CullMethod::gauge : CullMethod::automatic;
    if (c.n == 0) options.cull = CullMethod::automatic;
    used.clear();
    const Hull hull = convex_hull(PointView::row_major(rows.data(), c.n, 3), options);
    EXPECT_EQ(canonical_hash(hull), plain_hash(rows, 3)) << c.n;
    EXPECT_EQ(used.size(), c.devices) << c.n << hull.statistics.cull_reason;
    EXPECT_EQ(testing_support::has(hull.statistics.cull_reason,
                                   "on " + std::to_string(c.devices) + " devices"),
              c.devices > 1)
        << hull.statistics.cull_reason;
  }
  auto rows = ball(3, 200'000, 6);
  rows[3 * 190'000 + 1] = NAN;
  const auto points = PointView::row_major(rows.data(), 200'000, 3);
  EXPECT_TRUE(testing_support::has(
      testing_support::error_of(ErrorCode::not_finite, [&] { convex_hull(points, options); }),
      "point 190000,"));
}

// Unified addressing: a copy may name the memory of devices that are not current.
TEST(EmulatedDevices, CopiesNameMemoryOfAnyDevice) {
  emulation::settings().devices = 3;
  const std::vector<float> numbers{1, 2, 3, 4};
  constexpr std::size_t bytes = 4 * sizeof(float);
  check(cudaSetDevice(1));
  const OnDevice source(numbers);
  check(cudaSetDevice(2));
  const OnDevice target(std::vector<float>(4));
  check(cudaSetDevice(0));
  check(cudaMemcpy(target.data<float>(), source.data<float>(), bytes, cudaMemcpyDeviceToDevice));
  std::vector<float> back(4);
  check(cudaMemcpy(back.data(), target.data<float>(), bytes, cudaMemcpyDeviceToHost));
  EXPECT_EQ(back, numbers);
  check(cudaMemset(source.data<float>(), 0, bytes));
  check(cudaMemcpy(back.data(), source.data<float>(), bytes, cudaMemcpyDeviceToHost));
  EXPECT_EQ(back, std::vector<float>(4));
}

TEST(EmulatedDevices, TheHostFaultsWhereItTouchesADevicesMemory) {
  if (emulation::guard() == emulation::Guard::off) GTEST_SKIP() << "CULLHULL_DEVICE_GUARD=off";
  const OnDevice there(std::vector<float>{1, 2, 3});
  check(cudaDeviceSynchronize());
  volatile float sink = 0;
  EXPECT_DEATH(sink = *there.data<float>(), "");
  (void)sink;
}

TEST(EmulatedDevices, ALostDeviceIsSaidInEveryLaterCall) {
  const auto rows = ball(3, 20000, 6);
  const OnDevice there(rows);
  const auto view = DevicePointView::row_major(there.data<float>(), 20000, 3);
  emulation::restart();
  emulation::settings().failing_launch = 1;
  const auto lost = [&] {
    return testing_support::error_of(ErrorCode::backend_unavailable,
                                     [&] { convex_hull(view, on_device()); });
  };
  (void)lost();
  EXPECT_TRUE(testing_support::has(lost(), "restarted"));
  // The CPU goes on.
  EXPECT_EQ(canonical_hash(convex_hull(PointView::row_major(rows.data(), 20000, 3))),
            plain_hash(rows, 3));
}

}  // namespace emulated_devices_test
}  // namespace cullhull::testing
