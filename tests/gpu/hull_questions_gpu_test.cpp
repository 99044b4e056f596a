// On a CUDA device: what a hull answers about points that lie there is what it answers about the
// same points on the host. Skipped, with the reason, where there is no device.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "cuda/hull_questions.hpp"
#include "cullhull/cullhull.hpp"
#include "query/device_questions.hpp"
#include "tests/gpu/device.hpp"
#include "tests/gpu/same_batch.hpp"
#include "tests/thrown.hpp"

namespace cullhull::testing {
namespace {

using testing_support::error_of;

class GpuQuestions : public ::testing::Test {
 protected:
  void SetUp() override { CULLHULL_NEEDS_DEVICE(); }
};

template <class T>
std::vector<T> ball_of(unsigned d, std::size_t n, std::uint64_t seed, double radius) {
  Sets<T> sets(d);
  sets.add_ball(n, seed);
  for (T& v : sets.rows) v = static_cast<T>(v * radius);
  return sets.rows;
}

/// Not the CPU in its stead where memory is short.
Options on_device() {
  Options options;
  options.backend = Backend::cuda;
  return options;
}

/// All answers, of both; `options` for the device.
template <class T>
void expect_the_same(const HullQuery& query, const std::vector<T>& rows, unsigned d,
                     const Options& options = on_device()) {
  const std::size_t n = rows.size() / d;
  const auto here = PointView::row_major(rows.data(), n, d);
  const OnDevice copy(rows);
  const Stream stream;
  const auto there = DevicePointView::row_major(copy.data<T>(), n, d, stream);
  std::vector<std::uint8_t> in(n), in_there(n);
  query.contains(here, in.data());
  query.contains(there, in_there.data(), options);
  expect_same_bits(in_there, in, "contains");
  std::vector<Side> side(n), side_there(n);
  query.sides(here, side.data());
  query.sides(there, side_there.data(), options);
  ASSERT_EQ(side_there, side);
  std::vector<std::uint64_t> vertex(n), vertex_there(n);
  query.supports(here, vertex.data());
  query.supports(there, vertex_there.data(), options);
  expect_same_bits(vertex_there, vertex, "supports");
  std::vector<double> distance(n), distance_there(n);
  query.signed_distances(here, distance.data());
  query.signed_distances(there, distance_there.data(), options);
  expect_same_bits(distance_there, distance, "distances");
}

template <class T>
HullQuery query_of(const std::vector<T>& rows, unsigned d) {
  const auto view = PointView::row_major(rows.data(), rows.size() / d, d);
  return {view, convex_hull(view)};
}

TEST_F(GpuQuestions, PointsInsideAndOutsideOfBalls) {
  const std::size_t n = short_run() ? 3000 : 100000;
  for (unsigned d = 2; d <= 6; ++d) {
    SCOPED_TRACE(std::to_string(d) + "D");
    const HullQuery query = query_of(ball_of<double>(d, d > 4 ? 60 : 300, 1, 1), d);
    expect_the_same(query, ball_of<double>(d, d > 3 ? n / 10 : n, 2, 1.2), d);
    expect_the_same(query, ball_of<float>(d, n / 10, 3, 1.2), d);
    expect_the_same(query, ball_of<float>(d, 50, 4, 1e-30), d);  // directions of any length
    expect_the_same(query, ball_of<double>(d, 50, 4, 1e300), d);
  }
}

// Corners, points on facets, equal products: nothing that doubles decide.
TEST_F(GpuQuestions, PointsOnACube) {
  for (const unsigned d : {2U, 3U, 4U}) {
    SCOPED_TRACE(std::to_string(d) + "D");
    std::vector<double> lattice;
    std::size_t count = 1;
    for (unsigned j = 0; j < d; ++j) count *= 5;
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0, rest = i; j < d; ++j, rest /= 5)
        lattice.push_back((static_cast<double>(rest % 5) - 2) / 2);
    expect_the_same(query_of(lattice, d), lattice, d);
    for (double& v : lattice) v *= 1.5;
    expect_the_same(query_of(ball_of<double>(d, 200, 7, 1), d), lattice, d);
  }
}

// The products of two vertices of a sphere with their sum are equal but for rounding.
TEST_F(GpuQuestions, DirectionsBetweenTwoVertices) {
  for (const unsigned d : {2U, 3U}) {
    SCOPED_TRACE(std::to_string(d) + "D");
    Sets<double> sphere(d);
    sphere.add_sphere(300, 7);
    const auto view = PointView::row_major(sphere.rows.data(), 300, d);
    const Hull hull = convex_hull(view);
    std::vector<double> directions;
    for (std::size_t f = 0; f < hull.simplices.size(); f += d)
      for (unsigned j = 0; j < d; ++j)
        directions.push_back(sphere.rows[hull.simplices[f] * d + j] +
                             sphere.rows[hull.simplices[f + 1] * d + j]);
    expect_the_same(HullQuery(view, hull), directions, d);
  }
}

TEST_F(GpuQuestions, HullsThatTheCpuIsAskedAbout) {
  Options cpu;
  cpu.backend = Backend::cpu;
  const auto points = ball_of<float>(3, 500, 9, 1.5);
  expect_the_same(query_of(ball_of<float>(3, 100, 5, 1), 3), points, 3, cpu);
  auto flat = ball_of<float>(3, 100, 5, 1);
  for (std::size_t i = 0; i < flat.size(); i += 3) flat[i] = 0.5F;
  expect_the_same(query_of(flat, 3), points, 3);
  expect_the_same(query_of(std::vector<float>{1, 2, 3}, 3), points, 3);
  expect_the_same(query_of(ball_of<double>(3, 100, 5, 0x1p120), 3), points, 3);
  expect_the_same(query_of(ball_of<double>(1, 30, 5, 1), 1), ball_of<double>(1, 100, 6, 2), 1);
  expect_the_same(query_of(ball_of<double>(7, 30, 5, 1), 7), ball_of<double>(7, 20, 6, 2), 7);
  expect_the_same(query_of(points, 3), std::vector<float>(), 3);
}

// compute-sanitizer refuses a copy of words that no kernel wrote.
TEST_F(GpuQuestions, DistancesOfPointsThatAreNotInsideAreZero) {
  const internal::InnerPolytope triangle{2, {0, 0, 4, 0, 0, 4}, {0, 1, 1, 2, 2, 0}, {}};
  const std::vector<double> planes{0, -1, 0, 1, 1, -4, -1, 0, 0};
  const auto tables = internal::hull_tables(triangle, planes);
  ASSERT_TRUE(tables);
  const std::vector<double> rows{1, 1, 5, 5, 2, 0};  // inside, outside, on an edge
  const OnDevice copy(rows);
  const internal::QuestionsOnDevice questions(DevicePointView::row_major(copy.data<double>(), 3, 2),
                                              &*tables);
  internal::PointAnswer side[3];
  double distance[3];
  questions.sides(nullptr, 0, 3, side, distance);
  EXPECT_EQ(side[0], internal::PointAnswer::inside);
  EXPECT_EQ(distance[0], -1);
  EXPECT_NE(side[1], internal::PointAnswer::inside);
  EXPECT_EQ(distance[1], 0);
  EXPECT_NE(side[2], internal::PointAnswer::inside);
  EXPECT_EQ(distance[2], 0);
}

TEST_F(GpuQuestions, ErrorsAreTheCpus) {
  const HullQuery query = query_of(ball_of<double>(3, 100, 1, 1), 3);
  auto rows = ball_of<double>(3, 5000, 2, 1.5);
  rows[3 * 4000] = std::numeric_limits<double>::quiet_NaN();
  rows[3 * 3001 + 2] = std::numeric_limits<double>::infinity();
  const OnDevice copy(rows);
  const auto here = PointView::row_major(rows.data(), 5000, 3);
  const auto there = DevicePointView::row_major(copy.data<double>(), 5000, 3);
  std::vector<std::uint8_t> in(5000);
  std::vector<std::uint64_t> vertex(5000);
  std::vector<double> distance(5000);
  const std::string expected = error_of([&] { query.contains(here, in.data()); });
  EXPECT_NE(expected.find("3001"), std::string::npos) << expected;
  EXPECT_EQ(error_of([&] { query.contains(there, in.data()); }), expected);
  EXPECT_EQ(error_of([&] { query.supports(there, vertex.data()); }), expected);
  EXPECT_EQ(error_of([&] { query.signed_distances(there, distance.data()); }), expected);
  const auto other = DevicePointView::row_major(copy.data<double>(), 5000, 2);
  EXPECT_EQ(error_of([&] { query.contains(other, in.data()); }), error_of([&] {
              query.contains(PointView::row_major(rows.data(), 5000, 2), in.data());
            }));
}

}  // namespace
}  // namespace cullhull::testing
