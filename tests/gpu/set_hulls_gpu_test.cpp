// On a CUDA device: many small hulls of points that lie there are the CPU's batch, bit for bit.
// Skipped, with the reason, where there is no device.
#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

#include "cullhull/cullhull.hpp"
#include "parallel/threads/run.hpp"
#include "tests/gpu/device.hpp"
#include "tests/gpu/same_batch.hpp"
#include "tests/thrown.hpp"

namespace cullhull::testing {
namespace set_hulls_gpu_test {

using testing_support::error_of;

class GpuSets : public ::testing::Test {
 protected:
  void SetUp() override { CULLHULL_NEEDS_DEVICE(); }
};

template <class T>
PointView host_view(const Sets<T>& sets) {
  return PointView::row_major(sets.rows.data(), sets.offsets.back(), sets.d);
}

/// Planes and measures beside the lists, end to end and padded.
void expect_all_left_there(const DevicePointView& points, const std::uint64_t* offsets,
                           const HullBatch& expected, const Options& options = {}) {
  for (const bool padded : {false, true}) {
    SCOPED_TRACE(padded ? "padded" : "end to end");
    const DeviceHullBatch left =
        convex_hulls_on_device(points, offsets, expected.size(), options,
                               {.planes = true, .measures = true, .padded = padded});
    EXPECT_TRUE(left.volumes != nullptr && left.areas != nullptr && left.centroids != nullptr &&
                left.planes != nullptr);
    expect_same_lists(left, expected);
  }
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
  expect_all_left_there(view, sets.offsets.data(), expected, options);
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
std::size_t open_sets(const Sets<T>& sets, bool measured = false) {
  const OnDevice there(sets.rows);
  const auto view = DevicePointView::row_major(there.data<T>(), sets.offsets.back(), sets.d);
  const Options options;
  const internal::Run run(options);
  const auto device = internal::sets_on_device(view, run);
  device->find(sets.offsets.data(), static_cast<std::uint32_t>(sets.count()), measured);
  return device->open_sets().size();
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

/// In one batch: ordinary sets of points in space that a warp reads where they are, of which some
/// 640 may be vertices; what such a set may be but for that; sets that are larger or small.
template <class T>
Sets<T> larger_sets(const std::vector<std::size_t>& sizes) {
  Sets<T> sets(3);
  for (const std::size_t n : sizes) {
    sets.add_ball(n, n);
    sets.add_sphere(n, n + 1);
    sets.add_sphere(n, n + 2, 0x1p-5, 0x1p10);  // equal points, and points in one plane
    sets.add_lattice(n, 1U << 20, n + 3);
    sets.add_lattice(n, 9, n + 4);
    sets.add_ball(n, n + 5);
    sets.stretch_last(n, 1, 0x1p-20);
    sets.add_ball(n, n + 6);
    sets.flatten_last(n, sizeof(T) == 8 ? 0x1p-30 : 0x1p-12);
    sets.add_ball(n, n + 7);
    sets.repeat_last_points(n / 10);
    sets.add_ball(n, n + 8);
    sets.stretch_last(n, 2, 0);  // a flat
    for (const std::size_t few : {std::size_t{0}, n % 7, n % 101}) sets.add_ball(few, n + few);
  }
  return sets;
}

TEST_F(GpuSets, LargerSetsAreTheCpusBatch) {
  std::vector<std::size_t> sizes{129, 256, 257, 512, 513};
  if (!short_run()) sizes.insert(sizes.end(), {1000, 3000, 10000, 16384, 16385});
  expect_the_cpus(larger_sets<float>(sizes), "f32");
  if (!short_run()) sizes.push_back(5000);
  expect_the_cpus(larger_sets<double>(sizes), "f64");
}

TEST_F(GpuSets, LargerSetsAreDecidedThere) {
  Sets<float> balls(3);
  for (const std::size_t n : {200, 400, 800, 3000}) balls.add_ball(n, n);
  if (!short_run())
    for (const std::size_t n : {5000, 10000, 16384}) balls.add_ball(n, n);
  EXPECT_EQ(open_sets(balls), 0U);
  Sets<double> spheres(3);
  spheres.add_sphere(642, 1);
  EXPECT_EQ(open_sets(spheres), 0U);  // 1,280 facets
  spheres.add_sphere(643, 2);
  EXPECT_EQ(open_sets(spheres), 1U);
  expect_the_cpus(spheres, "as many facets as there is room for");
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

TEST_F(GpuSets, MeasuresOfOrdinarySetsAreMadeThere) {
  for (const unsigned d : {2U, 3U}) {
    Sets<float> sets(d);
    for (std::size_t i = 0; i < 200; ++i) sets.add_ball(50, i);
    EXPECT_LT(open_sets(sets, true), 10U) << d;  // facets so thin that normals need more bits
    expect_the_cpus(sets, "balls");
  }
}

/// The ends of all axes, at different distances: the centroid is the origin.
template <class T>
void add_cross(Sets<T>& sets, double size) {
  for (unsigned c = 0; c < sets.d; ++c)
    for (const double side : {size, -size})
      for (unsigned j = 0; j < sets.d; ++j)
        sets.rows.push_back(static_cast<T>(j == c ? side * (1 + c) : c % 2 == 0 ? 0.0 : -0.0));
  sets.end_set();
}

/// A simplex with a facet so nearly orthogonal to the first axis that what tilts it is below the
/// least normal number, once coordinates are scaled.
void add_tilted(Sets<double>& sets) {
  for (unsigned i = 0; i <= sets.d; ++i)
    for (unsigned c = 0; c < sets.d; ++c)
      sets.rows.push_back(c != 0        ? (i == c ? 0x1.8p39 : 0)
                          : i == sets.d ? 0x1p39
                                        : (i + 1) * 0x1.8p-1060);
  sets.end_set();
}

TEST_F(GpuSets, PlanesAndMeasuresThatNeedMoreThanDoubles) {
  for (const unsigned d : {2U, 3U}) {
    Sets<double> sets(d);
    for (std::size_t i = 0; i < 30; ++i) {
      for (const double power : {0x1p-98, 0x1p-42, 0x1p-40, 0x1p39, 0x1p40, 0x1p41, 0x1p98}) {
        sets.add_ball(12, i);
        for (unsigned c = 0; c < d; ++c) sets.stretch_last(12, c, power);
      }
      add_cross(sets, 1);
      add_cross(sets, 0x1p-20);
      sets.add_sphere(20, i, 2, 0x1p25);  // a small hull far from the origin
      sets.add_ball(20, i);
      sets.stretch_last(20, 0, 0x1p-44);  // thin facets, a thin hull
      sets.add_ball(20, i);
      sets.stretch_last(20, d - 1, 0x1p-140);
      sets.add_ball(15, i);  // two neighbours far away: normals of thin facets
      for (const double shift : {0.0, 0x1p-14})
        for (unsigned c = 0; c < d; ++c) sets.rows.push_back((c == 0 ? 4 : 0) + shift * (c + 1));
      sets.offsets.back() = sets.rows.size() / d;
      add_tilted(sets);
    }
    expect_the_cpus(sets, std::to_string(d) + "D");
  }
}

TEST_F(GpuSets, PaddedRows) {
  for (const unsigned d : {2U, 3U, 4U}) {
    Sets<float> sets(d);
    for (const std::size_t n : {5, 0, 30, 2, 140, 9}) sets.add_ball(n, n);
    sets.add_lattice(20, 2, 1);
    const OnDevice there(sets.rows);
    const auto view = DevicePointView::row_major(there.data<float>(), sets.offsets.back(), d);
    const HullBatch expected = convex_hulls(host_view(sets), sets.offsets);
    const std::uint64_t vertices = expected.vertices[4].size(),
                        simplices = expected.simplices[4].size() / d;
    DeviceBatchOptions options;
    options.padded = true;
    const auto left = [&] {
      return convex_hulls_on_device(view, sets.offsets.data(), sets.count(), {}, options);
    };
    DeviceHullBatch batch = left();
    EXPECT_EQ(batch.vertex_width, vertices);
    EXPECT_EQ(batch.simplex_width, simplices);
    EXPECT_EQ(batch.planes, nullptr);
    EXPECT_EQ(batch.volumes, nullptr);
    expect_same_lists(batch, expected);
    options.planes = true;
    options.most_vertices = vertices + 3;
    options.most_simplices = simplices + 7;
    batch = left();
    EXPECT_EQ(batch.vertex_width, vertices + 3);
    EXPECT_EQ(batch.simplex_width, simplices + 7);
    EXPECT_EQ(batch.volumes, nullptr);
    expect_same_lists(batch, expected);
    options.most_vertices = vertices - 1;
    EXPECT_EQ(error_of(left), "0 set 4 has " + std::to_string(vertices) +
                                  " vertices, and a padded row has room for " +
                                  std::to_string(vertices - 1));
    options.most_vertices = 0;
    options.most_simplices = simplices - 1;
    EXPECT_EQ(error_of(left), "0 set 4 has " + std::to_string(simplices) +
                                  " simplices, and a padded row has room for " +
                                  std::to_string(simplices - 1));
    options.most_simplices = std::uint64_t{1} << 63;
    EXPECT_EQ(error_of(left), "4 no device has memory for rows of this length");
  }
  Sets<double> empty(3);
  for (unsigned i = 0; i < 3; ++i) empty.end_set();
  expect_the_cpus(empty, "empty sets");
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
    for (std::size_t i = 0; i < 90; ++i) sets.add_ball(i % 2 == 0 ? 10 + i : 100 + i, i);
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
    if (!short_run()) expect_all_left_there(view, sets.offsets.data(), expected);
  }
}

}  // namespace set_hulls_gpu_test
}  // namespace cullhull::testing
