// Choosing the backend: what is asked for, what is there, and what happens otherwise. Holds on
// machines with a device and without, in builds with CUDA and without.
#include <gtest/gtest.h>

#include <functional>
#include <random>
#include <string>
#include <vector>

#include "call_options.hpp"
#include "cullhull/cullhull.hpp"
#include "cullhull/io.hpp"
#include "tests/agreement/canonical_hash.hpp"
#include "tests/rates.hpp"
#include "thrown.hpp"

namespace cullhull::backend_test {

using namespace testing_support;

std::vector<float> cube(std::size_t n, unsigned d) {
  std::mt19937_64 random(n);
  std::uniform_real_distribution<float> unit(-1, 1);
  std::vector<float> rows(n * d);
  for (float& v : rows) v = unit(random);
  return rows;
}

void expect_unavailable(const std::function<void()>& call) {
  EXPECT_EQ(error_of(ErrorCode::backend_unavailable, [&] { call(); }), cuda_status().reason);
}

TEST(Backend, StatusSaysWhy) {
  const CudaStatus status = cuda_status();
  EXPECT_EQ(status.available, status.reason.empty());
  EXPECT_TRUE(status.compiled || !status.available);
  if (status.available) {
    EXPECT_FALSE(status.device.empty());
    EXPECT_GE(status.compute_capability, 75);
  }
}

TEST(Backend, AskedForAndNotThere) {
  if (cuda_status().available) GTEST_SKIP() << "there is a CUDA device";
  const auto rows = cube(100, 3);
  Options options;
  options.backend = Backend::cuda;
  const auto view = PointView::row_major(rows.data(), 100, 3);
  expect_unavailable([&] { convex_hull(view, options); });
  expect_unavailable([&] { cull(view, options); });
  // Points in a device's memory need a device whatever the options say.
  const auto device = DevicePointView::row_major(rows.data(), 100, 3);
  for (const Backend backend : {Backend::automatic, Backend::cpu, Backend::cuda}) {
    options.backend = backend;
    expect_unavailable([&] { convex_hull(device, options); });
    expect_unavailable([&] { cull(device, options); });
  }
}

TEST(Backend, DeviceViewsAreChecked) {
  const auto invalid = [](const DevicePointView& view) {
    error_of(ErrorCode::invalid_argument, [&] { convex_hull(view); });
  };
  const float value = 0;
  invalid(DevicePointView::row_major(&value, 1, 0));
  invalid(DevicePointView::row_major(static_cast<const float*>(nullptr), 1, 3));
  DevicePointView integers = DevicePointView::row_major(&value, 1, 1);
  integers.scalar = ScalarType::i32;
  invalid(integers);
}

// A planner that believes in a miracle of a link: without a device the CPU takes over and the
// reason says so; with one, the result is the same.
TEST(Backend, AutomaticFallsBack) {
  const std::size_t n = 400000;
  const auto rows = cube(n, 3);
  const auto view = PointView::row_major(rows.data(), n, 3);
  Options plain;
  plain.backend = Backend::cpu;
  const Hull expected = convex_hull(view, plain);
  EXPECT_EQ(expected.statistics.backend, Backend::cpu);
  EXPECT_TRUE(has(expected.statistics.cull_reason, "CPU as asked"));

  const testing_support::WithRates miracle({.host_read = 1e3, .host_copy = 1e15, .link = 1e15});
  const Hull hull = convex_hull(view);
  EXPECT_EQ(testing_support::canonical_hash(hull), testing_support::canonical_hash(expected));
  const CudaStatus status = cuda_status();
  EXPECT_EQ(hull.statistics.backend, status.available ? Backend::cuda : Backend::cpu);
  if (!status.available) {
    EXPECT_TRUE(has(hull.statistics.cull_reason, ", but " + status.reason));
  }
}

TEST(Backend, EveryReasonIsALine) {
  const auto rows = cube(200000, 3);
  for (const CullMethod method :
       {CullMethod::automatic, CullMethod::gauge, CullMethod::pseudo_hull, CullMethod::none})
    for (const std::size_t n : {std::size_t{3}, std::size_t{200000}}) {
      const Survivors s = cull(PointView::row_major(rows.data(), n, 3), options_of(0, method));
      EXPECT_FALSE(s.reason.empty());
      EXPECT_FALSE(has(s.reason, "\n"));
      EXPECT_EQ(s.backend, Backend::cpu);
    }
}

}  // namespace cullhull::backend_test
