// Hulls with fewer vertices and planes: what is said of distances, in rational numbers.
#include "cullhull/simplify.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "agreement/canonical_hash.hpp"
#include "agreement/hard_sets.hpp"
#include "agreement/point_sets.hpp"
#include "call_options.hpp"
#include "cullhull/certify.hpp"
#include "exactness/rational_distance.hpp"
#include "thrown.hpp"

namespace cullhull {
namespace simplify_test {

using namespace testing_support;

PointSet centred_lattice(unsigned d, unsigned side, double angle) {
  PointSet s = full_grid(d, side, 0);
  for (double& x : s.coordinates) x -= (side - 1) / 2.0;
  for (unsigned k = 0; k + 1 < d; ++k) turn_axes(s, k, k + 1, angle + 0.1 * k);
  return s;
}

/// Turned about an axis through the origin (Rodrigues).
void turn_about(PointSet& s, double x, double y, double z, double angle) {
  const double length = std::sqrt(x * x + y * y + z * z), c = std::cos(angle), n = std::sin(angle);
  x /= length, y /= length, z /= length;
  for (std::size_t i = 0; i < s.coordinates.size(); i += 3) {
    double* p = s.coordinates.data() + i;
    const double along = (x * p[0] + y * p[1] + z * p[2]) * (1 - c);
    const double turned[3] = {c * p[0] + n * (y * p[2] - z * p[1]) + along * x,
                              c * p[1] + n * (z * p[0] - x * p[2]) + along * y,
                              c * p[2] + n * (x * p[1] - y * p[0]) + along * z};
    std::copy_n(turned, 3, p);
  }
}

std::vector<double> row(const PointView& points, std::uint64_t id) {
  std::vector<double> x;
  for (unsigned j = 0; j < points.dimension; ++j) x.push_back(points.at(id, j));
  return x;
}

/// Simplices of less area than `area`, in space.
unsigned slivers(const PointView& points, const Hull& hull, double area) {
  unsigned count = 0;
  for (std::size_t s = 0; s < hull.simplex_count(); ++s) {
    const auto a = row(points, hull.simplices[3 * s]), b = row(points, hull.simplices[3 * s + 1]),
               c = row(points, hull.simplices[3 * s + 2]);
    double square = 0;
    for (unsigned j = 0; j < 3; ++j) {
      const unsigned k = (j + 1) % 3, l = (j + 2) % 3;
      const double part = (b[k] - a[k]) * (c[l] - a[l]) - (b[l] - a[l]) * (c[k] - a[k]);
      square += part * part;
    }
    count += std::sqrt(square) / 2 < area;
  }
  return count;
}

std::vector<std::uint64_t> sorted(std::vector<std::uint64_t> ids) {
  std::sort(ids.begin(), ids.end());
  return ids;
}

/// All that simplify() says of its result but that nothing more can be dropped.
void expect_as_said(const PointSet& set, double distance) {
  SCOPED_TRACE(set.name + ", distance " + std::to_string(distance));
  const PointView points = view_of(set);
  const unsigned d = set.dimension;
  const Hull whole = convex_hull(points);
  const Simplification result = simplify(points, whole, distance);
  const Hull& hull = result.hull;

  EXPECT_LE(result.distance, distance);
  EXPECT_EQ(result.dropped + hull.vertices.size(), whole.vertices.size());
  EXPECT_EQ(result.distance > 0, result.dropped > 0);
  EXPECT_EQ(hull.affine_dimension, whole.affine_dimension);
  EXPECT_EQ(hull.point_count, whole.point_count);
  EXPECT_EQ(hull.scalar, whole.scalar);

  // It is the canonical hull of the kept vertices, which are some of the exact hull's.
  const std::vector<std::uint64_t> kept = sorted(hull.vertices), all = sorted(whole.vertices);
  EXPECT_TRUE(std::includes(all.begin(), all.end(), kept.begin(), kept.end()));
  std::vector<double> rows;
  for (const std::uint64_t id : kept)
    for (const double x : row(points, id)) rows.push_back(x);
  const PointView kept_points = PointView::row_major(rows.data(), kept.size(), d);
  Hull again = convex_hull(kept_points);
  EXPECT_TRUE(certify(kept_points, again)) << certify(kept_points, again).reason;
  again.rename([&](std::uint64_t place) { return kept[place]; });
  again.point_count = whole.point_count;
  EXPECT_EQ(canonical_hash(again), canonical_hash(hull));

  // Each dropped vertex is that near to some simplex.
  std::vector<std::uint64_t> dropped;
  std::set_difference(all.begin(), all.end(), kept.begin(), kept.end(),
                      std::back_inserter(dropped));
  std::vector<std::vector<double>> at;
  const auto width = static_cast<std::size_t>(std::max(hull.affine_dimension, 0));
  for (const std::uint64_t id : hull.simplices) at.push_back(row(points, id));
  for (const std::uint64_t id : dropped) {
    const std::vector<double> x = row(points, id);
    bool near = false;
    for (std::size_t s = 0; s < hull.simplex_count() && !near; ++s) {
      std::vector<const double*> simplex;
      for (std::size_t j = 0; j < width; ++j) simplex.push_back(at[s * width + j].data());
      near = near_simplex(simplex, x.data(), d, result.distance);
    }
    EXPECT_TRUE(near) << "vertex " << id << " is farther than " << result.distance;
  }
}

PointSet regular_polygon(unsigned n, double far) {
  PointSet s;
  s.name = "polygon of " + std::to_string(n);
  s.dimension = 2;
  for (unsigned i = 0; i < n; ++i) {
    const double t = 2 * std::numbers::pi * i / n;
    s.add({far + std::cos(t), far + std::sin(t)});
    s.add({far + (std::cos(t) + std::cos(t + 2 * std::numbers::pi / n)) / 2,
           far + (std::sin(t) + std::sin(t + 2 * std::numbers::pi / n)) / 2});
  }
  return s;
}

PointSet scaled(PointSet s, double factor) {
  for (double& x : s.coordinates) x *= factor;
  s.name += " scaled";
  return s;
}

TEST(Simplify, a_turned_lattice_has_no_slivers) {
  PointSet set = centred_lattice(3, 3, 0);
  turn_about(set, 1, 2, 3, 0.7);
  const PointView points = view_of(set);
  const Hull exact = convex_hull(points);
  EXPECT_GT(exact.simplex_count(), 12U);
  EXPECT_GT(slivers(points, exact, 1e-12), 0U);
  const Simplification result = simplify(points, exact, rounding_distance(points, exact));
  EXPECT_EQ(result.hull.simplex_count(), 12U);
  EXPECT_EQ(slivers(points, result.hull, 1e-12), 0U);
  EXPECT_EQ(result.hull.vertices, (std::vector<std::uint64_t>{0, 2, 6, 8, 18, 20, 24, 26}));
  EXPECT_LT(result.distance, 1e-14);
}

TEST(Simplify, holds_what_it_says_in_rational_numbers) {
  std::vector<PointSet> sets;
  for (unsigned d = 2; d <= 4; ++d) {
    sets.push_back(random_set("sphere", d == 4 ? 30 : 60, d, d));
    sets.push_back(random_set("gauss", 100, d, d));
    sets.push_back(centred_lattice(d, d == 4 ? 3 : 5, 0.7));
    sets.push_back(flat(60, d - 1, d, 5, 1));
    Random r(d);
    sets.push_back(turned_lattice(d, r));
  }
  sets.push_back(cylinder(80, 3));
  sets.push_back(cone(80, 3));
  sets.push_back(regular_polygon(40, 0));
  sets.push_back(regular_polygon(40, 1000));
  sets.push_back(all_magnitudes(60, 3, 1));
  for (const PointSet& set : sets) {
    const PointView points = view_of(set);
    const double rounding = rounding_distance(points, convex_hull(points));
    double size = 0;
    for (const double x : set.coordinates) size = std::max(size, std::fabs(x));
    for (const double distance : {0.0, rounding, 1e-6 * size, 0.05 * size, 0.4 * size})
      expect_as_said(set, distance);
  }
}

TEST(Simplify, huge_and_tiny_coordinates) {
  for (const double factor : {0x1p1020, 0x1p-1060, 1e308 / 4, 1e-310}) {
    PointSet lattice = scaled(centred_lattice(3, 4, 0.7), factor);
    expect_as_said(lattice, rounding_distance(view_of(lattice), convex_hull(view_of(lattice))));
    PointSet ball = scaled(random_set("sphere", 40, 3, 1), factor);
    expect_as_said(ball, 0.3 * factor);
    EXPECT_GT(simplify(view_of(ball), convex_hull(view_of(ball)), 0.3 * factor).dropped, 0U);
  }
  const PointSet set = random_set("sphere", 40, 3, 1);
  expect_as_said(set, std::numeric_limits<double>::denorm_min());
  expect_as_said(set, std::numeric_limits<double>::max());
}

TEST(Simplify, distance_zero_is_the_exact_hull) {
  for (const PointSet& set : {random_set("gauss", 300, 3, 1), centred_lattice(3, 3, 0.7),
                              regular_polygon(30, 0), flat(40, 2, 4, 5, 1)}) {
    const Hull hull = convex_hull(view_of(set));
    const Simplification result = simplify(view_of(set), hull, 0);
    EXPECT_EQ(canonical_hash(result.hull), canonical_hash(hull));
    EXPECT_EQ(result.dropped, 0U);
    EXPECT_EQ(result.distance, 0.0);
  }
}

TEST(Simplify, is_the_same_for_all_options) {
  for (const PointSet& set : {random_set("sphere", 3000, 3, 1), centred_lattice(3, 12, 0.7),
                              random_set("sphere", 300, 4, 1), regular_polygon(2000, 0)}) {
    const Hull hull = convex_hull(view_of(set));
    const double distance = set.dimension == 4 ? 0.2 : 0.01;
    Options one;
    one.threads = 1;
    one.cull = CullMethod::none;
    Options several;
    several.threads = 3;
    const Simplification a = simplify(view_of(set), hull, distance, one),
                         b = simplify(view_of(set), hull, distance, several);
    EXPECT_GT(a.dropped, 0U) << set.name;
    EXPECT_EQ(canonical_hash(a.hull), canonical_hash(b.hull)) << set.name;
    EXPECT_EQ(a.distance, b.distance);
  }
}

TEST(Simplify, keeps_the_dimension_however_large_the_distance) {
  for (unsigned d = 1; d <= 5; ++d)
    for (const PointSet& set : {random_set("sphere", 40, d, 2), full_grid(d, 2, 0), cyclic(12, d),
                                cross_polytope_with_middles(d), flat(30, d - 1, d, 4, 1)}) {
      const Hull whole = convex_hull(view_of(set));
      const Hull hull = simplify(view_of(set), whole, 1e9).hull;
      EXPECT_EQ(hull.affine_dimension, whole.affine_dimension) << set.name;
      EXPECT_GE(hull.vertices.size(), static_cast<std::size_t>(hull.affine_dimension + 1));
      if (d >= 2 && d <= 3) expect_as_said(set, 1e9);
    }
  // Thinner than the distance, but no flat.
  PointSet plate = full_grid(3, 2, 0);
  for (std::size_t i = 2; i < plate.coordinates.size(); i += 3) plate.coordinates[i] *= 1e-12;
  expect_as_said(plate, 1e-9);
  EXPECT_EQ(simplify(view_of(plate), convex_hull(view_of(plate)), 1e-9).hull.affine_dimension, 3);
}

TEST(Simplify, few_points_and_none) {
  for (unsigned d = 1; d <= 4; ++d)
    for (unsigned n : {0U, 1U, 2U, 3U, 10U}) {
      const PointSet set = random_set("ball", n, d, n);
      if (n < 3)
        EXPECT_EQ(simplify(view_of(set), convex_hull(view_of(set)), 1.0).dropped, 0U);
      else
        expect_as_said(set, 0.5);
    }
}

/// A prism over a regular polygon, with the middles of all its edges and points on its caps.
PointSet prism(unsigned n) {
  PointSet s = named("prism", 3);
  for (const double z : {-0.5, 0.0, 0.5})
    for (unsigned i = 0; i < 2 * n; ++i) {
      const double t = std::numbers::pi * i / n;
      const double r = i % 2 ? std::cos(std::numbers::pi / n) : 1;
      s.add({r * std::cos(t), r * std::sin(t), z});
      s.add({0.3 * std::cos(t), 0.3 * std::sin(t), z});
    }
  return s;
}

/// The lowest of all heights of all simplices, in space.
double least_height(const PointView& points, const Hull& hull) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t s = 0; s < hull.simplex_count(); ++s)
    for (unsigned i = 0; i < 3; ++i) {
      const auto a = row(points, hull.simplices[3 * s + i]),
                 b = row(points, hull.simplices[3 * s + (i + 1) % 3]),
                 c = row(points, hull.simplices[3 * s + (i + 2) % 3]);
      double along = 0, base = 0, side = 0;
      for (unsigned j = 0; j < 3; ++j) {
        along += (a[j] - b[j]) * (c[j] - b[j]);
        base += (c[j] - b[j]) * (c[j] - b[j]);
      }
      for (unsigned j = 0; j < 3; ++j)
        side += std::pow(a[j] - b[j] - along / base * (c[j] - b[j]), 2);
      least = std::min(least, std::sqrt(side));
    }
  return least;
}

