// What is remembered to the end of a process: devices that cannot be used, one that was lost. A
// program of its own, each test of which wants a process of its own.
#include <cuda_runtime_api.h>
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <string>
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
