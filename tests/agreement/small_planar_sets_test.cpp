// Single calls with few points of the plane take a way of their own: held against the general flow,
// which whoever chooses a filter gets, bit for bit.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "agreement/all_paths.hpp"
#include "agreement/canonical_hash.hpp"
#include "agreement/general_outcome.hpp"
#include "agreement/point_sets.hpp"
#include "call_options.hpp"
#include "cullhull/certify.hpp"
#include "exact/orientation/orientation.hpp"
#include "few/small_polygon.hpp"
#include "filter/inner_ellipse.hpp"

namespace cullhull::small_planar_sets_test {

using namespace testing_support;
using namespace internal;

using Coordinate = std::function<double(Random&)>;

/// What coordinates are like, one kind a set; some make lattices, some lines, some both.
const std::vector<Coordinate>& coordinates() {
  static const std::vector<Coordinate> kinds = {
      [](Random& r) { return r.between(-1, 1); },
      [](Random& r) { return static_cast<double>(r.integer(-3, 3)); },
      [](Random& r) { return static_cast<double>(r.integer(0, 40)); },
      [](Random& r) { return static_cast<double>(r.integer(0, 1)); },
      [](Random& r) { return r.between(-1, 1) * 1e308; },
      [](Random& r) { return r.integer(-4, 4) * std::numeric_limits<double>::denorm_min(); },
      [](Random& r) { return std::ldexp(r.between(-1, 1), r.integer(-1000, 1000)); },
      [](Random& r) { return 1 + r.integer(-9, 9) * 0x1p-52; },
      [](Random& r) { return r.integer(0, 1) == 0 ? -0.0 : r.between(-1, 1); },
      [](Random& r) { return static_cast<double>(static_cast<float>(r.between(-9, 9))); },
  };
  return kinds;
}

/// Of two random kinds, now and then on a line or with a point that is not finite.
PointSet random_plane_set(Random& r, unsigned n, unsigned d) {
  PointSet s;
  s.dimension = d;
  const auto last = static_cast<int>(coordinates().size()) - 1;
  std::vector<const Coordinate*> kinds;
  for (unsigned j = 0; j < d; ++j)
    kinds.push_back(&coordinates()[static_cast<std::size_t>(r.integer(0, last))]);
  const int line = r.integer(0, 9);
  for (unsigned i = 0; i < n; ++i) {
    std::vector<double> p;
    for (const Coordinate* c : kinds) p.push_back((*c)(r));
    if (d == 2 && line == 0) p[1] = p[0];
    if (d == 2 && line == 1) p[1] = p[0] * 0.3;  // nearly
    if (d == 2 && line == 2) p[1] = 0.1;
    if (i > 0 && r.integer(0, 9) == 0)
      for (unsigned j = 0; j < d; ++j) p[j] = s.coordinates[j];
    s.add(p);
  }
  if (n > 0 && r.integer(0, 30) == 0)
    s.coordinates[static_cast<std::size_t>(r.integer(0, static_cast<int>(n * d) - 1))] =
        r.integer(0, 1) == 0 ? std::numeric_limits<double>::quiet_NaN()
                             : -std::numeric_limits<double>::infinity();
  return s;
}

TEST(SmallPlanarSets, EqualTheGeneralFlow) {
  Random r(11);
  for (unsigned i = 0; i < 100'000; ++i) {
    const auto n = static_cast<unsigned>(i % 50 == 0 ? r.integer(0, 400) : r.integer(0, 14));
    const PointSet s = random_plane_set(r, n, i % 4 == 0 ? 1 : 2);
    expect_general(view_of(s), "set " + std::to_string(i));
    if (HasFailure()) return;
  }
}

TEST(SmallPlanarSets, AreCertified) {
  Random r(12);
  for (unsigned i = 0; i < 5'000; ++i) {
    const PointSet s = random_plane_set(r, static_cast<unsigned>(r.integer(1, 60)), 1 + i % 2);
    try {
      const Hull hull = convex_hull(view_of(s));
      const Certificate certificate = certify(view_of(s), hull);
      ASSERT_TRUE(certificate.valid) << "set " << i << ": " << certificate.reason;
    } catch (const Error& e) {
      ASSERT_EQ(e.code(), ErrorCode::not_finite);
    }
  }
}

template <class T>
void expect_scalar(Random& r, int low, int high) {
  for (unsigned i = 0; i < 300; ++i) {
    const auto n = static_cast<std::size_t>(r.integer(0, 500));
    std::vector<T> rows(5 * n);  // two in every five are coordinates, in either order
    for (T& v : rows) v = static_cast<T>(r.integer(low, high));
    const std::string what = std::string(scalar_name(scalar_type_of<T>())) + std::to_string(i);
    expect_general(PointView::row_major(rows.data(), n, 2), what);
    expect_general(PointView::column_major(rows.data(), n, 2), what);
    PointView strided = PointView::row_major(rows.data(), n, 5);
    strided.dimension = 2;
    expect_general(strided, what);
    if (n == 0) continue;
    strided.data = strided.address(n - 1, 3);
    strided.point_stride = -strided.point_stride;
    strided.coordinate_stride = -3 * strided.coordinate_stride;
    expect_general(strided, what);
  }
}

TEST(SmallPlanarSets, AnyScalarAndLayout) {
  Random r(13);
  expect_scalar<double>(r, -2000, 2000);
  expect_scalar<float>(r, -2000, 2000);
  expect_scalar<std::int8_t>(r, -128, 127);
  expect_scalar<std::uint8_t>(r, 0, 255);
  expect_scalar<std::int16_t>(r, -3000, 3000);
  expect_scalar<std::uint16_t>(r, 0, 60000);
  expect_scalar<std::int32_t>(r, -20, 20);
  expect_scalar<std::uint32_t>(r, 0, 2000000000);
}

// From some hundred points on a sample comes first: sizes about every step of it, in orders that
// hide much from it.
TEST(SmallPlanarSets, MiddleSizes) {
  for (const char* shape : {"ball", "cube", "gauss", "sphere", "octahedron"})
    for (const unsigned n : {191U, 192U, 193U, 255U, 256U, 257U, 1599U, 1608U, 1609U, 4096U, 4097U,
                             12800U, 65536U, 65537U}) {
      PointSet s = random_set(shape, n, 2, n);
      const std::string what = std::string(shape) + " " + std::to_string(n);
      expect_general(view_of(s), what);
      PointSet lattice = s;
      for (double& v : lattice.coordinates) v = std::round(16 * v);
      expect_general(view_of(lattice), what + " on a lattice");
      std::vector<std::pair<double, double>> points;
      for (std::size_t i = 0; i < s.coordinates.size(); i += 2)
        points.emplace_back(s.coordinates[i], s.coordinates[i + 1]);
      std::sort(points.begin(), points.end());
      for (std::size_t i = 0; i < points.size(); ++i) {
        s.coordinates[2 * i] = points[i].first;
        s.coordinates[2 * i + 1] = points[i].second;
      }
      expect_general(view_of(s), what + " sorted");
      for (std::size_t i = 1; i < s.coordinates.size(); i += 2) s.coordinates[i] *= 0x1p-40;
      expect_general(view_of(s), what + " flattened");
      s.coordinates[2 * std::size_t{n / 2 + 1}] = 100;
      expect_general(view_of(s), what + " with one far out");
      s.coordinates[2 * std::size_t{n / 2 + 1} + 1] = std::numeric_limits<double>::quiet_NaN();
      expect_general(view_of(s), what + " with one that is none");
    }
}

TEST(SmallPlanarSets, ManyAlikeAndHeaps) {
  Random r(14);
  for (unsigned i = 0; i < 60; ++i) {
    PointSet s;
    s.dimension = 2;
    const auto n = static_cast<unsigned>(r.integer(192, 9000));
    const int kinds = r.integer(1, 40);
    const double size = std::ldexp(1.0, r.integer(-1000, 900)), from = r.integer(0, 1) * 1e6;
    for (unsigned k = 0; k < n; ++k) {
      const double a = r.integer(0, kinds) * 0.7;
      s.add({(std::cos(a) * (i % 3) + from) * size, (std::sin(a) + from) * size});
    }
    expect_general(view_of(s), "set " + std::to_string(i));
  }
}

TEST(SmallPlanarSets, HearWhoWantsToStop) {
  const PointSet s = random_set("ball", 10, 2, 1);
  Options options = stopped();
  EXPECT_THROW(convex_hull(view_of(s), options), Error);
  options.stop = {};
  double told = 0;
  options.progress = [&](const char*, double share) { told = share; };
  convex_hull(view_of(s), options);
  EXPECT_EQ(told, 1);
}

// Whatever was worth sharing: the figure is what the call had at hand.
TEST(SmallPlanarSets, TellTheThreads) {
  for (const unsigned n : {10U, 3000U, 70'000U, 600'000U})
    EXPECT_EQ(convex_hull(view_of(random_set("ball", n, 2, 1)), options_of(2)).statistics.threads,
              2U);
}

// What the ellipse contains is strictly inside, to the last bit: points are taken on its rim.
TEST(InnerEllipse, IsStrictlyInside) {
  Random r(15);
  std::uint64_t contained = 0;
  for (unsigned i = 0; i < 2'000; ++i) {
    const double size = std::ldexp(1.0, i % 4 == 0 ? r.integer(-800, 800) : r.integer(-3, 3));
    const double from = i % 3 == 0 ? r.between(-1e3, 1e3) * size : 0, thin = i % 5 == 0 ? 1e-6 : 1;
    std::vector<double> rows;
    const auto n = static_cast<std::uint32_t>(r.integer(3, 40));
    for (std::uint32_t k = 0; k < n; ++k) {
      const double a = r.between(0, 6.2832);
      rows.push_back(from + size * std::cos(a));
      rows.push_back(from + size * thin * std::sin(a));
    }
    const internal::Run& run = internal::short_run();
    PolygonSeries series(run.control);
    const std::vector<std::uint32_t> corners = series.corners(rows.data(), n);
    if (corners.size() < 3) continue;
    const InnerEllipse ellipse(rows.data(), corners, series.box());
    for (unsigned k = 0; k < 40; ++k) {
      // Outwards from between three corners, by halves, to the last point that is contained.
      double in[2] = {}, out[2];
      const std::size_t first = static_cast<std::size_t>(r.integer(0, 1 << 20)) % corners.size();
      for (unsigned j = 0; j < 2; ++j) {
        for (const std::uint32_t c : corners)
          in[j] += rows[2 * std::size_t{c} + j] / static_cast<double>(corners.size());
        out[j] = rows[2 * std::size_t{corners[first]} + j] * 0.7 +
                 rows[2 * std::size_t{corners[(first + 1) % corners.size()]} + j] * 0.3;
      }
      if (!ellipse.contains(in[0], in[1])) break;
      for (unsigned step = 0; step < 60; ++step) {
        const double middle[2] = {in[0] / 2 + out[0] / 2, in[1] / 2 + out[1] / 2};
        double* const to = ellipse.contains(middle[0], middle[1]) ? in : out;
        to[0] = middle[0];
        to[1] = middle[1];
      }
      ++contained;
      for (std::size_t c = 0; c < corners.size(); ++c) {
        const double* p[3] = {rows.data() + 2 * std::size_t{corners[c]},
                              rows.data() + 2 * std::size_t{corners[(c + 1) % corners.size()]}, in};
        ASSERT_GT(static_cast<int>(orientation_exact(2, p)), 0) << "polygon " << i;
      }
    }
  }
  EXPECT_GT(contained, 20'000U);
}

}  // namespace cullhull::small_planar_sets_test
