// Voronoi and power diagrams against their definition in rational numbers.
#include "cullhull/voronoi.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>

#include "agreement/random_seeds.hpp"
#include "cullhull/error.hpp"
#include "diagrams/slow_cells.hpp"
#include "tests/counted_memory.hpp"
#include "thrown.hpp"

namespace cullhull {
namespace voronoi_test {

using namespace testing_support;

/// Of a facet and the corner opposite to it.
Rationals slow_ray(const LiftedSet& s, std::span<const std::uint32_t> facet,
                   std::uint32_t opposite) {
  const Rationals from = rational_point(s, facet[0]);
  Rationals away = minus(from, rational_point(s, opposite));
  std::vector<Rationals> edges, m;
  for (std::size_t i = 1; i < facet.size(); ++i)
    edges.push_back(minus(rational_point(s, facet[i]), from));
  for (const Rationals& e : edges) {
    Rationals row;
    for (const Rationals& o : edges) row.push_back(dot(e, o));
    row.push_back(dot(e, away));
    m.push_back(row);
  }
  const Rationals shares = *solved(m, edges.size());
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (std::size_t j = 0; j < away.size(); ++j) away[j] -= shares[i] * edges[i][j];
  return away;
}

struct SlowDual {
  std::vector<Rationals> centres;               ///< of groups
  std::vector<std::set<std::uint32_t>> groups;  ///< vertices
  struct Ray {
    std::uint32_t group;
    Rationals direction, from;
  };
  std::vector<Ray> rays;
};

SlowDual slow_dual(const LiftedSet& s, const Triangulation& t) {
  SlowDual dual;
  for (std::uint32_t c = 0; c < t.size(); ++c) {
    if (t.group(c) == dual.groups.size()) {
      dual.groups.emplace_back();
      dual.centres.push_back(slow_centre(s, t.cell(c)));
    }
    dual.groups[t.group(c)].insert(t.cell(c).begin(), t.cell(c).end());
  }
  for (std::uint64_t f = 0; f < t.hull_facet_count(); ++f) {
    const auto facet = t.hull_facet(f);
    for (const std::uint32_t v : t.cell(t.hull_cells[f]))
      if (std::find(facet.begin(), facet.end(), v) == facet.end())
        dual.rays.push_back(
            {t.group(t.hull_cells[f]), slow_ray(s, facet, v), rational_point(s, facet[0])});
  }
  return dual;
}

/// The groups and at_infinity around two points, if the ridge between them has dimension k - 1.
std::set<std::uint32_t> slow_ridge(const LiftedSet& s, const Triangulation& t, const SlowDual& dual,
                                   std::uint32_t a, std::uint32_t b) {
  std::set<std::uint32_t> around;
  std::vector<Rationals> spanned;
  std::uint32_t first = no_index;
  for (std::uint32_t g = 0; g < dual.groups.size(); ++g) {
    if (!dual.groups[g].count(a) || !dual.groups[g].count(b)) continue;
    if (first == no_index) first = g;
    around.insert(g);
    spanned.push_back(minus(dual.centres[g], dual.centres[first]));
  }
  for (const auto& ray : dual.rays) {
    if (!around.count(ray.group)) continue;
    if (dot(ray.direction, minus(rational_point(s, a), ray.from)) != 0 ||
        dot(ray.direction, minus(rational_point(s, b), ray.from)) != 0)
      continue;
    around.insert(at_infinity);
    spanned.push_back(ray.direction);
  }
  if (around.empty() || static_cast<int>(echelon(spanned).size()) != t.affine_dimension - 1)
    return {};
  return around;
}

void check_vertices(const LiftedSet& s, const SlowDual& dual, const Voronoi& v) {
  ASSERT_EQ(v.vertex_count(), dual.centres.size()) << s.name;
  for (std::size_t g = 0; g < dual.centres.size(); ++g)
    for (unsigned j = 0; j < s.dimension; ++j) {
      const double x = v.vertices[g * s.dimension + j];
      const mpq_class& exact = dual.centres[g][j];
      if (std::isinf(x))
        EXPECT_TRUE(abs(exact) >= mpq_class(std::numeric_limits<double>::max())) << s.name;
      else
        EXPECT_TRUE(nearest_to(x, exact)) << s.name << ": " << x << " for " << exact.get_d();
    }
}

void check_rays(const LiftedSet& s, const SlowDual& dual, const Voronoi& v) {
  ASSERT_EQ(v.ray_vertices.size(), dual.rays.size()) << s.name;
  for (std::size_t f = 0; f < dual.rays.size(); ++f) {
    EXPECT_EQ(v.ray_vertices[f], dual.rays[f].group);
    const double* r = v.ray_directions.data() + f * s.dimension;
    const Rationals& exact = dual.rays[f].direction;
    unsigned largest = 0;
    for (unsigned j = 1; j < s.dimension; ++j)
      if (abs(exact[j]) > abs(exact[largest])) largest = j;
    EXPECT_TRUE(std::abs(r[largest]) >= 0.5 && std::abs(r[largest]) <= 1) << s.name;
    const mpq_class unit = mpq_class(r[largest]) / exact[largest];
    EXPECT_EQ(unit > 0, !v.furthest_site) << s.name;
    for (unsigned j = 0; j < s.dimension; ++j)
      EXPECT_TRUE(near(r[j], unit * exact[j], 0x1p-49, mpq_class(0x1p-1000)))
          << s.name << ": " << r[j];
  }
}

void check_ridges(const LiftedSet& s, const Triangulation& t, const SlowDual& dual,
                  const Voronoi& v) {
  std::map<std::pair<std::uint32_t, std::uint32_t>, std::set<std::uint32_t>> expected, found;
  if (t.affine_dimension > 0)
    for (std::uint32_t a = 0; a < s.count(); ++a)
      for (std::uint32_t b = a + 1; b < s.count(); ++b)
        if (auto ridge = slow_ridge(s, t, dual, a, b); !ridge.empty()) expected[{a, b}] = ridge;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> order;
  for (std::uint64_t r = 0; r < v.ridge_count(); ++r) {
    order.emplace_back(v.ridge_points[2 * r], v.ridge_points[2 * r + 1]);
    const auto list = v.ridge(r);
    found[order.back()] = std::set<std::uint32_t>(list.begin(), list.end());
    EXPECT_EQ(found[order.back()].size(), list.size()) << s.name;
    for (std::size_t i = 0; t.affine_dimension == 3 && i < list.size(); ++i) {
      const std::uint32_t g = list[i], next = list[(i + 1) % list.size()];
      if (g == at_infinity || next == at_infinity) continue;
      std::vector<Rationals> common;
      for (const std::uint32_t p : dual.groups[g])
        if (dual.groups[next].count(p))
          common.push_back(minus(rational_point(s, p), rational_point(s, order.back().first)));
      EXPECT_EQ(echelon(common).size(), 2U) << s.name << ": no common face";
    }
  }
  EXPECT_TRUE(std::is_sorted(order.begin(), order.end())) << s.name;
  EXPECT_TRUE(expected == found) << s.name << ": " << found.size() << " ridges, not "
                                 << expected.size();
}

void check_regions(const LiftedSet& s, const Triangulation& t, const SlowDual& dual,
                   const Voronoi& v) {
  ASSERT_EQ(v.regions.size(), s.count()) << s.name;
  for (std::uint32_t p = 0; p < s.count(); ++p) {
    std::set<std::uint32_t> expected;
    for (std::uint32_t g = 0; g < dual.groups.size(); ++g)
      if (dual.groups[g].count(p)) expected.insert(g);
    for (const auto& ray : dual.rays)
      if (expected.count(ray.group) &&
          dot(ray.direction, minus(rational_point(s, p), ray.from)) == 0)
        expected.insert(at_infinity);
    if (t.affine_dimension == 0)
      expected = t.cells[0] == p ? std::set<std::uint32_t>{at_infinity} : std::set<std::uint32_t>();
    const auto list = v.region(p);
    EXPECT_EQ(std::set<std::uint32_t>(list.begin(), list.end()), expected) << s.name;
    EXPECT_EQ(list.size(), expected.size()) << s.name;
  }
}

void check(const LiftedSet& s, bool furthest = false) {
  TriangulationOptions o;
  o.furthest_site = furthest;
  const Triangulation t = triangulate(s, o);
  const Voronoi v = voronoi(view_of(s), t, s.weights);
  const SlowDual dual = t.affine_dimension > 0 ? slow_dual(s, t) : SlowDual();
  check_vertices(s, dual, v);
  check_rays(s, dual, v);
  check_ridges(s, t, dual, v);
  check_regions(s, t, dual, v);
}

TEST(Voronoi, SmallSetsAreAsDefined) {
  for (unsigned d = 1; d <= 4; ++d)
    for (const LiftedSet& s : sampled(small_lifted_sets(d, 23))) check(s);
}

TEST(Voronoi, RandomSmallSetsAreAsDefined) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed)
    for (unsigned d = 1; d <= 4; ++d) check(random_lifted_set(d, seed));
}

