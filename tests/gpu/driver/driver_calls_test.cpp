// Without a device, over a driver that counts its calls: `auto` does not start it for points in the
// host's memory. One test, since what a process has loaded stays.
#include <dlfcn.h>
#include <gtest/gtest.h>

#include <vector>

#include "cullhull/cullhull.hpp"
#include "cullhull/device_points.hpp"
#include "cullhull/generate.hpp"

namespace cullhull::testing {
namespace {

bool loaded() {
  void* const driver = ::dlopen("libcuda.so.1", RTLD_LAZY | RTLD_NOLOAD);
  if (driver == nullptr) return false;
  ::dlclose(driver);
  return true;
}

TEST(DriverCalls, AutomaticOnHostPointsDoesNotStartTheDriver) {
  const std::vector<double> rows = generate("ball", 300000, 3);
  const auto points = PointView::row_major(rows.data(), rows.size() / 3, 3);
  const Hull hull = convex_hull(points);
  EXPECT_EQ(hull.statistics.backend, Backend::cpu);
  (void)cull(points);
  (void)HullTracker().update(points);
  EXPECT_EQ(chosen_cuda_device(), -1);
  ASSERT_FALSE(loaded());

  // The driver is loaded, as by another library, but not started.
  void* const driver = ::dlopen("libcuda.so.1", RTLD_LAZY);
  ASSERT_NE(driver, nullptr) << ::dlerror();
  auto* const calls = reinterpret_cast<int (*)()>(::dlsym(driver, "stub_driver_calls"));
  auto* const start = reinterpret_cast<void (*)(int)>(::dlsym(driver, "stub_driver_start"));
  ASSERT_NE(calls, nullptr) << "not the test's driver";
  ASSERT_NE(start, nullptr);
  (void)convex_hull(points);
  EXPECT_EQ(chosen_cuda_device(), -1);
  start(-1);
  EXPECT_EQ(chosen_cuda_device(), -1);
  start(3);
  EXPECT_EQ(chosen_cuda_device(), 3);
  EXPECT_EQ(calls(), 0);

  // Whoever asks for a device starts it.
  Options cuda;
  cuda.backend = Backend::cuda;
  EXPECT_THROW((void)convex_hull(points, cuda), Error);
  EXPECT_GT(calls(), 0);
  EXPECT_EQ(current_cuda_device(), -1);
}

}  // namespace
}  // namespace cullhull::testing
