// Sets where rounding decides wrongly and Qhull is no oracle: grids, cubes, cross-polytopes, cyclic
// polytopes, cylinders, cones, cospherical integer points.
#include <algorithm>
#include <cmath>

#include "all_paths.hpp"
#include "canonical_hash.hpp"
#include "cullhull/extreme_points.hpp"
#include "cullhull/generate.hpp"
#include "point_sets.hpp"

namespace cullhull::testing_support::degenerate_sets_test {

constexpr double far_away = 0x1p40;

TEST(DegenerateSets, RandomIntegerGrids) {
  for (unsigned d = 2; d <= 5; ++d)
    for (int side : {2, 3, 5, 20})
      for (double shift : {0.0, far_away, -far_away})
        expect_exact(random_grid(d < 4 ? 250 : 120, d, side, shift, d * 100 + side));
}

TEST(DegenerateSets, FullGridsHaveTheirCorners) {
  const unsigned sides[] = {0, 0, 60, 15, 7, 4};
  for (unsigned d = 2; d <= 5; ++d)
    for (double shift : {0.0, far_away}) {
      const Hull h =
          expect_everywhere(full_grid(d, sides[d], shift), full_grid_corners(d, sides[d]));
      EXPECT_EQ(h.facet_count(), 2 * d);
      EXPECT_DOUBLE_EQ(h.volume, std::pow(sides[d] - 1, d));
    }
}

TEST(DegenerateSets, LargeGridsThatTheFilterThins) {
  for (double shift : {0.0, far_away}) {
    expect_everywhere(full_grid(2, 300, shift), full_grid_corners(2, 300));
    expect_everywhere(full_grid(3, 45, shift), full_grid_corners(3, 45));
  }
}

class CubeCorners : public ::testing::TestWithParam<unsigned> {};

TEST_P(CubeCorners, WithCentres) {
  const unsigned d = GetParam();
  const PointSet s = cube_with_centres(d);
  Ids corners;
  for (std::uint64_t i = 2 * d + 1; i < s.count(); ++i) corners.push_back(i);
  // 7! and 8! simplices a facet pair: seconds a hull.
  const Hull h = expect_everywhere(s, corners,
                                   d < 7    ? Paths::all
                                   : d == 7 ? Paths::few
                                            : Paths::reference);
  EXPECT_EQ(h.facet_count(), 2 * d);
  EXPECT_DOUBLE_EQ(h.volume, std::ldexp(1, static_cast<int>(d)));
}

INSTANTIATE_TEST_SUITE_P(DegenerateSets, CubeCorners, ::testing::Range(2U, 9U));

TEST(DegenerateSets, CrossPolytopesWithEdgeMiddles) {
  double factorial = 1;
  for (unsigned d = 2; d <= 7; ++d) {
    const PointSet s = cross_polytope_with_middles(d);
    Ids corners;
    for (std::uint64_t i = s.count() - 2 * d; i < s.count(); ++i) corners.push_back(i);
    const Hull h = expect_everywhere(s, corners);
    EXPECT_EQ(h.facet_count(), 1U << d) << s.name;
    factorial *= d;
    EXPECT_DOUBLE_EQ(h.volume, std::pow(4, d) / factorial) << s.name;
  }
}

TEST(DegenerateSets, CyclicPolytopes) {
  for (unsigned d = 2; d <= 7; ++d) {
    const unsigned n = d < 4 ? 40 : d + 8;
    const PointSet s = cyclic(n, d);
    Ids all(n);
    for (unsigned i = 0; i < n; ++i) all[i] = i;
    const Hull h = expect_everywhere(s, all);
    // Gale's evenness: n / (n - k) * C(n - k, k) facets for d = 2k, 2 C(n - k - 1, k) for 2k + 1.
    const unsigned k = d / 2, m = d % 2 ? n - k - 1 : n - k;
    double binomial = 1;
    for (unsigned i = 0; i < k; ++i) binomial = binomial * (m - i) / (i + 1);
    EXPECT_EQ(h.facet_count(), std::llround(d % 2 ? 2 * binomial : binomial * n / (n - k)))
        << s.name;
  }
}

TEST(DegenerateSets, CylindersAndCones) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    expect_exact(cylinder(250, seed));
    expect_exact(cone(250, seed));
  }
}

