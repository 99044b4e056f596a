// Small sets in space have an engine and a result stage of their own: held against the fallback,
// which a budget too small for short cuts insists on.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "agreement/canonical_hash.hpp"
#include "agreement/point_sets.hpp"
#include "cullhull/batch.hpp"
#include "cullhull/certify.hpp"
#include "few/small_3d.hpp"

namespace cullhull::small_sets_test {

using namespace testing_support;
using Make = std::function<PointSet(unsigned n, std::uint64_t seed)>;

/// Points of the surface of a box, coordinates of three faces in common.
PointSet box_surface(unsigned n, std::uint64_t seed) {
  PointSet s = random_set("cube", n, 3, seed);
  for (unsigned i = 0; i < n; ++i) s.coordinates[3 * i + (seed + i) % 3] = i % 2 ? 1 : -1;
  return s;
}

/// Some points are equal to others, zeros of either sign among them.
PointSet repeated(PointSet s, std::uint64_t seed) {
  Random r(seed);
  const auto n = static_cast<int>(s.coordinates.size() / 3);
  for (int i = 0; i < n; ++i) {
    const int from = r.integer(0, n - 1);
    if (r.integer(0, 2) == 0)
      for (int c = 0; c < 3; ++c) {
        const double v = s.coordinates[3 * from + c];
        s.coordinates[3 * i + c] = v == 0 ? -v : v;
      }
  }
  return s;
}

PointSet times(PointSet s, double x, double y, double z) {
  for (std::size_t i = 0; i < s.coordinates.size(); ++i)
    s.coordinates[i] *= i % 3 == 0 ? x : i % 3 == 1 ? y : z;
  return s;
}

/// Points near the planes of triangles among the first few, on either side: what the bounds of
/// cached planes and of doubles are there to tell apart.
PointSet near_planes(unsigned n, std::uint64_t seed) {
  Random r(seed);
  const auto base = static_cast<int>(std::min(n, 12U));
  PointSet s = random_set("sphere", static_cast<unsigned>(base), 3, seed);
  for (unsigned i = static_cast<unsigned>(base); i < n; ++i) {
    const double* v[3];
    for (auto& p : v) p = s.coordinates.data() + std::size_t{3} * r.integer(0, base - 1);
    double e[2][3], p[3], weight[2] = {r.unit() * 1.2, r.unit() * 1.2 - 0.1};
    for (int c = 0; c < 3; ++c) {
      e[0][c] = v[1][c] - v[0][c];
      e[1][c] = v[2][c] - v[0][c];
      p[c] = v[0][c] + weight[0] * e[0][c] + weight[1] * e[1][c];
    }
    const double away = std::ldexp(r.between(-1, 1), -r.integer(10, 60));
    for (int c = 0; c < 3; ++c)
      p[c] +=
          away * (e[0][(c + 1) % 3] * e[1][(c + 2) % 3] - e[0][(c + 2) % 3] * e[1][(c + 1) % 3]);
    s.add({p[0], p[1], p[2]});
  }
  return s;
}

PointSet clusters(unsigned n, std::uint64_t seed) {
  Random r(seed);
  PointSet s = named("clusters", 3), centres = random_set("sphere", 5, 3, seed);
  for (unsigned i = 0; i < n; ++i) {
    const double* c = centres.coordinates.data() + std::size_t{3} * r.integer(0, 4);
    const double size = std::ldexp(1.0, -r.integer(5, 50));
    s.add({c[0] + size * r.normal(), c[1] + size * r.normal(), c[2] + size * r.normal()});
  }
  return s;
}

PointSet points_and_a_line(unsigned n, std::uint64_t seed) {
  PointSet s = random_set("cube", 4, 3, seed);
  Random r(seed);
  while (s.coordinates.size() < std::size_t{3} * n) {
    const double t = r.integer(-8, 8);
    s.add({t, 2 * t, -3 * t});
  }
  return s;
}

void expect_the_general_way(const std::string& name, const Make& make, std::uint64_t seeds = 2) {
  std::vector<double> coordinates;
  std::vector<std::uint64_t> offsets{0};
  for (unsigned n = 4; n <= 200; n += n < 40 || (n > 120 && n < 132) ? 1 : 17)
    for (std::uint64_t seed = 0; seed < seeds; ++seed) {
      const PointSet s = make(n, 1000 * n + seed);
      coordinates.insert(coordinates.end(), s.coordinates.begin(), s.coordinates.end());
      offsets.push_back(coordinates.size() / 3);
    }
  const PointView all = PointView::row_major(coordinates.data(), offsets.back(), 3);
  Options general, threads;
  general.memory_budget = (1 << 22) - 1;
  general.threads = 1;
  const HullBatch batch = convex_hulls(all, offsets);
  for (std::size_t i = 0; i + 1 < offsets.size(); ++i) {
    PointView set = all;
    set.data += static_cast<std::ptrdiff_t>(offsets[i]) * set.point_stride;
    set.count = offsets[i + 1] - offsets[i];
    const Hull hull = convex_hull(set, general);
    ASSERT_EQ(canonical_hash(batch.hull(i)), canonical_hash(hull))
        << name << ", set " << i << " of " << set.count << " points";
    if (i % 16 == 0) {
      ASSERT_TRUE(certify(set, hull).valid) << name << ", set " << i;
    }
  }
  for (const unsigned t : {1U, 3U}) {
    threads.threads = t;
    const HullBatch again = convex_hulls(all, offsets, threads);
    ASSERT_TRUE(again.facets == batch.facets && again.facet_planes == batch.facet_planes &&
                again.centroids == batch.centroids && again.vertices == batch.vertices)
        << name;
  }
}

TEST(SmallSets, general_position) {
  for (const char* shape : {"sphere", "ball", "cube", "gauss", "octahedron"})
    expect_the_general_way(shape,
                           [=](unsigned n, auto seed) { return random_set(shape, n, 3, seed); });
  expect_the_general_way(
      "moment curve", [](unsigned n, auto) { return cyclic(n, 3); }, 1);
  expect_the_general_way("clusters", clusters);
}

TEST(SmallSets, faces_of_many_corners) {
  expect_the_general_way("box surface", box_surface);
  expect_the_general_way("turned box surface",
                         [](unsigned n, auto seed) { return turned(box_surface(n, seed)); });
  for (const int side : {2, 3, 4, 6})
    expect_the_general_way("lattice",
                           [=](unsigned n, auto seed) { return random_grid(n, 3, side, 0, seed); });
  expect_the_general_way("shifted lattice",
                         [](unsigned n, auto seed) { return random_grid(n, 3, 5, 0.1, seed); });
  expect_the_general_way("turned lattice", [](unsigned n, auto seed) {
    return turned(random_grid(n, 3, 4, 0, seed));
  });
  for (const unsigned side : {2U, 3U, 4U, 5U})
    for (const double shift : {0.0, 0.3})
      expect_the_general_way(
          "full lattice", [=](unsigned, auto) { return full_grid(3, side, shift); }, 1);
  expect_the_general_way(
      "cospherical", [](unsigned n, auto) { return cospherical(3, static_cast<int>(n) / 2); }, 1);
  expect_the_general_way("cylinder", cylinder);
  expect_the_general_way("cone", cone);
  expect_the_general_way("a line and four points", points_and_a_line);
}

TEST(SmallSets, equal_points) {
  expect_the_general_way("repeated sphere", [](unsigned n, auto seed) {
    return repeated(random_set("sphere", n, 3, seed), seed);
  });
  expect_the_general_way("repeated lattice", [](unsigned n, auto seed) {
    return repeated(random_grid(n, 3, 3, -1, seed), seed);
  });
  expect_the_general_way("repeated box", [](unsigned n, auto seed) {
    return repeated(times(box_surface(n, seed), 1, 0.5, 2), seed);
  });
}

TEST(SmallSets, flats) {
  for (const unsigned k : {1U, 2U})
    expect_the_general_way("flat", [=](unsigned n, auto seed) { return flat(n, k, 3, 5, seed); });
  expect_the_general_way(
      "equal",
      [](unsigned n, auto) {
    PointSet s = named("equal", 3);
    for (unsigned i = 0; i < n; ++i) s.add({0.1, -0.2, 1e9});
    return s;
      },
      1);
}

TEST(SmallSets, magnitudes) {
  const auto sphere = [](unsigned n, auto seed) { return random_set("sphere", n, 3, seed); };
  for (const int e : {-1060, -110, -99, 99, 110, 1000}) {
    const double size = std::ldexp(1.0, e);
    expect_the_general_way(
        "2^" + std::to_string(e),
        [=](unsigned n, auto seed) { return times(sphere(n, seed), size, size, size); }, 1);
    expect_the_general_way(
        "box of 2^" + std::to_string(e),
        [=](unsigned n, auto seed) { return times(box_surface(n, seed), size, size, size); }, 1);
  }
  for (const double thin : {1e-3, 1e-9, 1e-14, 1e-40, 1e-200})
    expect_the_general_way(
        "thin", [=](unsigned n, auto seed) { return times(sphere(n, seed), 1, thin, 1); }, 1);
  expect_the_general_way(
      "far away",
      [=](unsigned n, auto seed) {
    PointSet s = sphere(n, seed);
    for (double& v : s.coordinates) v += 1e12;
    return s;
      },
      1);
  expect_the_general_way("all magnitudes",
                         [](unsigned n, auto seed) { return all_magnitudes(n, 3, seed); });
}

/// Signs beyond the bounds must be right: a wrong one makes a wrong hull.
TEST(SmallSets, points_next_to_planes) {
  expect_the_general_way("next to planes", near_planes, 6);
  expect_the_general_way(
      "next to planes, thin",
      [](unsigned n, auto seed) { return times(near_planes(n, seed), 1, 0x1p-12, 0x1p-30); }, 2);
  expect_the_general_way(
      "next to planes, in f32 and doubled",
      [](unsigned n, auto seed) {
    PointSet s = near_planes(n, seed);
    for (double& v : s.coordinates) v = static_cast<double>(static_cast<float>(v)) * 2;
    return s;
      },
      2);
}

/// What the engine is to take itself, and what it must leave to others.
TEST(SmallSets, which_sets_the_engine_takes) {
  const auto takes = [](const PointSet& s) {
    internal::SmallPoints3D points;
    internal::SmallHull3D hull;
    const auto n = static_cast<unsigned>(s.coordinates.size() / 3);
    for (unsigned c = 0; c < 3; ++c)
      for (unsigned i = 0; i < (n + 15) / 16 * 16; ++i)
        points.axes[c][i] = s.coordinates[3 * (i < n ? i : 0) + c];
    return internal::small_hull_3d(points, n, hull);
  };
  for (std::uint64_t seed = 0; seed < 20; ++seed) {
    EXPECT_TRUE(takes(random_set("sphere", 65, 3, seed)));
    EXPECT_TRUE(takes(box_surface(65, seed)));
    EXPECT_TRUE(takes(turned(box_surface(65, seed))));
    EXPECT_TRUE(takes(random_grid(65, 3, 4, 0, seed)));
    EXPECT_TRUE(takes(repeated(random_set("ball", 128, 3, seed), seed)));
    EXPECT_FALSE(takes(flat(65, 2, 3, 5, seed)));
    EXPECT_FALSE(takes(times(random_set("ball", 65, 3, seed), 0x1p200, 1, 1)));
  }
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()})
    for (std::size_t i = 0; i < 12; ++i) {
      PointSet s = random_set("ball", 20, 3, 1);
      s.coordinates[5 * i] = bad;
      EXPECT_FALSE(takes(s)) << i;
    }
}

}  // namespace cullhull::small_sets_test