TEST(Voronoi, FurthestSite) {
  for (unsigned d = 1; d <= 3; ++d)
    for (const LiftedSet& s : small_lifted_sets(d, 29)) check(s, true);
}

TEST(Voronoi, FewPoints) {
  for (unsigned d = 1; d <= 4; ++d)
    for (const LiftedSet& s : few_points(d)) check(s);
}

/// Twice the area around the vertices.
double around(const Voronoi& v, std::span<const std::uint32_t> list, unsigned x, unsigned y) {
  double sum = 0;
  for (std::size_t i = 0; i < list.size(); ++i) {
    const double* a = v.vertices.data() + list[i] * v.dimension;
    const double* b = v.vertices.data() + list[(i + 1) % list.size()] * v.dimension;
    sum += a[x] * b[y] - a[y] * b[x];
  }
  return sum;
}

TEST(Voronoi, RegionsInThePlaneTurnLeft) {
  const LiftedSet s = random_points(2, 300, 4);
  const Voronoi v = voronoi(view_of(s), triangulate(s));
  unsigned bounded = 0;
  for (std::uint32_t p = 0; p < 300; ++p) {
    const auto list = v.region(p);
    ASSERT_GT(list.size(), 1U);
    if (list[0] == at_infinity) continue;
    ++bounded;
    EXPECT_EQ(list[0], *std::min_element(list.begin(), list.end()));
    EXPECT_GT(around(v, list, 0, 1), 0);
  }
  EXPECT_GT(bounded, 250U);
}

