// Clipped cells: measures against exact rational ones, sums, shapes that are closed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>

#include "cells/slow_volume.hpp"
#include "cullhull/error.hpp"
#include "cullhull/voronoi.hpp"

namespace cullhull {
namespace {

using namespace testing_support;

struct Box {
  std::vector<double> low, high;
  double measure() const {
    double m = 1;
    for (std::size_t j = 0; j < low.size(); ++j) m *= high[j] - low[j];
    return m;
  }
};

/// Around the points, less a part of them where `within`.
Box box_of(const LiftedSet& s, bool within) {
  Box box{std::vector<double>(s.dimension, 0.0), std::vector<double>(s.dimension, 1.0)};
  for (unsigned j = 0; j < s.dimension && s.count() > 0; ++j) {
    double low = s.rows[j], high = low;
    for (std::uint64_t i = 0; i < s.count(); ++i) {
      low = std::min(low, s.rows[i * s.dimension + j]);
      high = std::max(high, s.rows[i * s.dimension + j]);
    }
    const double margin = high > low ? (high - low) / 8 : 1;
    box.low[j] = low + (within ? margin : -margin);
    box.high[j] = high + (within && high > low ? -margin : 3 * margin);
  }
  return box;
}

double sum_of(const Array<double>& measures) {
  long double sum = 0;
  for (const double m : measures) sum += m;
  return static_cast<double>(sum);
}

/// The sum is the region's, each cell's shape has its measure, and each face has an owner.
void check_shapes(const LiftedSet& s, const ClippedCells& cells) {
  ASSERT_EQ(cells.vertex_offsets.size(), s.count() + 1);
  if (s.dimension == 1) {
    EXPECT_EQ(cells.neighbours.size(), cells.vertices.size());
  } else if (s.dimension == 2) {
    EXPECT_EQ(cells.neighbours.size() * 2, cells.vertices.size());
  } else {
    ASSERT_EQ(cells.face_offsets.size(), s.count() + 1);
    ASSERT_EQ(cells.face_offsets.back() + 1, cells.face_starts.size());
    ASSERT_EQ(cells.face_starts.back(), cells.face_vertices.size());
    ASSERT_EQ(cells.neighbours.size() + 1, cells.face_starts.size());
    for (std::uint64_t i = 0; i < s.count(); ++i) {
      std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
      const std::uint64_t count = cells.vertex_offsets[i + 1] - cells.vertex_offsets[i];
      EXPECT_EQ(count > 0, cells.face_offsets[i] < cells.face_offsets[i + 1]);
      for (std::uint64_t f = cells.face_offsets[i]; f < cells.face_offsets[i + 1]; ++f) {
        const std::uint64_t begin = cells.face_starts[f], end = cells.face_starts[f + 1];
        EXPECT_GE(end - begin, 2U);
        for (std::uint64_t v = begin; v < end; ++v) {
          const std::uint32_t a = cells.face_vertices[v],
                              b = cells.face_vertices[v + 1 < end ? v + 1 : begin];
          ASSERT_LT(a, count);
          ++edges[{a, b}];
          --edges[{b, a}];
        }
      }
      for (const auto& [edge, n] : edges) ASSERT_EQ(n, 0) << s.name << ": not closed";
    }
  }
}

void check(const LiftedSet& s, bool within, bool furthest = false) {
  const Box box = box_of(s, within);
  if (!(box.measure() < 1e300 && box.measure() > 1e-300)) return;
  TriangulationOptions o;
  o.furthest_site = furthest;
  const Triangulation t = triangulate(s, o);
  const ClippedCells cells = clip_voronoi(view_of(s), t, box.low, box.high, s.weights);
  ASSERT_EQ(cells.measures.size(), s.count());
  const mpq_class whole = slow_volume(box_rows(box.low, box.high), s.dimension);
  mpq_class sum = 0;
  for (std::uint32_t i = 0; i < s.count(); ++i) {
    const mpq_class exact = slow_cell(s, t, i, box_rows(box.low, box.high));
    sum += exact;
    EXPECT_TRUE(near(cells.measures[i], exact, 1e-12, whole))
        << s.name << ": " << cells.measures[i] << ", not " << exact.get_d() << " of "
        << whole.get_d();
  }
  if (s.count() > 0) {
    EXPECT_TRUE(sum == whole) << s.name;
    EXPECT_TRUE(near(sum_of(cells.measures), whole, 1e-12)) << s.name;
  }
  check_shapes(s, cells);
}

TEST(ClipVoronoi, SmallSetsAreAsDefined) {
  for (unsigned d = 1; d <= 3; ++d)
    for (const LiftedSet& s : small_lifted_sets(d, 31)) {
      check(s, false);
      check(s, true);
    }
}

TEST(ClipVoronoi, RandomSmallSetsAreAsDefined) {
  for (std::uint64_t seed = 1; seed <= 25; ++seed)
    for (unsigned d = 1; d <= 3; ++d) check(random_lifted_set(d, seed), seed % 2 == 0);
}

TEST(ClipVoronoi, FurthestSite) {
  for (unsigned d = 1; d <= 3; ++d)
    for (const LiftedSet& s : small_lifted_sets(d, 37)) check(s, false, true);
}

TEST(ClipVoronoi, FewPoints) {
  for (unsigned d = 1; d <= 3; ++d) {
    LiftedSet s;
    s.dimension = d;
    s.name = "few";
    std::mt19937_64 random(d);
    for (unsigned n = 0; n <= d + 3; ++n) {
      check(s, false);
      for (unsigned j = 0; j < d; ++j) s.rows.push_back(static_cast<double>(random() % 5));
    }
  }
}

TEST(ClipVoronoi, LargerSetsAddUp) {
  for (unsigned d = 1; d <= 3; ++d)
    for (const LiftedSet& s : large_lifted_sets(d, d < 3 ? 20000 : 3000)) {
      const Box box = box_of(s, false);
      const Triangulation t = triangulate(s);
      Options o;
      o.threads = 1;
      const ClippedCells cells = clip_voronoi(view_of(s), t, box.low, box.high, s.weights, true, o);
      EXPECT_NEAR(sum_of(cells.measures) / box.measure(), 1, 1e-12) << s.name;
      check_shapes(s, cells);
      o.threads = 3;
      const ClippedCells again =
          clip_voronoi(view_of(s), t, box.low, box.high, s.weights, false, o);
      EXPECT_EQ(cells.measures, again.measures);
      EXPECT_TRUE(again.vertices.empty());
    }
}

/// A triangle and a tetrahedron as regions; a box as the hull of its corners is the box.
TEST(ClipVoronoi, ConvexRegions) {
  for (unsigned d = 1; d <= 3; ++d) {
    const LiftedSet s = random_points(d, 200, d);
    const Triangulation t = triangulate(s);
    std::vector<double> corners(d, -0.25);
    for (unsigned j = 0; j < d; ++j) {
      std::vector<double> corner(d, -0.25);
      corner[j] = 2.75;
      corners.insert(corners.end(), corner.begin(), corner.end());
    }
    const ClippedCells cells =
        clip_voronoi(view_of(s), t, PointView::row_major(corners.data(), d + 1, d));
    const double whole = d == 1 ? 3 : d == 2 ? 4.5 : 4.5;
    EXPECT_NEAR(sum_of(cells.measures) / whole, 1, 1e-13) << d;
    check_shapes(s, cells);
    std::vector<double> box;
    for (unsigned i = 0; i < 1U << d; ++i)
      for (unsigned j = 0; j < d; ++j) box.push_back((i >> j & 1U) != 0 ? 1 : 0);
    const ClippedCells in_hull =
        clip_voronoi(view_of(s), t, PointView::row_major(box.data(), 1U << d, d));
    const ClippedCells in_box =
        clip_voronoi(view_of(s), t, std::vector<double>(d, 0), std::vector<double>(d, 1));
    for (std::uint32_t i = 0; i < s.count(); ++i)
      EXPECT_NEAR(in_hull.measures[i], in_box.measures[i], 1e-15);
  }
}

TEST(ClipVoronoi, RefusesWhatIsNone) {
  const LiftedSet s = random_points(2, 20, 1);
  const Triangulation t = triangulate(s);
  const auto message = [&](const auto& body) -> std::string {
    try {
      body();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
      return e.what();
    }
    return "nothing was thrown";
  };
  using Numbers = std::vector<double>;
  EXPECT_EQ(message([&] {
              clip_voronoi(view_of(s), t, Numbers{0, 1}, Numbers{1, 1});
            }),
            "the box is empty or not finite along axis 1");
  EXPECT_EQ(message([&] { clip_voronoi(view_of(s), t, Numbers{0}, Numbers{1}); }),
            "a box in dimension 2 needs as many numbers for each corner");
  const Numbers line{0, 0, 1, 1};
  EXPECT_EQ(message([&] { clip_voronoi(view_of(s), t, PointView::row_major(line.data(), 2, 2)); }),
            "the region spans dimension 1 only");
  const Numbers dented{0, 0, 1, 0, 0.5, 0.25, 1, 1, 0, 1};
  EXPECT_EQ(
      message([&] { clip_voronoi(view_of(s), t, PointView::row_major(dented.data(), 5, 2)); }),
      "the region is not convex: its point 2 lies inside the hull of the others; pass that hull's "
      "vertices if it is meant");
  const LiftedSet far = random_points(4, 20, 1);
  EXPECT_EQ(
      message([&] { clip_voronoi(view_of(far), triangulate(far), Numbers(4, 0), Numbers(4, 1)); }),
      "cells are clipped in dimensions 1 to 3, not in 4");
}

/// Where doubles cannot hold the shapes there is an error, and no measure of 0 or NaN.
TEST(ClipVoronoi, RefusesWhatDoublesCannotHold) {
  using Numbers = std::vector<double>;
  const auto refused = [](const Numbers& rows, const Numbers& low, const Numbers& high) {
    const PointView points = PointView::row_major(rows.data(), rows.size() / 2, 2);
    try {
      const ClippedCells cells = clip_voronoi(points, delaunay(points), low, high);
      double sum = 0;
      for (const double m : cells.measures) sum += m;
      return "adds up to " + std::to_string(sum);
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::invalid_argument);
      return std::string(e.what()).substr(0, 40);
    }
  };
  const std::string expected = "the cells cannot be clipped in doubles: ";
  EXPECT_EQ(refused({-1e16, 0, 1e16, 0, 0, 1e16}, {0, 0}, {1, 1}), expected);
  EXPECT_EQ(refused({-1e308, 0, 1e308, 0, 0, 1e308}, {-1, -1}, {1, 1}), expected);
  EXPECT_EQ(refused({-1, 0, 1, 0, 0, 1}, {-1, -1}, {1, 1}), "adds up to 4.000000");
}

}  // namespace
}  // namespace cullhull
