// Constrained triangulations against their certificate, and against what is forced and inside by
// definition, in rational numbers.
#include "cullhull/constrained.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <set>

#include "cullhull/error.hpp"
#include "diagrams/slow_cells.hpp"
#include "thrown.hpp"

namespace cullhull {
namespace constrained_test {

using namespace testing_support;
using Edges = std::vector<std::uint32_t>;

int turn(const LiftedSet& s, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const Rationals p = rational_point(s, a), q = rational_point(s, b), r = rational_point(s, c);
  return sgn(mpq_class((q[0] - p[0]) * (r[1] - p[1]) - (q[1] - p[1]) * (r[0] - p[0])));
}
bool cross(const LiftedSet& s, std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t e) {
  return turn(s, a, b, c) * turn(s, a, b, e) < 0 && turn(s, c, e, a) * turn(s, c, e, b) < 0;
}

/// Edges that do not cross each other, drawn at random.
Edges random_edges(const LiftedSet& s, unsigned tries, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  Edges edges;
  const auto n = static_cast<std::uint32_t>(s.count());
  for (unsigned i = 0; i < tries && n > 0; ++i) {
    const auto a = static_cast<std::uint32_t>(random() % n),
               b = static_cast<std::uint32_t>(random() % n);
    bool free = true;
    for (std::size_t e = 0; e < edges.size(); e += 2)
      free = free && !cross(s, a, b, edges[e], edges[e + 1]);
    if (free) edges.insert(edges.end(), {a, b});
  }
  return edges;
}

std::set<std::pair<std::uint32_t, std::uint32_t>> edges_of(const Triangulation& t) {
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  const unsigned m = t.corners();
  for (std::uint64_t c = 0; c < t.size(); ++c)
    for (unsigned i = 0; i < m; ++i)
      for (unsigned j = i + 1; j < m; ++j) edges.emplace(std::minmax(t.cell(c)[i], t.cell(c)[j]));
  return edges;
}

/// Which triangles there are by definition: those of no area crossed by constraints, whose circle
/// has no point inside that sees their interior. True of each cell.
bool slow_is_delaunay(const LiftedSet& s, const Triangulation& t,
                      std::span<const std::uint32_t> cell, const Edges& edges) {
  const auto n = static_cast<std::uint32_t>(s.count());
  for (std::uint32_t v = 0; v < n; ++v) {
    // In-circle by lifted determinant.
    std::vector<Rationals> m;
    const Rationals q = rational_point(s, v);
    for (const std::uint32_t c : cell) {
      const Rationals p = rational_point(s, c);
      const mpq_class x = p[0] - q[0], y = p[1] - q[1];
      m.push_back({x, y, x * x + y * y});
    }
    mpq_class det;
    echelon(m, &det);
    if (det <= 0) continue;
    // Visible from a point inside the triangle: the centroid.
    LiftedSet probe = s;
    probe.rows.insert(probe.rows.end(), {0, 0});
    Rationals centre(2);
    for (const std::uint32_t c : cell)
      for (unsigned j = 0; j < 2; ++j) centre[j] += rational_point(s, c)[j] / 3;
    bool seen = true;
    const auto turned = [&](const Rationals& a, const Rationals& b, const Rationals& c) {
      return sgn(mpq_class((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])));
    };
    for (std::size_t e = 0; e < edges.size() && seen; e += 2) {
      const Rationals a = rational_point(s, edges[e]), b = rational_point(s, edges[e + 1]);
      if (a == b || a == q || b == q) continue;
      if (turned(a, b, q) * turned(a, b, centre) <= 0 &&
          turned(centre, q, a) * turned(centre, q, b) <= 0)
        seen = false;
    }
    if (seen) return false;
  }
  (void)t;
  return true;
}

ConstrainedTriangulation check(const LiftedSet& s, const Edges& edges, bool slow = true) {
  const ConstrainedTriangulation c = constrained_delaunay(view_of(s), edges);
  const Certificate proof = certify(view_of(s), edges, c);
  EXPECT_TRUE(proof.valid) << s.name << ": " << proof.reason;
  const Triangulation& t = c.triangulation;
  EXPECT_EQ(t.affine_dimension, triangulate(s).affine_dimension);
  EXPECT_EQ(t.cells.size(), triangulate(s).cells.size());
  const auto there = edges_of(t);
  for (std::size_t i = 0; i < c.pieces.size(); i += 2)
    EXPECT_TRUE(there.contains({c.pieces[i], c.pieces[i + 1]})) << s.name;
  if (slow && t.affine_dimension == 2) {
    for (std::uint64_t i = 0; i < t.size(); ++i)
      EXPECT_TRUE(slow_is_delaunay(s, t, t.cell(i), edges)) << s.name << ", cell " << i;
  }
  // The other way round, and with each edge from its other end.
  Edges turned;
  for (std::size_t i = edges.size(); i > 0; i -= 2)
    turned.insert(turned.end(), {edges[i - 1], edges[i - 2]});
  const ConstrainedTriangulation again = constrained_delaunay(view_of(s), turned);
  EXPECT_EQ(again.triangulation.cells, t.cells) << s.name;
  EXPECT_EQ(again.triangulation.neighbours, t.neighbours) << s.name;
  EXPECT_EQ(again.pieces, c.pieces) << s.name;
  EXPECT_EQ(again.depths, c.depths) << s.name;
  return c;
}

TEST(Constrained, SmallSetsAreCertified) {
  for (std::uint64_t seed = 0; seed < 6; ++seed)
    for (const LiftedSet& s : small_lifted_sets(2, 71 + seed))
      if (s.weights.empty()) check(s, random_edges(s, 12, seed));
}

TEST(Constrained, FewPoints) {
  LiftedSet s{"few", 2, {}, {}};
  std::mt19937_64 random(3);
  for (unsigned n = 0; n < 9; ++n) {
    check(s, random_edges(s, 5, n));
    for (unsigned j = 0; j < 2; ++j) s.rows.push_back(static_cast<double>(random() % 3));
  }
}

TEST(Constrained, NothingForcedIsDelaunay) {
  for (const LiftedSet& s : {random_points(2, 300, 1), drawn_grid(2, 300, 17, 1, 0, 1)}) {
    const Triangulation t = triangulate(s);
    const ConstrainedTriangulation c = constrained_delaunay(view_of(s), {});
    EXPECT_EQ(c.triangulation.cells, t.cells);
    EXPECT_EQ(c.triangulation.neighbours, t.neighbours);
    EXPECT_EQ(c.triangulation.hull_facets, t.hull_facets);
    EXPECT_EQ(c.triangulation.hull_cells, t.hull_cells);
    EXPECT_EQ(c.pieces.size(), 0U);
  }
}

TEST(Constrained, ManyEdges) {
  for (std::uint64_t seed = 0; seed < 4; ++seed) {
    check(random_points(2, 60, seed), random_edges(random_points(2, 60, seed), 150, seed));
    const LiftedSet grid = drawn_grid(2, 80, 10, 1, 0, seed);
    check(grid, random_edges(grid, 150, seed));
    const LiftedSet tenths = drawn_grid(2, 50, 8, 0.1, 0.3, seed);
    check(tenths, random_edges(tenths, 80, seed));
    const LiftedSet circle = on_a_sphere(2, 8, seed);
    check(circle, random_edges(circle, 8, seed));
  }
}

/// One edge through many points, and over a fan whose hub it passes.
TEST(Constrained, LongEdges) {
  LiftedSet grid{"grid", 2, {}, {}};
  for (unsigned x = 0; x < 40; ++x)
    for (unsigned y = 0; y < 40; ++y) grid.rows.insert(grid.rows.end(), {double(x), double(y)});
  const ConstrainedTriangulation c = check(grid, {0, 1599, 3, 1203, 39, 495}, false);
  EXPECT_GE(c.pieces.size(), 2U * (39 + 30 + 12));
  for (unsigned n : {10U, 200U, 2000U}) {
    LiftedSet fan{"fan", 2, {-1, 0.5, double(n), 0.25, n / 2.0, double(n)}, {}};
    for (unsigned i = 0; i < n; ++i)
      fan.rows.insert(fan.rows.end(), {double(i), -0.001 * ((i * 7) % 11)});
    for (unsigned i = 0; i < n; ++i)
      fan.rows.insert(fan.rows.end(), {double(i) + 0.4, 1 + 0.001 * ((i * 5) % 13)});
    check(fan, {0, 1}, n <= 10);
  }
  const LiftedSet many = random_points(2, 20000, 4);
  std::uint32_t low = 0, high = 0;
  for (std::uint32_t i = 0; i < many.count(); ++i) {
    if (many.rows[2 * i] < many.rows[2 * low]) low = i;
    if (many.rows[2 * i] > many.rows[2 * high]) high = i;
  }
  check(many, {low, high}, false);
}

/// A spiral of points: a ring whose edges are far from Delaunay.
TEST(Constrained, InsideOfRings) {
  std::mt19937_64 random(8);
  LiftedSet s{"rings", 2, {}, {}};
  Edges edges;
  const auto ring = [&](double radius, unsigned n) {
    const auto first = static_cast<std::uint32_t>(s.count());
    for (unsigned i = 0; i < n; ++i) {
      const double a = 6.283185307179586 * i / n, r = radius * (i % 2 == 0 ? 1 : 0.8);
      s.rows.insert(s.rows.end(), {r * std::cos(a), r * std::sin(a)});
      edges.insert(edges.end(), {first + i, first + (i + 1) % n});
    }
  };
  ring(10, 40);
  ring(6, 30);  // a hole
  ring(3, 20);  // an island
  const auto fixed = static_cast<std::uint32_t>(s.count());
  for (unsigned i = 0; i < 60; ++i)
    for (unsigned j = 0; j < 2; ++j)
      s.rows.push_back(static_cast<double>(random() % 2400) / 100 - 12);
  edges.insert(edges.end(), {fixed, fixed});  // nothing
  const ConstrainedTriangulation whole = check(s, edges);
  ConstrainedOptions o;
  o.inside_only = true;
  const ConstrainedTriangulation inside = constrained_delaunay(view_of(s), edges, o);
  std::uint64_t kept = 0;
  for (std::uint64_t c = 0; c < whole.triangulation.size(); ++c) {
    // By crossings of a ray from the centroid with the rings.
    Rationals centre(2);
    for (const std::uint32_t v : whole.triangulation.cell(c))
      for (unsigned j = 0; j < 2; ++j) centre[j] += rational_point(s, v)[j] / 3;
    unsigned crossings = 0;
    for (std::size_t e = 0; e < edges.size(); e += 2) {
      const Rationals a = rational_point(s, edges[e]), b = rational_point(s, edges[e + 1]);
      if ((a[1] > centre[1]) == (b[1] > centre[1])) continue;
      if (a[0] + (centre[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]) > centre[0]) ++crossings;
    }
    EXPECT_EQ(crossings % 2, whole.depths[c] % 2) << c;
    if (crossings % 2 == 0) continue;
    ASSERT_LT(kept, inside.triangulation.size());
    EXPECT_TRUE(std::ranges::equal(whole.triangulation.cell(c), inside.triangulation.cell(kept)));
    ++kept;
  }
  EXPECT_EQ(kept, inside.triangulation.size());
  EXPECT_EQ(inside.triangulation.hull_facet_count(), 40U + 30U + 20U);
  for (std::uint64_t c = 0; c < kept; ++c)
    for (unsigned j = 0; j < 3; ++j) {
      const std::uint32_t n = inside.triangulation.neighbours_of(c)[j];
      if (n == no_index) continue;
      const auto back = inside.triangulation.neighbours_of(n);
      EXPECT_TRUE(std::count(back.begin(), back.end(), c) == 1);
    }
}

void expect_refusal(const LiftedSet& s, const Edges& edges, const std::string& message) {
  EXPECT_EQ(error_of(ErrorCode::invalid_argument, [&] { constrained_delaunay(view_of(s), edges); }),
            message);
}

TEST(Constrained, RefusesEdgesThatCross) {
  const LiftedSet s{"square", 2, {0, 0, 2, 0, 2, 2, 0, 2, 1, 0.5}, {}};
  expect_refusal(s, {0, 1, 0, 2, 1, 3}, "edges 1 (0, 2) and 2 (1, 3) cross");
  expect_refusal(s, {3, 1, 0, 1, 2, 0}, "edges 0 (3, 1) and 2 (2, 0) cross");
  expect_refusal(s, {0, 1, 2}, "constraints are pairs of points");
  expect_refusal(s, {0, 1, 2, 5}, "edge 1 has the point 5 of 5");
  expect_refusal(random_points(3, 9, 1), {},
                 "constrained triangulations are of points in the plane, not in dimension 3");
  for (std::uint64_t seed = 0; seed < 30; ++seed) {  // exactly those that cross are refused
    const LiftedSet r = drawn_grid(2, 12, 5, 1, 0, seed);
    std::mt19937_64 random(seed);
    Edges edges;
    for (unsigned i = 0; i < 6; ++i) edges.push_back(static_cast<std::uint32_t>(random() % 12));
    bool any = false;
    for (std::size_t a = 0; a < 6; a += 2)
      for (std::size_t b = 0; b < a; b += 2)
        any = any || cross(r, edges[a], edges[a + 1], edges[b], edges[b + 1]);
    // They also cross where a point lies on both.
    if (!any) {
      check(r, edges);
      continue;
    }
    const bool refused = !error_of([&] { constrained_delaunay(view_of(r), edges); }).empty();
    bool at_point = false;
    for (std::size_t a = 0; a < 6; a += 2)
      for (std::size_t b = 0; b < a; b += 2)
        for (std::uint32_t v = 0; v < 12; ++v)
          at_point = at_point || (turn(r, edges[a], edges[a + 1], v) == 0 &&
                                  turn(r, edges[b], edges[b + 1], v) == 0);
    EXPECT_TRUE(refused || at_point) << seed;
  }
}

TEST(Constrained, HubsOfManyEdges) {
  // Edges from the middle and from a corner of the hull to all they see, in either direction.
  for (const bool middle : {true, false})
    for (const bool turned : {false, true}) {
      LiftedSet s{"hub", 2, {0, middle ? 0.0 : -90.0}, {}};
      Edges edges;
      for (int i = 0; i < 60; ++i) {
        const double angle = i * 7 % 60 * 0.1, far = 1 + (i % 3) * 20;
        s.rows.insert(s.rows.end(), {far * std::cos(angle), far * std::sin(angle)});
        const auto v = static_cast<std::uint32_t>(i + 1);
        edges.insert(edges.end(), {turned ? v : 0U, turned ? 0U : v});
      }
      check(s, edges);
    }
}

/// Forcing polls once in so many triangles and edges that it looks at.
constexpr std::uint64_t steps_a_poll = 4096;

/// How many steps it takes to force these edges, give or take one poll.
std::uint64_t forcing_steps(const LiftedSet& s, const Edges& edges) {
  const auto polls = [&](const Edges& some) {
    std::uint64_t count = 0;
    ConstrainedOptions o;
    o.threads = 1;
    o.poll = [&] { ++count; };
    constrained_delaunay(view_of(s), some, o);
    return count;
  };
  return (polls(edges) - polls({})) * steps_a_poll;
}

TEST(Constrained, EdgesRoundOneHubTakeLinearWork) {
  constexpr std::uint32_t spokes = 16000;
  for (const bool middle : {true, false})
    for (const bool turned : {false, true}) {
      LiftedSet s{"hub", 2, {0, middle ? 0.0 : -2.0}, {}};
      Edges edges;
      for (std::uint32_t i = 0; i < spokes; ++i) {
        const double angle = i * (middle ? 6.28 : 3.14) / spokes;
        s.rows.insert(s.rows.end(), {std::cos(angle), std::sin(angle)});
        edges.insert(edges.end(), {turned ? i + 1 : 0U, turned ? 0U : i + 1});
      }
      // Up to 50 for each edge; going round the hub for each of them takes thousands.
      EXPECT_LT(forcing_steps(s, edges), 100U * spokes) << middle << " " << turned;
    }
}

TEST(Constrained, RefusalsNameTheFirstCrossingFromTheFirstPoint) {
  // A row of fences between 0 and 1; either end may be the busier one.
  LiftedSet s{"fences", 2, {0, 0, 20, 0}, {}};
  Edges fences;
  for (int i = 0; i < 8; ++i) {
    const double x = 2 + 2 * i;
    s.rows.insert(s.rows.end(), {x, -3 - 0.1 * i, x + 0.5, 3 + 0.2 * i});
    const auto v = static_cast<std::uint32_t>(2 + 2 * i);
    fences.insert(fences.end(), {v, v + 1});
  }
  for (const double side : {-1.0, 21.0})  // more points near one end
    for (const bool forward : {true, false}) {
      LiftedSet more = s;
      for (int i = 0; i < 9; ++i)
        more.rows.insert(more.rows.end(), {side + 0.01 * i * i, i - 4.0 + 0.3});
      Edges edges = fences;
      edges.insert(edges.end(), {forward ? 0U : 1U, forward ? 1U : 0U});
      expect_refusal(
          more, edges,
          forward ? "edges 0 (2, 3) and 8 (0, 1) cross" : "edges 7 (16, 17) and 8 (1, 0) cross");
    }
}

TEST(Constrained, CertificateRefusesWhatIsWrong) {
  const LiftedSet s = random_points(2, 40, 6);
  const Edges edges = random_edges(s, 20, 6);
  const ConstrainedTriangulation good = constrained_delaunay(view_of(s), edges);
  const auto refused = [&](const auto& change) {
    ConstrainedTriangulation bad = good;
    change(bad);
    EXPECT_FALSE(certify(view_of(s), edges, bad).valid);
  };
  refused([](auto& c) { std::swap(c.triangulation.cells[1], c.triangulation.cells[2]); });
  refused([](auto& c) { c.triangulation.neighbours[0] = 5; });
  refused([](auto& c) { c.depths[3] += 1; });
  refused([](auto& c) { c.pieces.resize(c.pieces.size() - 2), c.piece_sources.pop_back(); });
  refused([](auto& c) { c.piece_sources[0] += 1; });
  refused([](auto& c) { c.triangulation.hull_facets[0] = 99; });
  refused([&](auto& c) { c = constrained_delaunay(view_of(s), {}); });
  ConstrainedTriangulation other = constrained_delaunay(view_of(s), {});
  EXPECT_TRUE(certify(view_of(s), {}, other).valid);
  EXPECT_FALSE(certify(view_of(s), {}, good).valid);
}

ConstrainedOptions inside_alone() {
  ConstrainedOptions o;
  o.inside_only = true;
  return o;
}

TEST(Constrained, InsidesAreCertified) {
  for (std::uint64_t seed = 0; seed < 6; ++seed)
    for (const LiftedSet& s : small_lifted_sets(2, 91 + seed)) {
      if (!s.weights.empty()) continue;
      const Edges edges = random_edges(s, 12, seed);
      const auto inside = constrained_delaunay(view_of(s), edges, inside_alone());
      const Certificate proof = certify(view_of(s), edges, inside, inside_alone());
      EXPECT_TRUE(proof.valid) << s.name << ": " << proof.reason;
    }
  for (const LiftedSet& s : {LiftedSet{"none", 2, {}, {}}, LiftedSet{"one", 2, {1, 2}, {}},
                             LiftedSet{"line", 2, {0, 0, 1, 1, 2, 2}, {}}}) {
    const Edges edges = s.count() < 2 ? Edges{} : Edges{0, 1};
    const auto inside = constrained_delaunay(view_of(s), edges, inside_alone());
    EXPECT_TRUE(certify(view_of(s), edges, inside, inside_alone()).valid) << s.name;
  }
}

/// A square within a square, the ring between them kept, with points in all three regions.
TEST(Constrained, CertificateRefusesWhatIsNotTheInside) {
  LiftedSet s{"rings", 2, {0, 0, 9, 0, 9, 9, 0, 9, 3, 3, 6, 3, 6, 6, 3, 6}, {}};
  std::mt19937_64 random(2);
  for (unsigned i = 0; i < 120; ++i)
    s.rows.push_back(static_cast<double>(random() % 1300) / 100 - 2);
  s.rows.insert(s.rows.end(), {0, 0});  // a duplicate
  const Edges edges{0, 1, 1, 2, 2, 3, 3, 0, 4, 5, 5, 6, 6, 7, 7, 4};
  const auto good = constrained_delaunay(view_of(s), edges, inside_alone());
  const auto whole = constrained_delaunay(view_of(s), edges);
  const auto verdict = [&](const auto& c) {
    return certify(view_of(s), edges, c, inside_alone()).valid;
  };
  ASSERT_TRUE(verdict(good));
  ASSERT_LT(good.triangulation.size(), whole.triangulation.size());
  EXPECT_FALSE(verdict(whole));
  EXPECT_FALSE(certify(view_of(s), edges, good).valid);
  const auto refused = [&](const auto& change) {
    ConstrainedTriangulation bad = good;
    change(bad);
    EXPECT_FALSE(verdict(bad));
  };
  // One cell too few: its neighbours and the hull told as they would be.
  refused([](auto& c) {
    Triangulation& t = c.triangulation;
    for (unsigned i = 0; i < 3; ++i) t.cells.pop_back(), t.neighbours.pop_back();
    c.depths.pop_back();
    const auto gone = static_cast<std::uint32_t>(t.size());
    for (std::uint32_t& n : t.neighbours)
      if (n == gone) n = no_index;
  });
  // A cell of the hole in the place of one inside.
  refused([&](auto& c) {
    for (std::uint64_t i = 0; i < whole.triangulation.size(); ++i)
      if (whole.depths[i] == 2)
        std::copy_n(whole.triangulation.cell(i).begin(), 3, c.triangulation.cells.begin());
  });
  refused([](auto& c) {
    std::rotate(c.triangulation.cells.begin(), c.triangulation.cells.begin() + 1,
                c.triangulation.cells.begin() + 3);
  });
  refused([](auto& c) { c.triangulation.neighbours[0] ^= 1U; });
  refused([](auto& c) { c.depths[0] += 2; });
  refused([](auto& c) { c.triangulation.hidden.pop_back(); });
  refused([](auto& c) { c.triangulation.hidden.insert(c.triangulation.hidden.begin(), 0); });
  refused([](auto& c) { c.triangulation.duplicates.clear(); });
  refused([](auto& c) { c.triangulation.hull_facets[1] ^= 1U; });
  refused([](auto& c) { c.triangulation.hull_cells[0] += 1; });
  refused([](auto& c) { c.triangulation.hull_cells.pop_back(); });
  refused([](auto& c) { c.triangulation.cell_groups.assign(c.triangulation.size(), 0); });
  refused([](auto& c) { c.triangulation.affine_dimension = 1; });
  refused([](auto& c) { c.piece_sources[2] += 1; });
  refused([](auto& c) { c.pieces.resize(c.pieces.size() - 2), c.piece_sources.pop_back(); });
  refused([&](auto& c) { c = constrained_delaunay(view_of(s), {}, inside_alone()); });
  refused([&](auto& c) {  // without the hole
    c = constrained_delaunay(view_of(s), std::span(edges).first(8), inside_alone());
  });
  const Edges crossing{0, 2, 1, 3};
  EXPECT_FALSE(certify(view_of(s), crossing, good, inside_alone()).valid);
  EXPECT_FALSE(certify(view_of(random_points(2, 69, 1)), edges, good, inside_alone()).valid);
}

}  // namespace constrained_test
}  // namespace cullhull
