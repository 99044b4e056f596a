// What a page draws of a hull: true edges only, fair samples, and the frame of a page.
#include "viewer/hull_shape.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <set>

#include "cullhull/generate.hpp"
#include "cullhull/hull.hpp"
#include "thrown.hpp"
#include "viewer/page.hpp"
#include "viewer/scene.hpp"

namespace cullhull::viewer::hull_shape_test {

using testing_support::has;

constexpr ShapeLimits no_limit{1'000'000, 1'000'000};

/// The points of {0, ..., side - 1}^d.
std::vector<double> grid(unsigned side, unsigned d) {
  std::vector<double> rows;
  std::size_t count = 1;
  for (unsigned j = 0; j < d; ++j) count *= side;
  for (std::size_t i = 0; i < count; ++i)
    for (std::size_t j = 0, rest = i; j < d; ++j, rest /= side)
      rows.push_back(static_cast<double>(rest % side));
  return rows;
}

struct Drawn {
  Hull hull;
  std::vector<double> rows;
  HullShape shape;
};

Drawn draw(const std::vector<double>& points, unsigned d, const ShapeLimits& limits = no_limit) {
  const PointView view = PointView::row_major(points.data(), points.size() / d, d);
  Drawn drawn{convex_hull(view), {}, {}};
  drawn.rows = vertex_rows(view, drawn.hull);
  drawn.shape = hull_shape(drawn.hull, drawn.rows, limits);
  return drawn;
}

TEST(HullShape, CubesHaveTheirEdgesAndNoDiagonals) {
  // A d-cube has d 2^(d-1) edges, each along one axis; its facets are no simplices.
  const std::size_t edges[] = {0, 1, 4, 12, 32, 80, 192};
  for (unsigned d = 1; d <= 6; ++d) {
    const Drawn c = draw(grid(d <= 4 ? 3 : 2, d), d);
    ASSERT_EQ(c.shape.edges.size(), 2 * edges[d]) << d;
    for (std::size_t e = 0; e < c.shape.edges.size(); e += 2) {
      unsigned differing = 0;
      for (unsigned j = 0; j < d; ++j)
        differing +=
            c.rows[c.shape.edges[e] * d + j] != c.rows[c.shape.edges[e + 1] * d + j] ? 1 : 0;
      EXPECT_EQ(differing, 1U) << d;
    }
    EXPECT_FALSE(c.shape.simplified || c.shape.edges_sampled);
  }
}

TEST(HullShape, SimplicialHullsHaveEveryPairOfEverySimplex) {
  const Drawn c = draw(generate("sphere", 60, 4, 3), 4);
  std::set<std::pair<std::uint64_t, std::uint64_t>> want, have;
  for (std::size_t s = 0; s < c.hull.simplices.size(); s += 4)
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < i; ++j)
        want.insert(std::minmax(c.hull.simplices[s + i], c.hull.simplices[s + j]));
  for (std::size_t e = 0; e < c.shape.edges.size(); e += 2)
    have.insert(
        std::minmax(c.hull.vertices[c.shape.edges[e]], c.hull.vertices[c.shape.edges[e + 1]]));
  EXPECT_EQ(have, want);
}

TEST(HullShape, FlatsOfAnySpace) {
  // A cube in the first three of five coordinates, a square, a segment, a point.
  const std::size_t edges[] = {0, 1, 4, 12}, triangles[] = {0, 0, 2, 12};
  for (unsigned k = 0; k <= 3; ++k) {
    std::vector<double> rows;
    const std::vector<double> cube = k == 0 ? std::vector<double>{} : grid(2, k);
    for (std::size_t i = 0; i < std::size_t{1} << k; ++i)
      for (unsigned j = 0; j < 5; ++j) rows.push_back(j < k ? cube[i * k + j] : 7);
    const Drawn c = draw(rows, 5);
    EXPECT_EQ(c.shape.edges.size(), 2 * edges[k]) << k;
    EXPECT_EQ(c.shape.triangles.size(), 3 * triangles[k]) << k;
  }
}

