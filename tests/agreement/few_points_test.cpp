// Calls with few points in space take short cuts: straight to the result, or by a map of the
// outermost points. Held against frame, engine and result as larger sets take them.
// CULLHULL_RANDOM_RUNS says how many random sets (2000 if unset), CULLHULL_RANDOM_SEED which.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <functional>
#include <limits>
#include <string>

#include "agreement/canonical_hash.hpp"
#include "agreement/point_sets.hpp"
#include "agreement/random_seeds.hpp"
#include "call_options.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/cull.hpp"
#include "cullhull/error.hpp"
#include "cullhull/track.hpp"
#include "exact/orientation/orientation.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "filter/outermost.hpp"
#include "flow/pipeline.hpp"
#include "flow/sample_map.hpp"
#include "made_sets.hpp"
#include "parallel/threads/run.hpp"
#include "thrown.hpp"

namespace cullhull::few_points_test {

using namespace testing_support;

/// All points, which the ways for few points are taken to have refused, by frame, engine and the
/// result of large sets.
Hull the_general_way(const PointView& points) {
  const Options options = options_of(1);
  internal::Filtered all;
  all.survivors.all = true;
  return internal::hull_of_survivors(points, std::move(all), internal::Run(options));
}

struct Shape {
  const char* name;
  std::function<void(Random& r, const PointSet& s, double* p)> point;
};

void direction(Random& r, double* p) {
  double square = 0;
  for (int c = 0; c < 3; ++c) {
    p[c] = r.normal();
    square += p[c] * p[c];
  }
  for (int c = 0; c < 3; ++c) p[c] /= std::sqrt(square) + 1e-300;
}

const Shape shapes[] =
    {
        {"sphere", [](Random& r, const PointSet&, double* p) { direction(r, p); }},
        {"ball",
         [](Random& r, const PointSet&, double* p) {
  direction(r, p);
  const double size = std::cbrt(r.unit());
  for (int c = 0; c < 3; ++c) p[c] *= size;
         }},
        {"cube",
         [](Random& r, const PointSet&, double* p) {
  for (int c = 0; c < 3; ++c) p[c] = r.between(-1, 1);
         }},
            {"lattice",
             [](Random& r, const PointSet&, double* p) {
  for (int c = 0; c < 3; ++c) p[c] = r.integer(-6, 6);
             }},
    {"turned lattice",
     [](Random& r, const PointSet&, double* p) {
  const double x = r.integer(-4, 4), y = r.integer(-4, 4);
  p[0] = std::cos(0.7) * x - std::sin(0.7) * y;
  p[1] = std::sin(0.7) * x + std::cos(0.7) * y;
  p[2] = r.integer(-4, 4);
     }},
    {"copies",
     [](Random& r, const PointSet& s, double* p) {
  const auto n = static_cast<int>(s.coordinates.size() / 3);
  if (n == 0 || r.integer(0, 1) == 0) return direction(r, p);
  const double* from = s.coordinates.data() + std::size_t{3} * r.integer(0, n - 1);
  for (int c = 0; c < 3; ++c) p[c] = from[c] == 0 ? -from[c] : from[c];
     }},
    {"in a plane but for one",
     [](Random& r, const PointSet& s, double* p) {
  direction(r, p);
  p[2] = s.coordinates.empty() ? 1 : 0;
     }},
    {"on a line but for three",
     [](Random& r, const PointSet& s, double* p) {
  direction(r, p);
  if (s.coordinates.size() < 9) return;
  p[1] = 2 * p[0];
  p[2] = -p[0];
     }},
    {"three circles",
     [](Random& r, const PointSet&, double* p) {
  const double a = r.between(0, 6.3);
  p[0] = std::cos(a);
  p[1] = std::sin(a);
  p[2] = r.integer(-1, 1);
     }},
    {"surface of a box",
     [](Random& r, const PointSet&, double* p) {
  for (int c = 0; c < 3; ++c) p[c] = r.between(-1, 1);
  p[r.integer(0, 2)] = r.integer(0, 1) * 2 - 1;
     }},
    {"paraboloid of a lattice",
     [](Random& r, const PointSet&, double* p) {
  p[0] = r.integer(-16, 16) / 16.0;
  p[1] = r.integer(-16, 16) / 16.0;
  p[2] = p[0] * p[0] + p[1] * p[1];
     }},
    {"beside its mirror image",
     [](Random& r, const PointSet& s, double* p) {
  direction(r, p);
  if (s.coordinates.size() % 2 == 0) return;
  std::copy_n(s.coordinates.end() - 3, 3, p);
  p[1] = -p[1];
     }},
    {"of all sizes",
     [](Random& r, const PointSet&, double* p) {
  direction(r, p);
  const double size = std::exp(20 * r.normal());
  for (int c = 0; c < 3; ++c) p[c] *= size;
     }},
    {"thin",
     [](Random& r, const PointSet&, double* p) {
  p[0] = r.normal();
  p[1] = 1e-3 * r.normal();
  p[2] = 1e-7 * r.normal();
     }},
    };

PointSet any_set(std::uint64_t seed) {
  Random r(seed);
  const Shape& shape =
      shapes[static_cast<std::size_t>(r.integer(0, static_cast<int>(std::size(shapes)) - 1))];
  constexpr int most[] = {20, 130, 300, 1100, 4000};
  const int n = r.integer(4, most[r.integer(0, 9) == 0 ? 4 : r.integer(0, 3)]);
  const double scales[] = {1, 1, 1, 1e-150, 1e200, 1e-20, 1}, shifts[] = {0, 0, 0, 0, 0, 1, 1e6};
  const int place = r.integer(0, 6);
  PointSet s = named(std::string(shape.name) + " of " + std::to_string(n), 3);
  for (int i = 0; i < n; ++i) {
    double p[3];
    shape.point(r, s, p);
    s.add({p[0], p[1], p[2]});
  }
  for (double& v : s.coordinates) v = v * scales[place] + shifts[place];
  return s;
}

/// The set as doubles, floats, integers or columns, and the memory it is in.
struct Stored {
  std::vector<double> doubles;
  std::vector<float> floats;
  std::vector<std::int32_t> integers;
  PointView view;