/// A height is the distance of a corner to the hull of others, at most.
TEST(Simplify, leaves_no_simplex_lower_than_the_distance) {
  Random r(1);
  for (const auto& [set, corners] :
       {std::pair(full_grid(3, 6, 0), 8U), std::pair(prism(24), 48U)}) {
    for (unsigned turn = 0; turn < 25; ++turn) {
      PointSet turned = set;
      turn_about(turned, r.between(-1, 1), r.between(-1, 1), r.between(-1, 1), r.between(0, 3));
      const double far = turn % 2 * 1000;
      for (double& x : turned.coordinates) x += far;
      const PointView points = view_of(turned);
      const Hull exact = convex_hull(points);
      const double distance = rounding_distance(points, exact);
      const Simplification result = simplify(points, exact, distance);
      EXPECT_EQ(result.hull.vertices.size(), corners) << set.name;
      EXPECT_EQ(result.hull.simplex_count(), 2 * corners - 4);
      EXPECT_GT(least_height(points, result.hull), distance - result.distance);
      EXPECT_LT(result.distance, distance / 4);
    }
  }
}

TEST(Simplify, large_sets) {
  const PointSet sphere = random_set("sphere", 100000, 3, 1);
  const Hull round = convex_hull(view_of(sphere));
  const Simplification same =
      simplify(view_of(sphere), round, rounding_distance(view_of(sphere), round));
  EXPECT_EQ(same.dropped, 0U);
  EXPECT_EQ(canonical_hash(same.hull), canonical_hash(round));

  const PointSet lattice = centred_lattice(3, 46, 0.7);
  const Hull rough = convex_hull(view_of(lattice));
  const Simplification cube =
      simplify(view_of(lattice), rough, rounding_distance(view_of(lattice), rough));
  EXPECT_GT(rough.vertices.size(), 100U);
  EXPECT_EQ(cube.hull.vertices.size(), 8U);

  const Simplification coarse = simplify(view_of(sphere), round, 0.01);
  EXPECT_LT(coarse.hull.vertices.size(), round.vertices.size() / 20);
  EXPECT_LE(coarse.distance, 0.01);
  EXPECT_NEAR(coarse.hull.volume, 4 * std::numbers::pi / 3, 0.01 * 4 * std::numbers::pi);
}