TEST(Voronoi, RidgesGoRoundTheirEdges) {
  const LiftedSet plane = random_points(2, 300, 4);
  const Voronoi flat = voronoi(view_of(plane), triangulate(plane));
  for (std::uint64_t r = 0; r < flat.ridge_count(); ++r) {
    const auto list = flat.ridge(r);
    ASSERT_EQ(list.size(), 2U);
    if (list[0] == at_infinity || list[1] == at_infinity) continue;
    const double* p = plane.rows.data() + flat.ridge_points[2 * r] * 2;
    const double* q = plane.rows.data() + flat.ridge_points[2 * r + 1] * 2;
    const double *a = flat.vertices.data() + list[0] * 2, *b = flat.vertices.data() + list[1] * 2;
    EXPECT_GT((q[0] - p[0]) * (a[1] - b[1]) - (q[1] - p[1]) * (a[0] - b[0]), 0);
  }
  const LiftedSet space = random_points(3, 300, 5);
  const Voronoi v = voronoi(view_of(space), triangulate(space));
  for (std::uint64_t r = 0; r < v.ridge_count(); ++r) {
    const auto list = v.ridge(r);
    if (list[0] == at_infinity) continue;
    const double* p = space.rows.data() + v.ridge_points[2 * r] * 3;
    const double* q = space.rows.data() + v.ridge_points[2 * r + 1] * 3;
    double turn = 0;
    for (unsigned j = 0; j < 3; ++j)
      turn += (q[j] - p[j]) * around(v, list, (j + 1) % 3, (j + 2) % 3);
    EXPECT_GT(turn, 0);
  }
}

TEST(Voronoi, ThreadsChangeNothing) {
  for (unsigned d = 1; d <= 3; ++d)
    for (const LiftedSet& s : large_lifted_sets(d, 6000)) {
      const Triangulation t = triangulate(s);
      Options o;
      o.threads = 1;
      const Voronoi one = voronoi(view_of(s), t, s.weights, o);
      for (const unsigned threads : {2U, 8U}) {
        o.threads = threads;
        const Voronoi v = voronoi(view_of(s), t, s.weights, o);
        EXPECT_EQ(v.vertices, one.vertices);
        EXPECT_EQ(v.ridge_points, one.ridge_points);
        EXPECT_EQ(v.ridges, one.ridges);
        EXPECT_EQ(v.regions, one.regions);
        EXPECT_EQ(v.ray_directions, one.ray_directions);
      }
    }
}

TEST(Voronoi, RefusesWhatIsNone) {
  const LiftedSet s = random_points(2, 20, 1);
  const Triangulation t = triangulate(s);
  const LiftedSet other = random_points(2, 19, 1);
  EXPECT_THROW(voronoi(view_of(other), t), Error);
  const std::vector<double> weights(19);
  EXPECT_THROW(voronoi(view_of(s), t, weights), Error);
  Options o;
  o.memory_budget = 100;
  error_of(ErrorCode::out_of_budget, [&] { voronoi(view_of(s), t, {}, o); });
}

/// All whole points on the circle around 0 with that square of the radius.
LiftedSet whole_circle(long square) {
  LiftedSet s{"circle", 2, {}, {}};
  for (long x = 0; x * x <= square; ++x) {
    const long y = std::lround(std::sqrt(static_cast<double>(square - x * x)));
    if (x * x + y * y != square) continue;
    for (const long u : {x, -x})
      for (const long v : {y, -y}) s.rows.insert(s.rows.end(), {double(u), double(v)});
  }
  return s;
}

TEST(Voronoi, CellsOfOneCircleTakeLinearWork) {
  std::vector<std::uint64_t> bytes;
  std::vector<std::uint64_t> counts;
  for (const long square : {5L * 13 * 17 * 29, 5L * 5 * 5 * 13 * 13 * 17 * 29 * 37}) {
    const LiftedSet s = whole_circle(square);
    const Triangulation t = triangulate(s);
    ASSERT_EQ(t.cell_groups.back(), 0U);
    Options o;
    o.threads = 1;
    const std::int64_t before = allocated_bytes;
    const Voronoi v = voronoi(view_of(s), t, {}, o);
    bytes.push_back(static_cast<std::uint64_t>(allocated_bytes - before));
    counts.push_back(s.count());
    EXPECT_EQ(v.vertices.size(), 2U);
    EXPECT_EQ(v.ridge_points.size(),
              2 * s.count());  // rays alone: one for each side of the polygon
  }
  ASSERT_GE(counts[1], 6 * counts[0]);
  EXPECT_LT(bytes[1], 12 * bytes[0]);  // 36 times as many where work is quadratic
}

}  // namespace voronoi_test
}  // namespace cullhull
