// Few points in the plane: the same bits as by the general path, and what it leaves to that path.

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/triangulation.hpp"
#include "delaunay/same_triangulation.hpp"
#include "delaunay/triangulate.hpp"
#include "thrown.hpp"

namespace cullhull {
namespace few_in_plane_test {

using testing_support::error_of;
using testing_support::expect_same;

struct PlaneSet {
  std::string name;
  std::vector<double> rows;

  PointView view() const { return PointView::row_major(rows.data(), rows.size() / 2, 2); }
};

Triangulation general(const PointView& points) {
  internal::Prepared prepared;
  return internal::triangulate(points, {}, {}, prepared);
}

/// The same, with the scalar type.
void expect_equal(const Triangulation& a, const Triangulation& b, const std::string& what) {
  EXPECT_EQ(a.scalar, b.scalar) << what;
  expect_same(a, b, what);
}

/// Takes the short path and compares.
void expect_few(const PlaneSet& s) {
  Triangulation few;
  ASSERT_TRUE(internal::triangulate_few_in_plane(s.view(), {}, few)) << s.name;
  expect_equal(few, general(s.view()), s.name);
  const Certificate certificate = certify(s.view(), few);
  EXPECT_TRUE(certificate.valid) << s.name << ": " << certificate.reason;
}

/// Is left to the general path, which delaunay() then takes.
void expect_left(const PlaneSet& s) {
  Triangulation few;
  EXPECT_FALSE(internal::triangulate_few_in_plane(s.view(), {}, few)) << s.name;
  expect_equal(delaunay(s.view()), general(s.view()), s.name);
}

using Coordinate = std::function<double(std::mt19937_64&)>;
PlaneSet random_set(const std::string& name, std::size_t n, std::uint64_t seed,
                    const Coordinate& x) {
  std::mt19937_64 random(seed);
  PlaneSet s{name + " " + std::to_string(n) + " seed " + std::to_string(seed), {}};
  for (std::size_t i = 0; i < 2 * n; ++i) s.rows.push_back(x(random));
  return s;
}
Coordinate uniform(double low, double high) {
  return [=](std::mt19937_64& r) { return std::uniform_real_distribution<double>(low, high)(r); };
}
Coordinate whole(int most) {
  return [=](std::mt19937_64& r) { return std::uniform_int_distribution<int>(0, most)(r); };
}
bool flat(const PlaneSet& s) { return general(s.view()).affine_dimension < 2; }

TEST(FewInPlane, RandomSetsOfEverySize) {
  for (std::size_t n = 3; n <= 70; ++n) expect_few(random_set("uniform", n, n, uniform(-1, 2)));
  for (const std::size_t n : {100, 1000, 4000, 16384})
    expect_few(random_set("uniform", n, n, uniform(-1, 2)));
  expect_left(random_set("uniform", 16385, 1, uniform(0, 1)));
  for (std::uint64_t seed = 0; seed < 20; ++seed)
    expect_few(random_set("normal", 500, seed, [](std::mt19937_64& r) {
      return std::normal_distribution<double>()(r);
    }));
}

TEST(FewInPlane, TinyGridsWithTiesAndDuplicates) {
  std::size_t taken = 0;
  for (const int most : {1, 2, 3, 4})
    for (std::size_t n = 3; n <= 24; ++n)
      for (std::uint64_t seed = 0; seed < 30; ++seed) {
        const PlaneSet s = random_set("grid to " + std::to_string(most), n, seed, whole(most));
        if (flat(s)) {
          expect_left(s);
        } else {
          expect_few(s);
          ++taken;
        }
      }
  EXPECT_GT(taken, 2000U);
}

TEST(FewInPlane, LatticesCirclesAndDuplicates) {
  for (const std::size_t n : {200, 2000, 9000})
    for (const int most : {15, 63, 1000}) {
      PlaneSet s = random_set("integers to " + std::to_string(most), n, n, whole(most));
      expect_few(s);
      for (double& x : s.rows) x += 0x1p40;
      s.name += " far away";
      expect_few(s);
    }
  // Whole points on the circle of radius 65, some of them twice, in an order that is not sorted.
  PlaneSet circle{"circle", {}};
  for (int x = -65; x <= 65; ++x)
    for (int y = -65; y <= 65; ++y)
      if (x * x + y * y == 65 * 65) circle.rows.insert(circle.rows.end(), {double(x), double(y)});
  const std::vector<double> once = circle.rows;
  for (std::size_t i = once.size(); i > 8; i -= 4)
    circle.rows.insert(circle.rows.end(), {once[i - 2], once[i - 1]});
  expect_few(circle);
  circle.rows.insert(circle.rows.begin(), {0, 0});
  expect_few(circle);
  PlaneSet rounded{"rounded circle", {}};
  for (int i = 0; i < 3000; ++i)
    rounded.rows.insert(rounded.rows.end(), {std::cos(i * 0.7), std::sin(i * 0.7)});
  expect_few(rounded);
}

TEST(FewInPlane, LinesAndOnePointBeside) {
  PlaneSet line{"line", {}};
  for (int i = 0; i < 300; ++i) line.rows.insert(line.rows.end(), {i * 0.25, i * 0.5});
  expect_left(line);
  for (const double beside : {0x1p-60, 1.0, 50.0}) {
    PlaneSet s = line;
    s.rows.insert(s.rows.begin() + 100, {10.0, 20.0 + beside});
    if (flat(s)) {
      expect_left(s);
    } else {
      expect_few(s);
    }
  }
  // In the curve's order the line's points come first.
  PlaneSet low{"flat start", {}};
  for (int i = 0; i < 100; ++i) low.rows.insert(low.rows.end(), {i * 0.01, 0.0});
  low.rows.insert(low.rows.end(), {0.2, 1.0});
  expect_few(low);
}

TEST(FewInPlane, MagnitudesAndZeros) {
  for (const int by : {-499, -60, 60, 400, 499}) {
    PlaneSet s = random_set("scaled by 2^" + std::to_string(by), 300, 7, uniform(0.5, 1));
    for (double& x : s.rows) x = std::ldexp(x, by);
    expect_few(s);
  }
  for (const int by : {-1020, -700, 700, 1020}) {
    PlaneSet s = random_set("scaled by 2^" + std::to_string(by), 300, 7, uniform(0.5, 1));
    for (double& x : s.rows) x = std::ldexp(x, by);
    expect_left(s);
  }
  PlaneSet zeros = random_set("zeros of both signs", 100, 3, whole(5));
  for (std::size_t i = 0; i < zeros.rows.size(); i += 3) zeros.rows[i] = i % 2 != 0 ? -0.0 : 0.0;
  expect_few(zeros);
  // A coordinate that scaling would lose; one that it keeps.
  PlaneSet subnormal = random_set("subnormal", 100, 3, uniform(0, 7));
  subnormal.rows[11] = std::numeric_limits<double>::denorm_min();
  expect_left(subnormal);
  for (double& x : subnormal.rows)
    if (x > 0x1p-1000) x /= 8;
  expect_few(subnormal);
}

TEST(FewInPlane, ClustersAreLeftToFinerKeys) {
  PlaneSet s = random_set("cluster", 1000, 5, uniform(0, 1));
  s.rows[6] = 1e6;
  expect_left(s);
  expect_few(random_set("far away", 1000, 5, uniform(0x1p45, 0x1p45 + 1)));
  expect_left(random_set("equal", 100, 5, [](std::mt19937_64&) { return 3.0; }));
}

TEST(FewInPlane, LayoutsAndScalars) {
  const PlaneSet s = random_set("doubles", 257, 9, whole(40));
  const std::size_t n = s.rows.size() / 2;
  const Triangulation expected = general(s.view());
  std::vector<float> floats(s.rows.begin(), s.rows.end());
  Triangulation t = delaunay(PointView::row_major(floats.data(), n, 2));
  EXPECT_EQ(t.scalar, ScalarType::f32);
  EXPECT_EQ(t.cells, expected.cells);
  std::vector<double> columns;
  for (unsigned a = 0; a < 2; ++a)
    for (std::size_t i = 0; i < n; ++i) columns.push_back(s.rows[2 * i + a]);
  t = delaunay(PointView::column_major(columns.data(), n, 2));
  expect_equal(t, expected, "columns");
}

TEST(FewInPlane, ErrorsCancellationAndOptions) {
  PlaneSet s = random_set("uniform", 50, 1, uniform(0, 1));
  TriangulationOptions o;
  std::stop_source stop;
  stop.request_stop();
  o.stop = stop.get_token();
  error_of(ErrorCode::cancelled, [&] { delaunay(s.view(), o); });
  o = {};
  std::vector<std::string> phases;
  o.progress = [&](const char* phase, double) { phases.emplace_back(phase); };
  delaunay(s.view(), o);
  EXPECT_EQ(phases, std::vector<std::string>{"done"});
  o = {};
  o.memory_budget = 1000;
  error_of(ErrorCode::out_of_budget, [&] { delaunay(s.view(), o); });
  o = {};
  o.furthest_site = true;
  Triangulation few;
  EXPECT_FALSE(internal::triangulate_few_in_plane(s.view(), o, few));
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    s.rows[41] = bad;
    const std::string message = error_of(ErrorCode::not_finite, [&] { delaunay(s.view()); });
    EXPECT_NE(message.find("point 20, coordinate 1"), std::string::npos) << message;
  }
}

TEST(FewInPlane, CallsDoNotDependOnEarlierOnes) {
  const PlaneSet large = random_set("large", 5000, 2, whole(300)),
                 small = random_set("small", 12, 2, whole(3));
  Triangulation first, between, again;
  ASSERT_TRUE(internal::triangulate_few_in_plane(small.view(), {}, first));
  ASSERT_TRUE(internal::triangulate_few_in_plane(large.view(), {}, between));
  ASSERT_TRUE(internal::triangulate_few_in_plane(small.view(), {}, again));
  expect_equal(first, again, "after a large set");
  EXPECT_EQ(first.statistics.ties, again.statistics.ties);
  EXPECT_EQ(first.statistics.cells_created, again.statistics.cells_created);
  EXPECT_EQ(first.statistics.rung_counts[0], again.statistics.rung_counts[0]);
}

/// The extent is so small that its reciprocal overflows, beside a coordinate of ordinary size.
TEST(FewInPlane, OnALineOfSubnormalLength) {
  std::vector<double> rows;
  for (const int i : {2, 0, 4, 1, 3}) rows.insert(rows.end(), {1.0, i * 0x1p-1070});
  const Triangulation t = delaunay(PointView::row_major(rows.data(), 5, 2));
  EXPECT_EQ(t.affine_dimension, 1);
  EXPECT_EQ(t.size(), 4U);
}

}  // namespace few_in_plane_test
}  // namespace cullhull
