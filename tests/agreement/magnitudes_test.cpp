// Coordinates from 1e-308 to 1e308 in one set, denormals, zeros of both signs.
#include "all_paths.hpp"
#include "point_sets.hpp"

namespace cullhull::testing_support {
namespace {

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

}  // namespace
}  // namespace cullhull::testing_support
