#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <map>
#include <unordered_map>

#include "cullhull/hull.hpp"
#include "tests/reference/reference_boundary.hpp"

namespace cullhull::build_hull_test {

using reference::boundary_in_order;
using reference::build;
using reference::same_hull;
using Ids = std::vector<std::uint64_t>;

/// The hull of `rows`, after checking that every insertion order, arrangement and thread count
/// gives the same bits, and that it is certified.
Hull canonical(const std::vector<double>& rows, unsigned d, unsigned orders = 12) {
  const auto n = static_cast<std::uint32_t>(rows.size() / d);
  std::vector<std::uint32_t> order(n);
  std::iota(order.begin(), order.end(), 0U);
  std::mt19937 random(1);
  Hull first;
  for (unsigned i = 0; i < orders; ++i) {
    const Hull hull = build(rows, d, boundary_in_order(rows, d, order, random), 1 + i % 2);
    if (i == 0) first = hull;
    EXPECT_TRUE(same_hull(first, hull)) << "order " << i;
    std::shuffle(order.begin(), order.end(), random);
  }
  const Certificate c = certify(PointView::row_major(rows.data(), n, d), first);
  EXPECT_TRUE(c.valid) << c.reason;
  return first;
}

Ids facet(const Hull& h, std::size_t i) {
  return {h.facets.items.begin() + static_cast<std::ptrdiff_t>(h.facets.offsets[i]),
          h.facets.items.begin() + static_cast<std::ptrdiff_t>(h.facets.offsets[i + 1])};
}

std::vector<double> corners(unsigned d) {
  std::vector<double> rows;
  for (unsigned i = 0; i < (1U << d); ++i)
    for (unsigned j = 0; j < d; ++j) rows.push_back(i >> j & 1U);
  return rows;
}

TEST(BuildHull, TetrahedronIsSortedAndOutward) {
  const std::vector<double> rows{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const Hull h = canonical(rows, 3);
  EXPECT_EQ(h.vertices, (Ids{0, 1, 2, 3}));
  EXPECT_EQ(h.simplices, (Array<std::uint64_t>{0, 1, 3, 0, 2, 1, 0, 3, 2, 1, 2, 3}));
  EXPECT_EQ(h.simplex_neighbours, (Array<std::uint32_t>{3, 2, 1, 3, 0, 2, 3, 1, 0, 2, 0, 1}));
  EXPECT_EQ(h.facets.items, h.simplices);
  EXPECT_DOUBLE_EQ(h.volume, 1.0 / 6);
  EXPECT_DOUBLE_EQ(h.area, 1.5 + std::sqrt(3.0) / 2);
  for (const double c : h.centroid) EXPECT_DOUBLE_EQ(c, 0.25);
  EXPECT_DOUBLE_EQ(h.facet_planes[1], -1);  // facet 0 is y = 0
  EXPECT_DOUBLE_EQ(h.facet_planes[15], -1 / std::sqrt(3.0));
}

TEST(BuildHull, CubeMergesToSixSquares) {
  const Hull h = canonical(corners(3), 3, 40);
  EXPECT_EQ(h.vertices.size(), 8U);
  ASSERT_EQ(h.facet_count(), 6U);
  EXPECT_EQ(h.simplex_count(), 12U);
  EXPECT_EQ(facet(h, 0), (Ids{0, 1, 5, 4}));  // y = 0, counter-clockwise from outside
  EXPECT_DOUBLE_EQ(h.volume, 1);
  EXPECT_DOUBLE_EQ(h.area, 6);
  for (std::size_t f = 0; f < 6; ++f)  // every square meets four others
    EXPECT_EQ(h.facet_neighbours.offsets[f + 1] - h.facet_neighbours.offsets[f], 4U);
}

TEST(BuildHull, PyramidDropsEdgeMidpointsAndFacePoints) {
  // base square 0-3, apex 4, midpoints of base edges and of slanted edges, centre of the base
  const std::vector<double> rows{-2, -2, 0, 2, -2, 0,  2, 2, 0,  -2, 2, 0, 0, 0, 2,  0, -2,
                                 0,  2,  0, 0, -1, -1, 1, 1, -1, 1,  0, 0, 0, 0, -1, 1};
  const Hull h = canonical(rows, 3);
  EXPECT_EQ(h.vertices, (Ids{0, 1, 2, 3, 4}));
  ASSERT_EQ(h.facet_count(), 5U);
  EXPECT_EQ(facet(h, 0), (Ids{0, 1, 4}));
  EXPECT_EQ(facet(h, 1), (Ids{0, 3, 2, 1}));
  EXPECT_DOUBLE_EQ(h.volume, 16 * 2 / 3.0);
  EXPECT_DOUBLE_EQ(h.centroid[2], 0.5);
}

TEST(BuildHull, OctahedronDropsFaceCentres) {
  std::vector<double> rows;
  for (unsigned j = 0; j < 3; ++j)
    for (const double s : {3.0, -3.0})
      for (unsigned c = 0; c < 3; ++c) rows.push_back(c == j ? s : 0);
  for (unsigned i = 0; i < 8; ++i)
    for (unsigned j = 0; j < 3; ++j) rows.push_back((i >> j & 1U) ? 1 : -1);
  const Hull h = canonical(rows, 3);
  EXPECT_EQ(h.vertices, (Ids{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(h.facet_count(), 8U);
  EXPECT_EQ(h.simplex_count(), 8U);
  EXPECT_DOUBLE_EQ(h.volume, 36);
}

TEST(BuildHull, FourCubeIsPulledFromTheLowestId) {
  const Hull h = canonical(corners(4), 4, 8);
  EXPECT_EQ(h.vertices.size(), 16U);
  EXPECT_EQ(h.facet_count(), 8U);
  EXPECT_EQ(h.simplex_count(), 48U);  // 3! for each of 8 cubes
  EXPECT_DOUBLE_EQ(h.volume, 1);
  EXPECT_DOUBLE_EQ(h.area, 8);
  for (std::size_t i = 0; i < h.simplex_count(); ++i)
    EXPECT_EQ(h.simplices[4 * i], facet(h, h.simplex_facets[i])[0]);
}

TEST(BuildHull, FiveCubeAndFiveCrossPolytope) {
  const Hull cube = canonical(corners(5), 5, 3);
  EXPECT_EQ(cube.facet_count(), 10U);
  EXPECT_EQ(cube.simplex_count(), 240U);
  EXPECT_NEAR(cube.volume, 1, 1e-14);
  std::vector<double> rows;
  for (unsigned j = 0; j < 5; ++j)
    for (const double s : {1.0, -1.0})
      for (unsigned c = 0; c < 5; ++c) rows.push_back(c == j ? s : 0);
  rows.insert(rows.end(), {0.5, 0.5, 0, 0, 0});  // an edge's midpoint
  const Hull cross = canonical(rows, 5, 6);
  EXPECT_EQ(cross.vertices.size(), 10U);
  EXPECT_EQ(cross.facet_count(), 32U);
  EXPECT_EQ(cross.simplex_count(), 32U);
  EXPECT_NEAR(cross.volume, 32.0 / 120, 1e-15);
}

TEST(BuildHull, PolygonIsCounterClockwiseFromTheLowestId) {
  // lowest id not the leftmost; points on edges; an interior point
  const std::vector<double> rows{4, 4, 0, 0, 4, 0, 0, 4, 2, 0, 2, 4, 0, 1, 2, 2};
  const Hull h = canonical(rows, 2);
  EXPECT_EQ(h.vertices, (Ids{0, 3, 1, 2}));
  EXPECT_EQ(h.facet_count(), 4U);
  for (std::size_t f = 0; f < 4; ++f) {
    const auto v = facet(h, f);
    const auto at = std::find(h.vertices.begin(), h.vertices.end(), v[0]) - h.vertices.begin();
    EXPECT_EQ(h.vertices[static_cast<std::size_t>(at + 1) % 4], v[1]);
  }
  EXPECT_DOUBLE_EQ(h.volume, 16);
  EXPECT_DOUBLE_EQ(h.area, 16);
  EXPECT_DOUBLE_EQ(h.centroid[0], 2);
}

TEST(BuildHull, OfEqualPointsTheLowestIdIsTheVertex) {
  std::vector<double> rows = corners(3);
  const std::vector<double> again = rows;
  rows.insert(rows.end(), again.begin(), again.end());
  std::reverse(rows.begin(), rows.end());  // the cube is symmetric: still its corners, twice
  const Hull h = canonical(rows, 3, 20);
  EXPECT_EQ(h.vertices, (Ids{0, 1, 2, 3, 4, 5, 6, 7}));
}

TEST(BuildHull, SmallGridsInFourDimensions) {
  std::vector<double> rows;
  for (unsigned i = 0; i < 81; ++i)
    for (unsigned j = 0, r = i; j < 4; ++j, r /= 3) rows.push_back(r % 3);
  const Hull h = canonical(rows, 4, 3);
  EXPECT_EQ(h.vertices.size(), 16U);
  EXPECT_EQ(h.facet_count(), 8U);
  EXPECT_EQ(h.simplex_count(), 48U);
}

TEST(BuildHull, RandomIntegerPointsAgreeWithTheReference) {
  for (unsigned d = 2; d <= 5; ++d)
    for (unsigned seed = 1; seed <= 6; ++seed) {
      SCOPED_TRACE(::testing::Message() << "d = " << d << ", seed = " << seed);
      std::mt19937 random(seed);
      std::vector<double> rows;
      for (unsigned i = 0; i < 24 * d; ++i) rows.push_back(static_cast<double>(random() % 4));
      const reference::SlowHull slow(rows, d);
      ASSERT_EQ(slow.affine_dimension(), static_cast<int>(d));
      const Hull h = canonical(rows, d, 4);
      Ids vertices = h.vertices;
      std::sort(vertices.begin(), vertices.end());
      const auto extreme = slow.extreme_points();
      EXPECT_EQ(vertices, Ids(extreme.begin(), extreme.end()));
      std::vector<std::vector<std::uint32_t>> facets;
      for (std::size_t f = 0; f < h.facet_count(); ++f) {
        Ids v = facet(h, f);
        std::sort(v.begin(), v.end());
        facets.emplace_back(v.begin(), v.end());
      }
      std::sort(facets.begin(), facets.end());
      std::vector<std::vector<std::uint32_t>> expected = slow.maximal_facets();
      for (auto& list : expected) std::sort(list.begin(), list.end());
      std::sort(expected.begin(), expected.end());
      EXPECT_EQ(facets, expected);
    }
}

TEST(BuildHull, VolumeFarFromTheOriginKeepsItsDigits) {
  std::vector<double> rows = corners(3);
  for (std::size_t i = 0; i < rows.size(); ++i)
    rows[i] = 636000 + 1000.0 * static_cast<double>(i % 3) + rows[i] * 0.015625;
  const Hull h = canonical(rows, 3, 2);
  EXPECT_NEAR(h.volume, 0x1p-18, 0x1p-18 * 1e-13);
}

TEST(BuildHull, HugeTinyAndThin) {
  for (const double scale : {1e300, 1e-300, 1e-308}) {
    std::vector<double> rows = corners(3);
    for (double& v : rows) v *= scale;
    const Hull h = canonical(rows, 3, 2);
    EXPECT_EQ(h.facet_count(), 6U);
    EXPECT_FALSE(std::isnan(h.volume) || std::isnan(h.area));
    for (unsigned c = 0; c < 3; ++c) EXPECT_NEAR(h.centroid[c] / scale, 0.5, 1e-12);
  }
  // A box of 1e300 x 1e-300 x 1
  std::vector<double> box = corners(3);
  for (std::size_t i = 0; i < box.size(); ++i)
    box[i] *= i % 3 == 0 ? 1e300 : i % 3 == 1 ? 1e-300 : 1;
  const Hull h = canonical(box, 3, 2);
  EXPECT_NEAR(h.volume, 1, 1e-12);
  EXPECT_NEAR(h.area / 2e300, 1, 1e-12);
  // Two units in the last place thick, and slanted.
  const double e = 0x1p-52;
  const std::vector<double> thin{1, 1, 1, 2, 2, 2 + 2 * e, 1, 2, 1.5, 2, 1, 1.5 + e};
  const Hull t = canonical(thin, 3, 2);
  EXPECT_NEAR(t.volume, e / 6, e * 1e-12);
}

/// Closes a surface of outward triangles: neighbours by their edges.
internal::Boundary closed(const std::vector<std::array<std::uint32_t, 3>>& triangles) {
  internal::Boundary out;
  out.dimension = 3;
  std::unordered_map<std::uint64_t, std::uint32_t> left_of;
  const auto edge = [](std::uint64_t from, std::uint64_t to) { return from << 32 | to; };
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (unsigned j = 0; j < 3; ++j)
      left_of[edge(triangles[t][(j + 1) % 3], triangles[t][(j + 2) % 3])] = t;
  for (const auto& t : triangles)
    for (unsigned j = 0; j < 3; ++j) {
      out.vertices.push_back(t[j]);
      out.neighbours.push_back(left_of.at(edge(t[(j + 2) % 3], t[(j + 1) % 3])));
    }
  return out;
}

// A cube whose faces are k x k squares: corners, flat vertices on edges and inside of faces.
TEST(BuildHull, FacesFullOfFlatVertices) {
  for (const std::uint32_t k : {1U, 2U, 7U, 40U}) {
    std::vector<double> rows;
    std::map<std::array<std::uint32_t, 3>, std::uint32_t> number;
    const auto vertex = [&](const std::array<std::uint32_t, 3>& p) {
      const auto [it, added] = number.try_emplace(p, static_cast<std::uint32_t>(number.size()));
      if (added) rows.insert(rows.end(), {double(p[0]), double(p[1]), double(p[2])});
      return it->second;
    };
    std::mt19937 random(k);
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (unsigned axis = 0; axis < 3; ++axis)
      for (const bool high : {false, true})
        for (std::uint32_t a = 0; a < k; ++a)
          for (std::uint32_t b = 0; b < k; ++b) {
            std::uint32_t v[4];  // a square, counter-clockwise in the axes that follow
            for (unsigned c = 0; c < 4; ++c) {
              std::array<std::uint32_t, 3> p;
              p[axis] = high ? k : 0;
              p[(axis + 1) % 3] = a + (c == 1 || c == 2);
              p[(axis + 2) % 3] = b + (c >= 2);
              v[c] = vertex(p);
            }
            if (!high) std::swap(v[1], v[3]);
            const unsigned s = random() % 2;  // which diagonal
            triangles.push_back({v[s], v[s + 1], v[s + 2]});
            triangles.push_back({v[s], v[s + 2], v[(s + 3) % 4]});
          }
    std::shuffle(triangles.begin(), triangles.end(), random);
    const Hull one = build(rows, 3, closed(triangles), 1);
    EXPECT_EQ(one.vertices.size(), 8U);
    EXPECT_EQ(one.facet_count(), 6U);
    EXPECT_EQ(one.simplex_count(), 12U);
    EXPECT_DOUBLE_EQ(one.volume, std::pow(k, 3));
    const Certificate c = certify(PointView::row_major(rows.data(), rows.size() / 3, 3), one);
    EXPECT_TRUE(c.valid) << c.reason;
    for (const unsigned threads : {2U, 3U, 8U})
      EXPECT_TRUE(same_hull(one, build(rows, 3, closed(triangles), threads))) << threads;
  }
}

// Two faces with thousands of corners, and a ring of rectangles, each two triangles.
TEST(BuildHull, FacesWithThousandsOfCorners) {
  const std::uint32_t n = 20001;
  std::vector<std::uint32_t> place(2 * n);  // ids in no order
  std::iota(place.begin(), place.end(), 0U);
  std::mt19937 random(4);
  std::shuffle(place.begin(), place.end(), random);
  std::vector<double> rows(6 * n);
  for (std::uint32_t i = 0; i < n; ++i)
    for (const std::uint32_t top : {0U, 1U}) {
      double* p = &rows[3 * place[2 * i + top]];
      const double x = double(i) - (n - 1) / 2;
      p[0] = x;
      p[1] = x * x;
      p[2] = top;
    }
  const auto id = [&](std::uint32_t i, std::uint32_t top) { return place[2 * (i % n) + top]; };
  Hull first;
  for (const std::uint32_t apex : {0U, 77U}) {
    std::vector<std::array<std::uint32_t, 3>> triangles;
    for (std::uint32_t i = 0; i < n; ++i) {
      if (i != apex && (i + 1) % n != apex) {  // seen from above x^2 runs counter-clockwise
        triangles.push_back({id(apex, 1), id(i, 1), id(i + 1, 1)});
        triangles.push_back({id(apex, 0), id(i + 1, 0), id(i, 0)});
      }
      const std::uint32_t a = id(i, 0), b = id(i + 1, 0), c = id(i + 1, 1), d = id(i, 1);
      if ((i + apex) % 3 == 0) {
        triangles.push_back({a, b, c});
        triangles.push_back({a, c, d});
      } else {
        triangles.push_back({a, b, d});
        triangles.push_back({b, c, d});
      }
    }
    std::shuffle(triangles.begin(), triangles.end(), random);
    const internal::Boundary surface = closed(triangles);
    for (const unsigned threads : {1U, 3U, 8U}) {
      const Hull hull = build(rows, 3, surface, threads);
      if (first.vertices.empty()) first = hull;
      EXPECT_TRUE(same_hull(first, hull)) << apex << ", threads " << threads;
    }
  }
  EXPECT_EQ(first.vertices.size(), 2 * n);
  EXPECT_EQ(first.facet_count(), n + 2);
  const Certificate c = certify(PointView::row_major(rows.data(), 2 * n, 3), first);
  EXPECT_TRUE(c.valid) << c.reason;
}

TEST(BuildHull, RefusesWhatIsNoHull) {
  const std::vector<double> rows = corners(3);
  std::vector<std::uint32_t> order(8);
  std::iota(order.begin(), order.end(), 0U);
  std::mt19937 random(3);
  const auto good = boundary_in_order(rows, 3, order, random);
  const auto refused = [&](auto&& spoil) {
    auto bad = good;
    spoil(bad);
    try {
      build(rows, 3, std::move(bad));
    } catch (const Error& e) {
      return e.code() == ErrorCode::not_exact;
    }
    return false;
  };
  EXPECT_FALSE(refused([](auto&) {}));
  EXPECT_TRUE(refused([](auto& b) { std::swap(b.vertices[0], b.vertices[1]); }));
  EXPECT_TRUE(refused([](auto& b) { b.neighbours[0] = b.neighbours[1]; }));
  EXPECT_TRUE(refused([](auto& b) { b.neighbours[0] = 99; }));
  EXPECT_TRUE(refused([](auto& b) { b.vertices[0] = 99; }));
  EXPECT_TRUE(refused([](auto& b) {
    b.vertices.resize(9);
    b.neighbours.resize(9);
  }));
  EXPECT_TRUE(refused([](auto& b) {  // inside out
    for (std::size_t f = 0; f < b.facet_count(); ++f) {
      std::swap(b.vertices[3 * f], b.vertices[3 * f + 1]);
      std::swap(b.neighbours[3 * f], b.neighbours[3 * f + 1]);
    }
  }));
}

/// Flat sets: the hull is built on a projection and measured in space.
TEST(BuildHull, FlatSetsAreMeasuredInTheirFlat) {
  // A 3 x 4 rectangle in the plane spanned by (1, 1, 0, 0)/sqrt 2 and (0, 0, 1, 1)/sqrt 2 in 4D.
  const double a = 3 / std::sqrt(2.0), b = 4 / std::sqrt(2.0);
  const std::vector<double> rows{0, 0, 0, 0, a, a, 0, 0, a, a, b, b, 0, 0, b, b};
  const auto view = PointView::row_major(rows.data(), 4, 4);
  const std::vector<double> projected{0, 0, a, 0, a, b, 0, b};
  internal::LocalPoints local;
  local.dimension = 2;
  local.count = 4;
  local.coordinates = local.exact = projected.data();
  const unsigned axes[] = {0, 2};
  std::vector<std::uint32_t> order{0, 1, 2, 3};
  std::mt19937 random(5);
  const internal::Run& run = internal::short_run();
  Hull h;
  internal::build_hull({&view, &local, nullptr, axes},
                       boundary_in_order(projected, 2, order, random), run, h);
  EXPECT_EQ(h.vertices, (Ids{0, 1, 2, 3}));
  EXPECT_NEAR(h.volume, 12, 1e-14);
  EXPECT_NEAR(h.area, 14, 1e-14);
  EXPECT_NEAR(h.centroid[1], a / 2, 1e-15);
  EXPECT_NEAR(h.facet_planes[7], -std::sqrt(0.5), 1e-15);  // facet 1, the edge 0-1
  const Certificate c = certify(view, h);
  EXPECT_TRUE(c.valid) << c.reason;
}

TEST(BuildHull, SegmentInSpace) {
  const std::vector<double> rows{1, 1, 1, 4, 5, 1, 2.5, 3, 1};
  const std::vector<double> projected{1, 4, 2.5};
  const auto view = PointView::row_major(rows.data(), 3, 3);
  internal::LocalPoints local;
  local.dimension = 1;
  local.count = 3;
  local.coordinates = local.exact = projected.data();
  const unsigned axes[] = {0};
  internal::Boundary ends;
  ends.dimension = 1;
  ends.vertices = {1, 0};
  ends.neighbours = {1, 0};
  const internal::Run& run = internal::short_run();
  Hull h;
  internal::build_hull({&view, &local, nullptr, axes}, std::move(ends), run, h);
  EXPECT_EQ(h.vertices, (Ids{0, 1}));
  EXPECT_EQ(h.simplices, (Array<std::uint64_t>{0, 1}));
  EXPECT_DOUBLE_EQ(h.volume, 5);
  EXPECT_DOUBLE_EQ(h.area, 2);
  EXPECT_DOUBLE_EQ(h.centroid[1], 3);
  EXPECT_DOUBLE_EQ(h.facet_planes[0], -0.6);
  EXPECT_DOUBLE_EQ(h.facet_planes[5], 0.8);
  const Certificate c = certify(view, h);
  EXPECT_TRUE(c.valid) << c.reason;
}

}  // namespace cullhull::build_hull_test
