// Planes, measures and coordinates that are wrong by less than the hull's largest extent shows, and
// right ones of extreme size.
#include <gtest/gtest.h>

#include <cmath>
#include <ctime>
#include <functional>
#include <limits>
#include <random>

#include "agreement/hard_sets.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/hull.hpp"
#include "io/certify_file.hpp"
#include "io/json/json.hpp"

namespace cullhull::testing_support {
namespace certify_numbers_test {

constexpr double infinity = std::numeric_limits<double>::infinity();

std::string reason(const PointSet& s, const Hull& h) { return certify(view_of(s), h).reason; }

PointSet box(std::vector<double> sides) {
  const auto d = static_cast<unsigned>(sides.size());
  PointSet s = full_grid(d, 2, 0);
  for (std::size_t i = 0; i < s.coordinates.size(); ++i) s.coordinates[i] *= sides[i % d];
  return s;
}

double* plane(Hull& h, std::size_t f) {
  return h.facet_planes.data() + f * (h.dimension + std::size_t{1});
}

/// Spoils the plane of every facet in turn: each time it is refused.
void expect_each_refused(const PointSet& s, const std::function<bool(double*)>& spoil) {
  const Hull good = convex_hull(view_of(s));
  ASSERT_EQ(reason(s, good), "") << s.name;
  unsigned spoilt = 0;
  for (std::size_t f = 0; f < good.facet_count(); ++f) {
    Hull bad = good;
    if (!spoil(plane(bad, f))) continue;
    ++spoilt;
    EXPECT_NE(reason(s, bad).find("facet " + std::to_string(f)), std::string::npos)
        << s.name << ", facet " << f << ": '" << reason(s, bad) << "'";
  }
  EXPECT_GT(spoilt, 0U);
}

TEST(CertifyNumbers, InfiniteOffsetsOfSmallHullsAreRefused) {
  const PointSet s = box({1, 1, 1});
  Hull h = convex_hull(view_of(s));
  for (std::size_t f = 0; f < h.facet_count(); ++f)
    std::copy_n(std::vector<double>{1, 0, 0, infinity}.begin(), 4, plane(h, f));
  EXPECT_NE(reason(s, h), "");
  for (const double offset : {infinity, -infinity, std::nan("")})
    expect_each_refused(s, [&](double* p) {
      p[3] = offset;
      return true;
    });
}

/// 1.2e308 times the square root of 3 is beyond the doubles.
TEST(CertifyNumbers, AnOffsetThatOverflowsIsInfinite) {
  PointSet s = named("far corner", 3);
  const double m = 1.7e308;
  for (const auto& p : std::vector<std::vector<double>>{{m, m, m}, {m, m, 0}, {m, 0, m}, {0, m, m}})
    s.add(p);
  Hull h = convex_hull(view_of(s));
  unsigned infinite = 0;
  for (std::size_t f = 0; f < h.facet_count(); ++f) infinite += std::isinf(plane(h, f)[3]);
  EXPECT_GT(infinite, 0U);
  EXPECT_EQ(reason(s, h), "");
  for (std::size_t f = 0; f < h.facet_count(); ++f) {
    Hull bad = h;
    double& offset = plane(bad, f)[3];
    offset = std::isinf(offset) ? -offset : offset < 0 ? -infinity : infinity;
    EXPECT_NE(reason(s, bad), "") << f;
  }
}

TEST(CertifyNumbers, PlanesOfThinBoxes) {
  for (const auto& sides : std::vector<std::vector<double>>{
           {1e6, 1, 1e-6}, {1e-310, 1e-310, 1e-310}, {1e6, 1e-6}, {1e300, 1, 1e-300}}) {
    const PointSet s = box(sides);
    const auto d = static_cast<unsigned>(sides.size());
    expect_each_refused(s, [&](double* p) {
      for (unsigned c = 0; c <= d; ++c) p[c] = -p[c];
      return true;
    });
    for (const double share : {900.0, 1.0, 0.5, 1e-3})
      for (const double sign : {-1, 1})
        expect_each_refused(s, [&](double* p) {
          for (unsigned c = 0; c < d; ++c)
            if (p[c] != 0) p[d] += sign * share * sides[c];
          return true;
        });
    // Tilted by so little that only the long sides show it.
    for (unsigned axis = 0; axis < d; ++axis)
      expect_each_refused(s, [&](double* p) {
        if (p[axis] != 0) return false;
        p[axis] = 1e-12;
        return true;
      });
  }
}

TEST(CertifyNumbers, NormalsOfFlatHullsLieInTheFlat) {
  PointSet square = named("square in space", 3);
  for (int i = 0; i < 4; ++i) square.add({1.0 * (i & 1), 1.0 * (i >> 1), 0});
  expect_each_refused(square, [](double* p) {
    p[0] = p[1] = 0x1p-40;
    p[2] = 1;
    p[3] = 0;
    return true;
  });
  expect_each_refused(square, [](double* p) {
    p[2] = 1e-12;
    return true;
  });
  PointSet turned = named("square across the diagonal", 3);
  for (int i = 0; i < 4; ++i) {
    const double a = i & 1, b = i >> 1;
    turned.add({a, b, 1 - a - b});
  }
  for (const double off : {1.0, 1e-3, 1e-9})
    expect_each_refused(turned, [&](double* p) {
      for (unsigned c = 0; c < 3; ++c) p[c] += off;
      p[3] -= off;  // the plane of the flat
      return true;
    });
  PointSet segment = named("segment", 3);
  segment.add({0, 0, 0});
  segment.add({3, 4, 0});
  expect_each_refused(segment, [](double* p) {
    // At right angles to the segment but for its length along it.
    const double n[] = {0.6 + 0.08, 0.8 - 0.06, 0};
    for (unsigned c = 0; c < 3; ++c) p[c] = std::copysign(n[c], p[c]);
    return true;
  });
}

/// The measures of a hull so small that an absolute tolerance would swallow them.
TEST(CertifyNumbers, SmallMeasuresAreRelative) {
  PointSet s = box({1e-110, 3e-110});
  const Hull good = convex_hull(view_of(s));
  ASSERT_EQ(reason(s, good), "");
  ASSERT_GT(good.volume, 0);
  for (const double wrong : {0.0, 2.2e-308, -good.volume, good.volume * (1 + 1e-12), infinity}) {
    Hull bad = good;
    bad.volume = wrong;
    EXPECT_EQ(reason(s, bad).find("the volume"), 0U) << wrong;
    bad = good;
    bad.area = wrong;
    EXPECT_EQ(reason(s, bad).find("the area"), 0U) << wrong;
  }
  PointSet cube = box({1e-110, 1e-110, 1e-110});
  const Hull none = convex_hull(view_of(cube));
  EXPECT_EQ(none.volume, 0);  // 1e-330
  EXPECT_EQ(reason(cube, none), "");
  for (const double wrong : {2.2e-308, -2.2e-308, 0x1p-1074}) {
    Hull bad = none;
    bad.volume = wrong;
    EXPECT_EQ(reason(cube, bad).find("the volume"), 0U) << wrong;
  }
}

/// The volume of a triangle as long as 1e308 and as wide as 1e-289, one edge of which is shorter
/// still: found by fuzzing.
TEST(CertifyNumbers, VolumesBelowEveryDouble) {
  const PointSet s{"thin", 2, {1e308, 2.061491772686043e-289, 7.748611111577175e-304, 0, 0, 0}};
  EXPECT_EQ(reason(s, convex_hull(view_of(s))), "");
}

/// In a flat whose axes differ so, each component of a normal counts down to the least double:
/// found by fuzzing.
TEST(CertifyNumbers, FlatAcrossAllMagnitudes) {
  const PointSet s{"flat",
                   6,
                   {2.1189065346908687e-164, 2.204457e-317, 1.0359284e-316, -3.0654017248048465e248,
                    1.0336529548714315e-166, -1.5494739372372946e231, 5.375598442580152e-299,
                    -1.3024916433538417e163, 3.9419496760921695e195, 4.144532e-317,
                    7.301631366461899e-184, 5.96046447e-316, 0, 0, 0, 0, 0, 0}};
  EXPECT_EQ(reason(s, convex_hull(view_of(s))), "");
}

/// No axis is short, but the steps to most vertices vanish in the units of the longest.
TEST(CertifyNumbers, FlatOfPointsOfAllMagnitudes) {
  PointSet s{"flat", 3, {}};
  for (const auto& [x, z] : {std::pair{-1.6091764227273352e-50, -1.249173079655945e-50},
                             {-1.7295838356764733e+145, -5.339552228491322e+145},
                             {-3.913398946408882e-64, 1.5212031767603455e-64},
                             {2.401149624540777e+305, 3.981093880978109e+305},
                             {-5.313469677496112e-37, 4.780555619957536e-36}})
    s.add({x, x, z});
  EXPECT_EQ(reason(s, convex_hull(view_of(s))), "");
}

/// Coordinates of any magnitudes, a point or an axis at a time: facets so thin that only wide
/// arithmetic tells their normals.
TEST(CertifyNumbers, AnyMagnitudesInAnyDimension) {
  std::mt19937_64 random(7);
  const auto below = [&](unsigned n) { return static_cast<unsigned>(random() % n); };
  for (unsigned run = 0; run < 180; ++run) {
    const unsigned d = 1 + run % 6, n = d + 1 + below(6), kind = below(4);
    std::vector<int> of_axis(d);
    for (int& e : of_axis) e = static_cast<int>(below(2040)) - 1020;
    PointSet s{"magnitudes, run " + std::to_string(run), d, {}};
    for (unsigned i = 0; i < n; ++i) {
      const int of_point = static_cast<int>(below(2040)) - 1020;
      for (unsigned c = 0; c < d; ++c) {
        const int own = static_cast<int>(below(2040)) - 1020;
        const int exponent = kind == 0 ? of_axis[c] : kind == 1 ? of_point : own;
        const double v = std::ldexp(1 + static_cast<double>(below(4096)) / 4096, exponent);
        s.coordinates.push_back(below(4) == 0 ? 0 : below(2) == 0 ? v : -v);
      }
      if (run % 7 == 0) s.coordinates.back() = s.coordinates[s.coordinates.size() - d];  // a flat
    }
    EXPECT_EQ(reason(s, convex_hull(view_of(s))), "") << s.name;
  }
}

/// The centroid of a box goes by its own axis' extent.
TEST(CertifyNumbers, CentroidsAxisByAxis) {
  const PointSet s = box({1e6, 1, 1e-6});
  const Hull good = convex_hull(view_of(s));
  const double sides[] = {1e6, 1, 1e-6};
  for (unsigned c = 0; c < 3; ++c)
    for (const double share : {0.1, 1e-9, -1e-12}) {
      Hull bad = good;
      bad.centroid[c] += share * sides[c];
      EXPECT_EQ(reason(s, bad).find("coordinate " + std::to_string(c) + " of the centroid"), 0U);
    }
}

/// What no documented bound allows, however far it exceeds the measure.
void expect_measures_held(const PointSet& s) {
  const Hull good = convex_hull(view_of(s));
  ASSERT_EQ(reason(s, good), "") << s.name;
  ASSERT_GT(good.volume, 0) << s.name;
  const auto refused = [&](double Hull::*measure, double wrong, const char* what) {
    Hull bad = good;
    bad.*measure = wrong;
    EXPECT_EQ(reason(s, bad).find(what), 0U) << s.name << ": " << wrong << " for " << good.*measure;
  };
  for (const double share : {0.0, -1.0, 2.0, 0.5, -1e-3, 1e3, 1.3}) {
    refused(&Hull::volume, share * good.volume, "the volume");
    refused(&Hull::area, share * good.area, "the area");
  }
  refused(&Hull::volume, -5e-324, "the volume");
  refused(&Hull::area, -5e-324, "the area");
  for (unsigned c = 0; c < s.dimension; c += 1 + s.dimension / 6) {
    double low = infinity, high = -infinity;
    for (const std::uint64_t v : good.vertices) {
      low = std::min(low, s.row(v)[c]);
      high = std::max(high, s.row(v)[c]);
    }
    for (const double outside : {std::nextafter(low, -infinity), std::nextafter(high, infinity),
                                 high + 2 * (high - low), 1e300, -infinity}) {
      Hull bad = good;
      bad.centroid[c] = outside;
      EXPECT_EQ(reason(s, bad).find("coordinate " + std::to_string(c) + " of the centroid"), 0U)
          << s.name << ": " << outside;
    }
  }
}

/// Lattices of a plane, turned: rounding leaves hulls about as thick as doubles are apart.
TEST(CertifyNumbers, MeasuresOfHullsAsThinAsRounding) {
  for (const unsigned d : {3U, 4U})
    for (const double angle : {0.3, 0.7, 1.1}) {
      PointSet s = named("turned 5 x 5 lattice", d);
      for (int i = 0; i < 25; ++i) {
        std::vector<double> p(d, 0);
        p[0] = i % 5 - 2;
        p[1] = i / 5 - 2;
        s.add(p);
      }
      turn_axes(s, 0, d - 1, angle);
      turn_axes(s, 1, d - 1, 0.5 + angle);
      if (d == 4) turn_axes(s, 0, 2, angle);
      expect_measures_held(s);
    }
}

/// From nine dimensions on the bounds of elimination exceed many volumes; in flats they do earlier.
TEST(CertifyNumbers, MeasuresOfManyDimensions) {
  for (const unsigned d : {9U, 12U})
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      PointSet s =
          random_set(seed == 1 ? "sphere" : "cube", d + static_cast<unsigned>(seed), d, seed);
      if (seed == 3)
        for (std::size_t i = 0; i < s.coordinates.size(); ++i)
          s.coordinates[i] = std::ldexp(s.coordinates[i], static_cast<int>(i % d) * -5);
      expect_measures_held(s);
    }
  for (const unsigned k : {2U, 5U, 7U, 9U}) {
    PointSet s = flat(k + 3, k, 11, 6, k);
    for (std::size_t i = 0; i < s.coordinates.size(); ++i) s.coordinates[i] *= 0x1p-20;
    expect_measures_held(s);
  }
}

/// Beyond eight dimensions measures are held to what is lost, not to what elimination may lose at
/// worst, and right ones pass, of thin hulls as well.
TEST(CertifyNumbers, MeasuresBeyondEightDimensionsAreTight) {
  for (const unsigned d : {9U, 11U})
    for (std::uint64_t seed = 1; seed <= 2; ++seed) {
      std::vector<PointSet> sets{random_set("sphere", d + 4, d, seed),
                                 random_set("cube", d + 4, d, seed),
                                 flat(d + 2, d, d + 4, 1000, seed)};
      for (const int bits : {-8, -20, -34}) {  // thinner and thinner, and askew
        PointSet s = random_set("cube", d + 4, d, seed);
        for (std::size_t i = 0; i < s.coordinates.size(); i += d)
          s.coordinates[i] = std::ldexp(s.coordinates[i], bits);
        turn_axes(s, 0, 1, 0.7);
        turn_axes(s, 0, d - 1, 0.4);
        sets.push_back(s);
      }
      for (const PointSet& s : sets) {
        const Hull good = convex_hull(view_of(s));
        ASSERT_EQ(reason(s, good), "") << s.name;
        for (const double off : {1e-6, -1e-9}) {
          if (&s == &sets[2] && off != 1e-6) continue;  // the library sees a projection of it
          Hull bad = good;
          bad.volume *= 1 + off;
          EXPECT_EQ(reason(s, bad).find("the volume"), 0U) << s.name << " " << off;
          bad = good;
          bad.area *= 1 + off;
          EXPECT_EQ(reason(s, bad).find("the area"), 0U) << s.name << " " << off;
        }
      }
    }
}

/// Facets of the curve of powers are so thin that their normals need long numbers; that takes
/// about as long as the hull, which needs them as well.
TEST(CertifyNumbers, ThinFacetsTakeAboutAsLongAsTheHull) {
  PointSet s = named("curve of powers", 8);
  for (int i = 1; i <= 22; ++i) {
    std::vector<double> p;
    for (int power = 1; power <= 8; ++power) p.push_back(std::pow(i, power));
    s.add(p);
  }
  const auto seconds = [](const auto& body) {
    const std::clock_t before = std::clock();
    body();
    return static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC;
  };
  Hull hull;
  const double of_hull = seconds([&] { hull = convex_hull(view_of(s)); });
  const double of_proof = seconds([&] { EXPECT_EQ(reason(s, hull), ""); });
  EXPECT_LT(of_proof, 3 * of_hull + 0.2);
}

/// Axes whose proportions make every facet a needle: the exact normals take no more than integers
/// of a column each.
TEST(CertifyNumbers, AxesOfAnyProportionsTakeNoLonger) {
  PointSet s = random_set("ball", 13, 9, 5);
  for (std::size_t i = 0; i < s.coordinates.size(); ++i)
    s.coordinates[i] = std::ldexp(s.coordinates[i], static_cast<int>(i % 9) * 230 - 960);
  const Hull hull = convex_hull(view_of(s));
  const std::clock_t before = std::clock();
  EXPECT_EQ(reason(s, hull), "");
  EXPECT_LT(static_cast<double>(std::clock() - before) / CLOCKS_PER_SEC, 5);
}

TEST(CertifyNumbers, SimplexesOfManyDimensionsAndAnySize) {
  for (const double size : {1e308, 1e250, 1.0, 1e-300})
    for (unsigned d = 12; d <= 30; d += size == 1e308 ? 3 : 6) {
      PointSet s = named("simplex", d);
      s.add(std::vector<double>(d, 0));
      for (unsigned i = 0; i < d; ++i) {
        std::vector<double> p(d, 0);
        p[i] = size;
        s.add(p);
      }
      EXPECT_EQ(reason(s, convex_hull(view_of(s))), "") << d << "D, " << size;
    }
}

TEST(CertifyNumbers, VertexCoordinatesOfAFile) {
  const PointSet s = random_set("ball", 30, 3, 1);
  const Hull hull = convex_hull(view_of(s));
  std::string text;
  internal::write_result_json(view_of(s), hull, [&](const std::string& piece) { text += piece; });
  const auto verdict = [&](const std::string& file) {
    return internal::certify_source(view_of(s), {"F", file.data(), file.size()}, {}).reason;
  };
  EXPECT_EQ(verdict(text), "");
  const std::size_t at = text.find("\"vertex_coordinates\": [\n[") + 25;
  const std::size_t end = text.find(',', at);
  for (const char* wrong : {"0", "1e-300", "0.5"}) {
    std::string file = text;
    file.replace(at, end - at, wrong);
    EXPECT_EQ(verdict(file),
              "row 0 of vertex_coordinates is not point " + std::to_string(hull.vertices[0]));
  }
  const std::size_t list = text.find("\"vertex_coordinates\": [") + 23;
  std::string empty = text;
  empty.erase(list, text.find("\"facets\"") - list - 3);
  EXPECT_THROW(verdict(empty), Error);
}

}  // namespace certify_numbers_test
}  // namespace cullhull::testing_support
