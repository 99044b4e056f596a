// On a CUDA device: what a hull answers about points that lie there is what it answers about the
// same points on the host. Skipped, with the reason, where there is no device.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <string>
#include <tuple>
#include <type_traits>
#include <vector>

#include "cuda/hull_questions.hpp"
#include "cullhull/cullhull.hpp"
#include "query/device_questions.hpp"
#include "query/facet_search.hpp"
#include "tests/gpu/device.hpp"
#include "tests/gpu/same_batch.hpp"
#include "tests/rates.hpp"
#include "tests/thrown.hpp"

namespace cullhull::testing {
namespace hull_questions_gpu_test {

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

/// A slow device on a fast link: sides by cells of directions for all but a few dozen facets.
struct ByCells {
  explicit ByCells(const Options& those) : options(those) {}
  operator const Options&() const { return options; }
  const Options& options;
  testing_support::WithRates rates{internal::Rates{.link = 1e12, .device_copy = 1}};
};

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
  query.contains(there, in_there.data(), ByCells(options));
  expect_same_bits(in_there, in, "contains, by cells");
  query.sides(there, side_there.data(), ByCells(options));
  ASSERT_EQ(side_there, side) << "by cells";
  std::vector<std::uint64_t> vertex(n), vertex_there(n);
  query.supports(here, vertex.data());
  query.supports(there, vertex_there.data(), options);
  expect_same_bits(vertex_there, vertex, "supports");
  std::vector<double> distance(n), distance_there(n);
  query.signed_distances(here, distance.data());
  query.signed_distances(there, distance_there.data(), options);
  expect_same_bits(distance_there, distance, "distances");
  // The same, left on the device.
  const DeviceMemory memory = device_memory(there, 8 * n);
  const auto expect_left = [&](const auto& expected, const char* what) {
    using Item = typename std::remove_cvref_t<decltype(expected)>::value_type;
    expect_same_bits(fetched(static_cast<const Item*>(memory.data.get()), n), expected, what);
    check(cudaMemset(memory.data.get(), 0x55, 8 * n));
    check(cudaDeviceSynchronize());
  };
  query.contains_on_device(there, static_cast<std::uint8_t*>(memory.data.get()), options);
  expect_left(in, "contains, left there");
  query.contains_on_device(there, static_cast<std::uint8_t*>(memory.data.get()), ByCells(options));
  expect_left(in, "contains, by cells, left there");
  query.sides_on_device(there, static_cast<Side*>(memory.data.get()), options);
  ASSERT_EQ(fetched(static_cast<const Side*>(memory.data.get()), n), side);
  query.supports_on_device(there, static_cast<std::uint64_t*>(memory.data.get()), options);
  expect_left(vertex, "supports, left there");
  query.signed_distances_on_device(there, static_cast<double*>(memory.data.get()), options);
  expect_left(distance, "distances, left there");
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

/// A hull and its cells of directions.
class Celled {
 public:
  template <class T>
  Celled(const std::vector<T>& rows, unsigned d)
      : Celled(PointView::row_major(rows.data(), rows.size() / d, d), Options()) {}
  Celled(const Celled&) = delete;
  Celled& operator=(const Celled&) = delete;

  std::uint64_t count() const { return internal::FacetCells::count(search_); }

  /// Asks about all points on the device: each answer must be that of the CPU's cells, open ones
  /// included. Returns how many are open.
  std::size_t expect_the_same(const PointView& here, const DevicePointView& there) const {
    const std::size_t n = here.count;
    internal::KeptTables kept;
    const auto questions = internal::questions_on_device(there, nullptr, kept, {});
    auto* const out = static_cast<std::uint8_t*>(questions->room(n));
    const std::vector<std::uint64_t> open = questions->sides(cells_->table(), {7, 9}, 0, n, out);
    std::vector<std::uint8_t> answers(n);
    questions->fetch(answers.data(), out, n);
    std::vector<std::uint64_t> expected_open;
    for (std::uint64_t i = 0; i < n; ++i) {
      const int side = side_by_cells(here, i);
      if (side == 0) expected_open.push_back(i);
      EXPECT_EQ(answers[i], side == 0 ? 0 : side < 0 ? 7 : 9) << "point " << i;
    }
    EXPECT_EQ(open, expected_open);
    return open.size();
  }
  template <class T>
  std::size_t expect_the_same(const std::vector<T>& rows) const {
    const unsigned d = points_.dimension;
    const OnDevice copy(rows);
    const Stream stream;
    const auto here = PointView::row_major(rows.data(), rows.size() / d, d);
    return expect_the_same(here, copy.view(here, stream));
  }

