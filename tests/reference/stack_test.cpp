// A call needs at most 128 KiB of stack, what a thread has with the C library musl
// (docs/machines.md): less than 80.
#include <gtest/gtest.h>
#if defined(__linux__)
#include <pthread.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

#include "../call_options.hpp"
#include "../made_sets.hpp"
#include "../sanitized.hpp"
#include "cullhull/cullhull.hpp"

namespace cullhull::stack_test {

using testing_support::normal_points;
using testing_support::options_of;

constexpr unsigned char untouched = 0xA5;

struct Call {
  std::function<void()> work;
  unsigned char* begin = nullptr;  // of the stack, where the call is made
};

void* run_call(void* argument) {
  Call& call = *static_cast<Call*>(argument);
  call.begin = static_cast<unsigned char*>(__builtin_frame_address(0));
  call.work();
  return nullptr;
}

/// The bytes of stack between the frame of a thread's function and the lowest that `work` changes.
std::size_t stack_of(std::function<void()> work) {
  std::vector<unsigned char> stack(std::size_t{1} << 20, untouched);
  Call call{std::move(work)};
  pthread_attr_t attributes;
  pthread_attr_init(&attributes);
  pthread_attr_setstack(&attributes, stack.data(), stack.size());
  pthread_t thread;
  EXPECT_EQ(pthread_create(&thread, &attributes, run_call, &call), 0);
  pthread_join(thread, nullptr);
  pthread_attr_destroy(&attributes);
  const auto touched =
      std::find_if(stack.begin(), stack.end(), [](unsigned char b) { return b != untouched; });
  return static_cast<std::size_t>(call.begin - &*touched);
}

/// Sets that take each way to a hull: few points, in general position and on a lattice, many.
std::vector<std::vector<double>> sets_of(unsigned d) {
  std::vector<std::vector<double>> sets;
  for (const double step : {0.0, 0.25})
    for (const std::size_t n : {10, d > 4 ? 12 : 100, d > 3 ? 14 : 2'000})
      sets.push_back(normal_points<double>(n, d, 1, step));
  if (d < 4) sets.push_back(testing_support::made<double>("sphere", 2'048, d, 1));
  sets.push_back(normal_points<double>(d > 6 ? 1'000 : 30'000, d, 2, 0x1p-10));
  for (double& x : sets.back()) x /= 64;
  for (unsigned j = 0; j < 2 * d * d; ++j)  // the corners of a cross polytope around all others
    sets.back()[j] = j / d / 2 == j % d ? (j / d % 2 == 0 ? 8 : -8) : 0;
  return sets;
}

TEST(Stack, ACallFitsIntoAThreadOfMusl) {
  if (testing::sanitized) GTEST_SKIP() << "sanitizers make frames larger";
  const auto call = [](const char* name, unsigned d, const std::function<void()>& work) {
    EXPECT_LE(stack_of(work), std::size_t{80} << 10) << name << " in " << d << "D";
  };
  const Options options = options_of(1);
  const auto clip_options = options_as<ClipOptions>(options);
  const auto cells_options = options_as<TriangulationOptions>(options);
  for (const unsigned d : {2U, 3U, 4U, 6U, 8U}) {
    for (const std::vector<double>& rows : sets_of(d)) {
      const PointView points = PointView::row_major(rows.data(), rows.size() / d, d);
      Hull hull;
      std::vector<std::uint8_t> inside(rows.size());
      call("convex_hull", d, [&] { hull = convex_hull(points, options); });
      call("extreme_points", d, [&] { extreme_points(points, options); });
      call("certify", d, [&] { certify(points, hull, options); });
      const PointView few =
          PointView::row_major(rows.data(), std::min<std::uint64_t>(points.count, 100), d);
      call("HullQuery", d,
           [&] { HullQuery(points, hull, options).contains(few, inside.data(), options); });
      call("convex_hulls", d, [&] {
        convex_hulls(points, std::vector<std::uint64_t>{0, points.count / 2, points.count},
                     options);
      });
      call("HullStream", d, [&] {
        HullStream stream(options);
        stream.push(points);
        stream.hull();
      });
      if (d > 5 || points.count > (d > 3 ? 200 : 2'000)) continue;
      Triangulation cells;
      call("delaunay", d, [&] { cells = delaunay(points, cells_options); });
      call("certify cells", d, [&] { certify(points, cells, cells_options); });
      if (cells.affine_dimension != static_cast<int>(d)) continue;
      Voronoi diagram;
      call("voronoi", d, [&] { diagram = voronoi(points, cells, {}, options); });
      call("alpha_shape", d, [&] { alpha_shape(points, cells, 1, options); });
      if (d > 3) continue;
      const std::vector<double> low(d, -9), high(d, 9);
      call("clip_voronoi", d, [&] { clip_voronoi(points, cells, low, high, {}, clip_options); });
    }
  }
}

}  // namespace cullhull::stack_test
#endif