TEST(DegenerateSets, CospericalIntegerPoints) {
  expect_exact(cospherical(2, 5 * 5 * 13 * 13));
  expect_exact(cospherical(3, 101));
  expect_exact(cospherical(3, 9 * 9));
  expect_exact(cospherical(4, 10));
  expect_exact(cospherical(5, 4));
}

TEST(DegenerateSets, ManyDuplicates) {
  for (unsigned d = 2; d <= 5; ++d) {
    PointSet s = random_grid(40, d, 3, 0, d);
    const std::vector<double> once = s.coordinates;
    for (int k = 0; k < 5; ++k) s.coordinates.insert(s.coordinates.end(), once.begin(), once.end());
    s.name += " six times";
    expect_exact(s);
    PointSet g = random_set("gauss", 40, d, d);
    const std::vector<double> base = g.coordinates;
    g.coordinates.insert(g.coordinates.end(), base.begin(), base.end());
    g.name += " twice";
    expect_exact(g);
  }
}

TEST(DegenerateSets, RotatedLattices) {
  // Rounding a rotated lattice leaves faces of points one ulp off a plane.
  for (unsigned d = 2; d <= 4; ++d) {
    PointSet s = full_grid(d, d == 2 ? 14 : d == 3 ? 6 : 4, 0);
    s.name = "rotated " + s.name;
    for (std::uint64_t i = 0; i < s.count(); ++i)
      for (unsigned j = 0; j + 1 < d; ++j) {
        double& x = s.coordinates[i * d + j];
        double& y = s.coordinates[i * d + j + 1];
        const double a = x * std::cos(0.7) - y * std::sin(0.7);
        y = x * std::sin(0.7) + y * std::cos(0.7);
        x = a;
      }
    expect_exact(s);
  }
}

/// A flat's points are filtered in the flat: with the bits of no filter, and of all their vertices.
TEST(DegenerateSets, ManyPointsInAFlat) {
  for (const unsigned k : {2U, 3U})
    for (const char* shape : {"ball", "gauss", "sphere"}) {
      const std::uint64_t n = k == 2 ? 60'000 : 20'000;
      const std::vector<double> made = generate(shape, n, k, 5);
      for (const unsigned d : {k + 1, k + 2}) {
        PointSet s;
        s.dimension = d;
        for (std::uint64_t i = 0; i < n; ++i) {
          std::vector<double> p(made.begin() + static_cast<std::ptrdiff_t>(i * k),
                                made.begin() + static_cast<std::ptrdiff_t>((i + 1) * k));
          for (double& x : p) x = std::ldexp(std::round(std::ldexp(x, 20)), -20);
          for (unsigned j = k; j < d; ++j) p.push_back(j * p[0] - p[1] + 0.25);  // exact
          s.add(p);
        }
        Options plain;
        plain.cull = CullMethod::none;
        const Hull expected = convex_hull(view_of(s), plain), hull = convex_hull(view_of(s));
        EXPECT_EQ(hull.affine_dimension, static_cast<int>(k));
        EXPECT_EQ(canonical_hash(hull), canonical_hash(expected)) << shape << " " << k << " " << d;
        const ExtremePoints extreme = extreme_points(view_of(s));
        EXPECT_EQ(extreme.affine_dimension, static_cast<int>(k));
        std::vector<std::uint64_t> ids = hull.vertices;
        std::sort(ids.begin(), ids.end());
        EXPECT_EQ(extreme.ids, ids) << shape << " " << k << " " << d;
      }
    }
}

}  // namespace cullhull::testing_support::degenerate_sets_test
