// Small sets in four to eight dimensions have an engine and a writer of their own: held against the
// general way, which a budget too small for short cuts insists on.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "agreement/canonical_hash.hpp"
#include "agreement/point_sets.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/error.hpp"
#include "few/few_in_space.hpp"
#include "few/small_nd.hpp"
#include "made_sets.hpp"
#include "parallel/dispatch.hpp"
#include "thrown.hpp"

namespace cullhull::small_sets_nd_test {

using namespace testing_support;
using Make = std::function<PointSet(unsigned n, unsigned d, std::uint64_t seed)>;

/// Points near the planes of simplices among the first few, on either side.
PointSet near_planes(unsigned n, unsigned d, std::uint64_t seed) {
  Random r(seed);
  const unsigned base = std::min(n, d + 4);
  PointSet s = random_set("sphere", base, d, seed);
  std::vector<double> p(d);
  for (unsigned i = base; i < n; ++i) {
    // A combination of d points, weights that sum to 1, and a little more.
    std::fill(p.begin(), p.end(), 0.0);
    double sum = 0;
    for (unsigned j = 0; j < d; ++j) {
      const double weight = j + 1 < d ? r.between(-0.3, 0.8) : 1 - sum;
      sum += weight;
      for (unsigned c = 0; c < d; ++c) p[c] += weight * s.coordinates[(i + j) % base * d + c];
    }
    const double away = std::ldexp(r.between(-1, 1), -r.integer(10, 60));
    for (double& v : p) v += away * r.normal();
    s.add(p);
  }
  return s;
}

/// Some points are equal to others.
PointSet repeated(PointSet s, std::uint64_t seed) {
  Random r(seed);
  const unsigned d = s.dimension;
  const auto n = static_cast<int>(s.count());
  for (int i = 0; i < n; ++i)
    if (r.integer(0, 2) == 0)
      std::copy_n(s.coordinates.begin() + r.integer(0, n - 1) * static_cast<int>(d), d,
                  s.coordinates.begin() + i * static_cast<int>(d));
  return s;
}

PointSet scaled(PointSet s, double first, double others) {
  for (std::size_t i = 0; i < s.coordinates.size(); ++i)
    s.coordinates[i] *= i % s.dimension == 0 ? first : others;
  return s;
}

std::vector<unsigned> sizes(unsigned d) {
  std::vector<unsigned> n{d + 1, d + 2, d + 3, d + 5, 2 * d + 1, 3 * d};
  if (d == 4) n.insert(n.end(), {33, 100, 129, 400});
  if (d == 5) n.insert(n.end(), {40, 200});
  if (d == 6) n.push_back(40);
  return n;
}

void expect_the_general_way(const std::string& name, const Make& make, std::uint64_t seeds = 3,
                            unsigned most = 400) {
  Options general;
  general.memory_budget = (1 << 22) - 1;
  general.threads = 1;
  for (unsigned d = 4; d <= 8; ++d)
    for (const unsigned n : sizes(d))
      for (std::uint64_t seed = 0; seed < seeds && n <= most; ++seed) {
        const PointSet s = make(n, d, 1000 * n + seed);
        const PointView view = view_of(s);
        const Hull expected = convex_hull(view, general), hull = convex_hull(view);
        ASSERT_EQ(canonical_hash(hull), canonical_hash(expected))
            << name << " " << d << "D, " << n << " points, seed " << seed;
        if (seed == 0) {
          ASSERT_TRUE(certify(view, hull).valid) << name << " " << d << "D, " << n << " points";
        }
      }
}

/// Whether the engine takes the points itself.
bool takes(const PointSet& s) {
  return internal::with_dimension<4, 7, 8>(s.dimension, [&](auto d) {
    internal::SmallSurfaceNd<d> surface;
    return surface.build(s.coordinates.data(), static_cast<unsigned>(s.count()));
  });
}

TEST(SmallSetsNd, GeneralPosition) {
  for (const char* shape : {"sphere", "ball", "cube", "gauss", "octahedron"})
    expect_the_general_way(
        shape, [=](unsigned n, unsigned d, auto seed) { return random_set(shape, n, d, seed); });
  expect_the_general_way(
      "moment curve", [](unsigned n, unsigned d, auto) { return cyclic(std::min(n, 3 * d), d); },
      1);
}

TEST(SmallSetsNd, NextToPlanes) {
  expect_the_general_way("next to planes", near_planes, 6);
  expect_the_general_way(
      "next to planes, thin",
      [](unsigned n, unsigned d, auto seed) { return scaled(near_planes(n, d, seed), 1, 0x1p-30); },
      2);
  expect_the_general_way(
      "next to planes, in f32",
      [](unsigned n, unsigned d, auto seed) {
    PointSet s = near_planes(n, d, seed);
    for (double& v : s.coordinates) v = static_cast<double>(static_cast<float>(v));
    return s;
      },
      2);
}

TEST(SmallSetsNd, Degenerate) {
  for (const int side : {2, 3, 5})
    expect_the_general_way(
        "lattice",
        [=](unsigned n, unsigned d, auto seed) { return random_grid(n, d, side, 0.1, seed); }, 1);
  expect_the_general_way(
      "flat", [](unsigned n, unsigned d, auto seed) { return flat(n, d - 1, d, 5, seed); }, 1);
  expect_the_general_way(
      "equal points",
      [](unsigned n, unsigned d, auto seed) {
    return repeated(random_set("sphere", n, d, seed), seed);
      },
      2);
  expect_the_general_way(
      "one point",
      [](unsigned n, unsigned d, auto) {
    PointSet s = named("one point", d);
    s.coordinates.assign(std::size_t{n} * d, -0.3);
    return s;
      },
      1);
}

TEST(SmallSetsNd, Magnitudes) {
  constexpr unsigned few = 16;  // exact sums of the general way take long
  for (const int e : {-1060, -501, -499, -300, 300, 499, 501, 1000}) {
    const double size = std::ldexp(1.0, e);
    expect_the_general_way(
        "2^" + std::to_string(e),
        [=](unsigned n, unsigned d, auto seed) {
      return scaled(random_set("sphere", n, d, seed), size, size);
        },
        1, few);
  }
  for (const double thin : {1e-3, 1e-9, 1e-14, 1e-40, 1e-100, 1e-200})
    expect_the_general_way(
        "thin",
        [=](unsigned n, unsigned d, auto seed) {
      return scaled(random_set("sphere", n, d, seed), thin, 1);
        },
        1, few);
  for (const double far : {1e6, 1e12})
    expect_the_general_way(
        "far away",
        [=](unsigned n, unsigned d, auto seed) {
      PointSet s = random_set("ball", n, d, seed);
      for (double& v : s.coordinates) v += far;
      return s;
        },
        1, few);
  expect_the_general_way(
      "all magnitudes",
      [](unsigned n, unsigned d, auto seed) { return all_magnitudes(n, d, seed); }, 1, few);
}

/// Other scalars and strides, and a part of the points: what a filter leaves.
TEST(SmallSetsNd, ViewsAndIds) {
  constexpr unsigned d = 5, n = 60;
  const PointSet s = random_set("ball", n, d, 7);
  const std::vector<float> floats(s.coordinates.begin(), s.coordinates.end());
  const std::vector<double> columns =
      transposed(std::vector<double>(floats.begin(), floats.end()), d);
  EXPECT_EQ(canonical_hash(convex_hull(PointView::column_major(columns.data(), n, d))),
            canonical_hash(convex_hull(PointView::row_major(floats.data(), n, d))));

  const Hull whole = convex_hull(view_of(s));
  Hull part;
  ASSERT_TRUE(
      internal::hull_of_few(view_of(s), whole.vertices.data(), whole.vertices.size(), part));
  EXPECT_EQ(part.vertices, whole.vertices);
  EXPECT_EQ(part.simplices, whole.simplices);
  EXPECT_EQ(part.facet_planes, whole.facet_planes);
  EXPECT_EQ(part.volume, whole.volume);
}

TEST(SmallSetsNd, WhichSetsTheEngineTakes) {
  for (unsigned d = 4; d <= 8; ++d)
    for (std::uint64_t seed = 0; seed < 10; ++seed) {
      EXPECT_TRUE(takes(random_set("sphere", 2 * d, d, seed)));
      EXPECT_TRUE(takes(random_set("gauss", 3 * d, d, seed)));
      EXPECT_TRUE(takes(scaled(random_set("ball", 2 * d, d, seed), 0x1p400, 0x1p400)));
      EXPECT_FALSE(takes(random_set("ball", d, d, seed)));
      EXPECT_FALSE(takes(flat(3 * d, d - 1, d, 5, seed)));
      EXPECT_FALSE(takes(full_grid(d, 2, 0.1)));
      EXPECT_FALSE(takes(scaled(random_set("ball", 2 * d, d, seed), 1, 0x1p600)));
      PointSet twice = random_set("sphere", 2 * d, d, seed);
      twice.coordinates.insert(twice.coordinates.end(), twice.coordinates.begin(),
                               twice.coordinates.begin() + d);
      EXPECT_FALSE(takes(twice));
    }
}

/// Too many facets, and too many signs that f32 leaves open.
TEST(SmallSetsNd, GivesUp) {
  EXPECT_FALSE(takes(cyclic(140, 4)));
  PointSet s = random_set("sphere", 300, 4, 5);
  for (unsigned i = 5; i < 300; ++i)  // about a vertex
    for (unsigned c = 0; c < 4; ++c)
      s.coordinates[4 * i + c] = s.coordinates[c] + 1e-8 * s.coordinates[4 * i + c];
  EXPECT_FALSE(takes(s));
  for (const PointSet& given_up : {cyclic(140, 4), s})
    for (int call = 0; call < 2; ++call) {
      const Hull hull = convex_hull(view_of(given_up));
      EXPECT_TRUE(certify(view_of(given_up), hull).valid);
      const PointSet next = random_set("ball", 50, 4, 1);  // in memory that was dropped
      EXPECT_TRUE(certify(view_of(next), convex_hull(view_of(next))).valid);
    }
}

TEST(SmallSetsNd, PointsThatAreNotFiniteAreNamed) {
  PointSet s = random_set("ball", 30, 6, 3);
  s.coordinates[6 * 11 + 4] = std::nan("");
  EXPECT_TRUE(has(error_of(ErrorCode::not_finite, [&] { convex_hull(view_of(s)); }), "11"));
}

}  // namespace cullhull::small_sets_nd_test
