// The PseudoHull on the device equals the host's, bit for bit, in every round; what it drops lies
// strictly inside by exact arithmetic.
#include <gtest/gtest.h>

#include <string>

#include "cuda/kernels/pseudo_hull.hpp"
#include "cullhull/cull.hpp"
#include "cullhull/device_points.hpp"
#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/options.hpp"
#include "filter/pseudo_hull/pseudo_hull.hpp"
#include "gpu/device.hpp"
#include "reference/same_rounds.hpp"
#include "reference/slow_hull.hpp"
#include "tests/made_sets.hpp"
#include "tests/thrown.hpp"

namespace cullhull::internal {
namespace pseudo_hull_gpu_test {

const Options defaults;

using testing::OnDevice;
using testing::Stream;
using testing_support::each_awkward_set;
using testing_support::normal_points;

void expect_as_on_the_host(const PointView& host, const OnDevice& device, unsigned subsets,
                           unsigned max_rounds, const std::string& name) {
  const Stream stream;
  std::vector<PseudoHullRound> rounds, expected;
  const auto got = pseudo_hull_survivors_cuda(device.view(host, stream), {subsets, max_rounds},
                                              internal::Run(defaults).control, &rounds);
  EXPECT_EQ(got, pseudo_hull_survivors(host, {subsets, max_rounds},
                                       internal::Run(defaults).with_threads(0), &expected))
      << name << ", " << host.dimension << "D, " << host.count << " points, " << subsets
      << " subsets, " << max_rounds << " rounds";
  testing_support::expect_same_rounds(rounds, expected, name);
}

template <class T>
void expect_as_on_the_host(const std::vector<T>& points, const PointView& host,
                           const std::string& name) {
  const OnDevice device(points);
  if (testing::short_run()) return expect_as_on_the_host(host, device, 2, 100, name);
  for (const unsigned subsets : {1U, 3U})
    for (const unsigned max_rounds : {0U, 2U, 100U})
      expect_as_on_the_host(host, device, subsets, max_rounds, name);
}

template <class T>
void expect_agreement(unsigned d) {
  const std::size_t n = testing::short_run() ? 1100 : d <= 4 ? 6000 : 2500;
  testing_support::each_normal_layout<T>(
      n, d, 41 * d, [](const auto& points, const PointView& view, const char* name) {
        expect_as_on_the_host(points, view, name);
      });
}

TEST(PseudoHullGpu, EqualsTheHostInEveryRound) {
  CULLHULL_NEEDS_DEVICE();
  for (unsigned d = 2; d <= pseudo_hull_cuda_max_dimension; ++d) {
    expect_agreement<float>(d);
    expect_agreement<double>(d);
  }
}

TEST(PseudoHullGpu, FewPointsAndBordersOfBlocks) {
  CULLHULL_NEEDS_DEVICE();
  for (const std::size_t n : {0, 1, 2, 3, 4, 5, 31, 32, 33, 255, 256, 257, 511, 512, 513, 1535})
    for (const unsigned d : {2U, 3U}) {
      const std::vector<float> p = normal_points<float>(n, d, 7 + n, 0);
      expect_as_on_the_host(p, PointView::row_major(p.data(), n, d), "few");
    }
}

TEST(PseudoHullGpu, FlatTinyHugeAndNotFinite) {
  CULLHULL_NEEDS_DEVICE();
  each_awkward_set(1500, [](const auto& rows, const std::string& name) {
    expect_as_on_the_host(rows, PointView::row_major(rows.data(), rows.size() / 3, 3), name);
  });
}

TEST(PseudoHullGpu, WhatItDropsIsStrictlyInsideExactly) {
  CULLHULL_NEEDS_DEVICE();
  for (unsigned d = 2; d <= 4; ++d)
    for (const double step : {0.0, 0.25}) {
      const std::size_t n = d == 4 ? 150 : 500;
      const std::vector<double> p = normal_points<double>(n, d, 3 * d, step);
      const reference::SlowHull hull(p, d);
      const PointView view = PointView::row_major(p.data(), n, d);
      const OnDevice device(p);
      const Stream stream;
      const auto kept = pseudo_hull_survivors_cuda(device.view(view, stream), {},
                                                   internal::Run(defaults).control);
      EXPECT_LT(kept.size(), n);
      for (std::uint64_t i = 0, k = 0; i < n; ++i) {
        if (k < kept.size() && kept[k] == i)
          ++k;
        else
          EXPECT_EQ(hull.locate(hull.point(static_cast<std::uint32_t>(i))), -1) << d << "D " << i;
      }
    }
}

TEST(PseudoHullGpu, RefusesPointsThatADeviceCannotRead) {
  CULLHULL_NEEDS_DEVICE();
  const std::vector<float> good = normal_points<float>(300, 3, 1, 0);
  const OnDevice device(good);
  const Stream stream;
  const PointView all = PointView::row_major(good.data(), 300, 3);
  Options options;
  options.backend = Backend::cuda;
  options.cull = CullMethod::pseudo_hull;
  const auto expect_refused = [&](DevicePointView view) {
    testing_support::error_of(ErrorCode::invalid_argument, [&] { convex_hull(view, options); });
  };
  DevicePointView crooked = device.view(all, stream), integers = crooked;
  crooked.data = static_cast<const std::byte*>(crooked.data) + 2;
  crooked.count = 10;
  integers.scalar = ScalarType::i32;
  expect_refused(crooked);
  expect_refused(integers);
  // The device works as before.
  expect_as_on_the_host(good, all, "after an error");
}

// Beyond what a checker of memory accesses has the patience for.
TEST(PseudoHullGpuLarge, EqualsTheHost) {
  CULLHULL_NEEDS_DEVICE();
  struct Case {
    std::size_t n;
    unsigned d;
    double step;
  };
  for (const Case c : {Case{3'000'000, 3, 0}, Case{2'000'000, 2, 0}, Case{500'000, 4, 0},
                       Case{1'000'000, 3, 0.0625}}) {
    const std::size_t n = testing::short_run() ? c.n / 10 : c.n;
    const std::vector<float> p = normal_points<float>(n, c.d, c.n + c.d, c.step);
    const PointView view = PointView::row_major(p.data(), n, c.d);
    const OnDevice device(p);
    for (const unsigned subsets : {1U, 4U})
      expect_as_on_the_host(view, device, subsets, 100, "large");
  }
}

}  // namespace pseudo_hull_gpu_test
}  // namespace cullhull::internal
