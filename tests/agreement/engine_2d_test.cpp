// hull_2d against a monotone chain with exact orientations.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <random>
#include <tuple>

#include "call_options.hpp"
#include "exact/orientation/orientation.hpp"
#include "hull/engine.hpp"
#include "parallel/threads/run.hpp"
#include "thrown.hpp"

namespace cullhull::internal::engine_2d_test {

using namespace testing_support;
using Points = std::vector<double>;

Sign turn(const Points& p, std::uint32_t a, std::uint32_t b, std::uint32_t c) {
  const double* rows[] = {&p[2 * a], &p[2 * b], &p[2 * c]};
  return orientation_exact(2, rows);
}

/// Andrew's monotone chain over a comparison sort, every turn by exact arithmetic: no collinear
/// corners, and of equal points the lowest id.
std::vector<std::uint32_t> monotone_chain(const Points& p) {
  std::vector<std::uint32_t> order(p.size() / 2);
  std::iota(order.begin(), order.end(), 0U);
  const auto key = [&](std::uint32_t i) { return std::make_tuple(p[2 * i], p[2 * i + 1], i); };
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return key(a) < key(b); });
  order.erase(
      std::unique(
          order.begin(), order.end(),
          [&](auto a, auto b) { return p[2 * a] == p[2 * b] && p[2 * a + 1] == p[2 * b + 1]; }),
      order.end());
  std::vector<std::uint32_t> hull;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t base = hull.size();
    for (const std::uint32_t i : order) {
      while (hull.size() >= base + 2 &&
             turn(p, hull[hull.size() - 2], hull.back(), i) != Sign::positive)
        hull.pop_back();
      hull.push_back(i);
    }
    hull.pop_back();
    std::reverse(order.begin(), order.end());
  }
  return hull;
}

LocalPoints local(const Points& p) {
  LocalPoints l;
  l.dimension = 2;
  l.count = static_cast<std::uint32_t>(p.size() / 2);
  l.coordinates = l.exact = p.data();
  return l;
}

std::vector<std::uint32_t> canonical(std::vector<std::uint32_t> cycle) {
  std::rotate(cycle.begin(), std::min_element(cycle.begin(), cycle.end()), cycle.end());
  return cycle;
}

/// Follows the neighbours round, checking that they are what engine.hpp says.
std::vector<std::uint32_t> cycle_of(const Boundary& h) {
  std::vector<std::uint32_t> out;
  std::uint32_t facet = 0;
  for (std::size_t i = 0; i < h.facet_count(); ++i) {
    out.push_back(h.vertices[2 * facet + 1]);
    const std::uint32_t next = h.neighbours[2 * facet + 1];
    EXPECT_EQ(h.vertices[2 * next + 1], h.vertices[2 * facet]);
    EXPECT_EQ(h.neighbours[2 * next], facet);
    facet = next;
  }
  EXPECT_EQ(facet, 0u);
  return out;
}

Boundary run(const LocalPoints& points, unsigned threads = 1) {
  return hull_2d(points, internal::short_run().with_threads(threads));
}

void expect_agreement(const Points& p, const std::string& what) {
  const Boundary h = run(local(p));
  EXPECT_EQ(canonical(cycle_of(h)), canonical(monotone_chain(p))) << what;
  EXPECT_TRUE(h.duplicates.empty());
}

TEST(Hull2d, SmallGridsWithDuplicates) {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    std::mt19937_64 g(seed);
    const int side = 2 + static_cast<int>(seed % 9);
    Points p = {0, 0, 1, 0, 0, 1};
    const unsigned n = static_cast<unsigned>(g() % 60);
    for (unsigned i = 0; i < 2 * n; ++i) {
      const double v = static_cast<double>(g() % static_cast<unsigned>(side)) / 16;
      p.push_back(v == 0 && g() % 2 ? -0.0 : v);
    }
    // Against the order of ids as well: the triangle last.
    Points q(p.begin() + 6, p.end());
    q.insert(q.end(), p.begin(), p.begin() + 6);
    expect_agreement(p, "seed " + std::to_string(seed));
    expect_agreement(q, "reversed, seed " + std::to_string(seed));
  }
}

TEST(Hull2d, NearlyCollinearNeedsExactArithmetic) {
  for (unsigned seed = 1; seed <= 50; ++seed) {
    std::mt19937_64 g(seed);
    std::uniform_real_distribution<double> u(0, 1);
    Points p = {0, 0, 0.5, 0.25, 0.25, 0.5};
    for (int i = 0; i < 200; ++i) {
      const double x = u(g) / 4;
      p.push_back(x);
      p.push_back(x * 2 + 0x1p-54 * static_cast<double>(static_cast<int>(g() % 3) - 1));
    }
    expect_agreement(p, "seed " + std::to_string(seed));
  }
  Points line;
  for (int i = 0; i < 64; ++i) line.insert(line.end(), {i * 0.01, i * 0.01 * 3});
  line.insert(line.end(), {0.0, 0.5});
  const Boundary h = run(local(line));
  EXPECT_GT(h.rung_counts.of[2], 0u);
}

