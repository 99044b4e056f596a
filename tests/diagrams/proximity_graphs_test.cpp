// Proximity graphs against their definitions, in rational numbers.
#include "cullhull/proximity_graphs.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>
#include <set>

#include "agreement/random_seeds.hpp"
#include "cullhull/error.hpp"
#include "diagrams/slow_cells.hpp"

namespace cullhull {
namespace proximity_graphs_test {

using namespace testing_support;
using Graph = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

Graph pairs(const Array<std::uint32_t>& edges) {
  Graph graph;
  for (std::size_t i = 0; i + 1 < edges.size(); i += 2) graph.emplace_back(edges[i], edges[i + 1]);
  return graph;
}

mpq_class between(const LiftedSet& s, std::uint32_t a, std::uint32_t b) {
  const Rationals p = rational_point(s, a), q = rational_point(s, b);
  mpq_class sum = 0;
  for (unsigned j = 0; j < s.dimension; ++j) sum += (p[j] - q[j]) * (p[j] - q[j]);
  return sum;
}

struct SlowGraphs {
  Graph tree, relative, gabriel;
};

/// Of the complete graph.
SlowGraphs slow_graphs(const LiftedSet& s) {
  SlowGraphs all;
  const auto n = static_cast<std::uint32_t>(s.count());
  std::vector<std::vector<mpq_class>> length(n, std::vector<mpq_class>(n));
  std::vector<bool> twin(n);
  std::vector<std::tuple<mpq_class, std::uint32_t, std::uint32_t>> edges;
  for (std::uint32_t a = 0; a < n; ++a)
    for (std::uint32_t b = a + 1; b < n; ++b) {
      length[a][b] = length[b][a] = between(s, a, b);
      if (length[a][b] == 0) twin[b] = true;
      edges.emplace_back(length[a][b], a, b);
    }
  for (std::uint32_t a = 0; a < n; ++a)
    for (std::uint32_t b = a + 1; b < n; ++b) {
      if (twin[a] || twin[b]) continue;
      bool relative = true, gabriel = true;
      for (std::uint32_t c = 0; c < n; ++c) {
        if (c == a || c == b || twin[c]) continue;
        if (length[a][c] < length[a][b] && length[b][c] < length[a][b]) relative = false;
        if (length[a][c] + length[b][c] <= length[a][b]) gabriel = false;  // an angle of 90 or more
      }
      if (relative) all.relative.emplace_back(a, b);
      if (gabriel) all.gabriel.emplace_back(a, b);
    }
  std::sort(edges.begin(), edges.end());
  std::vector<std::uint32_t> root(n);
  std::iota(root.begin(), root.end(), 0U);
  const auto find = [&](std::uint32_t v) {
    while (root[v] != v) v = root[v];
    return v;
  };
  for (const auto& [size, a, b] : edges) {
    if (find(a) == find(b)) continue;
    root[find(a)] = find(b);
    all.tree.emplace_back(a, b);
  }
  std::sort(all.tree.begin(), all.tree.end());
  return all;
}

void check(const LiftedSet& s) {
  const Triangulation t = triangulate(s);
  const SlowGraphs slow = slow_graphs(s);
  EXPECT_EQ(pairs(minimum_spanning_tree(view_of(s), t)), slow.tree) << s.name;
  EXPECT_EQ(pairs(relative_neighbourhood_graph(view_of(s), t)), slow.relative) << s.name;
  EXPECT_EQ(pairs(gabriel_graph(view_of(s), t)), slow.gabriel) << s.name;
}

TEST(ProximityGraphs, SmallSetsAreAsDefined) {
  for (unsigned d = 1; d <= 5; ++d)
    for (const LiftedSet& s : small_lifted_sets(d, 61))
      if (s.weights.empty()) check(s);
}

TEST(ProximityGraphs, FewPoints) {
  for (unsigned d = 1; d <= 3; ++d) {
    LiftedSet s{"few", d, {}, {}};
    std::mt19937_64 random(d);
    for (unsigned n = 0; n <= d + 3; ++n) {
      check(s);
      for (unsigned j = 0; j < d; ++j) s.rows.push_back(static_cast<double>(random() % 3));
    }
  }
}

/// Edges whose squared lengths are 2, exactly known, and one of 2 + 2e-36, which double-doubles
/// round to 2 and sort first by its ids.
TEST(ProximityGraphs, ExactLengthsBetweenNearlyEqualOnes) {
  check({"diagonal", 2, {1e-18, -1e-18, 1, 1, 2, 2, 0, 0}, {}});
  check({"two sides", 2, {1e-18, 2, 5, 0, 5, 1, 5, 2, 1e-20, 2, 0, 1}, {}});
}

/// Lattices of which some coordinates are moved by far less than an ulp of the lengths, down to
/// denormals: many exact ties and many that are ties but for the last digits.
TEST(ProximityGraphs, LatticesMovedByAlmostNothing) {
  const double moves[] = {1e-16, 1e-18, 1e-20, 3e-32, 1e-40, 1e-150, 1e-300, 5e-324};
  for_random_seeds(10'000, [&](std::uint64_t seed) {
    std::mt19937_64 random(seed);
    const auto d = static_cast<unsigned>(1 + random() % 3);
    const std::uint64_t width = 2 + random() % 3;
    LiftedSet s{"moved lattice " + std::to_string(seed), d, {}, {}};
    const std::size_t n = 3 + random() % (d == 3 ? 7 : 10);
    for (std::size_t i = 0; i < n * d; ++i) {
      const auto whole = static_cast<double>(random() % width);
      const double moved = moves[random() % std::size(moves)] * (random() % 2 == 0 ? 1 : -1);
      s.rows.push_back(whole == 0 && random() % 3 == 0 ? moved : whole);
    }
    check(s);
  });
}

/// Lunes whose points are not neighbours of either end, and clusters far from each other.
TEST(ProximityGraphs, SomewhatLargerSets) {
  check(random_points(2, 120, 1));
  check(random_points(3, 70, 2));
  check(drawn_grid(2, 100, 12, 1, 0, 3));
  check(drawn_grid(2, 80, 9, 0.1, 0.3, 3));
  check(drawn_grid(3, 70, 5, 1, 0, 4));
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    LiftedSet s = random_points(2, 60, seed);
    for (std::size_t i = 0; i < s.rows.size(); ++i)
      s.rows[i] = std::ldexp(s.rows[i], -static_cast<int>(i / 2 % 9) * 3);
    s.name = "clusters";
    check(s);
  }
}

