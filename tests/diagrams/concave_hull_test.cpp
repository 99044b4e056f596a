// Concave hulls by the length of edges against a reference that looks at all edges in each step.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <set>

#include "cullhull/alpha_shape.hpp"
#include "cullhull/error.hpp"
#include "diagrams/slow_cells.hpp"

namespace cullhull {
namespace concave_hull_test {

using namespace testing_support;

using Corners = std::vector<std::uint32_t>;
using Edge = std::pair<std::uint32_t, std::uint32_t>;

mpq_class square_length(const LiftedSet& s, const Edge& e) {
  const Rationals a = rational_point(s, e.first), b = rational_point(s, e.second);
  mpq_class sum = 0;
  for (unsigned j = 0; j < s.dimension; ++j) sum += (a[j] - b[j]) * (a[j] - b[j]);
  return sum;
}

/// Edges that one triangle alone has, with its corner opposite to them.
std::map<Edge, std::pair<std::uint32_t, Corners>> boundary_of(const std::set<Corners>& cells) {
  std::map<Edge, std::pair<std::uint32_t, Corners>> edges;
  std::set<Edge> twice;
  for (const Corners& c : cells)
    for (unsigned j = 0; j < 3; ++j) {
      const auto e = std::minmax(c[(j + 1) % 3], c[(j + 2) % 3]);
      if (!edges.emplace(e, std::pair{c[j], c}).second) twice.insert(e);
    }
  for (const Edge& e : twice) edges.erase(e);
  return edges;
}

std::set<Corners> slow_hull(const LiftedSet& s, const Triangulation& t, const mpq_class& square) {
  std::set<Corners> cells;
  for (std::uint64_t c = 0; c < t.size(); ++c) cells.emplace(t.cell(c).begin(), t.cell(c).end());
  for (;;) {
    const auto boundary = boundary_of(cells);
    std::set<std::uint32_t> there;
    for (const auto& [e, cell] : boundary) there.insert({e.first, e.second});
    mpq_class longest = square;
    const Corners* dug = nullptr;
    for (const auto& [e, cell] : boundary) {  // lowest ids first
      if (there.contains(cell.first)) continue;
      const mpq_class length = square_length(s, e);
      if (length <= longest) continue;
      longest = length;
      dug = &cell.second;
    }
    if (dug == nullptr) return cells;
    cells.erase(Corners(*dug));
  }
}

void check(const LiftedSet& s) {
  const Triangulation t = triangulate(s);
  ASSERT_EQ(t.affine_dimension, 2) << s.name;
  std::set<mpq_class> squares;
  for (std::uint64_t c = 0; c < t.size(); ++c)
    for (unsigned j = 0; j < 3; ++j)
      squares.insert(square_length(s, {t.cell(c)[j], t.cell(c)[(j + 1) % 3]}));
  std::set<double> lengths{0, INFINITY};
  for (const mpq_class& square : squares) {
    const double l = std::sqrt(square.get_d());
    if (std::isfinite(l) && (lengths.size() < 40 || square == *squares.rbegin()))
      lengths.insert({std::nextafter(l, 0), l, std::nextafter(l, INFINITY)});
  }
  for (const double l : lengths) {
    if (std::isinf(l) && l < 0) continue;
    const AlphaShape hull = concave_hull(view_of(s), t, l);
    std::set<Corners> found;
    for (const std::uint32_t c : hull.cells) found.emplace(t.cell(c).begin(), t.cell(c).end());
    const mpq_class square = std::isinf(l) ? *squares.rbegin() : mpq_class(l) * mpq_class(l);
    EXPECT_TRUE(found == slow_hull(s, t, square)) << s.name << ", length " << l;
    // One ring without a repeated point, around all of them.
    const CellPolygons ring = cell_polygons(view_of(s), t, hull.cells);
    EXPECT_EQ(ring.polygon_count(), 1U) << s.name << ", length " << l;
    EXPECT_EQ(ring.ring_count(), 1U) << s.name << ", length " << l;
    EXPECT_EQ(ring.rings.items.size(), hull.facet_cells.size()) << s.name << ", length " << l;
    std::set<std::uint32_t> met;
    for (const Corners& c : found) met.insert(c.begin(), c.end());
    EXPECT_EQ(met.size(), t.vertex_count()) << s.name << ", length " << l;
  }
}

TEST(ConcaveHull, SmallSetsAreAsDefined) {
  for (const LiftedSet& s : small_lifted_sets(2, 61))
    if (s.weights.empty() && triangulate(s).affine_dimension == 2) check(s);
  check(random_points(2, 60, 5));
  check(drawn_grid(2, 60, 9, 1, 0, 5));
  check(in_a_flat(3, 2, 30, 5));
}

TEST(ConcaveHull, FewPointsAndLinesKeepAllCells) {
  for (const LiftedSet& s :
       {LiftedSet{"none", 2, {}, {}}, LiftedSet{"one", 2, {3, 4}, {}},
        LiftedSet{"two", 2, {3, 4, 5, 9}, {}}, LiftedSet{"line", 2, {0, 0, 1, 1, 9, 9}, {}},
        LiftedSet{"equal", 3, {1, 2, 3, 1, 2, 3}, {}}}) {
    const Triangulation t = triangulate(s);
    const AlphaShape hull = concave_hull(view_of(s), t, 0);
    EXPECT_EQ(hull.cells.size(), t.size()) << s.name;
    EXPECT_EQ(hull.facets, t.hull_facets) << s.name;
    EXPECT_EQ(concave_length(view_of(s), t, 0.5), 0) << s.name;
  }
}

/// 3, 4, 5: one below the double of the hypotenuse it goes, at it it stays.
TEST(ConcaveHull, ComparesExactly) {
  for (const double scale : {1.0, 0x1p-530, 0x1p1000}) {
    std::vector<double> rows{0, 0, 3, 0, 3, 4, 2, 1};
    for (double& x : rows) x *= scale;
    const PointView points = PointView::row_major(rows.data(), 4, 2);
    const Triangulation t = delaunay(points);
    const auto left = [&](double l) { return concave_hull(points, t, l).cells.size(); };
    EXPECT_EQ(left(5 * scale), 3U);
    EXPECT_EQ(left(std::nextafter(5 * scale, 0)), 2U);
    EXPECT_EQ(left(0), 2U);
  }
}

TEST(ConcaveHull, ARatioIsBetweenTheShortestAndTheLongest) {
  for (const double scale : {1.0, 0x1p-600, 0x1p1020}) {
    std::vector<double> rows{0, 0, 3, 0, 3, 4};
    for (double& x : rows) x *= scale;
    const PointView points = PointView::row_major(rows.data(), 3, 2);
    const Triangulation t = delaunay(points);
    EXPECT_EQ(concave_length(points, t, 0), 3 * scale);
    EXPECT_EQ(concave_length(points, t, 0.5), 4 * scale);
    EXPECT_EQ(concave_length(points, t, 1), INFINITY);
    for (const double ratio : {-0.1, 1.1, double(NAN)})
      EXPECT_THROW(concave_length(points, t, ratio), Error);
  }
}

/// A comb of two long teeth: what is between them is dug out, at any size of the set.
TEST(ConcaveHull, LargeSetsOfAShape) {
  for (const unsigned n : {1'000U, 100'000U}) {
    LiftedSet s = random_points(2, n, 8);
    double low = INFINITY, high = -INFINITY;
    for (const double x : s.rows) low = std::min(low, x), high = std::max(high, x);
    std::vector<double> rows;
    const auto wide = high - low;
    for (std::size_t i = 0; i < s.rows.size(); i += 2) {
      const double x = (s.rows[i] - low) / wide, y = (s.rows[i + 1] - low) / wide;
      if (x < 0.3 || x > 0.7 || y < 0.2) rows.insert(rows.end(), {x, y});
    }
    const PointView points = PointView::row_major(rows.data(), rows.size() / 2, 2);
    const Triangulation t = delaunay(points);
    const AlphaShape hull = concave_hull(points, t, 0.2);
    const CellPolygons ring = cell_polygons(points, t, hull.cells);
    ASSERT_EQ(ring.ring_count(), 1U);
    double area = 0;
    for (std::size_t i = 0; i < ring.rings.items.size(); ++i) {
      const double *a = rows.data() + 2 * ring.rings[0][i],
                   *b = rows.data() + 2 * ring.rings[0][(i + 1) % ring.rings.items.size()];
      area += (a[0] * b[1] - a[1] * b[0]) / 2;
    }
    EXPECT_NEAR(area, 1 - 0.4 * 0.8, 0.1) << n;
    EXPECT_LT(area, 0.75) << n;
  }
}

TEST(ConcaveHull, RefusesWhatIsNone) {
  const LiftedSet s = random_points(2, 20, 1);
  const Triangulation t = triangulate(s);
  EXPECT_THROW(concave_hull(view_of(s), t, -1), Error);
  EXPECT_THROW(concave_hull(view_of(s), t, NAN), Error);
  EXPECT_THROW(concave_hull(view_of(random_points(2, 19, 1)), t, 1), Error);
  const LiftedSet solid = random_points(3, 20, 1);
  EXPECT_THROW(concave_hull(view_of(solid), triangulate(solid), 1), Error);
  TriangulationOptions furthest;
  furthest.furthest_site = true;
  EXPECT_THROW(concave_hull(view_of(s), triangulate(s, furthest), 1), Error);
}

}  // namespace concave_hull_test
}  // namespace cullhull
