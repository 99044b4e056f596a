#include "cullhull/certify.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

#include "cullhull/generate.hpp"
#include "cullhull/hull.hpp"
#include "tests/call_options.hpp"
#include "tests/reference/reference_boundary.hpp"
#include "tests/thrown.hpp"

namespace cullhull {
namespace certify_test {

struct Case {
  std::vector<double> rows;
  unsigned d;
  PointView view() const { return PointView::row_major(rows.data(), rows.size() / d, d); }
};

Case cube(unsigned d) {
  Case c{{}, d};
  for (unsigned i = 0; i < (1U << d); ++i)
    for (unsigned j = 0; j < d; ++j) c.rows.push_back(i >> j & 1U);
  c.rows.insert(c.rows.end(), d, 0.5);
  return c;
}

Case random_points(unsigned d, unsigned n, unsigned seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> uniform(-1, 1);
  Case c{{}, d};
  for (unsigned i = 0; i < n * d; ++i) c.rows.push_back(uniform(random));
  return c;
}

Hull reference_hull(const Case& c) {
  std::vector<std::uint32_t> order(c.rows.size() / c.d);
  std::iota(order.begin(), order.end(), 0U);
  std::mt19937 random(1);
  return reference::build(c.rows, c.d, reference::boundary_in_order(c.rows, c.d, order, random));
}

std::string reason(const Case& c, const Hull& h) {
  const Certificate certificate = certify(c.view(), h);
  EXPECT_EQ(certificate.valid, certificate.reason.empty());
  return certificate.reason;
}

void expect_fault(const Case& c, const Hull& good, const std::function<void(Hull&)>& spoil,
                  const std::string& why) {
  Hull bad = good;
  spoil(bad);
  const std::string found = reason(c, bad);
  EXPECT_NE(found.find(why), std::string::npos)
      << "expected '" << why << "', got '" << found << "'";
}

// Surfaces of several chunks, all whose facets are simplices (sphere) or not (cube): the same for
// any number of threads, sums over all vertices included.
TEST(Certify, AnyNumberOfThreadsSaysTheSame) {
  for (const char* shape : {"sphere", "cube"}) {
    const Case c{generate(shape, 20000, 3, 5), 3};
    const Hull good = convex_hull(c.view());
    Hull bad = good;
    std::swap(bad.simplex_facets.edit()[good.simplex_count() - 1], bad.simplex_facets.edit()[0]);
    const Certificate one = certify(c.view(), good, testing_support::options_of(1));
    const Certificate fault = certify(c.view(), bad, testing_support::options_of(1));
    EXPECT_TRUE(one.valid) << one.reason;
    EXPECT_FALSE(fault.valid) << shape;
    for (const unsigned threads : {2U, 3U, 16U, 64U}) {
      const Certificate many = certify(c.view(), good, testing_support::options_of(threads));
      EXPECT_TRUE(many.valid) << many.reason;
      EXPECT_EQ(many.ridges_checked, one.ridges_checked);
      EXPECT_EQ(many.exact_decisions, one.exact_decisions) << threads;
      EXPECT_EQ(certify(c.view(), bad, testing_support::options_of(threads)).reason, fault.reason);
    }
  }
}

TEST(Certify, AcceptsHulls) {
  for (unsigned d = 2; d <= 6; ++d) {
    for (const Case& c : {cube(d), random_points(d, 40, d)}) {
      const Hull h = reference_hull(c);
      const Certificate certificate = certify(c.view(), h);
      EXPECT_TRUE(certificate.valid) << certificate.reason;
      EXPECT_EQ(certificate.ridges_checked, h.simplex_count() * d / 2);
      EXPECT_EQ(certificate.points_checked, c.view().count);
    }
  }
}

TEST(Certify, ReadsEveryScalarTypeAndStride) {
  const Case c = cube(3);
  Hull h = reference_hull(Case{{c.rows.begin(), c.rows.begin() + 24}, 3});
  h.scalar = ScalarType::u8;
  std::vector<std::uint8_t> columns(24);
  for (unsigned i = 0; i < 8; ++i)
    for (unsigned j = 0; j < 3; ++j) columns[j * 8 + i] = i >> j & 1U;
  const Certificate certificate = certify(PointView::column_major(columns.data(), 8, 3), h);
  EXPECT_TRUE(certificate.valid) << certificate.reason;
}

TEST(Certify, EmptyAndSingle) {
  Hull none;
  none.dimension = 3;
  const Case empty{{}, 3};
  EXPECT_EQ(reason(empty, none), "");
  none.vertices = {0};
  EXPECT_NE(reason(empty, none), "");

  const Case same{{1, 2, 3, 1, 2, 3}, 3};
  Hull h;
  h.dimension = 3;
  h.point_count = 2;
  h.affine_dimension = 0;
  h.vertices = {0};
  EXPECT_EQ(reason(same, h), "the centroid is not the only point");
  h.centroid = {1, 2, 3};
  EXPECT_EQ(reason(same, h), "");
  expect_fault(
      same, h, [](Hull& b) { b.vertices = {1}; }, "vertex should be point 0");
  const Case differ{{1, 2, 3, 1, 2, 4}, 3};
  EXPECT_EQ(reason(differ, h), "point 1 differs from point 0");
}

TEST(Certify, PointsOneUnitOutsideAreFound) {
  const Case c = cube(3);
  const Hull h = reference_hull(c);
  const double inf = std::numeric_limits<double>::infinity();
  const auto with_last = [&](double x, double y, double z) {
    Case moved = c;
    std::copy_n(std::vector<double>{x, y, z}.begin(), 3, moved.rows.end() - 3);
    return reason(moved, h);
  };
  EXPECT_EQ(with_last(0.25, 0.75, 1), "");
  EXPECT_EQ(with_last(1, 1, 1), "");
  EXPECT_EQ(with_last(0.25, 0.75, std::nextafter(1, 2)), "point 8 lies outside the hull");
  EXPECT_EQ(with_last(-std::numeric_limits<double>::denorm_min(), 0.5, 0.5),
            "point 8 lies outside the hull");
  EXPECT_EQ(with_last(inf, 0, 0), "point 8 is not finite");
  EXPECT_EQ(with_last(std::nan(""), 0, 0), "point 8 is not finite");
}

TEST(Certify, LargeSetsGoThroughTheInnerFilter) {
  // Enough points to build the filter; one of them one ulp outside.
  for (unsigned d = 2; d <= 6; ++d) {
    Case c = cube(d);
    const Hull h = [&] {
      Hull base = reference_hull(c);
      base.point_count = 40000 + (1U << d) + 1;
      return base;
    }();
    std::mt19937 random(d);
    std::uniform_real_distribution<double> uniform(0, 1);
    for (unsigned i = 0; i < 40000 * d; ++i) c.rows.push_back(uniform(random));
    EXPECT_EQ(reason(c, h), "");
    c.rows[c.rows.size() - 2] = std::nextafter(1, 2);
    EXPECT_EQ(reason(c, h),
              "point " + std::to_string(h.point_count - 1) + " lies outside the hull");
  }
}

TEST(Certify, MutationsOfACubeAreNamed) {
  const Case c = cube(3);
  const Hull h = reference_hull(c);
  const auto fault = [&](const char* why, const std::function<void(Hull&)>& spoil) {
    expect_fault(c, h, spoil, why);
  };
  fault("not a vertex", [](Hull& b) { b.vertices.pop_back(); });
  fault("vertex 8 is on no simplex", [](Hull& b) { b.vertices.push_back(8); });
  fault("ascending", [](Hull& b) { std::swap(b.vertices[0], b.vertices[1]); });
  fault("out of range", [](Hull& b) { b.vertices[7] = 1U << 20; });
  fault("not a vertex", [](Hull& b) { b.simplices.edit()[0] = 77; });
  fault("out of range", [](Hull& b) { b.simplex_neighbours[4] = 12; });
  fault("out of range", [](Hull& b) { b.simplex_facets.edit()[0] = 6; });
  fault("", [](Hull& b) { std::swap(b.simplices.edit()[1], b.simplices.edit()[2]); });
  fault("differ in length", [](Hull& b) { b.simplices.edit().resize(3); });
  fault("offsets", [](Hull& b) { b.facets.offsets.edit()[1] = 1U << 30; });
  fault("offsets", [](Hull& b) { b.facets.offsets.clear(); });
  fault("cyclic", [](Hull& b) { std::swap(b.facets.items.edit()[1], b.facets.items.edit()[2]); });
  fault("neighbours of facet 0",
        [](Hull& b) { std::swap(b.facet_neighbours.items[0], b.facet_neighbours.items[1]); });
  fault("volume", [](Hull& b) { b.volume *= 1 + 1e-6; });
  fault("area", [](Hull& b) { b.area = std::nan(""); });
  fault("centroid", [](Hull& b) { b.centroid[1] += 1e-6; });
  fault("facet 1", [](Hull& b) {
    for (unsigned i = 0; i < 4; ++i) b.facet_planes[4 + i] *= -1;
  });
  fault("normal of facet 0", [](Hull& b) { b.facet_planes[0] += 1e-3; });
  fault("misses vertex", [](Hull& b) { b.facet_planes[3] += 1e-3; });
  fault("", [](Hull& b) { b.affine_dimension = 2; });
  fault("affine dimension", [](Hull& b) { b.affine_dimension = 4; });
  fault("8 points, not of 9", [](Hull& b) { b.point_count = 8; });
  fault("", [](Hull& b) { b.simplex_facets.edit()[1] = b.simplex_facets[0] == 0 ? 1 : 0; });
}

/// Every simplex reversed: locally concave from its own side.
TEST(Certify, InsideOutIsFound) {
  const Case c = random_points(3, 12, 5);
  const Hull h = reference_hull(c);
  Hull b = h;
  std::vector<std::size_t> order(b.simplex_count());
  std::iota(order.begin(), order.end(), std::size_t{0});
  for (std::size_t i = 0; i < b.simplex_count(); ++i) {
    std::swap(b.simplices.edit()[3 * i + 1], b.simplices.edit()[3 * i + 2]);
    std::swap(b.simplex_neighbours[3 * i + 1], b.simplex_neighbours[3 * i + 2]);
  }
  std::sort(order.begin(), order.end(), [&](std::size_t x, std::size_t y) {
    return std::lexicographical_compare(&b.simplices[3 * x], &b.simplices[3 * x] + 3,
                                        &b.simplices[3 * y], &b.simplices[3 * y] + 3);
  });
  std::vector<std::uint32_t> rank(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = static_cast<std::uint32_t>(i);
  Hull sorted = b;
  for (std::size_t i = 0; i < order.size(); ++i)
    for (unsigned j = 0; j < 3; ++j) {
      sorted.simplices.edit()[3 * i + j] = b.simplices[3 * order[i] + j];
      sorted.simplex_neighbours[3 * i + j] = rank[b.simplex_neighbours[3 * order[i] + j]];
    }
  EXPECT_NE(reason(c, sorted).find("not strictly beneath"), std::string::npos) << reason(c, sorted);
}

TEST(Certify, SplitAndJoinedFacetsAreFound) {
  const Case c = cube(3);
  const Hull h = reference_hull(c);
  // Split: the second simplex of the last facet becomes a facet of its own.
  expect_fault(
      c, h,
      [](Hull& b) {
    b.simplex_facets.edit().back() = 6;
    Array<std::uint64_t>& items = b.facets.items.edit();
    items.insert(items.end(), b.simplices.end() - 3, b.simplices.end());
    b.facets.offsets.push_back(b.facets.items.size());
    b.facet_neighbours.items.insert(b.facet_neighbours.items.end(), {0, 1, 2});
    b.facet_neighbours.offsets.push_back(b.facet_neighbours.items.size());
    b.facet_planes.insert(b.facet_planes.end(), b.facet_planes.end() - 4, b.facet_planes.end());
      },
      "coplanar, but of different facets");
  // Joined: two squares claim to be one facet.
  expect_fault(
      c, h,
      [](Hull& b) {
    for (auto& f : b.simplex_facets.edit()) f = f == 5 ? 4 : f;
      },
      "not coplanar");
}

TEST(Certify, DuplicatesMustBeTheLowestId) {
  Case c = cube(3);
  c.rows.insert(c.rows.begin(), {1, 1, 1});  // id 0 equals id 8
  const Hull h = reference_hull(c);
  ASSERT_EQ(h.vertices[0], 0U);
  EXPECT_EQ(reason(c, h), "");
  // The same hull of the points without it, ids shifted: vertex 8 instead of 0.
  const Case without = cube(3);
  Hull b = reference_hull(without);
  b.point_count = c.view().count;
  b.rename([](std::uint64_t v) { return v + 1; });
  EXPECT_EQ(reason(c, b), "point 0 equals vertex 8 and has the lower id");
}

TEST(Certify, SkippedVertexIsAnOutsidePoint) {
  const Case all = random_points(3, 30, 9);
  // The hull of all but the last point, moved far outside.
  Case moved = all;
  moved.rows[moved.rows.size() - 1] = 5;
  Case rest{{all.rows.begin(), all.rows.end() - 3}, 3};
  Hull h = reference_hull(rest);
  h.point_count = 30;
  EXPECT_EQ(reason(moved, h), "point 29 lies outside the hull");
}

/// A closed, locally convex surface that winds twice around: the pentagram.
TEST(Certify, DoubleCoveringIsFound) {
  Case c{{}, 2};
  const int x[] = {0, 95, 59, -59, -95}, y[] = {100, 31, -81, -81, 31};
  for (unsigned i = 0; i < 5; ++i) c.rows.insert(c.rows.end(), {1.0 * x[i], 1.0 * y[i]});
  Hull h = reference_hull(c);
  EXPECT_EQ(reason(c, h), "");
  // Edges i -> i + 2 clockwise, sorted: (tail, head).
  const std::vector<std::pair<unsigned, unsigned>> edges{{0, 2}, {1, 3}, {2, 4}, {3, 0}, {4, 1}};
  for (unsigned i = 0; i < 5; ++i) {
    h.simplices.edit()[2 * i] = edges[i].first;
    h.simplices.edit()[2 * i + 1] = edges[i].second;
    for (std::uint32_t j = 0; j < 5; ++j) {
      if (edges[j].first == edges[i].second) h.simplex_neighbours[2 * i] = j;
      if (edges[j].second == edges[i].first) h.simplex_neighbours[2 * i + 1] = j;
    }
    h.simplex_facets.edit()[i] = i;
  }
  EXPECT_NE(reason(c, h).find("covers itself"), std::string::npos) << reason(c, h);
}

TEST(Certify, FourDimensionalTriangulationMustBePulled) {
  const Case c = cube(4);
  const Hull h = reference_hull(c);
  EXPECT_EQ(reason(c, h), "");
  expect_fault(
      c, h, [](Hull& b) { b.facets.items.edit()[1] = b.facets.items[2]; }, "facet 0");
  expect_fault(
      c, h, [](Hull& b) { b.facet_neighbours.items[0] = 7; }, "neighbours of facet 0");
}

TEST(Certify, RandomMutationsAreRejectedAndNeverCrash) {
  for (unsigned d = 2; d <= 4; ++d) {
    const Case c = cube(d);
    const Hull h = reference_hull(c);
    std::mt19937 random(d);
    const auto value = [&]() -> std::uint32_t {
      return static_cast<std::uint32_t>(random() % 4 == 0 ? random() : random() % 20);
    };
    for (unsigned round = 0; round < 3000; ++round) {
      SCOPED_TRACE(::testing::Message() << "d = " << d << ", round = " << round);
      Hull b = h;
      const auto set = [&](auto& list) {
        if (list.empty()) return;
        auto& slot = list[random() % list.size()];
        slot = static_cast<std::decay_t<decltype(slot)>>(value());
      };
      const std::function<void()> spoil[] = {
          [&] { set(b.vertices); },
          [&] { set(b.simplices.edit()); },
          [&] { set(b.simplex_neighbours); },
          [&] { set(b.simplex_facets.edit()); },
          [&] { set(b.facets.items.edit()); },
          [&] { set(b.facets.offsets.edit()); },
          [&] { set(b.facet_neighbours.items); },
          [&] { set(b.facet_neighbours.offsets.edit()); },
          [&] { set(b.facet_planes); },
      };
      for (unsigned i = 0; i <= random() % 3; ++i) spoil[random() % std::size(spoil)]();
      // Two mutations may cancel; then nothing is wrong.
      EXPECT_EQ(certify(c.view(), b).valid, reference::same_hull(b, h));
    }
  }
}

TEST(Certify, ThinHullsWithoutADoubleInside) {
  const double e = 0x1p-52;
  const Case triangle{{1, 1, 1 + e, 1, 1, 1 + e}, 2};
  EXPECT_EQ(reason(triangle, reference_hull(triangle)), "");
  const Case tetrahedron{{1, 1, 1, 1 + e, 1, 1, 1, 1 + e, 1, 1, 1, 1 + e}, 3};
  EXPECT_EQ(reason(tetrahedron, reference_hull(tetrahedron)), "");
  Case outside = triangle;
  Hull h = reference_hull(triangle);
  outside.rows.insert(outside.rows.end(), {1 + e, 1 + e});
  h.point_count = 4;
  EXPECT_EQ(reason(outside, h), "point 3 lies outside the hull");
}

TEST(Certify, StopsWhenAsked) {
  const Case c = cube(3);
  const Hull h = reference_hull(c);
  testing_support::error_of(ErrorCode::cancelled,
                            [&] { certify(c.view(), h, testing_support::stopped()); });
}

}  // namespace certify_test
}  // namespace cullhull
