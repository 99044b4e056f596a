// The surface that is grown and flipped on the device equals the host's, bit for bit, and the hull
// that comes of it is the CPU's.
#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "agreement/canonical_hash.hpp"
#include "cuda/kernels/star_hull.hpp"
#include "cuda/runtime.hpp"
#include "cullhull/device_hull.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/options.hpp"
#include "gpu/device.hpp"
#include "gpu/same_batch.hpp"
#include "reference/same_rounds.hpp"
#include "result/write/star_result.hpp"
#include "tests/made_sets.hpp"

namespace cullhull::internal {
namespace star_hull_gpu_test {

using testing::OnDevice;
using testing::Stream;
using testing_support::canonical_hash;
using testing_support::each_awkward_set;
using testing_support::normal_points;

template <class T>
void expect_as_on_the_host(const std::vector<T>& points, const PointView& host,
                           const std::string& name) {
  const OnDevice device(points);
  const Stream stream;
  const Options options;
  const Run run(options);
  std::vector<PseudoHullRound> rounds, expected;
  const StarHullThere there = star_hull_there(device.view(host, stream), run, {.rounds = &rounds});
  StarHull<SerialExecutor, RowsInPlace<3, T>> here(SerialExecutor{});
  const auto in_place = rows_in_place<3, T>(host, {host.count, 0, 1});
  const auto count = static_cast<std::uint32_t>(host.count);
  const StarCounts counts = here.run(in_place, count, 64, run.control, expected);
  std::vector<std::uint64_t> ids(there.ids.count), wanted;
  download(ids.data(), there.ids.ids.data(), there.ids.count, stream);
  for (std::uint64_t i = 0; i < host.count; ++i)
    if (here.culled()[i] == 0) wanted.push_back(i);
  EXPECT_EQ(ids, wanted) << name;
  EXPECT_EQ(there.counts.vertices, counts.vertices) << name;
  EXPECT_EQ(there.counts.aside, counts.aside) << name;
  EXPECT_EQ(there.counts.end.facets, counts.end.facets) << name;
  EXPECT_EQ(there.counts.end.reflex, counts.end.reflex) << name;
  EXPECT_EQ(there.counts.end.uncertain, counts.end.uncertain) << name;
  StarResult<SerialExecutor, RowsInPlace<3, T>> result;
  StarLists lists;
  if (result.compute(here, in_place, count, counts))
    lists = result.fetch(here.executor(), run, StarWanted::vertices).value_or(StarLists{});
  const TriangleLists& triangles = lists.triangles;
  EXPECT_EQ(there.lists.rows, lists.rows) << name;
  EXPECT_EQ(there.lists.coordinates, lists.coordinates) << name;
  EXPECT_EQ(there.lists.triangles.vertices, triangles.vertices) << name;
  EXPECT_EQ(there.lists.triangles.neighbours, triangles.neighbours) << name;
  EXPECT_EQ(there.lists.triangles.planes, triangles.planes) << name;
  EXPECT_EQ(there.lists.triangles.exponent, triangles.exponent) << name;
  EXPECT_EQ(there.lists.triangles.sums.volume.value(), triangles.sums.volume.value()) << name;
  EXPECT_EQ(there.lists.triangles.sums.area.value(), triangles.sums.area.value()) << name;
  testing_support::expect_same_rounds(rounds, expected, name);
}

template <class T>
void expect_agreement() {
  const std::size_t n = testing::short_run() ? 900 : 20000;
  testing_support::each_normal_layout<T>(
      n, 3, 41, [](const auto& points, const PointView& view, const char* name) {
        expect_as_on_the_host(points, view, name);
      });
  const std::vector<T> p = testing_support::made<T>("sphere", n, 3, 5);
  expect_as_on_the_host(p, PointView::row_major(p.data(), n, 3), "sphere");
}

TEST(StarHullGpu, EqualsTheHost) {
  CULLHULL_NEEDS_DEVICE();
  // Flipping stalls before all edges are convex, and vertices are marked for removal.
  const std::vector<double> stuck = generate("ball", 2000, 3, 57);
  expect_as_on_the_host(stuck, PointView::row_major(stuck.data(), 2000, 3), "stuck");
  expect_agreement<float>();
  expect_agreement<double>();
}

// Signs that rounding decides: planes of points that are turned; and points in a plane with two
// others and the centre, which is that of the four corners.
TEST(StarHullGpu, EqualsTheHostWhereRoundingDecides) {
  CULLHULL_NEEDS_DEVICE();
  std::vector<double> lifted;
  for (int x = -5; x <= 5; ++x)
    for (int y = -5; y <= 5; ++y) {
      const double z = 0.25 * (x * x + y * y);
      lifted.insert(lifted.end(), {0.8 * x - 0.6 * y, 0.48 * x + 0.64 * y - 0.6 * z,
                                   0.36 * x + 0.48 * y + 0.8 * z});
    }
  expect_as_on_the_host(lifted, PointView::row_major(lifted.data(), lifted.size() / 3, 3),
                        "turned lifted lattice");
  std::vector<double> points = {4, 4, 4, 4, -4, -4, -4, 4, -4, -4, -4, 4};
  const std::vector<double> tips = generate("sphere", 30, 3, 12);
  for (std::size_t i = 0; i < 90; ++i) points.push_back(3.9 * tips[i]);
  for (std::size_t i = 0; i < 90; i += 3)
    for (std::size_t j = 0; j < i; j += 3)
      for (unsigned k = 0; k < 3; ++k) points.push_back(1.7 * tips[i + k] + 2.1 * tips[j + k]);
  expect_as_on_the_host(points, PointView::row_major(points.data(), points.size() / 3, 3),
                        "in planes through the centre");
}

TEST(StarHullGpu, FewFlatTinyHugeAndNotFinite) {
  CULLHULL_NEEDS_DEVICE();
  for (const std::size_t n : {0, 1, 3, 4, 5, 31, 33, 257}) {
    const std::vector<float> p = normal_points<float>(n, 3, 7 + n, 0);
    expect_as_on_the_host(p, PointView::row_major(p.data(), n, 3), "few");
  }
  each_awkward_set(600, [](const auto& rows, const std::string& name) {
    expect_as_on_the_host(rows, PointView::row_major(rows.data(), rows.size() / 3, 3), name);
  });
}

// The whole call: points inside are culled before, or every point is a vertex.
TEST(StarHullGpu, HullsAreTheCpus) {
  CULLHULL_NEEDS_DEVICE();
  for (const char* shape : {"ball", "sphere", "cube", "gauss", "lattice"}) {
    const std::size_t n = testing::short_run() ? 20000 : 400000;
    const std::vector<double> doubles = std::string(shape) == "lattice"
                                            ? normal_points<double>(n, 3, 3, 0.25)
                                            : generate(shape, n, 3, 8);
    const std::vector<float> points(doubles.begin(), doubles.end());
    const OnDevice device(points);
    const Stream stream;
    const PointView host = PointView::row_major(points.data(), n, 3);
    Options here, there;
    here.backend = Backend::cpu;
    there.backend = Backend::cuda;
    EXPECT_EQ(canonical_hash(convex_hull(device.view(host, stream), there)),
              canonical_hash(convex_hull(host, here)))
        << shape;
  }
}

/// What is left on the device is what the CPU's hull has, bit for bit.
void expect_left_there(const DeviceHull& there, const Hull& here, const std::string& name) {
  const auto same = [&](const auto* found, const auto& expected, const char* what) {
    testing::expect_same_bits(testing::fetched(found, expected.size()), expected, what);
  };
  ASSERT_EQ(there.affine_dimension, here.affine_dimension) << name;
  ASSERT_EQ(there.vertex_count, here.vertices.size()) << name;
  ASSERT_EQ(there.simplex_count, here.simplex_count()) << name;
  EXPECT_EQ(there.point_count, here.point_count) << name;
  EXPECT_EQ(there.volume, here.volume) << name;
  EXPECT_EQ(there.area, here.area) << name;
  EXPECT_EQ(there.centroid, here.centroid) << name;
  std::vector<double> planes;
  for (std::uint64_t i = 0; i < here.simplex_count(); ++i)
    for (const double v : here.plane(here.simplex_facets[i])) planes.push_back(v);
  const auto ids = [](const auto& list) {
    return std::vector<std::int64_t>(list.begin(), list.end());
  };
  const auto& across = here.simplex_neighbours;
  same(there.vertices, ids(here.vertices), name.c_str());
  same(there.simplices, ids(here.simplices), name.c_str());
  same(there.neighbours, std::vector<std::int32_t>(across.begin(), across.end()), name.c_str());
  same(there.planes, planes, name.c_str());
}

// Left on the device: found there, with a map before or of all points; found by the CPU, in any
// dimension; and of no, one and few points.
TEST(StarHullGpu, HullsLeftOnTheDevice) {
  CULLHULL_NEEDS_DEVICE();
  const std::size_t most = testing::short_run() ? 20000 : 400000;
  Options there, here;
  here.backend = Backend::cpu;
  const auto expect_same = [&](const std::vector<float>& points, unsigned d, Backend backend,
                               bool found, const std::string& name) {
    const OnDevice device(points);
    const Stream stream;
    const PointView host = PointView::row_major(points.data(), points.size() / d, d);
    there.backend = backend;
    const DeviceHull hull = convex_hull_on_device(device.view(host, stream), there);
    expect_left_there(hull, convex_hull(host, here), name);
    EXPECT_EQ(hull.statistics.cull_reason.ends_with("which is the hull"), found) << name;
  };
  // Of a ball's points the map leaves some 35,000, as many as a surface is worth.
  for (const auto& [shape, n] :
       {std::pair("ball", std::size_t{250000}), std::pair("sphere", most)}) {
    const std::vector<double> p = generate(shape, n, 3, 8);
    expect_same({p.begin(), p.end()}, 3, Backend::cuda, true, shape);
  }
  const std::vector<double> gauss = generate("gauss", most, 3, 8);
  expect_same({gauss.begin(), gauss.end()}, 3, Backend::cpu, false, "gauss");
  expect_same(normal_points<float>(most, 3, 3, 0.25), 3, Backend::cuda, false, "lattice");
  for (const unsigned d : {2U, 3U, 4U})
    for (const std::size_t n : {0, 1, 2, 10, 600}) {
      expect_same(normal_points<float>(n, d, 5 + n, 0), d, Backend::automatic, false, "few");
      expect_same(std::vector<float>(n * d, 2), d, Backend::automatic, false, "equal");
    }
}

}  // namespace star_hull_gpu_test
}  // namespace cullhull::internal