  Stored(const PointSet& s, int layout) : doubles(s.coordinates) {
    const std::size_t n = doubles.size() / 3;
    const auto all = [&](double most) {
      return std::all_of(doubles.begin(), doubles.end(),
                         [&](double v) { return std::abs(v) < most; });
    };
    view = PointView::row_major(doubles.data(), n, 3);
    if (layout == 1 && all(1e38)) {
      floats.assign(doubles.begin(), doubles.end());
      view = PointView::row_major(floats.data(), n, 3);
    } else if (layout == 2 && all(1e9)) {
      integers.assign(doubles.begin(), doubles.end());
      view = PointView::row_major(integers.data(), n, 3);
    } else if (layout == 3) {
      doubles = transposed(s.coordinates, 3);
      view = PointView::column_major(doubles.data(), n, 3);
    }
  }
};

void expect_the_same(const PointView& points, const std::string& name) {
  const Hull general = the_general_way(points);
  for (const unsigned threads : {1U, 0U}) {
    const Hull hull = convex_hull(points, options_of(threads));
    ASSERT_EQ(canonical_hash(hull), canonical_hash(general)) << name << ", threads " << threads;
  }
}

TEST(FewPoints, random_sets_as_the_general_way_has_them) {
  const std::uint64_t runs = number_from_environment("CULLHULL_RANDOM_RUNS", share_of(2000)),
                      first = number_from_environment("CULLHULL_RANDOM_SEED", 1);
  for (std::uint64_t seed = first; seed < first + runs; ++seed) {
    const PointSet s = any_set(seed);
    const Stored stored(s, static_cast<int>(seed % 5));
    const std::string name = s.name + ", seed " + std::to_string(seed);
    expect_the_same(stored.view, name);
    if (HasFatalFailure()) return;
    if (seed % 8 != 0 && runs < 10000) continue;
    const Certificate certificate = certify(stored.view, convex_hull(stored.view));
    ASSERT_TRUE(certificate.valid) << name << ": " << certificate.reason;
  }
}

TEST(FewPoints, sizes_where_the_way_changes) {
  for (const char* shape : {"sphere", "ball", "cube", "gauss", "cube-surface"})
    for (const unsigned n : {4U, 5U, 16U, 17U, 127U, 128U, 129U, 1023U, 1024U, 1025U, 2047U, 2049U,
                             8192U, 8193U, 32768U, 32769U, 65536U, 65537U}) {
      const PointSet s = random_set(shape, n, 3, n);
      expect_the_same(view_of(s), s.name + " of " + std::to_string(n));
    }
}

/// A few hundred corners on each of two large faces, whose fans have long edges in common.
TEST(FewPoints, large_faces) {
  for (const unsigned n : {65U, 200U, 511U}) {
    PointSet s = named("prism", 3);
    // Pythagorean: all on one circle up to rounding, each face in a plane exactly.
    for (unsigned i = 0; i < n; ++i) {
      const double t = std::tan(0.78 * i / n);
      for (const double z : {-1.0, 1.0}) s.add({(1 - t * t) / (1 + t * t), 2 * t / (1 + t * t), z});
    }
    expect_the_same(view_of(s), "prism of " + std::to_string(n));
  }
}

/// Four points that two others mirror are on a plane, which no exact arithmetic is needed for: many
/// such signs must not send the set the general way, which takes ten times as long.
TEST(FewPoints, mirror_images_stay_few) {
  for (const int n : {60, 500, 2000}) {
    Random r(static_cast<std::uint64_t>(n));
    PointSet s = named("mirrored", 3);
    for (int i = 0; i < n / 2; ++i) {
      double p[3];
      direction(r, p);
      const double size = 1 + 0.4 * std::sin(3 * p[0] + 1) * std::sin(4 * p[1]);
      for (const int side : {-1, 1}) s.add({p[0] * size, side * p[1] * size / 2, p[2] * size});
    }
    expect_the_same(view_of(s), "mirrored");
    const Hull hull = convex_hull(view_of(s));
    EXPECT_LT(hull.facet_count(), hull.simplex_count());
    EXPECT_TRUE(has(hull.statistics.cull_reason, "few in space")) << hull.statistics.cull_reason;
  }
}

TEST(FewPoints, what_is_not_finite_is_named) {
  for (const unsigned n : {10U, 100U, 700U, 5000U})
    for (const double bad :
         {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()})
      for (const unsigned at : {0U, n / 2, n - 1}) {
        PointSet s = random_set("ball", n, 3, n);
        s.coordinates[3 * at + 1] = bad;
        EXPECT_TRUE(has(error_of(ErrorCode::not_finite, [&] { convex_hull(view_of(s)); }),
                        "point " + std::to_string(at) + ","));
      }
}

TEST(FewPoints, a_filter_of_few_keeps_every_vertex_and_its_copies) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    PointSet s = random_set(seed % 2 != 0 ? "ball" : "gauss", 4000, 3, seed);
    const Hull hull = the_general_way(view_of(s));
    std::vector<std::uint64_t> kept = hull.vertices;
    for (const std::uint64_t v : hull.vertices) {  // by the same coordinates, later
      kept.push_back(s.coordinates.size() / 3);
      s.add({s.coordinates[3 * v], s.coordinates[3 * v + 1], s.coordinates[3 * v + 2]});
    }
    const Survivors survivors = cull(view_of(s));
    ASSERT_EQ(survivors.filter, UsedFilter::gauge);
    ASSERT_LT(survivors.ids.size(), 2000U);
    EXPECT_TRUE(std::includes(survivors.ids.begin(), survivors.ids.end(), kept.begin(), kept.end()))
        << "seed " << seed;
  }
}

