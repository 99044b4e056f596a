// Alpha shapes against exact rational radii.
#include "cullhull/alpha_shape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "cullhull/error.hpp"
#include "diagrams/slow_cells.hpp"

namespace cullhull {
namespace alpha_shape_test {

using namespace testing_support;

/// Of the sphere around a cell within its flat, squared.
mpq_class slow_radius(const LiftedSet& s, std::span<const std::uint32_t> cell) {
  return slow_power(s, cell[0], slow_centre(s, cell));
}

void check(const LiftedSet& s) {
  const Triangulation t = triangulate(s);
  std::vector<mpq_class> radii;
  std::set<double> alphas{0, 1, std::numeric_limits<double>::infinity()};
  for (std::uint64_t c = 0; c < t.size(); ++c) {
    radii.push_back(slow_radius(s, t.cell(c)));
    const double a = std::sqrt(radii.back().get_d());
    if (!std::isfinite(a)) continue;
    for (const double v : {std::nextafter(a, 0), a, std::nextafter(a, INFINITY)})
      if (alphas.size() < 30 && std::isfinite(v)) alphas.insert(v);
  }
  for (const double alpha : alphas) {
    const AlphaShape shape = alpha_shape(view_of(s), t, alpha);
    std::set<std::uint32_t> kept;
    for (std::uint32_t c = 0; c < t.size(); ++c)
      if (std::isinf(alpha) || radii[c] <= mpq_class(alpha) * mpq_class(alpha)) kept.insert(c);
    EXPECT_TRUE(std::set<std::uint32_t>(shape.cells.begin(), shape.cells.end()) == kept)
        << s.name << ", alpha " << alpha;
    // Facets that an odd number of kept cells has.
    std::map<std::set<std::uint32_t>, std::set<std::uint32_t>> facets, found;
    for (const std::uint32_t c : kept)
      for (const std::uint32_t v : t.cell(c)) {
        std::set<std::uint32_t> facet(t.cell(c).begin(), t.cell(c).end());
        facet.erase(v);
        if (!facet.empty()) facets[facet].insert(c);
      }
    std::erase_if(facets, [](const auto& f) { return f.second.size() != 1; });
    const unsigned k = t.corners() > 0 ? t.corners() - 1 : 0;
    for (std::size_t f = 0; f < shape.facet_cells.size(); ++f)
      found[{shape.facets.begin() + static_cast<std::ptrdiff_t>(f * k),
             shape.facets.begin() + static_cast<std::ptrdiff_t>((f + 1) * k)}] = {
          shape.facet_cells[f]};
    EXPECT_TRUE(facets == found) << s.name << ", alpha " << alpha;
    if (!std::isinf(alpha) || t.affine_dimension < 1) continue;
    EXPECT_EQ(shape.facets, t.hull_facets) << s.name;
    EXPECT_EQ(shape.facet_cells, t.hull_cells) << s.name;
  }
}

TEST(AlphaShape, SmallSetsAreAsDefined) {
  for (unsigned d = 1; d <= 4; ++d)
    for (const LiftedSet& s : small_lifted_sets(d, 43))
      if (s.weights.empty()) check(s);
}

bool reaches(double radius, const mpq_class& square) {
  return std::isinf(radius) || mpq_class(radius) * mpq_class(radius) >= square;
}

/// Whether each vertex has a cell among those of at most this radius, and they are of one piece.
std::pair<bool, bool> slow_goals(const Triangulation& t, const Array<double>& radii, double alpha) {
  std::set<std::uint32_t> met, kept, todo;
  for (std::uint32_t c = 0; c < t.size(); ++c) {
    if (radii[c] > alpha) continue;
    kept.insert(c);
    met.insert(t.cell(c).begin(), t.cell(c).end());
  }
  const bool all = met.size() == t.vertex_count();
  if (kept.empty()) return {all, false};
  todo.insert(*kept.begin());
  while (!todo.empty()) {
    const std::uint32_t c = *todo.begin();
    todo.erase(todo.begin());
    kept.erase(c);
    for (const std::uint32_t o : t.neighbours_of(c))
      if (kept.contains(o)) todo.insert(o);
  }
  return {all, all && kept.empty()};
}

void check_radii(const LiftedSet& s) {
  const Triangulation t = triangulate(s);
  const Array<double> radii = alpha_radii(view_of(s), t);
  ASSERT_EQ(radii.size(), t.size());
  std::set<double> candidates{0};
  for (std::uint64_t c = 0; c < t.size(); ++c) {
    const mpq_class square = t.affine_dimension > 0 ? slow_radius(s, t.cell(c)) : mpq_class(0);
    EXPECT_TRUE(reaches(radii[c], square)) << s.name;
    EXPECT_TRUE(radii[c] == 0 || !reaches(std::nextafter(radii[c], 0), square)) << s.name;
    candidates.insert(radii[c]);
  }
  double all = -1, one = -1;
  for (const double alpha : candidates) {
    const auto [has_all, is_one] = slow_goals(t, radii, alpha);
    if (has_all && all < 0) all = alpha;
    if (is_one && one < 0) one = alpha;
  }
  if (t.size() == 0) one = 0;
  EXPECT_EQ(critical_alpha(view_of(s), t, false), all) << s.name;
  EXPECT_EQ(critical_alpha(view_of(s), t, true), one) << s.name;
}

TEST(AlphaShape, RadiiAreTheLeastDoubles) {
  for (unsigned d = 1; d <= 4; ++d)
    for (const LiftedSet& s : small_lifted_sets(d, 47))
      if (s.weights.empty()) check_radii(s);
  check_radii({"none", 2, {}, {}});
  check_radii({"one", 2, {3, 4}, {}});
  check_radii(random_points(2, 60, 9));
  check_radii(drawn_grid(2, 60, 9, 1, 0, 9));
  check_radii(random_points(3, 40, 9));
}

mpq_class twice_area(const LiftedSet& s, const Triangulation& t,
                     std::span<const std::uint32_t> ring) {
  mpq_class sum = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Rationals a = rational_point(s, ring[i]),
                    b = rational_point(s, ring[(i + 1) % ring.size()]);
    sum += a[t.axes[0]] * b[t.axes[1]] - a[t.axes[1]] * b[t.axes[0]];
  }
  return sum;
}

/// Rings have each edge of the boundary once and no point twice, outer ones turn left and holes
/// right, areas add up piece by piece.
void check_polygons(const LiftedSet& s, const Triangulation& t,
                    const std::vector<std::uint32_t>& cells) {
  const CellPolygons polygons = cell_polygons(view_of(s), t, cells);
  std::multiset<std::pair<std::uint32_t, std::uint32_t>> edges, found;
  mpq_class area = 0, sum = 0;
  for (const std::uint32_t c : cells) {
    area += twice_area(s, t, t.cell(c));
    for (unsigned j = 0; j < 3; ++j)
      if (std::count(cells.begin(), cells.end(), t.neighbours_of(c)[j]) == 0)
        edges.emplace(t.cell(c)[(j + 1) % 3], t.cell(c)[(j + 2) % 3]);
  }
  std::set<std::uint32_t> todo(cells.begin(), cells.end());
  std::size_t pieces = 0;
  for (; !todo.empty(); ++pieces) {
    std::vector<std::uint32_t> stack{*todo.begin()};
    todo.erase(todo.begin());
    while (!stack.empty()) {
      const std::uint32_t c = stack.back();
      stack.pop_back();
      for (const std::uint32_t o : t.neighbours_of(c))
        if (todo.erase(o) > 0) stack.push_back(o);
    }
  }
  EXPECT_EQ(polygons.polygon_count(), pieces) << s.name;
  for (std::uint64_t i = 0; i < polygons.polygon_count(); ++i)
    for (std::uint64_t r = polygons.polygon_offsets[i]; r < polygons.polygon_offsets[i + 1]; ++r) {
      const std::span<const std::uint32_t> ring = polygons.rings[r];
      EXPECT_EQ(std::set<std::uint32_t>(ring.begin(), ring.end()).size(), ring.size()) << s.name;
      EXPECT_EQ(ring[0], *std::min_element(ring.begin(), ring.end()));
      const mpq_class own = twice_area(s, t, ring);
      EXPECT_EQ(own > 0, r == polygons.polygon_offsets[i]) << s.name;
      sum += own;
      for (std::size_t v = 0; v < ring.size(); ++v)
        found.emplace(ring[v], ring[(v + 1) % ring.size()]);
    }
  EXPECT_TRUE(edges == found) << s.name;
  EXPECT_TRUE(area == sum) << s.name;
}

TEST(AlphaShape, PolygonsAreTheBoundaryOfCells) {
  std::vector<LiftedSet> sets{random_points(2, 40, 3),
                              drawn_grid(2, 40, 7, 1, 0, 3),
                              in_a_flat(3, 2, 30, 3),
                              {"none", 2, {}, {}}};
  for (const LiftedSet& s : small_lifted_sets(2, 53))
    if (s.weights.empty()) sets.push_back(s);
  std::mt19937_64 random(5);
  for (const LiftedSet& s : sets) {
    const Triangulation t = triangulate(s);
    if (t.affine_dimension != 2) {
      EXPECT_EQ(cell_polygons(view_of(s), t, {}).ring_count(), 0U);
      continue;
    }
    for (unsigned share = 1; share <= 4; ++share) {
      std::vector<std::uint32_t> cells;
      for (std::uint32_t c = 0; c < t.size(); ++c)
        if (random() % 4 < share) cells.push_back(c);
      check_polygons(s, t, cells);
    }
  }
}

/// A square's half diagonal is no double: both of its neighbours tell the cells apart.
TEST(AlphaShape, ComparesExactly) {
  const std::vector<double> rows{0, 0, 1, 0, 0, 1, 1, 1};
  const PointView points = PointView::row_major(rows.data(), 4, 2);
  const Triangulation t = delaunay(points);
  EXPECT_EQ(alpha_shape(points, t, std::nextafter(std::sqrt(0.5), 0)).cells.size(), 0U);
  EXPECT_EQ(alpha_shape(points, t, std::nextafter(std::sqrt(0.5), 1)).cells.size(), 2U);
  const std::vector<double> wide{0, 0, 6, 0, 0, 8};  // a radius of 5
  const PointView triangle = PointView::row_major(wide.data(), 3, 2);
  EXPECT_EQ(alpha_shape(triangle, delaunay(triangle), 5).cells.size(), 1U);
  EXPECT_EQ(alpha_shape(triangle, delaunay(triangle), std::nextafter(5, 0)).cells.size(), 0U);
}

TEST(AlphaShape, RefusesWhatIsNone) {
  const LiftedSet s = random_points(2, 20, 1);
  const Triangulation t = triangulate(s);
  EXPECT_THROW(alpha_shape(view_of(s), t, -1), Error);
  EXPECT_THROW(alpha_shape(view_of(s), t, NAN), Error);
  EXPECT_THROW(alpha_shape(view_of(random_points(2, 19, 1)), t, 1), Error);
}

}  // namespace alpha_shape_test
}  // namespace cullhull
