// The cull is sound: a point is dropped only if it lies strictly inside the polytope, exactly.
#include "filter/gauge/gauge_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "call_options.hpp"
#include "exact/orientation/orientation.hpp"
#include "filter/gauge/gauge_table.hpp"
#include "parallel/threads/run.hpp"
#include "tests/made_sets.hpp"
#include "tests/reference/slow_hull.hpp"
#include "thrown.hpp"

namespace cullhull::internal {
namespace gauge_map_test {

using reference::SlowHull;

/// The polytope of a reference hull, on its own vertices only.
InnerPolytope polytope_of(const SlowHull& hull) {
  InnerPolytope p;
  p.dimension = hull.dimension();
  p.vertices = hull.rows();
  for (const auto& f : hull.facets()) {
    p.facets.insert(p.facets.end(), f.vertices.begin(), f.vertices.end());
    p.neighbours.insert(p.neighbours.end(), f.neighbours.begin(), f.neighbours.end());
  }
  return p;
}

std::vector<std::uint64_t> survivors(const GaugeMap& map, const std::vector<double>& rows,
                                     unsigned d) {
  const Options options;
  const auto ids = map.survivors(PointView::row_major(rows.data(), rows.size() / d, d),
                                 internal::Run(options).with_threads(1));
  return {ids.begin(), ids.end()};
}

/// Every dropped point is strictly beneath every facet, decided exactly. A filter in doubles spares
/// the exact test where the answer is beyond doubt: its bound, 2^-40 of the sum of magnitudes, is
/// far above the rounding of seven terms.
void expect_sound(const SlowHull& hull, const std::vector<double>& rows,
                  const std::vector<std::uint64_t>& kept, const std::string& what) {
  const unsigned d = hull.dimension();
  std::vector<std::vector<double>> planes;
  for (const auto& f : hull.facets()) {
    // Common power of two per facet, chosen so that the largest term of the normal is near one.
    long top = std::numeric_limits<long>::min();
    const auto height = [](const reference::Dyadic& v) {
      return v.exponent + static_cast<long>(mpz_sizeinbase(v.mantissa.get_mpz_t(), 2));
    };
    for (const auto& n : f.plane.normal)
      if (n.sign() != 0) top = std::max(top, height(n));
    std::vector<double> row;
    for (const auto& n : f.plane.normal) {
      long e = 0;
      const double m = mpz_get_d_2exp(&e, n.mantissa.get_mpz_t());
      row.push_back(std::ldexp(m, static_cast<int>(std::max(-3000L, e + n.exponent - top))));
    }
    planes.push_back(row);
  }
  std::size_t next = 0;
  for (std::uint64_t i = 0; i < rows.size() / d; ++i) {
    if (next < kept.size() && kept[next] == i) {
      ++next;
      continue;
    }
    const double* x = &rows[i * d];
    for (std::size_t f = 0; f < planes.size(); ++f) {
      const double* p0 = hull.point(hull.facets()[f].vertices[0]);
      double value = 0;
      double size = 0;
      for (unsigned j = 0; j < d; ++j) {
        const double term = planes[f][j] * (x[j] - p0[j]);
        value += term;
        size += std::abs(planes[f][j]) * (std::abs(x[j]) + std::abs(p0[j]));
      }
      if (value < -0x1p-40 * size && size > 0x1p-900 && size < 0x1p900) continue;
      ASSERT_LT(hull.facets()[f].plane.side(x), 0)
          << what << ": point " << i << " was dropped but is not strictly inside";
    }
  }
  ASSERT_EQ(next, kept.size()) << what << ": ids not ascending or out of range";
}

struct Shape {
  std::string name;
  unsigned d;
  std::vector<double> vertices;
};

std::vector<double> cross_polytope(unsigned d) {
  return testing_support::cross_polytope<InnerPolytope>(d, 0, 1).vertices;
}

std::vector<double> cube(unsigned d) {
  std::vector<double> rows;
  for (unsigned c = 0; c < 1U << d; ++c)
    for (unsigned j = 0; j < d; ++j) rows.push_back(c >> j & 1 ? 1.0 : -1.0);
  return rows;
}

std::vector<double> simplex(unsigned d) {
  std::vector<double> rows(d, 0.0);
  for (unsigned i = 0; i < d; ++i)
    for (unsigned j = 0; j < d; ++j) rows.push_back(i == j ? 1.0 : 0.0);
  return rows;
}

std::vector<double> gaussian(unsigned d, unsigned n, std::mt19937_64& random, bool on_sphere) {
  std::normal_distribution<double> normal;
  std::vector<double> rows;
  for (unsigned i = 0; i < n; ++i) {
    double v[8];
    double norm = 0;
    for (unsigned j = 0; j < d; ++j) v[j] = normal(random), norm += v[j] * v[j];
    for (unsigned j = 0; j < d; ++j) rows.push_back(on_sphere ? v[j] / std::sqrt(norm) : v[j]);
  }
  return rows;
}

std::vector<double> polygon(unsigned n) {
  std::vector<double> rows;
  for (unsigned i = 0; i < n; ++i) {
    rows.push_back(std::cos(6.283185307179586 * i / n));
    rows.push_back(std::sin(6.283185307179586 * i / n));
  }
  return rows;
}

std::vector<Shape> shapes(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<Shape> all;
  all.push_back({"polygon 7", 2, polygon(7)});
  all.push_back({"polygon 200", 2, polygon(200)});
  for (unsigned d = 2; d <= 6; ++d) {
    const std::string dimension = std::to_string(d) + "D ";
    all.push_back({dimension + "simplex", d, simplex(d)});
    all.push_back({dimension + "cross polytope", d, cross_polytope(d)});
    if (d <= 4) all.push_back({dimension + "cube", d, cube(d)});
    const unsigned n[] = {0, 0, 40, 60, 25, 16, 14};
    all.push_back({dimension + "gauss", d, gaussian(d, n[d], random, false)});
    all.push_back({dimension + "sphere", d, gaussian(d, n[d], random, true)});
  }
  return all;
}

/// x -> x * scale_j + shift_j, rounded: the images are the points, whatever was rounded.
std::vector<double> affine(const std::vector<double>& rows, unsigned d, const double* scale,
                           const double* shift) {
  std::vector<double> image(rows);
  for (std::size_t e = 0; e < rows.size(); ++e) image[e] = rows[e] * scale[e % d] + shift[e % d];
  return image;
}

/// Points on and next to facets, ridges and vertices, between them, and all over.
std::vector<double> adversarial(const SlowHull& hull, std::mt19937_64& random, unsigned budget) {
  const unsigned d = hull.dimension();
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<double> centre(d, 0.0);
  const auto n = static_cast<std::uint32_t>(hull.rows().size() / d);
  for (std::size_t e = 0; e < hull.rows().size(); ++e) centre[e % d] += hull.rows()[e] / n;
  std::vector<double> rows;
  const auto push = [&](const std::vector<double>& x) {
    const double infinity = std::numeric_limits<double>::infinity();
    rows.insert(rows.end(), x.begin(), x.end());
    for (unsigned j = 0; j < d; ++j) {  // one ulp either way
      for (const double towards : {-infinity, infinity}) {
        rows.insert(rows.end(), x.begin(), x.end());
        double& c = rows[rows.size() - d + j];
        c = std::nextafter(c, towards);
      }
    }
  };
  for (std::uint32_t v = 0; v < n; ++v) push({hull.point(v), hull.point(v) + d});
  for (unsigned k = 0; k < budget; ++k) {
    const auto& f = hull.facets()[random() % hull.facets().size()];
    // A random face of the facet: weights, some zero.
    std::vector<double> w(d);
    double total = 0;
    for (double& x : w) x = random() % 3 ? unit(random) : 0, total += x;
    if (total == 0) w[0] = total = 1;
    std::vector<double> x(d, 0.0);
    for (unsigned i = 0; i < d; ++i)
      for (unsigned j = 0; j < d; ++j) x[j] += w[i] / total * hull.point(f.vertices[i])[j];
    push(x);
    for (const double shrink : {1 - 0x1p-48, 1 - 0x1p-24, 1 - 0x1p-20, 0.999, 1 + 0x1p-40}) {
      for (unsigned j = 0; j < d; ++j) rows.push_back(centre[j] + (x[j] - centre[j]) * shrink);
    }
  }
  rows.insert(rows.end(), centre.begin(), centre.end());
  return rows;
}

std::vector<std::uint64_t> outside_cones(const GaugeMap& map, const std::vector<double>& rows,
                                         unsigned d) {
  const Options options;
  return map.outside_cones(Array<double>(rows.begin(), rows.end()),
                           std::vector<char>(rows.size() / d, 0),
                           internal::Run(options).with_threads(2));
}

/// All facets positive as seen from the vertices' mean.
InnerPolytope oriented(InnerPolytope p) {
  const unsigned d = p.dimension;
  std::vector<double> mean(d, 0);
  for (std::size_t i = 0; i < p.vertices.size(); ++i)
    mean[i % d] += p.vertices[i] * d / static_cast<double>(p.vertices.size());
  for (std::size_t f = 0; f < p.facets.size(); f += d) {
    std::vector<const double*> simplex;
    for (unsigned i = 0; i < d; ++i) simplex.push_back(&p.vertices[p.facets[f + i] * d]);
    simplex.push_back(mean.data());
    if (orientation(d, simplex.data()) != Sign::positive) continue;
    std::swap(p.facets[f], p.facets[f + 1]);
    std::swap(p.neighbours[f], p.neighbours[f + 1]);
  }
  return p;
}

// A surface that has moved is no convex polytope any more; what its cones prove must still hold for
// the hull of its vertices.
TEST(GaugeMap, ADentedSurfaceProvesNothingFalse) {
  std::mt19937_64 random(5);
  std::uniform_real_distribution<double> noise(-0.1, 0.1);
  unsigned maps = 0, dropped = 0;
  for (const Shape& shape : shapes(3)) {
    const SlowHull round(shape.vertices, shape.d);
    InnerPolytope dented = oriented(polytope_of(round));
    for (double& x : dented.vertices) x += noise(random) * std::abs(x);
    const SlowHull hull(dented.vertices, shape.d);
    if (hull.affine_dimension() < static_cast<int>(shape.d)) continue;
    const auto rows = adversarial(hull, random, shape.d <= 3 ? 200 : 30);
    const auto map = GaugeMap::build(dented, {.cones = true, .convex = false});
    if (!map) continue;
    ++maps;
    expect_sound(hull, rows, survivors(*map, rows, shape.d), shape.name + ", dented");
    const auto kept = outside_cones(*map, rows, shape.d);
    expect_sound(hull, rows, kept, shape.name + ", dented, cones");
    dropped += kept.size() < rows.size() / shape.d;
    if (::testing::Test::HasFatalFailure()) return;
  }
  EXPECT_GE(maps, 3U);
  EXPECT_GE(dropped, 3U);
}

/// The map of the leaders of a hull's vertices, among points that are no leaders.
std::unique_ptr<GaugeMap> led(const SlowHull& hull, const GaugeMap& before,
                              const LeaderCells& cells, unsigned threads = 1) {
  Array<double> rows(hull.rows().begin(), hull.rows().end());
  const unsigned d = hull.dimension();
  for (std::size_t e = 0; e + 2 * d <= hull.rows().size(); ++e)
    rows.push_back(hull.rows()[e] / 2 + hull.rows()[e + d] / 2);
  rows.resize(rows.size() / d * d);
  const Options options;
  return GaugeMap::of_leaders(rows, before, cells, internal::Run(options).with_threads(threads));
}

/// Tests the rows that are values of T, as T.
template <class T>
void expect_sound_as(const SlowHull& hull, const GaugeMap& map, const std::vector<double>& rows,
                     const std::string& what) {
  const unsigned d = hull.dimension();
  std::vector<T> values;
  std::vector<double> exact;
  for (std::size_t i = 0; i < rows.size(); i += d) {
    const double* x = &rows[i];
    if (!std::all_of(x, x + d, [](double v) { return std::abs(v) < 0x1p30; })) continue;
    for (unsigned j = 0; j < d; ++j) {
      values.push_back(static_cast<T>(x[j]));
      exact.push_back(static_cast<double>(values.back()));
    }
  }
  const Options options;
  const auto kept = map.survivors(PointView::row_major(values.data(), values.size() / d, d),
                                  internal::Run(options).with_threads(1));
  expect_sound(hull, exact, {kept.begin(), kept.end()}, what);
}

// A point is dropped only if it is strictly inside, whatever the leaders are, as numbers of every
// kind.
TEST(GaugeMap, LeadersDropOnlyWhatIsStrictlyInside) {
  std::mt19937_64 random(17);
  unsigned maps = 0, dropping = 0;
  for (std::uint64_t seed = 1; seed <= 2; ++seed)
    for (const Shape& shape : shapes(seed)) {
      if (shape.d < 3) continue;
      for (const double size : {1.0, 4096.0}) {
        const std::vector<double> scale(6, size), shift(6, size / 8);
        const SlowHull hull(affine(shape.vertices, shape.d, scale.data(), shift.data()), shape.d);
        const auto before = GaugeMap::build(polytope_of(hull), 3);
        ASSERT_TRUE(before) << shape.name;
        const auto rows = adversarial(hull, random, shape.d <= 3 ? 60 : 15);
        for (const LeaderCells& cells :
             {LeaderCells{2, 2, false}, LeaderCells{5, 8, true}, LeaderCells{9, 4, false}}) {
          const auto map = led(hull, *before, cells);
          if (map == nullptr) continue;
          ++maps;
          const std::string what = shape.name + ", leaders of " + std::to_string(cells.leaders);
          const auto kept = survivors(*map, rows, shape.d);
          dropping += kept.size() < rows.size() / shape.d;
          expect_sound(hull, rows, kept, what);
          expect_sound_as<float>(hull, *map, rows, what + ", f32");
          expect_sound_as<std::int32_t>(hull, *map, rows, what + ", i32");
          if (HasFatalFailure()) return;
        }
      }
    }
  EXPECT_GE(maps, 60U);
  EXPECT_GE(dropping, 20U);
}

TEST(GaugeMap, LeadersAreTheSameForEveryNumberOfThreads) {
  for (unsigned d = 3; d <= 6; ++d) {
    std::mt19937_64 random(d);
    const unsigned n[] = {0, 0, 0, 3000, 5000, 8000, 20000};
    const std::vector<double> points = gaussian(d, n[d], random, true);
    const auto before = GaugeMap::build(polytope_of(SlowHull(cross_polytope(d), d)), 4);
    ASSERT_TRUE(before);
    const Array<double> rows(points.begin(), points.end());
    const Options options;
    std::vector<float> nodes;
    for (const unsigned threads : {1U, 2U, 3U, 16U, 64U}) {
      const auto map = GaugeMap::of_leaders(rows, *before, {d == 3 ? 6U : 2U, 5, true},
                                            internal::Run(options).with_threads(threads));
      ASSERT_TRUE(map) << d;
      if (nodes.empty()) nodes = map->table().nodes;
      EXPECT_EQ(map->table().nodes, nodes) << d << "D, " << threads << " threads";
    }
  }
}

// A node whose simplex was not found would be far above those beside it.
TEST(GaugeMap, NodesOfLeadersAreLevel) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> uniform(-1, 1);
    Array<double> rows(60000);
    for (double& x : rows) x = uniform(random);
    const auto before = GaugeMap::build(polytope_of(SlowHull(cross_polytope(3), 3)), 4);
    const Options options;
    const auto map =
        GaugeMap::of_leaders(rows, *before, {12, 28, true}, internal::Run(options).with_threads(1));
    ASSERT_TRUE(map);
    const GaugeTable& t = map->table();
    for (std::uint32_t side = 0; side < 6; ++side)
      for (std::uint32_t j = 0; j <= t.cells; ++j)
        for (std::uint32_t i = 1; i < t.cells; ++i) {
          const float* node = &t.nodes[(side * (t.cells + 1) + j) * (t.cells + 1) + i];
          EXPECT_LT(node[0], 0.55F * (node[-1] + node[1])) << seed << ' ' << side;
        }
  }
}