/// Whether a filter pays is seen on a sample: not where all points are as far out as they get.
TEST(FewPoints, no_filter_where_all_are_outside) {
  const PointSet s = random_set("sphere", 5000, 3, 1);
  EXPECT_TRUE(internal::outermost_points(view_of(s), {.cells = 4, .most_outside = 0.75}).empty());
  EXPECT_FALSE(internal::outermost_points(view_of(s), {.cells = 4}).empty());
}

/// A point that a map of few facets drops is strictly beneath every facet, by exact signs: also
/// points within rounding of the facets, and bodies that are thin or far away.
TEST(FewPoints, a_map_of_few_facets_drops_what_is_inside) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Random r(seed);
    PointSet s = random_set("sphere", 40, 3, seed);
    const double thin = std::ldexp(1.0, -r.integer(0, 14)), shift = seed % 3 == 0 ? 1000 : 0;
    for (std::size_t i = 0; i < s.coordinates.size(); ++i)
      s.coordinates[i] = s.coordinates[i] * (i % 3 == 2 ? thin : 1) + shift;
    const Hull hull = the_general_way(view_of(s));
    internal::InnerPolytope polytope;
    polytope.dimension = 3;
    polytope.vertices = s.coordinates;
    polytope.facets.assign(hull.simplices.begin(), hull.simplices.end());
    polytope.neighbours.assign(hull.simplex_neighbours.begin(), hull.simplex_neighbours.end());
    const auto map = internal::GaugeMap::of_few_facets(polytope, 8);
    ASSERT_NE(map, nullptr);
    PointSet near = named("near facets", 3);
    for (int i = 0; i < 4000; ++i) {
      const std::size_t f =
          3 * static_cast<std::size_t>(r.integer(0, static_cast<int>(hull.simplex_count()) - 1));
      double weight[3] = {r.unit(), r.unit(), r.unit()}, p[3] = {}, sum = 0;
      for (const double w : weight) sum += w;
      const double inwards = r.integer(0, 1) * std::ldexp(r.unit(), -r.integer(0, 24));
      for (int j = 0; j < 3; ++j)
        for (int c = 0; c < 3; ++c)
          p[c] += weight[j] / sum * s.coordinates[3 * hull.simplices[f + j] + c];
      for (int c = 0; c < 3; ++c) p[c] += inwards * (hull.centroid[c] - p[c]);
      near.add({p[0], p[1], p[2]});
    }
    const internal::Run& run = internal::short_run();
    const auto kept = map->survivors(view_of(near), run);
    ASSERT_LT(kept.size(), 4000U) << "nothing was dropped";
    auto next = kept.begin();
    for (std::uint64_t i = 0; i < 4000; ++i) {
      if (next != kept.end() && *next == i) {
        ++next;
        continue;
      }
      for (std::size_t f = 0; f < hull.simplex_count(); ++f) {
        const double* rows[4];
        for (int j = 0; j < 3; ++j) rows[j] = s.coordinates.data() + 3 * hull.simplices[3 * f + j];
        rows[3] = near.coordinates.data() + 3 * i;
        ASSERT_EQ(internal::orientation(3, rows), internal::Sign::negative)
            << "seed " << seed << ", point " << i;
      }
    }
  }
}