 private:
  Celled(const PointView& view, const Options& options)
      : hull_(convex_hull(view)),
        points_(internal::make_query_points(&view, hull_, internal::Control(options))),
        search_(points_, hull_, internal::Control(options)),
        cells_(internal::FacetCells::build(search_, points_, internal::Run(options))) {}

  int side_by_cells(const PointView& here, std::uint64_t i) const {
    std::vector<double> columns(internal::FacetCells::block * here.dimension);
    for (unsigned j = 0; j < here.dimension; ++j)
      columns[j * internal::FacetCells::block] = here.at(i, j) + 0.0;
    std::vector<std::int8_t> side(internal::FacetCells::block);
    return cells_->sides(columns.data(), 1, side.data()) ? side[0] : 0;
  }

  Hull hull_;
  internal::QueryPoints points_;
  internal::FacetSearch search_;
  std::unique_ptr<internal::FacetCells> cells_;
};

TEST_F(GpuQuestions, ByCellsAroundSpheres) {
  const std::size_t n = short_run() ? 3000 : 100000;
  for (unsigned d = 2; d <= 4; ++d) {
    SCOPED_TRACE(std::to_string(d) + "D");
    Sets<double> sphere(d);
    sphere.add_sphere(d == 4 ? 80 : 500, 3);
    const Celled celled(sphere.rows, d);
    ASSERT_GT(celled.count(), 1000U);
    EXPECT_LT(celled.expect_the_same(ball_of<double>(d, n, 2, 1.2)), n / 1000 + 1);
    EXPECT_LT(celled.expect_the_same(ball_of<float>(d, n, 3, 1.2)), n / 1000 + 1);
    for (const double radius : {1e-300, 1e-30, 1.0000001, 1e30, 1e300})
      celled.expect_the_same(ball_of<double>(d, 200, 4, radius));
    EXPECT_EQ(celled.expect_the_same(sphere.rows), sphere.rows.size() / d) << "vertices";
  }
}

// Points on facets, edges and vertices, and the centre, which has no direction: all open, and no
// others.
TEST_F(GpuQuestions, ByCellsOnCubes) {
  for (unsigned d = 2; d <= 4; ++d) {
    SCOPED_TRACE(std::to_string(d) + "D");
    std::vector<double> lattice;
    std::size_t count = 1, inner = 1;
    for (unsigned j = 0; j < d; ++j) count *= 5, inner *= 3;
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t j = 0, rest = i; j < d; ++j, rest /= 5)
        lattice.push_back((static_cast<double>(rest % 5) - 2) / 2);
    const Celled celled(lattice, d);
    EXPECT_EQ(celled.expect_the_same(lattice), count - inner + 1);
    for (double& v : lattice) v *= 1.5;
    EXPECT_EQ(celled.expect_the_same(lattice), 1U) << "the centre";
    for (double& v : lattice) v *= 0x1p-600;
    EXPECT_EQ(celled.expect_the_same(lattice), count) << "too near to the centre";
  }
}

TEST_F(GpuQuestions, ByCellsOfAnySizeAndPlace) {
  for (unsigned d = 2; d <= 4; ++d)
    for (const double size : {0x1p-900, 0x1p-120, 0x1p120, 0x1p900}) {
      SCOPED_TRACE(std::to_string(d) + "D, " + std::to_string(std::log2(size)));
      const Celled celled(ball_of<double>(d, 100, 5, size), d);
      EXPECT_LT(celled.expect_the_same(ball_of<double>(d, 500, 6, 1.3 * size)), 5U);
    }
  Sets<double> flat(3);
  flat.add_ball(300, 1);
  flat.flatten_last(300, 1e-13);
  const Celled thin(flat.rows, 3);  // many lists are empty, because errors are large
  EXPECT_GT(thin.expect_the_same(flat.rows), 20U);
  Sets<double> far(3);
  far.add_sphere(200, 2, 2, 1e9);
  Celled(far.rows, 3).expect_the_same(far.rows);
}

TEST_F(GpuQuestions, ByCellsWithAnyStridesAndNotFinite) {
  const double infinity = std::numeric_limits<double>::infinity();
  for (unsigned d = 2; d <= 4; ++d) {
    SCOPED_TRACE(std::to_string(d) + "D");
    const Celled celled(ball_of<double>(d, 300, 8, 1), d);
    auto rows = ball_of<float>(d + 3, 700, 9, 2);
    rows[(d + 3) * 5] = static_cast<float>(infinity);
    rows[(d + 3) * 30 + d - 1] = static_cast<float>(-infinity);
    rows[(d + 3) * 299 + 1] = std::numeric_limits<float>::quiet_NaN();
    const OnDevice copy(rows);
    const Stream stream;
    const auto* const bytes = reinterpret_cast<const std::byte*>(rows.data());
    const auto step = static_cast<std::ptrdiff_t>((d + 3) * sizeof(float));
    for (const auto& [first, point, coordinate] :
         {std::tuple<std::ptrdiff_t, std::ptrdiff_t, std::ptrdiff_t>{0, step, 4},
          {0, step, 8},
          {699 * step, -step, 4},
          {0, 4, 700 * 4},
          {0, 0, 4}}) {
      const PointView here{bytes + first, ScalarType::f32, d, 700, point, coordinate};
      const std::size_t open = celled.expect_the_same(here, copy.view(here, stream));
      if (coordinate == 4 && point != 0) {
        EXPECT_GE(open, 3U);
      }
      EXPECT_LT(open, 20U);
    }
  }
}

TEST_F(GpuQuestions, DistancesOfPointsThatAreNotInsideAreOpen) {
  const internal::InnerPolytope triangle{2, {0, 0, 4, 0, 0, 4}, {0, 1, 1, 2, 2, 0}, {}};
  const std::vector<double> planes{0, -1, 0, 1, 1, -4, -1, 0, 0};
  const auto tables = internal::hull_tables(triangle, planes);
  ASSERT_TRUE(tables);
  const std::vector<double> rows{1, 1, 5, 5, 2, 0};  // inside, outside, on an edge
  const OnDevice copy(rows);
  internal::KeptTables kept;
  const auto questions = internal::questions_on_device(
      DevicePointView::row_major(copy.data<double>(), 3, 2), &*tables, kept, {});
  auto* const out = static_cast<double*>(questions->room(3 * sizeof(double)));
  EXPECT_EQ(questions->distances(0, 3, out), (std::vector<std::uint64_t>{1, 2}));
  double distance[3];
  questions->fetch(distance, out, sizeof distance);
  EXPECT_EQ(distance[0], -1);
  EXPECT_EQ(distance[1], 0);
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
  EXPECT_EQ(error_of([&] { query.contains(there, in.data(), on_device()); }), expected);
  EXPECT_EQ(error_of([&] { query.contains(there, in.data(), ByCells(on_device())); }), expected);
  EXPECT_EQ(error_of([&] { query.supports(there, vertex.data()); }), expected);
  EXPECT_EQ(error_of([&] { query.signed_distances(there, distance.data()); }), expected);
  const DeviceMemory memory = device_memory(there, 8 * 5000 + 4);
  EXPECT_EQ(error_of([&] {
              query.contains_on_device(there, static_cast<std::uint8_t*>(memory.data.get()));
            }),
            expected);
  const auto good = DevicePointView::row_major(copy.data<double>(), 1000, 3);
  EXPECT_NE(error_of([&] {
              query.contains_on_device(good, in.data());
            }).find("the memory for answers is not in a CUDA device's memory"),
            std::string::npos);
  auto* const odd =
      reinterpret_cast<double*>(static_cast<std::byte*>(memory.data.get()) + sizeof(float));
  EXPECT_NE(error_of([&] { query.signed_distances_on_device(good, odd); }).find("aligned"),
            std::string::npos);
  const auto other = DevicePointView::row_major(copy.data<double>(), 5000, 2);
  EXPECT_EQ(error_of([&] { query.contains(other, in.data()); }), error_of([&] {
              query.contains(PointView::row_major(rows.data(), 5000, 2), in.data());
            }));
}

}  // namespace hull_questions_gpu_test
}  // namespace cullhull::testing
