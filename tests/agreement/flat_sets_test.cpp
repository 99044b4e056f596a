// Sets without volume: no points, few, all equal, collinear, coplanar, in any flat of 3D to 6D.
#include <algorithm>
#include <cmath>

#include "all_paths.hpp"
#include "cullhull/extreme_points.hpp"
#include "point_sets.hpp"

namespace cullhull::testing_support::flat_sets_test {

TEST(FlatSets, NoPoints) {
  for (unsigned d = 1; d <= 6; ++d) {
    const Hull h = expect_everywhere(named("none", d), {});
    EXPECT_EQ(h.affine_dimension, -1);
    EXPECT_EQ(h.facet_count(), 0u);
    EXPECT_EQ(h.volume, 0);
  }
}

TEST(FlatSets, FewPoints) {
  for (unsigned d = 1; d <= 8; ++d) {
    PointSet s = named("few", d);
    Ids all;
    for (unsigned n = 1; n <= d + 1; ++n) {
      std::vector<double> p(d, 1.0);
      if (n > 1) p[n - 2] = 3;
      s.add(p);
      all.push_back(n - 1);
      const Hull h = expect_everywhere(s, all);
      EXPECT_EQ(h.affine_dimension, static_cast<int>(n) - 1);
      if (n > 1) {
        EXPECT_EQ(h.facet_count(), n);
      }
    }
  }
}

TEST(FlatSets, OneDimension) {
  PointSet s = named("line", 1);
  s.coordinates = {3, -1, 7, 7, -1, 2, 0};
  const Hull h = expect_everywhere(s, {1, 2});
  EXPECT_EQ(h.volume, 8);
  EXPECT_EQ(h.area, 2);
}

TEST(FlatSets, AMillionEqualPoints) {
  for (unsigned d = 2; d <= 3; ++d) {
    PointSet s = named("equal", d);
    s.coordinates.assign(std::size_t{1000000} * d, 0.1);
    Options options;
    const Hull h = convex_hull(view_of(s), options);
    EXPECT_EQ(h.vertices, Ids{0});
    EXPECT_EQ(h.affine_dimension, 0);
    EXPECT_TRUE(certify(view_of(s), h));
    // One, two ... points apart from the rest, at the end: the million represent one vertex.
    Ids expected{0};
    for (unsigned k = 0; k < d; ++k) {
      std::vector<double> p(d, 0.1);
      p[k] = 0.7;
      expected.push_back(s.count());
      s.add(p);
    }
    for (CullMethod cull : {CullMethod::none, CullMethod::gauge, CullMethod::pseudo_hull}) {
      options.cull = cull;
      const Hull simplex = convex_hull(view_of(s), options);
      EXPECT_EQ(sorted_vertices(simplex), expected);
      if (cull == CullMethod::none) {
        EXPECT_TRUE(certify(view_of(s), simplex));
      }
    }
  }
}

TEST(FlatSets, EqualPointsOfAnyDimension) {
  for (unsigned d = 1; d <= 9; ++d) {
    PointSet s = named("equal", d);
    s.coordinates.assign(50 * d, -0.3);
    EXPECT_EQ(expect_everywhere(s, {0}).affine_dimension, 0);
  }
}

TEST(FlatSets, FlatsOfEveryDimension) {
  for (unsigned d = 3; d <= 6; ++d)
    for (unsigned k = 1; k < d; ++k) {
      const Hull h = expect_exact(flat(60, k, d, 4, d * 10 + k));
      EXPECT_EQ(h.affine_dimension, static_cast<int>(k)) << "in " << d << "D";
    }
}

TEST(FlatSets, LargeFlatsThatTheFilterThins) {
  for (unsigned d = 3; d <= 4; ++d) {
    // A full grid of a plane in space: four corners.
    PointSet s = named("large plane", d);
    for (int i = 0; i < 200; ++i)
      for (int j = 0; j < 200; ++j) {
        std::vector<double> p(d, 5.0);
        p[0] += 2 * i + j;
        p[1] += 3 * i - 7 * j;
        p[d - 1] += i + j;
        s.add(p);
      }
    const Hull h = expect_everywhere(s, {0, 199, 199 * 200, 199 * 200 + 199});
    EXPECT_EQ(h.affine_dimension, 2);
  }
}

TEST(FlatSets, CollinearDoubles) {
  // Multiples of one vector of doubles: collinear exactly, since the factors are powers of two.
  for (unsigned d = 2; d <= 6; ++d) {
    PointSet s = named("powers along a line", d);
    Random r(d);
    std::vector<double> v(d);
    for (double& x : v) x = r.between(-1, 1);
    for (int e = -20; e <= 20; ++e) {
      std::vector<double> p = v;
      for (double& x : p) x = std::ldexp(x, e);
      s.add(p);
    }
    const Hull h = expect_everywhere(s, {0, 40});
    EXPECT_EQ(h.affine_dimension, 1);
  }
}

TEST(FlatSets, OneUlpOffAFlatIsNoFlat) {
  for (unsigned d = 2; d <= 5; ++d) {
    PointSet s = named("one ulp off a flat", d);
    Random r(d);
    for (int i = 0; i < 40; ++i) {
      std::vector<double> p(d, 0);
      for (unsigned j = 0; j + 1 < d; ++j) p[j] = r.integer(0, 64) / 64.0;
      p[d - 1] = p[0] + (i == 20 ? 0x1p-52 : 0);
      if (i == 20) p[d - 1] = std::nextafter(p[0], 2);
      s.add(p);
    }
    const Hull h = expect_exact(s);
    EXPECT_EQ(h.affine_dimension, static_cast<int>(d));
  }
}

/// Lattice points under shears that are exact in doubles and leave 2^-44 of one or two directions:
/// the simplices are those of the lattice points, ties included.
TEST(FlatSets, NearlyFlatLikeTheLatticeBeforeItsShear) {
  for (const unsigned d : {4U, 5U, 6U, 8U})
    for (const unsigned sheared : {1U, 2U})
      for (const int side : {4, 15}) {
        const PointSet lattice = random_grid(400 >> (d - 4), d, side, 0, d + sheared);
        PointSet thin = lattice;
        thin.name = "sheared " + lattice.name;
        for (std::uint64_t i = 0; i < thin.count(); ++i)
          for (unsigned j = 0; j < sheared; ++j) {
            double* x = thin.coordinates.data() + i * d;
            x[d - 1 - j] = x[j] + x[d - 1 - j] * 0x1p-44;
          }
        const Hull before = convex_hull(view_of(lattice));
        const Hull after = expect_everywhere(thin, sorted_vertices(before), Paths::few);
        EXPECT_TRUE(std::ranges::equal(after.simplices, before.simplices)) << thin.name;
        EXPECT_TRUE(std::ranges::equal(after.simplex_neighbours, before.simplex_neighbours));
        EXPECT_EQ(after.facet_count(), before.facet_count()) << thin.name;
        EXPECT_EQ(extreme_points(view_of(thin)).ids, sorted_vertices(before)) << thin.name;
      }
}

/// Shares that sum to 1 but for rounding: filters in doubles decide nearly all of their signs.
TEST(FlatSets, SharesTakeFewExactSigns) {
  for (const unsigned d : {4U, 5U, 6U}) {
    PointSet shares = generated("gauss", 8000 >> (d - 4) * 2, d, 7);
    for (std::uint64_t i = 0; i < shares.count(); ++i) {
      double* x = shares.coordinates.data() + i * d;
      double sum = 0;
      for (unsigned j = 0; j < d; ++j) sum += x[j] = std::abs(x[j]);
      for (unsigned j = 0; j < d; ++j) x[j] /= sum;
    }
    const Hull h = convex_hull(view_of(shares));
    EXPECT_TRUE(certify(view_of(shares), h)) << d;
    EXPECT_EQ(extreme_points(view_of(shares)).ids, sorted_vertices(h)) << d;
    EXPECT_LT(h.statistics.rung_counts[2], h.facet_count() / 4) << d;
  }
}

}  // namespace cullhull::testing_support::flat_sets_test