class GaugeMapSeeds : public ::testing::TestWithParam<std::uint64_t> {};

TEST_P(GaugeMapSeeds, DropsOnlyWhatIsStrictlyInside) {
  const std::uint64_t seed = GetParam();
  std::mt19937_64 random(seed);
  const struct {
    const char* name;
    double scale[6];
    double shift[6];
  } images[] = {
      {"as is", {1, 1, 1, 1, 1, 1}, {0, 0, 0, 0, 0, 0}},
      {"far from the origin", {1, 1, 1, 1, 1, 1}, {1e6, -3e6, 1e6, 5e5, 1e6, 1e6}},
      {"nearly flat", {1, 1e-9, 3, 1e-5, 1, 1e-12}, {0, 1, 0, 0, 0, 0}},
      {"huge and tiny", {1e300, 1e-300, 1e150, 1, 1e-150, 1e7}, {0, 0, 0, 0, 0, 0}},
      {"subnormal", {1e-308, 1e-310, 1e-308, 1e-309, 1e-308, 1e-308}, {0, 0, 0, 0, 0, 0}},
      {"coarse", {16, 16, 16, 16, 16, 16}, {0x1p52, 0x1p51, 0x1p52, 0x1p52, 0x1p52, 0x1p52}},
  };
  for (const Shape& shape : shapes(seed)) {
    for (const auto& image : images) {
      const std::string what = shape.name + ", " + image.name + ", seed " + std::to_string(seed);
      const SlowHull hull(affine(shape.vertices, shape.d, image.scale, image.shift), shape.d);
      if (hull.affine_dimension() < static_cast<int>(shape.d)) continue;  // rounded flat
      const auto rows = adversarial(hull, random, shape.d <= 3 ? 40 : 12);
      for (const unsigned resolution : {0U, 3U}) {
        const auto map = GaugeMap::build(polytope_of(hull), {.resolution = resolution});
        if (!map) continue;
        expect_sound(hull, rows, survivors(*map, rows, shape.d), what);
        if (HasFatalFailure()) return;
        const auto cones = GaugeMap::build(polytope_of(hull),
                                           {.resolution = resolution, .cones = true, .threads = 2});
        ASSERT_TRUE(cones) << what;
        EXPECT_EQ(survivors(*cones, rows, shape.d), survivors(*map, rows, shape.d)) << what;
        expect_sound(hull, rows, outside_cones(*cones, rows, shape.d), what + ", cones");
        if (HasFatalFailure()) return;
      }
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Seeds, GaugeMapSeeds, ::testing::Values(1, 2));

// A map that keeps everything would be sound too: at half the way to the boundary all must go,
// near it most, and this under every scaling of the axes.
TEST(GaugeMap, DropsWhatIsWellInside) {
  std::mt19937_64 random(7);
  const double scales[][6] = {
      {1, 1, 1, 1, 1, 1}, {1, 1e-9, 3, 1e-5, 1, 1e-12}, {1e300, 1e-300, 1e150, 1, 1e-150, 1e7}};
  const double shift[6] = {};
  for (const Shape& shape : shapes(11)) {
    for (const auto& scale : scales) {
      const SlowHull hull(affine(shape.vertices, shape.d, scale, shift), shape.d);
      const auto map = GaugeMap::build(polytope_of(hull));
      ASSERT_TRUE(map) << shape.name;
      std::vector<double> rows;
      for (unsigned k = 0; k < 200; ++k) {
        // Convex combination of all vertices' mean (the larger part) and one facet's point.
        const auto& f = hull.facets()[random() % hull.facets().size()];
        for (unsigned j = 0; j < shape.d; ++j) {
          double mean = 0;
          double on = 0;
          for (std::uint32_t v = 0; v < hull.rows().size() / shape.d; ++v)
            mean += hull.point(v)[j] / static_cast<double>(hull.rows().size() / shape.d);
          for (const std::uint32_t v : f.vertices) on += hull.point(v)[j] / shape.d;
          rows.push_back(mean + 0.3 * (on - mean));
        }
      }
      EXPECT_EQ(survivors(*map, rows, shape.d).size(), 0U) << shape.name;
    }
  }
}

TEST(GaugeMap, KeepsEveryPointThatIsNotFinite) {
  const double bad[] = {std::numeric_limits<double>::quiet_NaN(),
                        -std::numeric_limits<double>::quiet_NaN(),
                        std::numeric_limits<double>::infinity(),
                        -std::numeric_limits<double>::infinity(),
                        1e308,
                        -1e308,
                        1e39,
                        3.0};
  for (unsigned d = 2; d <= 6; ++d) {
    const auto map = GaugeMap::build(polytope_of(SlowHull(cross_polytope(d), d)));
    ASSERT_TRUE(map);
    std::vector<double> rows;
    std::vector<std::uint64_t> expected;
    for (const double value : bad) {
      for (unsigned mask = 1; mask < 1U << d; ++mask) {
        expected.push_back(rows.size() / d);
        for (unsigned j = 0; j < d; ++j) rows.push_back(mask >> j & 1 ? value : 0.01);
        rows.insert(rows.end(), d, 0.0);  // a point inside between any two
      }
    }
    EXPECT_EQ(survivors(*map, rows, d), expected) << d;
    std::vector<float> single;
    for (const double v : rows) single.push_back(static_cast<float>(v));
    const Options options;
    const auto kept = map->survivors(PointView::row_major(single.data(), rows.size() / d, d),
                                     internal::Run(options).with_threads(1));
    EXPECT_EQ(std::vector<std::uint64_t>(kept.begin(), kept.end()), expected) << d;
  }
}

TEST(GaugeMap, RefusesWhatHasNoInside) {
  InnerPolytope flat = polytope_of(SlowHull(cube(3), 3));
  for (std::size_t e = 2; e < flat.vertices.size(); e += 3) flat.vertices[e] = 5;
  EXPECT_FALSE(GaugeMap::build(flat));
  for (std::size_t e = 2; e < flat.vertices.size(); e += 3)
    flat.vertices[e] = flat.vertices[e - 1] + flat.vertices[e - 2];
  EXPECT_FALSE(GaugeMap::build(flat));
  EXPECT_FALSE(GaugeMap::build(InnerPolytope{}));
  InnerPolytope empty;
  empty.dimension = 3;
  EXPECT_FALSE(GaugeMap::build(empty));
  const SlowHull wide({-1.7e308, 0, 1.7e308, 1, 1.7e308, -1}, 2);
  EXPECT_FALSE(GaugeMap::build(polytope_of(wide)));  // differences to the centre overflow
}

TEST(GaugeMap, StopsWhenAsked) {
  const Options options = testing_support::stopped();
  const auto map = GaugeMap::build(polytope_of(SlowHull(cube(2), 2)));
  const std::vector<double> rows(2000, 0.0);
  testing_support::error_of(ErrorCode::cancelled, [&] {
    map->survivors(PointView::row_major(rows.data(), 1000, 2),
                   internal::Run(options).with_threads(1));
  });
}

}  // namespace gauge_map_test
}  // namespace cullhull::internal