TEST(Simplify, refuses_what_makes_no_sense) {
  const PointSet set = random_set("ball", 50, 3, 1);
  const Hull hull = convex_hull(view_of(set));
  const double infinity = std::numeric_limits<double>::infinity();
  for (const double distance : {-1.0, infinity, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(simplify(view_of(set), hull, distance), Error);
    EXPECT_THROW(shared_planes(view_of(set), hull, distance), Error);
  }
  const PointSet few = random_set("ball", 5, 3, 1), plane = random_set("ball", 50, 2, 1);
  EXPECT_THROW(simplify(view_of(few), hull, 1), Error);
  EXPECT_THROW(simplify(view_of(plane), hull, 1), Error);
  error_of(ErrorCode::cancelled, [&] { simplify(view_of(set), hull, 1, stopped()); });
}

/// All that shared_planes() says; returns the number of planes.
std::size_t planes_as_said(const PointSet& set, double distance) {
  SCOPED_TRACE(set.name);
  const PointView points = view_of(set);
  const Hull hull = convex_hull(points);
  const unsigned d = hull.dimension;
  const std::vector<std::uint32_t> of = shared_planes(points, hull, distance);
  EXPECT_EQ(of.size(), hull.facet_count());
  for (std::size_t f = 0; f < of.size(); ++f) {
    EXPECT_EQ(of[of[f]], of[f]);
    if (of[f] == f) continue;
    double cosine = 0;
    const double* plane = hull.facet_planes.data() + of[f] * (d + 1);
    for (unsigned j = 0; j < d; ++j) cosine += plane[j] * hull.facet_planes[f * (d + 1) + j];
    EXPECT_GT(cosine, 0);
    for (const std::uint64_t id : hull.facets[f])
      EXPECT_TRUE(near_plane(plane, row(points, id).data(), d, distance)) << "facet " << f;
  }
  return std::set<std::uint32_t>(of.begin(), of.end()).size();
}

TEST(SharedPlanes, facets_flat_but_for_rounding_have_one_plane) {
  for (unsigned d = 2; d <= 4; ++d) {
    const PointSet lattice = centred_lattice(d, d == 2 ? 8 : 3, 0.7);
    const Hull hull = convex_hull(view_of(lattice));
    EXPECT_GT(hull.facet_count(), 2 * d);
    const double rounding = rounding_distance(view_of(lattice), hull);
    EXPECT_EQ(planes_as_said(lattice, rounding), 2 * d);
    EXPECT_EQ(planes_as_said(lattice, 0), hull.facet_count());
  }
  EXPECT_EQ(planes_as_said(regular_polygon(30, 0), 1e-14), 30U);
  EXPECT_EQ(planes_as_said(full_grid(3, 3, 0), 1e-14), 6U);
}

TEST(SharedPlanes, a_thin_body_keeps_two_sides) {
  PointSet plate = random_set("sphere", 60, 3, 1);
  for (std::size_t i = 2; i < plate.coordinates.size(); i += 3) plate.coordinates[i] *= 1e-9;
  EXPECT_GE(planes_as_said(plate, 1e-6), 2U);
  for (const double distance : {1e-9, 1e-3, 0.1, 10.0})
    planes_as_said(random_set("sphere", 200, 3, 2), distance);
  for (const double factor : {0x1p1020, 0x1p-1060}) {
    planes_as_said(scaled(centred_lattice(3, 3, 0.7), factor), factor * 1e-14);
  }
  planes_as_said(flat(40, 2, 3, 5, 1), 0.5);
  planes_as_said(random_set("ball", 0, 3, 1), 0.5);
  planes_as_said(random_set("ball", 2, 1, 1), 0.5);
}

}  // namespace simplify_test
}  // namespace cullhull