TEST(ProximityGraphs, AnyThreadsGiveTheSame) {
  for (const LiftedSet& s : {random_points(2, 20000, 5), drawn_grid(3, 4000, 17, 1, 0, 5)}) {
    const Triangulation t = triangulate(s);
    Options one, three;
    one.threads = 1;
    three.threads = 3;
    EXPECT_EQ(gabriel_graph(view_of(s), t, one), gabriel_graph(view_of(s), t, three));
    EXPECT_EQ(relative_neighbourhood_graph(view_of(s), t, one),
              relative_neighbourhood_graph(view_of(s), t, three));
    const Graph tree = pairs(minimum_spanning_tree(view_of(s), t));
    EXPECT_EQ(tree.size(), s.count() - 1);
    std::set<std::pair<std::uint32_t, std::uint32_t>> relative;
    for (const auto& e : pairs(relative_neighbourhood_graph(view_of(s), t))) relative.insert(e);
    for (const auto& [a, b] : tree)
      EXPECT_TRUE(relative.contains({a, b}) || between(s, a, b) == 0) << a << " " << b;
  }
}

TEST(ProximityGraphs, RefusesOtherTriangulations) {
  const LiftedSet s = random_points(2, 20, 1);
  TriangulationOptions furthest;
  furthest.furthest_site = true;
  const Triangulation upper = triangulate(s, furthest);
  EXPECT_THROW(minimum_spanning_tree(view_of(s), upper), Error);
  EXPECT_THROW(gabriel_graph(view_of(s), upper), Error);
  EXPECT_THROW(relative_neighbourhood_graph(view_of(s), upper), Error);
  EXPECT_THROW(gabriel_graph(view_of(random_points(2, 19, 1)), triangulate(s)), Error);
}

}  // namespace proximity_graphs_test
}  // namespace cullhull