TEST(Hull2d, TinyAndHugeTogether) {
  // What the pipeline makes of 1e308 beside 1e-308: scaled rows that underflowed, exact ones
  // beside.
  for (unsigned seed = 1; seed <= 100; ++seed) {
    std::mt19937_64 g(seed);
    Points exact, scaled;
    for (int i = 0; i < 40; ++i) {
      for (int j = 0; j < 2; ++j) {
        const int e = static_cast<int>(g() % 2040) - 1022;
        double v = std::ldexp(1.0 + static_cast<double>(g() % 8) / 8, e);
        if (g() % 2) v = -v;
        if (g() % 4 == 0) v = std::ldexp(static_cast<double>(g() % 5), -1074);
        exact.push_back(v);
        scaled.push_back(std::ldexp(v, -1023));
      }
    }
    LocalPoints l = local(scaled);
    l.exact = exact.data();
    EXPECT_EQ(canonical(cycle_of(run(l))), canonical(monotone_chain(exact))) << "seed " << seed;
  }
}

TEST(Hull2d, ManyPointsKeepEveryVertex) {
  for (unsigned seed = 1; seed <= 4; ++seed) {
    std::mt19937_64 g(seed);
    const unsigned n = 60000;
    Points p;
    for (unsigned i = 0; i < n; ++i) {
      double x = std::ldexp(static_cast<double>(g()), -64),
             y = std::ldexp(static_cast<double>(g()), -64);
      if (seed == 2) x = std::floor(x * 100) / 128, y = std::floor(y * 100) / 128;
      if (seed == 3) x = x * 2 - 1, y = (y * 2 - 1) * std::sqrt(1 - x * x);
      if (seed == 4) x = std::floor(x * 2) / 2 + (y > 0.5 ? 0.25 : 0), y = std::floor(y * 64) / 64;
      p.push_back(x);
      p.push_back(y);
    }
    expect_agreement(p, "seed " + std::to_string(seed));
  }
}

TEST(Hull2d, ManyOnACircleAndManyEqual) {
  const unsigned n = 200000;
  Points p;
  for (unsigned i = 0; i < n; ++i) {
    const double t = static_cast<double>((i * 7919ULL) % n) * (2 * 3.14159265358979 / n);
    p.insert(p.end(), {std::cos(t), std::sin(t)});
  }
  EXPECT_GT(run(local(p)).facet_count(), n - n / 100);
  expect_agreement(p, "circle");

  Points equal;
  for (unsigned i = 0; i < n; ++i) equal.insert(equal.end(), {0.5, 0.5});
  equal.insert(equal.end(), {0.25, 0.25, 0.25, 0.5});
  EXPECT_EQ(canonical(cycle_of(run(local(equal)))), (std::vector<std::uint32_t>{0, n + 1, n}));
}

TEST(Hull2d, LatticeDecidesWithoutExactArithmetic) {
  Points p;
  for (int i = 0; i < 1000; ++i) p.insert(p.end(), {(i % 31) / 32.0, (i % 29) / 32.0});
  LocalPoints l = local(p);
  l.small_lattice = true;
  const Boundary h = run(l);
  EXPECT_EQ(h.rung_counts.of[2], 0u);
  EXPECT_EQ(canonical(cycle_of(h)), canonical(monotone_chain(p)));
}

TEST(Hull2d, StopsWhenAsked) {
  const Options options = stopped();
  const Points p = {0, 0, 1, 0, 0, 1};
  error_of(ErrorCode::cancelled,
           [&] { hull_2d(local(p), internal::Run(options).with_threads(1)); });
}

TEST(Hull2d, ManyPointsOnAnyNumberOfThreads) {
  constexpr std::uint32_t n = 150'000;
  std::mt19937_64 g(7);
  std::uniform_real_distribution<double> unit(-1, 1);
  Points circle, columns, line, clusters;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double a = 3.14159265358979 * unit(g);
    circle.insert(circle.end(), {std::cos(a), std::sin(a)});
    columns.insert(columns.end(), {static_cast<double>(g() % 20) / 32, unit(g)});
    // All on one line but a few; all but a few in two places.
    const double t = unit(g);
    line.insert(line.end(), {t, i % 50'000 == 7 ? unit(g) : t / 2});
    const double side = i % 2 ? 0.75 : -0.75;
    clusters.insert(clusters.end(),
                    {side + 0x1p-30 * unit(g), i % 10'000 == 3 ? unit(g) : 0x1p-40 * unit(g)});
  }
  // Arcs of which few points are on the hull, so that joined chains lose most of what they have;
  // x that no cells of equal width divide; few places, each many times; the largest doubles.
  Points arcs, powers, repeated, largest;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double a = 3.14159265358979 * unit(g), c = static_cast<double>(g() % 30) - 15;
    arcs.insert(arcs.end(), {(c + std::cos(a) / 2) / 16, (0.01 * c * c + std::sin(a) / 2) / 16});
    const double e = std::ldexp(1 + unit(g) / 4, -static_cast<int>(g() % 1000));
    powers.insert(powers.end(), {g() % 2 ? e : -e, unit(g) * e});
    repeated.insert(repeated.end(), {static_cast<double>(g() % 40) / 64, unit(g) > 0 ? 0.5 : 0.25});
    largest.insert(largest.end(), {1.7e308 * std::cos(a), 1.7e308 * std::sin(a)});
  }
  for (const Points* p :
       {&circle, &columns, &line, &clusters, &arcs, &powers, &repeated, &largest}) {
    const std::vector<std::uint32_t> expected = canonical(monotone_chain(*p));
    for (const unsigned threads : {1U, 2U, 5U})
      EXPECT_EQ(canonical(cycle_of(run(local(*p), threads))), expected) << threads;
  }
}

}  // namespace cullhull::internal::engine_2d_test