TEST(HullShape, TrianglesNameTheirFacets) {
  const Drawn c = draw(grid(3, 3), 3);
  ASSERT_EQ(c.shape.facets.size(), 12U);
  EXPECT_EQ(std::set(c.shape.facets.begin(), c.shape.facets.end()).size(), 6U);
  for (std::size_t t = 0; t < 12; ++t) {
    const auto facet = c.hull.facets[c.shape.facets[t]];
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint64_t id = c.hull.vertices[c.shape.vertices[c.shape.triangles[3 * t + i]]];
      EXPECT_NE(std::find(facet.begin(), facet.end(), id), facet.end());
    }
  }
  EXPECT_TRUE(draw(generate("ball", 3000, 3), 3, {20, 0}).shape.facets.empty());
}

TEST(HullShape, ShadowsAreTheHullsOfProjections) {
  const Drawn c = draw(grid(2, 5), 5);
  const std::vector<Shadow> all = shadows(c.rows, 5, c.shape.vertices, 5);
  ASSERT_EQ(all.size(), 10U);  // three of five
  for (const Shadow& s : all) {
    EXPECT_TRUE(s.axes[0] < s.axes[1] && s.axes[1] < s.axes[2]);
    EXPECT_EQ(s.edges.size(), 24U);  // a cube
    EXPECT_EQ(s.triangles.size(), 36U);
    for (const std::uint32_t row : s.triangles) EXPECT_LT(row, c.shape.vertices.size());
  }
  EXPECT_TRUE(shadows(c.rows, 5, c.shape.vertices, 2).empty());
}

TEST(HullShape, LimitsHold) {
  const Drawn solid = draw(generate("sphere", 3000, 3, 1), 3, {500, 0});
  EXPECT_TRUE(solid.shape.simplified);
  EXPECT_EQ(solid.shape.vertices.size(), 500U);
  EXPECT_EQ(solid.shape.edges.size(), 2U * (3 * 500 - 6));  // Euler: a simplicial polyhedron
  EXPECT_EQ(solid.shape.triangles.size(), 3U * (2 * 500 - 4));

  const Drawn all = draw(generate("sphere", 2000, 4, 1), 4);
  const Drawn some = draw(generate("sphere", 2000, 4, 1), 4, {1'000'000, 300});
  EXPECT_TRUE(some.shape.edges_sampled);
  EXPECT_EQ(some.shape.edges.size(), 600U);
  std::set<std::pair<std::uint32_t, std::uint32_t>> edges;
  for (std::size_t e = 0; e < all.shape.edges.size(); e += 2)
    edges.insert({all.shape.edges[e], all.shape.edges[e + 1]});
  for (std::size_t e = 0; e < some.shape.edges.size(); e += 2)
    EXPECT_TRUE(edges.count({some.shape.edges[e], some.shape.edges[e + 1]}));
}

TEST(FairSample, OneOfEachRange) {
  EXPECT_EQ(fair_sample(3, 10), (std::vector<std::uint64_t>{0, 1, 2}));
  EXPECT_TRUE(fair_sample(0, 10).empty());
  EXPECT_TRUE(fair_sample(10, 0).empty());
  const std::uint64_t count = (std::uint64_t{1} << 60) + 12345;
  const std::vector<std::uint64_t> ids = fair_sample(count, 1000);
  ASSERT_EQ(ids.size(), 1000U);
  for (std::uint64_t i = 0; i < 1000; ++i) EXPECT_EQ(ids[i] / (count / 1000 + 1), i);
  // Every period of the order is met in all its phases.
  std::vector<int> phases(8);
  for (const std::uint64_t id : fair_sample(80'000, 10'000)) ++phases[id % 8];
  for (const int n : phases) EXPECT_NEAR(n, 1250, 6 * 33);  // six standard deviations
}

TEST(Page, TextIsSafe) {
  EXPECT_EQ(html_escaped("a<b>&\"\xC3\xA4\xFF\n"),
            "a&lt;b>&amp;&quot;\xC3\xA4\xEF\xBF\xBD\xEF\xBF\xBD");
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xFF\xFE\xFD"), "//79");
  Page page;
  page.title = "</title>{{body}}";
  page.body = "<p>body</p>";
  page.data.push_back({"d", "application/json", "{\"x\":\"</script>\"}"});
  const std::string text = page_text(page);
  EXPECT_FALSE(has(text, "</script>{{"));
  EXPECT_TRUE(has(text, "<title>&lt;/title>{{body}}</title>"));
  EXPECT_TRUE(has(text, "{\"x\":\"\\u003c/script>\"}"));
  EXPECT_FALSE(has(text, "http-equiv=\"refresh\""));
}

}  // namespace cullhull::viewer::hull_shape_test
