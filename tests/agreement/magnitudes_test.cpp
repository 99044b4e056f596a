// Coordinates from 1e-308 to 1e308 in one set, denormals, zeros of both signs.
#include <numeric>

#include "all_paths.hpp"
#include "point_sets.hpp"

namespace cullhull::testing_support::magnitudes_test {

TEST(Magnitudes, AllInOneSet) {
  for (unsigned d = 1; d <= 5; ++d)
    for (std::uint64_t seed = 1; seed <= (d < 4 ? 8U : 3U); ++seed)
      expect_exact(all_magnitudes(d < 4 ? 40 : 18, d, seed));
}

TEST(Magnitudes, TheTinyEndOfALine) {
  // Beside 1e308 the two upper ends underflow to one number.
  for (unsigned d = 1; d <= 4; ++d) {
    PointSet s = named("tiny end of a line", d);
    for (double v : {-1e308, 0.0, 5e-324, -1e307}) {
      std::vector<double> p(d, 7.0);
      p[d - 1] = v;
      s.add(p);
    }
    expect_everywhere(s, {0, 2});
  }
}

TEST(Magnitudes, ThinnerThanTheSmallestVolume) {
  // The volume underflows; the centroid does not. Found by the fuzzer.
  PointSet s = named("one denormal thick", 4);
  s.coordinates = {0, 0, 0, 0, 5e-324, 0, 0, 0, 0, 0, 0, 1, 1, 0, 1, 0};
  const Hull h = expect_everywhere(s, {0, 1, 2, 3});
  EXPECT_EQ(h.centroid, (std::vector<double>{0.25, 0, 0.25, 0.25}));
}

TEST(Magnitudes, AThinTriangleOfInfiniteArea) {
  // 1e140 times as long as it is thick, yet its area is beyond the doubles. Found by the fuzzer.
  PointSet s = named("thin and infinite", 2);
  s.coordinates = {7.454161766632727e-308, -3.5376697029559833e+108, -3.0654017248057606e+248,
                   4.034280573063184e+195, 2.113821014380367e-307,   4.53307e-318};
  const Hull h = expect_everywhere(s, {0, 1, 2});
  EXPECT_EQ(h.volume, std::numeric_limits<double>::infinity());
}

TEST(Magnitudes, CentroidOfAFlatWithTinyAndHugeAxes) {
  // Two axes 1e480 times smaller than the others. Found by the fuzzer.
  PointSet s = named("tiny and huge axes", 4);
  s.coordinates = {2.0279106256126465e-304, 9.220110800955372e-212,  -1.306712965271115e-270,
                   -3.826520040177059e-280, -7.480089288414401e-220, 1.0610002235e-314,
                   7.301631366187919e-184,  -2.460063180362194e+260, 2.5124504766443e-310,
                   3.421955758886039e+270,  2.5597041069920914e-308, 6.3e-322};
  const Hull h = expect_everywhere(s, {0, 1, 2});
  EXPECT_NEAR(h.centroid[0], -7.480089288414401e-220 / 3, 1e-234);
}

TEST(Magnitudes, UnitNormalsOfALongTriangle) {
  // A flat triangle whose sides are 1e304 to 1. Found by the fuzzer.
  for (unsigned d = 3; d <= 5; ++d) {
    PointSet s = named("long triangle", d);
    s.coordinates.assign(std::size_t{3} * d, 0.0);
    s.coordinates[1] = 1;
    s.coordinates[2] = -0x1.c00fc144286ep+1011;
    s.coordinates[2 * d] = 1;
    expect_everywhere(s, {0, 1, 2});
  }
}

/// A simplex with legs `legs` along the first axes of R^d, its corner at 0.
PointSet right_simplex(unsigned d, const std::vector<double>& legs) {
  PointSet s = named("right simplex", d);
  s.coordinates.assign(d, 0.0);
  for (unsigned i = 0; i < legs.size(); ++i) {
    s.coordinates.resize(s.coordinates.size() + d, 0.0);
    s.coordinates[s.coordinates.size() - d + i] = legs[i];
  }
  return s;
}

TEST(Magnitudes, RightSimplicesOfAnyProportions) {
  // Volume and centroid are known; the volume may overflow to infinity, but is a number.
  const double sizes[] = {5e-324, 0x1p-600, 1, 0x1p600, 0x1p1023};
  Random r(77);
  for (unsigned d = 1; d <= 6; ++d)
    for (unsigned k = 1; k <= d; ++k)
      for (unsigned repeat = 0; repeat < (d < 4 ? 8U : 3U); ++repeat) {
        std::vector<double> legs;
        long exponent = 0, factorial = 1;
        for (unsigned i = 0; i < k; ++i) {
          legs.push_back(sizes[r.integer(0, 4)]);
          exponent += std::ilogb(legs.back());
          factorial *= i + 1;
        }
        const PointSet s = right_simplex(d, legs);
        Ids all(k + 1);
        std::iota(all.begin(), all.end(), 0U);
        const Hull h = expect_everywhere(s, all, Paths::few);
        SCOPED_TRACE("d " + std::to_string(d) + ", k " + std::to_string(k) + ", repeat " +
                     std::to_string(repeat));
        EXPECT_FALSE(std::isnan(h.area));
        EXPECT_DOUBLE_EQ(
            h.volume, std::ldexp(1.0 / static_cast<double>(factorial), static_cast<int>(exponent)));
        ASSERT_EQ(h.centroid.size(), d);
        for (unsigned c = 0; c < d; ++c)
          EXPECT_DOUBLE_EQ(h.centroid[c], c < k ? legs[c] / (k + 1) : 0.0);
        for (const double v : h.facet_planes) EXPECT_FALSE(std::isnan(v));
      }
}

TEST(Magnitudes, FlatsThatAreNearlyUpright) {
  // Triangles and tetrahedra whose first axes see next to nothing of them.
  for (unsigned d = 3; d <= 6; ++d)
    for (unsigned k = 2; k < d && k <= 3; ++k)
      for (const double lean : {1e-3, 1e-20, 1e-300}) {
        PointSet s = right_simplex(d, {});
        s.name = "nearly upright";
        for (unsigned i = 0; i < k; ++i) {
          std::vector<double> p(d, 0.0);
          p[i] = lean;
          p[d - 1 - i] += 1;
          s.add(p);
        }
        Ids all(k + 1);
        std::iota(all.begin(), all.end(), 0U);
        expect_everywhere(s, all, Paths::few);
      }
}

TEST(Magnitudes, AxesOfDifferentUnits) {
  for (unsigned d = 2; d <= 5; ++d) {
    PointSet s = random_grid(80, d, 4, 0, d);
    s.name += " with axes of different units";
    for (std::uint64_t i = 0; i < s.coordinates.size(); ++i)
      s.coordinates[i] = std::ldexp(s.coordinates[i], i % d == 0 ? 1000 : i % d == 1 ? -1074 : 0);
    expect_exact(s);
  }
}

TEST(Magnitudes, DenormalsAlone) {
  for (unsigned d = 2; d <= 5; ++d) {
    PointSet s = random_grid(100, d, 7, -3, d);
    s.name = "denormal " + s.name;
    for (double& v : s.coordinates) v = std::ldexp(v, -1074);
    expect_exact(s);
  }
}

TEST(Magnitudes, TheLargestDoubles) {
  for (unsigned d = 2; d <= 5; ++d) {
    PointSet s = cube_with_centres(d);
    s.name = "largest doubles, " + s.name;
    for (double& v : s.coordinates) v *= 0x1.fffffffffffffp1023;
    const Ids vertices = exact_extreme_points(s);
    EXPECT_EQ(vertices.size(), 1U << d);
    expect_everywhere(s, vertices);
  }
}

TEST(Magnitudes, ZerosOfBothSignsAreEqual) {
  for (unsigned d = 2; d <= 4; ++d) {
    PointSet s = random_grid(120, d, 3, -1, d);
    s.name = "zeros of both signs, " + s.name;
    Random r(d);
    for (double& v : s.coordinates)
      if (v == 0 && r.integer(0, 1)) v = -0.0;
    expect_exact(s);
  }
}

TEST(Magnitudes, AHugeOutlierHidesNoDetail) {
  for (unsigned d = 2; d <= 4; ++d)
    for (double huge : {1e20, 1e300}) {
      PointSet s = random_set("gauss", 60, d, d);
      s.name += " with an outlier";
      std::vector<double> p(d, 0.0);
      p[0] = huge;
      s.add(p);
      expect_exact(s);
    }
}

}  // namespace cullhull::testing_support::magnitudes_test
