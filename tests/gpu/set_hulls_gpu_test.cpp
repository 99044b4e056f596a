// On a CUDA device: many small hulls of points that lie there are the CPU's batch, bit for bit.
// Skipped, with the reason, where there is no device.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "cullhull/cullhull.hpp"
#include "tests/gpu/device.hpp"
#include "tests/gpu/same_batch.hpp"
#include "tests/thrown.hpp"

namespace cullhull::testing {
namespace {

using testing_support::error_of;

class GpuSets : public ::testing::Test {
 protected:
  void SetUp() override { CULLHULL_NEEDS_DEVICE(); }
};

template <class T>
PointView host_view(const Sets<T>& sets) {
  return PointView::row_major(sets.rows.data(), sets.offsets.back(), sets.d);
}

template <class T>
void expect_the_cpus(const Sets<T>& sets, const std::string& what) {
  SCOPED_TRACE(what);
  const OnDevice there(sets.rows);
  const auto view = DevicePointView::row_major(there.data<T>(), sets.offsets.back(), sets.d);
  const HullBatch expected = convex_hulls(host_view(sets), sets.offsets);
  Options options;
  options.backend = Backend::cuda;  // not the CPU in its stead where memory is short
  expect_same(convex_hulls(view, sets.offsets.data(), sets.count(), options), expected);
  expect_same_lists(convex_hulls_on_device(view, sets.offsets.data(), sets.count(), options),
                    expected);
}

TEST_F(GpuSets, AllSizesAreTheCpusBatch) {
  for (const unsigned d : {2U, 3U}) {
    Sets<float> f32(d);
    Sets<double> f64(d);
    for (std::size_t n = 0; n <= 200; ++n) {
      f32.add_ball(n, n + 1);
      f64.add_ball(n, n + 2);
    }
    expect_the_cpus(f32, "f32, " + std::to_string(d) + "D");
    expect_the_cpus(f64, "f64, " + std::to_string(d) + "D");
  }
}

/// The sizes of sets from 4 to one beyond what a warp takes; in a short run those around the
/// borders of words and classes.
std::vector<std::size_t> sizes_of_sets() {
  std::vector<std::size_t> sizes;
  for (std::size_t n = 4; n <= 129; ++n)
    if (!short_run() || n <= 8 || (n + 1) % 32 <= 2 || n % 10 == 7) sizes.push_back(n);
  return sizes;
}

// All points are vertices or nearly: as many facets, edges and bits as there can be.
template <class T>
Sets<T> extreme_sets(unsigned d) {
  Sets<T> sets(d);
  for (const std::size_t n : sizes_of_sets()) {
    sets.add_sphere(n, n);
    sets.add_sphere(n, n + 1000);
    sets.stretch_last(n, d - 1, n % 2 == 0 ? 0x1p-12 : 0x1p-30);  // thin ellipsoids
    sets.add_sphere(n, n + 2000);
    sets.stretch_last(n, 0, 0x1p8);
    sets.add_sphere(n, n + 3000, n % 2 == 0 ? 0x1p-3 : 0x1p-9);      // caps
    sets.add_sphere(n, n + 4000, 2, n % 2 == 0 ? 0x1p10 : -0x1p16);  // far from the origin
    sets.add_sphere(n, n + 5000, 2, 0x1p-2);
    sets.zero_last(n);
  }
  return sets;
}

TEST_F(GpuSets, SpheresEllipsoidsCapsFarPointsAndNegativeZeros) {
  for (const unsigned d : {2U, 3U}) {
    expect_the_cpus(extreme_sets<float>(d), "f32, " + std::to_string(d) + "D");
    expect_the_cpus(extreme_sets<double>(d), "f64, " + std::to_string(d) + "D");
  }
}

template <class T>
std::size_t open_sets(const Sets<T>& sets) {
  const OnDevice there(sets.rows);
  const auto view = DevicePointView::row_major(there.data<T>(), sets.offsets.back(), sets.d);
  const Options options;
  const internal::Run run(options);
  internal::cuda::SetsOnDevice device(view, run);
  device.find(sets.offsets.data(), static_cast<std::uint32_t>(sets.count()));
  return device.open_sets().size();
}

TEST_F(GpuSets, OrdinarySetsAreDecidedThere) {
  for (const unsigned d : {2U, 3U}) {
    Sets<float> sets(d);
    Sets<double> thin(d);
    for (std::size_t i = 0; i < 200; ++i) {
      sets.add_ball(50, i);
      thin.add_ball(33, i);
      thin.flatten_last(33, 0x1p-30);  // signs that f32 does not have, and doubles do
    }
    EXPECT_EQ(open_sets(sets), 0U) << d;
    EXPECT_LT(open_sets(thin), 50U) << d;
    Sets<double> spheres(d);
    for (std::size_t n = 4; n <= 128; n += 4) spheres.add_sphere(n, n);
    EXPECT_EQ(open_sets(spheres), 0U) << d;  // up to 252 facets
    expect_the_cpus(thin, "thin");
  }
}

TEST_F(GpuSets, SetsThatNeedExactSigns) {
  for (const unsigned d : {2U, 3U}) {
    Sets<double> sets(d);
    for (std::size_t i = 0; i < 60; ++i) {
      sets.add_ball(40, i);
      sets.add_lattice(30, 4, i);  // coplanar points and equal ones
      sets.add_ball(20, i + 1000);
      sets.repeat_last_points(5);  // each twice
      sets.add_ball(25, i + 2000);
      for (std::size_t k = 1; k <= 25; ++k) sets.rows[sets.rows.size() - k * d] = 0.25;  // a flat
      sets.add_ball(33, i + 3000);
      sets.stretch_last(33, 0, 0x1p-40);  // nearly a flat
      sets.add_ball(33, i + 4000);
      sets.flatten_last(33, 0x1p-30);  // signs that f32 does not have
      for (const std::size_t n : {5U, 6U, 7U}) {
        sets.add_ball(n, i + 1000 * n);
        sets.flatten_last(n, i % 2 == 0 ? 0x1p-51 : 0x1p-50);  // signs that doubles do not have
      }
      sets.add_ball(9, i);
      sets.stretch_last(9, d - 1, 0x1p-600);
      sets.add_ball(12, i);
      for (unsigned c = 0; c < d; ++c) sets.stretch_last(12, c, i % 2 == 0 ? 0x1p300 : 0x1p-300);
    }
    expect_the_cpus(sets, std::to_string(d) + "D");
  }
}

TEST_F(GpuSets, OtherDimensionsAndNoSets) {
  for (const unsigned d : {1U, 4U, 5U}) {
    Sets<float> sets(d);
    for (std::size_t n : {0, 1, 7, 30}) sets.add_ball(n, n);
    expect_the_cpus(sets, std::to_string(d) + "D");
  }
  Sets<double> none(3);
  none.rows.assign(30, 1.0);
  none.offsets[0] = 10;
  expect_the_cpus(none, "no sets");
}

TEST_F(GpuSets, AnyStridesAndOffsetsOnTheDevice) {
  Sets<float> sets(3);
  for (std::size_t i = 0; i < 100; ++i) sets.add_ball(20 + i % 50, i);
  const std::uint64_t n = sets.offsets.back();
  std::vector<float> columns(3 * n), wide(5 * n, 1e30F);
  for (std::uint64_t i = 0; i < n; ++i)
    for (unsigned j = 0; j < 3; ++j)
      columns[j * n + i] = wide[5 * i + 1 + j] = sets.rows[3 * i + j];
  const HullBatch expected = convex_hulls(host_view(sets), sets.offsets);
  const OnDevice columns_there(columns), wide_there(wide), offsets_there(sets.offsets);
  const Stream stream;
  auto view = DevicePointView::column_major(columns_there.data<float>(), n, 3, stream);
  expect_same(convex_hulls(view, offsets_there.data<std::uint64_t>(), sets.count()), expected);
  view = DevicePointView::row_major(wide_there.data<float>() + 1, n, 3, stream);
  view.point_stride = 5 * sizeof(float);
  expect_same(convex_hulls(view, sets.offsets.data(), sets.count()), expected);
  expect_same_lists(convex_hulls_on_device(view, offsets_there.data<std::uint64_t>(), sets.count()),
                    expected);
}

TEST_F(GpuSets, ErrorsAreTheCpus) {
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()}) {
    Sets<double> sets(3);
    for (std::size_t i = 0; i < 90; ++i) sets.add_ball(10 + i, i);
    sets.rows[3 * (sets.offsets[60] + 5) + 1] = bad;
    sets.rows[3 * (sets.offsets[33] + 7) + 2] = bad;
    const OnDevice there(sets.rows);
    const auto view = DevicePointView::row_major(there.data<double>(), sets.offsets.back(), 3);
    const auto* offsets = sets.offsets.data();
    const std::string expected = error_of([&] { convex_hulls(host_view(sets), sets.offsets); });
    EXPECT_NE(expected.find("set 33: point 7"), std::string::npos) << expected;
    EXPECT_EQ(error_of([&] { convex_hulls(view, offsets, sets.count()); }), expected);
    EXPECT_EQ(error_of([&] { convex_hulls_on_device(view, offsets, sets.count()); }), expected);
  }
  Sets<float> sets(2);
  for (std::size_t i = 0; i < 5; ++i) sets.add_ball(10, i);
  const OnDevice there(sets.rows);
  const auto view = DevicePointView::row_major(there.data<float>(), 50, 2);
  for (const std::vector<std::uint64_t>& wrong :
       {std::vector<std::uint64_t>{0, 20, 10}, std::vector<std::uint64_t>{0, 20, 51}}) {
    const std::string expected = error_of([&] { convex_hulls(host_view(sets), wrong); });
    EXPECT_EQ(error_of([&] { convex_hulls(view, wrong.data(), 2); }), expected);
    EXPECT_EQ(error_of([&] { convex_hulls_on_device(view, wrong.data(), 2); }), expected);
  }
  EXPECT_EQ(error_of([&] { convex_hulls(view, nullptr, 2); }),
            error_of([&] { convex_hulls(host_view(sets), std::span<const std::uint64_t>()); }));
}

TEST_F(GpuSets, ManySetsInPieces) {
  const std::size_t count = short_run() ? 1300 : 100000;
  for (const unsigned d : {2U, 3U}) {
    Sets<float> sets(d);
    for (std::size_t i = 0; i < count; ++i) sets.add_ball(50, i);
    Options options;
    options.memory_budget = std::uint64_t{1} << 22;  // pieces of some 30,000 points
    const OnDevice there(sets.rows);
    const auto view = DevicePointView::row_major(there.data<float>(), sets.offsets.back(), d);
    const HullBatch expected = convex_hulls(host_view(sets), sets.offsets);
    expect_same(convex_hulls(view, sets.offsets.data(), sets.count(), options), expected);
    expect_same_lists(convex_hulls_on_device(view, sets.offsets.data(), sets.count()), expected);
  }
}

}  // namespace
}  // namespace cullhull::testing
