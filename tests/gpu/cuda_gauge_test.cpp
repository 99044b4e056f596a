// On a CUDA device: the GaugeMap keeps what it keeps on the CPU, and hulls are the same bit for
// bit. Skipped, with the reason, where there is no device.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "cuda/gauge.hpp"
#include "cuda/kernels/gauge_kernel.hpp"
#include "cullhull/cullhull.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "parallel/dispatch.hpp"
#include "tests/agreement/canonical_hash.hpp"
#include "tests/agreement/outermost_of_cells.hpp"
#include "tests/gpu/device.hpp"
#include "tests/made_sets.hpp"
#include "tests/thrown.hpp"

namespace cullhull::internal {
namespace cuda_gauge_test {

using cullhull::testing::OnDevice;
using cullhull::testing::short_run;
using namespace testing_support;

class CudaGauge : public ::testing::Test {
 protected:
  void SetUp() override { CULLHULL_NEEDS_DEVICE(); }
};

template <class T>
void strew(std::vector<T>& rows) {
  const double bad[] = {NAN, INFINITY, -INFINITY, 1e38, -3e38, 0x1p126, 0, -0.0, 1e-44};
  for (std::size_t e = 0; e * 7 < rows.size() / 2; ++e)
    rows[e * 7] = static_cast<T>(bad[e % std::size(bad)]);
}

Array<std::uint64_t> on_host(const DeviceIds& found) {
  Array<std::uint64_t> ids(found.count);
  download(ids.data(), found.ids.data(), found.count, nullptr);
  return ids;
}

template <class T>
void expect_same_survivors(const GaugeMap& map, const std::vector<T>& rows, std::size_t n,
                           unsigned d) {
  const Options options;
  const internal::Run run(options);
  const auto view = PointView::row_major(rows.data(), n, d);
  const auto expected = map.survivors(view, run.with_threads(1));
  const std::string what =
      std::to_string(d) + "D " + scalar_name(view.scalar) + " " + std::to_string(n) + " points";
  EXPECT_EQ(survivors_there(map.table(), view, run.with_threads(2)), expected) << what;

  const OnDevice there(rows);
  const auto packed = DevicePointView::row_major(there.data<T>(), n, d);
  EXPECT_EQ(on_host(survivors_of_device_points(map.table(), packed)), expected) << what;
  EXPECT_EQ(survivors_by_pieces(map.table(), packed, run.control), expected) << what;

  // One scalar off the alignment of vectors, and columns.
  std::vector<T> shifted(1 + n * d);
  std::copy_n(rows.data(), n * d, shifted.data() + 1);
  const OnDevice odd(shifted);
  EXPECT_EQ(on_host(survivors_of_device_points(
                map.table(), DevicePointView::row_major(odd.data<T>() + 1, n, d))),
            expected)
      << what;
  const OnDevice turned(transposed(rows, d));
  EXPECT_EQ(on_host(survivors_of_device_points(
                map.table(), DevicePointView::column_major(turned.data<T>(), n, d))),
            expected)
      << what;
}

TEST_F(CudaGauge, SurvivorsAreThoseOfTheCpu) {
  for (unsigned d = 2; d <= 6; ++d) {
    const auto map = GaugeMap::build(cross_polytope(d, 0.125, 1), 0, most_map_nodes());
    ASSERT_TRUE(map);
    for (const std::size_t n :
         {1U, 31U, 32U, 33U, 127U, 128U, 129U, 32767U, 32768U, 32769U, 1000003U}) {
      if (n > 100000 && short_run()) continue;
      auto doubles = uniform_points<double>(d, n, 0.125, 1.2 / d + 0.2, n + d);
      auto floats = uniform_points<float>(d, n, 0.125, 1.2 / d + 0.2, n + d);
      strew(doubles);
      strew(floats);
      expect_same_survivors(*map, doubles, n, d);
      expect_same_survivors(*map, floats, n, d);
    }
  }
}

// A table beyond shared memory is read from global memory; a centre that is no float needs doubles.
TEST_F(CudaGauge, OtherWaysThroughTheKernel) {
  const auto large = GaugeMap::build(cross_polytope(3, 0.125, 1), 200);
  ASSERT_TRUE(large);
  ASSERT_GT(large->table().nodes.size() * sizeof(float), this_device().shared_per_block);
  const auto rows = uniform_points<float>(3, 100000, 0.125, 0.6, 1);
  expect_same_survivors(*large, rows, 100000, 3);

  const auto far = GaugeMap::build(cross_polytope(3, 0x1p23 + 0.75, 1));
  ASSERT_FALSE(far->table().single_precision);
  auto shifted = uniform_points<float>(3, 50000, 0.125, 2, 2);
  for (float& v : shifted) v += 0x1p23F;
  expect_same_survivors(*far, shifted, 50000, 3);
}

TEST_F(CudaGauge, IntegersGoAsDoubles) {
  const auto map = GaugeMap::build(cross_polytope(3, 60, 50));
  std::mt19937_64 random(1);
  std::vector<std::int16_t> rows(30000);
  for (auto& v : rows) v = static_cast<std::int16_t>(random() % 60 + 30);
  const Options options;
  const internal::Run run(options);
  const auto view = PointView::row_major(rows.data(), 10000, 3);
  EXPECT_EQ(survivors_there(map->table(), view, run.with_threads(2)),
            map->survivors(view, run.with_threads(1)));
}

// Several pieces, so that both slots are used more than once. In a short run only the points of the
// host, as those of the device would be one piece.
TEST_F(CudaGauge, ManyPieces) {
  const auto map = GaugeMap::build(cross_polytope(3, 0.125, 1));
  const std::size_t n = short_run() ? 4500001 : 7000001;
  const auto rows = uniform_points<float>(3, n, 0.125, 0.6, 9);
  if (!short_run()) return expect_same_survivors(*map, rows, n, 3);
  const Options options;
  const internal::Run run(options);
  const auto view = PointView::row_major(rows.data(), n, 3);
  EXPECT_EQ(survivors_there(map->table(), view, run.with_threads(2)),
            map->survivors(view, run.with_threads(2)));
}

template <class T>
void expect_same_hull(const std::vector<T>& rows, std::size_t n, unsigned d,
                      const std::string& what) {
  Options plain;
  plain.cull = CullMethod::none;
  plain.backend = Backend::cpu;
  const auto view = PointView::row_major(rows.data(), n, d);
  const std::uint64_t expected = canonical_hash(convex_hull(view, plain));
  const OnDevice there(rows);
  const auto device = DevicePointView::row_major(there.data<T>(), n, d);
  for (const CullMethod method : {CullMethod::automatic, CullMethod::gauge, CullMethod::none}) {
    for (const Backend backend : {Backend::automatic, Backend::cpu, Backend::cuda}) {
      Options options;
      options.cull = method;
      options.backend = backend;
      EXPECT_EQ(canonical_hash(convex_hull(device, options)), expected) << what;
      EXPECT_EQ(canonical_hash(convex_hull(view, options)), expected) << what;
    }
  }
}

TEST_F(CudaGauge, HullsAreTheSameBitForBit) {
  for (unsigned d = 2; d <= 6; ++d) {
    const std::size_t whole = d < 4 ? 200000 : d == 4 ? 50000 : 3000;
    const std::size_t n = !short_run() ? whole : d < 5 ? 20000 : 800;
    const auto rows = made<float>("ball", n, d, d);
    expect_same_hull(rows, n, d, std::to_string(d) + "D ball");
    expect_same_hull(std::vector<double>(rows.begin(), rows.end()), n, d,
                     std::to_string(d) + "D ball, f64");
  }
  const std::size_t on_sphere = short_run() ? 12000 : 20000;
  expect_same_hull(made<float>("sphere", on_sphere, 3, 3), on_sphere, 3, "sphere");
  std::vector<float> grid;  // ties, coplanar points, duplicates
  const int side = short_run() ? 24 : 40;
  for (int i = 0; i < side; ++i)
    for (int j = 0; j < side; ++j)
      for (int k = 0; k < side; ++k)
        for (const int v : {i, j, k}) grid.push_back(static_cast<float>(v));
  grid.insert(grid.end(), grid.begin(), grid.end() - 3);
  expect_same_hull(grid, grid.size() / 3, 3, "grid");
  std::vector<float> flat = made<float>("ball", short_run() ? 20000 : 100000, 3, 4);
  for (std::size_t i = 0; i < flat.size(); i += 3) flat[i] = 0.5F;
  expect_same_hull(flat, flat.size() / 3, 3, "flat");
  expect_same_hull(std::vector<float>{-0.0F, 1, 2}, 1, 3, "a point");
}

TEST_F(CudaGauge, LeadersAreTheOutermostOfTheirCells) {
  for (unsigned d = 4; d <= 6; ++d) {
    const std::size_t n = 5003;
    const auto map = GaugeMap::build(cross_polytope(d, 0.125, 1));
    auto rows = uniform_points<double>(d, n, 0.125, 1.2 / d + 0.2, d);
    rows[7] = NAN;
    const OnDevice there(rows), turned(transposed(rows, d));
    const auto expected = with_dimension<4, 5, 6>(
        d, [&](auto D) { return outermost_of_cells<D()>(map->table(), 4, rows); });
    ASSERT_GT(expected.size(), 100U);
    for (const auto& view : {DevicePointView::row_major(there.data<double>(), n, d),
                             DevicePointView::column_major(turned.data<double>(), n, d)}) {
      const auto found = on_host(outermost_there(map->table(), 4, view));
      EXPECT_EQ(std::vector<std::uint64_t>(found.begin(), found.end()), expected) << d;
    }
  }
}

// The least number of points for which leaders are looked for.
TEST_F(CudaGauge, LeadersOfAllPointsMakeTheMap) {
  const std::size_t n = 1 << 16;
  for (const auto& [shape, d] : {std::pair{"ball", 4U}, {"gauss", 5U}}) {
    const auto rows = made<float>(shape, n, d, d);
    const OnDevice there(rows);
    Options options;
    const auto view = PointView::row_major(rows.data(), n, d);
    const Hull expected = convex_hull(view, options);
    options.backend = Backend::cuda;
    const Hull hull = convex_hull(DevicePointView::row_major(there.data<float>(), n, d), options);
    EXPECT_EQ(canonical_hash(hull), canonical_hash(expected));
    EXPECT_TRUE(has(hull.statistics.cull_reason, "the leaders of all points"));
    EXPECT_FALSE(has(hull.statistics.cull_reason, "a second map")) << hull.statistics.cull_reason;
  }
}

// Of points of the host the CPU makes the first map, of a sample.
TEST_F(CudaGauge, LeadersOfWhatAMapLeft) {
  const std::size_t n = 1 << 18;
  const auto rows = made<float>("ball", n, 4, 6);
  const auto view = PointView::row_major(rows.data(), n, 4);
  Options options;
  const Hull expected = convex_hull(view, options);
  options.backend = Backend::cuda;
  const Hull hull = convex_hull(view, options);
  EXPECT_EQ(canonical_hash(hull), canonical_hash(expected));
  EXPECT_TRUE(has(hull.statistics.cull_reason, "a second map: of the leaders of all"));
  EXPECT_LE(hull.statistics.survivors, expected.statistics.survivors * 11 / 10);
}

TEST_F(CudaGauge, TheFirstPointThatIsNotFiniteIsNamed) {
  const std::size_t n = 300000;
  bool cull_alone = false;  // hull and cull filter alike: in a short run they take turns
  for (const std::size_t bad : {std::size_t{0}, std::size_t{123456}, n - 1}) {
    auto rows = made<float>("ball", n, 3, 5);
    for (std::size_t i = bad; i < n; i += 1000) rows[3 * i + 1] = NAN;
    const OnDevice there(rows);
    for (const CullMethod method : {CullMethod::automatic, CullMethod::gauge, CullMethod::none}) {
      Options options;
      options.cull = method;
      options.backend = Backend::cuda;
      cull_alone = !cull_alone;
      for (const bool whole : {false, true}) {
        if (short_run() && whole == cull_alone) continue;
        const auto view = DevicePointView::row_major(there.data<float>(), n, 3);
        EXPECT_TRUE(has(error_of(
                            ErrorCode::not_finite,
                            [&] {
          if (whole)
            convex_hull(view, options);
          else
            cull(view, options);
                            }),
                        "point " + std::to_string(bad) + ","));
      }
    }
  }
}

TEST_F(CudaGauge, ViewsThatNoDeviceReadsAreRefused) {
  const std::vector<float> host(300, 0.0F);
  const OnDevice there(host);
  DevicePointView odd = DevicePointView::row_major(there.data<float>(), 90, 3);
  odd.point_stride = 13;
  for (const DevicePointView& view : {DevicePointView::row_major(host.data(), 100, 3), odd})
    error_of(ErrorCode::invalid_argument, [&] { convex_hull(view); });
}

// The caller's stream may still be writing the points when the call begins.
TEST_F(CudaGauge, WorkIsOrderedBehindTheStream) {
  const std::size_t n = short_run() ? 300000 : 1000000;  // either is worth two filters
  const auto rows = made<float>("ball", n, 3, 6);
  const CudaStream stream;
  const OnDevice there(std::vector<float>(rows.size()));
  const std::shared_ptr<float> memory = pinned<float>(rows.size());
  std::copy(rows.begin(), rows.end(), memory.get());
  check(cudaMemcpyAsync(there.data<float>(), memory.get(), rows.size() * sizeof(float),
                        cudaMemcpyHostToDevice, stream.get()),
        "copying");
  Options options;
  options.backend = Backend::cuda;
  const Hull hull =
      convex_hull(DevicePointView::row_major(there.data<float>(), n, 3, stream.get()), options);
  EXPECT_EQ(hull.statistics.backend, Backend::cuda);
  EXPECT_EQ(canonical_hash(hull),
            canonical_hash(convex_hull(PointView::row_major(rows.data(), n, 3))));
}

}  // namespace cuda_gauge_test
}  // namespace cullhull::internal
