// The result made of the 3D engine's own facets is the one that the fallback gives, bit for bit,
// and a surface that is not a hull's is refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <string>
#include <vector>

#include "cullhull/generate.hpp"
#include "hull/space/triangle_mesh.hpp"
#include "result/write/write_simplices.hpp"
#include "tests/reference/framed_points.hpp"

namespace cullhull::internal::write_triangles_test {

using Rows = std::vector<double>;

/// A frame and an engine's surface.
struct Case : FramedPoints {
  explicit Case(const Rows& rows, unsigned threads = 1)
      : FramedPoints(rows, 3),
        surface(triangle_mesh(frame.points(), frame.simplex().data(),
                              run.with_budget(std::uint64_t{1} << 40).with_threads(threads))) {}

  TriangleMesh surface;
};

std::uint64_t the_general_way(const Rows& rows) {
  Case c(rows);
  Boundary surface = boundary_of(std::move(c.surface), c.run.with_threads(1));
  sort_simplices(surface, c.frame.points(), c.run);
  return c.the_general_way(std::move(surface));
}

/// Whether the short way can be gone; then its result is the same for any number of threads.
bool the_short_way(const Rows& rows, std::uint64_t expected) {
  for (const unsigned threads : {1U, 2U, 5U}) {
    Case c(rows, threads);
    Hull hull = c.empty_hull();
    if (!write_triangles(c.input(), c.surface, c.run.with_threads(threads), hull)) return false;
    EXPECT_EQ(testing_support::canonical_hash(hull), expected) << "threads " << threads;
  }
  return true;
}

bool same_both_ways(const Rows& rows) { return the_short_way(rows, the_general_way(rows)); }

Rows changed(Rows rows, const std::function<double(double, unsigned)>& change) {
  for (std::size_t i = 0; i < rows.size(); ++i)
    rows[i] = change(rows[i], static_cast<unsigned>(i % 3));
  return rows;
}

TEST(WriteTriangles, AsTheFallback) {
  for (const char* shape : {"sphere", "ball", "gauss", "cylinder", "cone", "cyclic"})
    for (const std::uint64_t n : {4, 5, 33, 700, 30'000}) {
      SCOPED_TRACE(std::string(shape) + " " + std::to_string(n));
      EXPECT_TRUE(same_both_ways(generate(shape, n, 3)));
    }
}

TEST(WriteTriangles, OtherFrames) {
  const Rows rows = generate("sphere", 9'000, 3);
  const double factors[] = {37.5, 1e-3, 4e5}, far[] = {1000, -77, 0.5};
  EXPECT_TRUE(same_both_ways(changed(rows, [&](double v, unsigned c) { return v * factors[c]; })));
  // Local coordinates are translated, the frame's are not.
  EXPECT_TRUE(same_both_ways(changed(rows, [&](double v, unsigned c) { return v + far[c]; })));
  EXPECT_TRUE(same_both_ways(changed(rows, [&](double v, unsigned) { return v * 1e-310; })));
  EXPECT_TRUE(same_both_ways(changed(rows, [&](double v, unsigned) { return v * 1e300; })));
  // Normals that need more bits.
  EXPECT_TRUE(
      same_both_ways(changed(rows, [&](double v, unsigned c) { return c == 2 ? v * 1e-9 : v; })));
  // More powers of two than doubles of one scale hold.
  EXPECT_FALSE(
      same_both_ways(changed(rows, [&](double v, unsigned c) { return c == 0 ? v * 1e300 : v; })));
}

/// A zero's sign shows in a plane's.
TEST(WriteTriangles, NegativeZeros) {
  std::mt19937 random(7);
  Rows rows = generate("sphere", 3'000, 3);
  for (unsigned i = 0; i < 3; ++i)
    for (const double at : {1.5, -1.5}) {
      Rows corner(3, -0.0);
      corner[i] = at;
      rows.insert(rows.end(), corner.begin(), corner.end());
    }
  EXPECT_TRUE(same_both_ways(rows));
  EXPECT_TRUE(same_both_ways({1, -0.0, -0.0, -0.0, 1, 0.0, 0.0, -0.0, 1, -0.0, 0.0, -0.0}));
}

TEST(WriteTriangles, EqualPoints) {
  std::mt19937 random(3);
  Rows rows = generate("sphere", 20'000, 3);
  for (std::size_t i = 0; i < 20'000; ++i) {
    if (random() % 3 != 0) continue;
    const std::size_t j = random() % 20'000;
    std::copy_n(rows.begin() + static_cast<std::ptrdiff_t>(3 * j), 3,
                rows.begin() + static_cast<std::ptrdiff_t>(3 * i));
  }
  EXPECT_TRUE(same_both_ways(rows));
}

/// Facets that share a plane need the fallback, however few they are.
TEST(WriteTriangles, CoplanarFacetsAreSeen) {
  Rows rows = generate("sphere", 5'000, 3);
  for (const double x : {-1.5, 1.5})
    for (const double y : {-1.5, 1.5}) rows.insert(rows.end(), {x, y, 2});
  EXPECT_FALSE(same_both_ways(rows));
  EXPECT_FALSE(same_both_ways(generate("grid:8", 900, 3)));
}

/// Turns the ridge between facet f and its first neighbour into the other diagonal, along which the
/// surface is folded inwards.
void fold(TriangleMesh& s, std::uint32_t f) {
  const auto slot_of = [&](std::uint32_t facet, auto Facet3D::*ids, std::uint32_t id) {
    const auto& all = s.facets[facet].*ids;
    return static_cast<unsigned>(std::find(all, all + 3, id) - all);
  };
  const std::uint32_t g = s.facets[f].neighbours[0];
  const Facet3D a = s.facets[f], b = s.facets[g];
  const unsigned off = slot_of(g, &Facet3D::neighbours, f);
  const unsigned first = slot_of(g, &Facet3D::vertices, a.vertices[1]);
  const unsigned second = slot_of(g, &Facet3D::vertices, a.vertices[2]);
  const auto set = [](Facet3D& facet, const std::uint32_t(&v)[3], const std::uint32_t(&n)[3]) {
    std::copy_n(v, 3, facet.vertices);
    std::copy_n(n, 3, facet.neighbours);
  };
  const std::uint32_t x = b.vertices[off];
  const std::uint32_t beside_f = b.neighbours[second], beside_g = a.neighbours[1];
  set(s.facets[f], {a.vertices[0], a.vertices[1], x}, {beside_f, g, a.neighbours[2]});
  set(s.facets[g], {a.vertices[0], x, a.vertices[2]}, {b.neighbours[first], beside_g, f});
  s.facets[beside_f].neighbours[slot_of(beside_f, &Facet3D::neighbours, g)] = f;
  s.facets[beside_g].neighbours[slot_of(beside_g, &Facet3D::neighbours, f)] = g;
}

TEST(WriteTriangles, RefusesWhatIsNoHull) {
  const Rows rows = generate("sphere", 300, 3);
  const auto refused = [&](const std::function<void(TriangleMesh&)>& spoil) {
    Case c(rows);
    spoil(c.surface);
    Hull hull = c.empty_hull();
    return !write_triangles(c.input(), c.surface, c.run.with_threads(1), hull);
  };
  EXPECT_FALSE(refused([](TriangleMesh&) {}));
  EXPECT_TRUE(refused(
      [](TriangleMesh& s) { std::swap(s.facets[9].vertices[0], s.facets[9].vertices[1]); }));
  EXPECT_TRUE(refused(
      [](TriangleMesh& s) { std::swap(s.facets[9].neighbours[0], s.facets[9].neighbours[1]); }));
  EXPECT_TRUE(
      refused([](TriangleMesh& s) { s.facets[9].neighbours[1] = s.facets[9].neighbours[2]; }));
  EXPECT_TRUE(refused([](TriangleMesh& s) { s.facets[9].owner = Facet3D::none; }));
  EXPECT_TRUE(refused([](TriangleMesh& s) { s.live += 2; }));
  EXPECT_TRUE(refused([](TriangleMesh& s) {  // inside out
    for (std::uint64_t f = 0; f < s.live; ++f) {
      std::swap(s.facets[f].vertices[0], s.facets[f].vertices[1]);
      std::swap(s.facets[f].neighbours[0], s.facets[f].neighbours[1]);
    }
  }));
  EXPECT_TRUE(refused([](TriangleMesh& s) { fold(s, 9); }));
}

}  // namespace cullhull::internal::write_triangles_test