/// A polytope whose centre is on a facet, or whose facets doubles cannot tell, gives no map.
TEST(FewPoints, no_map_of_flat_polytopes) {
  for (const double height : {0.0, 0x1p-60, 0x1p-40}) {
    internal::InnerPolytope p;
    p.dimension = 3;
    p.vertices = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0.25, 0.25, height};
    p.facets = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    const auto map = internal::GaugeMap::of_few_facets(p, 4);
    if (map == nullptr) continue;
    EXPECT_GT(height, 0);
    // A map there may be, but none that drops what is on the boundary.
    const double on[] = {0.25, 0.25, 0, 0.25, 0.25, height, 0.5, 0.5, 0};
    EXPECT_EQ(map->survivors(PointView::row_major(on, 3, 3), internal::short_run()).size(), 3U);
  }
}

/// Moving points: few of them are culled afresh in every frame.
TEST(FewPoints, moving_points) {
  const PointSet start = random_set("ball", 9000, 3, 5);
  HullTracker tracker;
  for (int frame = 0; frame < 6; ++frame) {
    PointSet s = start;
    for (std::size_t i = 0; i < s.coordinates.size(); i += 3) {
      const double a = 0.1 * frame * s.coordinates[i + 2], x = s.coordinates[i],
                   y = s.coordinates[i + 1];
      s.coordinates[i] = std::cos(a) * x - std::sin(a) * y;
      s.coordinates[i + 1] = std::sin(a) * x + std::cos(a) * y;
    }
    const Hull& hull = tracker.update(view_of(s));
    ASSERT_EQ(canonical_hash(hull), canonical_hash(the_general_way(view_of(s)))) << frame;
    EXPECT_LT(tracker.report().survivors, 3000U);
  }
}

}  // namespace cullhull::few_points_test
