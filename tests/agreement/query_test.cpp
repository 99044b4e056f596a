// HullQuery against brute force: exact signs over all simplices, hulls with the point added, all
// faces for distances, all planes for rays.
#include "cullhull/query.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "agreement/point_sets.hpp"
#include "call_options.hpp"
#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "exact/numbers/exact_float.hpp"
#include "exact/orientation/orientation.hpp"
#include "made_sets.hpp"
#include "thrown.hpp"

namespace cullhull::query_test {

using internal::ExactFloat;
using internal::orientation;
using namespace testing_support;

/// A hull with what the slow answers need.
struct Subject {
  explicit Subject(const PointSet& s) : set(s), hull(convex_hull(view_of(s))), d(s.dimension) {
    k = static_cast<unsigned>(hull.affine_dimension);
    std::vector<const double*> rows;
    for (const std::uint64_t v : hull.vertices) rows.push_back(point(v));
    // Affinely independent vertices, one by one.
    for (const double* p : rows) {
      basis.push_back(p);
      if (internal::affine_rank_exact(d, basis.data(), static_cast<unsigned>(basis.size())) + 1 <
          basis.size())
        basis.pop_back();
    }
    axes.resize(k);
    internal::affine_rank_exact(d, basis.data(), k + 1, axes.data());
  }
  const double* point(std::uint64_t id) const { return set.coordinates.data() + id * d; }

  bool in_flat(const double* q) const {
    std::vector<const double*> rows = basis;
    rows.push_back(q);
    return internal::affine_rank_exact(d, rows.data(), k + 2) == k;
  }
  /// Sign of simplex s and q on the axes; +1: above.
  int sign(std::size_t s, const double* q) const {
    std::vector<double> packed;
    for (unsigned i = 0; i <= k; ++i) {
      const double* p = i == k ? q : point(hull.simplices[s * k + i]);
      for (const unsigned a : axes) packed.push_back(p[a]);
    }
    std::vector<const double*> rows;
    for (unsigned i = 0; i <= k; ++i) rows.push_back(packed.data() + std::size_t{i} * k);
    // The filter in front has tests of its own.
    return static_cast<int>(k <= 3 ? internal::orientation_exact(k, rows.data())
                                   : orientation(k, rows.data()));
  }
  Side side(const double* q) const {
    if (!in_flat(q)) return Side::outside;
    if (k == 0) return Side::boundary;
    if (k == 1) {
      const unsigned a = axes[0];
      const double x = point(hull.vertices[0])[a], y = point(hull.vertices[1])[a];
      if (q[a] == x || q[a] == y) return Side::boundary;
      return q[a] > std::min(x, y) && q[a] < std::max(x, y) ? Side::inside : Side::outside;
    }
    int most = -1;
    for (std::size_t s = 0; s < hull.simplex_count(); ++s) most = std::max(most, sign(s, q));
    return static_cast<Side>(most);
  }

  PointSet set;
  Hull hull;
  unsigned d, k;
  std::vector<const double*> basis;
  std::vector<unsigned> axes;
};

/// Points at all the awkward places: vertices, middles, their neighbours by one ulp, the inside,
/// near and far outside.
std::vector<double> awkward_points(const Subject& s, unsigned count, std::uint64_t seed) {
  Random r(seed);
  const std::uint64_t n = s.hull.point_count;
  const auto any = [&] {
    return s.point(static_cast<std::uint64_t>(r.integer(0, static_cast<int>(n) - 1)));
  };
  const auto vertex = [&] {
    return s.point(s.hull.vertices[static_cast<std::size_t>(
        r.integer(0, static_cast<int>(s.hull.vertices.size()) - 1))]);
  };
  std::vector<double> out;
  for (unsigned i = 0; i < count; ++i) {
    std::vector<double> q(s.d);
    const double *a = any(), *b = any(), *v = vertex(), *w = vertex();
    const std::size_t f =
        s.k > 0
            ? static_cast<std::size_t>(r.integer(0, static_cast<int>(s.hull.simplex_count()) - 1))
            : 0;
    for (unsigned j = 0; j < s.d; ++j) switch (i % 8) {
        case 0:
          q[j] = v[j];
          break;
        case 1:
          q[j] = v[j] / 2 + w[j] / 2;
          break;
        case 2:
          q[j] = a[j] / 2 + b[j] / 2;
          break;
        case 3:  // a hair from a vertex
          q[j] = r.integer(0, 1) ? v[j] : std::nextafter(v[j], r.integer(0, 1) ? 1e300 : -1e300);
          break;
        case 4:  // on a simplex of the boundary, up to rounding
          for (unsigned c = 0; c < s.k; ++c)
            q[j] += s.point(s.hull.simplices[f * s.k + c])[j] / s.k;
          break;
        case 5:  // around a vertex
          q[j] = v[j] + (v[j] - a[j]) * 0.25;
          break;
        case 6:
          q[j] = v[j] / 4 + a[j] / 4 + b[j] / 2;
          break;
        default:  // far
          q[j] = v[j] * 1e3 - a[j] * r.unit();
          break;
      }
    for (unsigned j = 0; j < s.d; ++j) out.push_back(std::isfinite(q[j]) ? q[j] : v[j]);
  }
  return out;
}

std::vector<PointSet> subjects() {
  std::vector<PointSet> sets;
  for (unsigned d = 2; d <= 6; ++d) {
    sets.push_back(random_set("ball", d < 5 ? 300 : 40, d, d));
    sets.push_back(random_set("sphere", d < 5 ? 150 : 25, d, d));
    sets.push_back(random_grid(d < 5 ? 300 : 50, d, 4, 0, d));
    sets.push_back(cube_with_centres(d));
    sets.push_back(cross_polytope_with_middles(d));
  }
  sets.push_back(random_set("gauss", 16, 7, 3));
  sets.push_back(random_set("gauss", 14, 8, 3));
  sets.push_back(random_set("gauss", 12, 9, 3));
  sets.push_back(full_grid(3, 5, 0));
  sets.push_back(full_grid(3, 5, 0.1));
  sets.push_back(cylinder(200, 1));
  sets.push_back(cone(200, 1));
  sets.push_back(cospherical(3, 81));
  sets.push_back(flat(60, 2, 3, 5, 1));
  sets.push_back(flat(60, 2, 5, 5, 2));
  sets.push_back(flat(60, 1, 3, 5, 3));
  sets.push_back(flat(60, 3, 5, 5, 4));
  sets.push_back(all_magnitudes(60, 2, 1));
  sets.push_back(all_magnitudes(60, 3, 1));
  PointSet line = random_set("cube", 30, 1, 1);
  sets.push_back(line);
  PointSet one = named("one point", 3);
  one.add({1, 2, 3});
  one.add({1, 2, 3});
  sets.push_back(one);
  PointSet thin = random_set("ball", 300, 3, 9);
  thin.name = "thin and turned";
  for (std::size_t i = 0; i < thin.coordinates.size(); i += 3) {
    const double x = thin.coordinates[i], z = thin.coordinates[i + 2] * 1e-13;
    thin.coordinates[i] = 0.6 * x - 0.8 * z;
    thin.coordinates[i + 2] = 0.8 * x + 0.6 * z;
  }
  sets.push_back(thin);
  return sets;
}

TEST(HullQuery, sides_are_those_of_exact_signs) {
  int seen[3] = {0, 0, 0};
  for (const PointSet& set : subjects()) {
    const Subject s(set);
    const HullQuery query(view_of(set), s.hull);
    const unsigned count = s.d < 5 ? 240 : 80;
    const std::vector<double> points = awkward_points(s, count, 5);
    std::vector<Side> batch(count);
    std::vector<std::uint8_t> contained(count);
    const PointView view = PointView::row_major(points.data(), count, s.d);
    query.sides(view, batch.data());
    query.contains(view, contained.data());
    for (unsigned i = 0; i < count; ++i) {
      const Side expected = s.side(points.data() + std::size_t{i} * s.d);
      ASSERT_EQ(query.side(points.data() + std::size_t{i} * s.d), expected)
          << set.name << ", point " << i;
      ASSERT_EQ(batch[i], expected) << set.name << ", point " << i;
      ASSERT_EQ(contained[i], expected != Side::outside) << set.name << ", point " << i;
      ++seen[1 + static_cast<int>(expected)];
    }
  }
  for (const int n : seen) EXPECT_GT(n, 500);
}

TEST(HullQuery, contains_what_adds_no_vertex) {
  for (const PointSet& set : subjects()) {
    if (set.dimension > 4) continue;
    const Subject s(set);
    const HullQuery query(view_of(set), s.hull);
    const unsigned count = 24;
    const std::vector<double> points = awkward_points(s, count, 6);
    for (unsigned i = 0; i < count; ++i) {
      PointSet more = set;
      const auto at = points.begin() + static_cast<std::ptrdiff_t>(std::size_t{i} * s.d);
      more.coordinates.insert(more.coordinates.end(), at, at + s.d);
      const Hull larger = convex_hull(view_of(more));
      const bool outside = std::find(larger.vertices.begin(), larger.vertices.end(),
                                     s.hull.point_count) != larger.vertices.end();
      ASSERT_EQ(query.contains(&*at), !outside) << set.name << ", point " << i;
    }
  }
}

TEST(HullQuery, large_batches_go_through_the_map_and_agree) {
  for (const unsigned d : {2U, 3U, 4U}) {
    const PointSet set = random_set("ball", 2000, d, 11);
    const Subject s(set);
    const HullQuery query(view_of(set), s.hull);
    const PointSet asked = random_set("cube", 20000, d, 12);
    std::vector<Side> one(20000), two(20000);
    Options options = options_of(1);
    query.sides(view_of(asked), one.data(), options);
    options.threads = 3;
    query.sides(view_of(asked), two.data(), options);
    EXPECT_EQ(one, two);
    unsigned inside = 0;
    for (std::size_t i = 0; i < one.size(); ++i) {
      ASSERT_EQ(one[i], query.side(asked.coordinates.data() + i * d));
      inside += one[i] == Side::inside;
    }
    EXPECT_GT(inside, 2000U);
    EXPECT_LT(inside, 18000U);
  }
}

/// Sets whose hulls are asked by cells of directions: lattices (many points exactly on facets, on
/// ridges, at vertices), slivers, and every dimension that has cells.
TEST(HullQuery, cells_answer_as_single_questions_do) {
  std::vector<PointSet> sets;
  for (unsigned d = 2; d <= 4; ++d) {
    sets.push_back(random_set("ball", d < 4 ? 1000 : 60, d, 21));
    sets.push_back(random_grid(d < 4 ? 300 : 100, d, 4, 0, d));
    sets.push_back(cube_with_centres(d));
  }
  sets.push_back(full_grid(3, 5, 0.1));
  sets.push_back(cylinder(200, 1));
  sets.push_back(cone(200, 1));
  sets.push_back(cospherical(3, 81));
  sets.push_back(all_magnitudes(60, 3, 1));
  unsigned seen[3] = {0, 0, 0};
  for (const PointSet& set : sets) {
    const Subject s(set);
    const HullQuery query(view_of(set), s.hull);
    const unsigned count = 10000;  // enough for cells
    const std::vector<double> points = awkward_points(s, count, 31);
    std::vector<Side> batch(count), turned(count);
    const Options options = options_of(2);
    query.sides(PointView::row_major(points.data(), count, s.d), batch.data(), options);
    const std::vector<double> columns = transposed(points, s.d);
    query.sides(PointView::column_major(columns.data(), count, s.d), turned.data(), options);
    ASSERT_EQ(batch, turned) << set.name;
    for (unsigned i = 0; i < count; ++i) {
      ASSERT_EQ(batch[i], query.side(points.data() + std::size_t{i} * s.d))
          << set.name << ", point " << i;
      ++seen[1 + static_cast<int>(batch[i])];
    }
  }
  for (const unsigned n : seen) EXPECT_GT(n, 10000U);
}

TEST(HullQuery, large_batches_name_the_first_point_that_is_not_finite) {
  const PointSet set = random_set("ball", 500, 3, 11);
  const Hull hull = convex_hull(view_of(set));
  const HullQuery query(view_of(set), hull);
  PointSet asked = random_set("cube", 100000, 3, 12);
  std::vector<std::uint8_t> out(100000);
  for (const double bad :
       {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()}) {
    asked.coordinates[3 * 77000 + 2] = asked.coordinates[3 * 99999] = bad;
    EXPECT_TRUE(
        has(error_of(ErrorCode::not_finite, [&] { query.contains(view_of(asked), out.data()); }),
            "77000"));
  }
}

TEST(HullQuery, visible_facets_are_those_below_the_point) {
  std::size_t seen = 0;
  for (const PointSet& set : subjects()) {
    const Subject s(set);
    if (s.k < 2) continue;
    const HullQuery query(view_of(set), s.hull);
    const unsigned count = 64;
    const std::vector<double> points = awkward_points(s, count, 7);
    for (unsigned i = 0; i < count; ++i) {
      const double* q = points.data() + std::size_t{i} * s.d;
      std::vector<std::uint32_t> expected;
      for (std::size_t t = 0; t < s.hull.simplex_count() && s.in_flat(q); ++t)
        if (s.sign(t, q) > 0) expected.push_back(s.hull.simplex_facets[t]);
      std::sort(expected.begin(), expected.end());
      expected.erase(std::unique(expected.begin(), expected.end()), expected.end());
      ASSERT_EQ(query.visible_facets(q), expected) << set.name << ", point " << i;
      seen += expected.size();
    }
  }
  EXPECT_GT(seen, 1000U);
}

TEST(HullQuery, support_is_exact_and_lowest) {
  for (const PointSet& set : subjects()) {
    const Subject s(set);
    const HullQuery query(view_of(set), s.hull);
    Random r(8);
    std::vector<double> directions;
    for (unsigned i = 0; i < 100; ++i)
      for (unsigned j = 0; j < s.d; ++j)
        directions.push_back(i == 0 ? 0 : i % 2 ? r.integer(-1, 1) : r.normal());
    std::vector<std::uint64_t> batch(100);
    query.supports(PointView::row_major(directions.data(), 100, s.d), batch.data());
    std::vector<std::uint64_t> vertices = s.hull.vertices;
    std::sort(vertices.begin(), vertices.end());
    for (unsigned i = 0; i < 100; ++i) {
      const double* u = directions.data() + std::size_t{i} * s.d;
      std::uint64_t best = 0;
      ExactFloat best_value;
      for (const std::uint64_t v : vertices) {
        ExactFloat value;
        for (unsigned j = 0; j < s.d; ++j)
          value = value + ExactFloat(s.point(v)[j]) * ExactFloat(u[j]);
        if (v == vertices[0] || value > best_value) {
          best = v;
          best_value = value;
        }
      }
      ASSERT_EQ(query.support(u), best) << set.name << ", direction " << i;
      ASSERT_EQ(batch[i], best) << set.name << ", direction " << i;
    }
  }
}

/// Least distance to the simplices of up to d vertices, each by the normal equations.
double slow_distance(const Subject& s, const double* q) {
  const std::size_t n = s.hull.vertices.size();
  double best = std::numeric_limits<double>::infinity();
  std::vector<std::size_t> chosen;
  const auto visit = [&](auto&& self, std::size_t from) -> void {
    if (!chosen.empty()) {
      // Minimise |sum w p - q|, sum w = 1, by elimination on the edges' Gram matrix.
      const std::size_t m = chosen.size() - 1;
      const double* o = s.point(s.hull.vertices[chosen[0]]);
      std::vector<double> e(m * s.d), a(m * (m + 1));
      for (std::size_t i = 0; i < m; ++i)
        for (unsigned j = 0; j < s.d; ++j)
          e[i * s.d + j] = s.point(s.hull.vertices[chosen[i + 1]])[j] - o[j];
      for (std::size_t i = 0; i < m; ++i)
        for (unsigned j = 0; j < s.d; ++j) {
          for (std::size_t l = 0; l < m; ++l) a[i * (m + 1) + l] += e[i * s.d + j] * e[l * s.d + j];
          a[i * (m + 1) + m] += e[i * s.d + j] * (q[j] - o[j]);
        }
      bool regular = true;
      for (std::size_t i = 0; i < m && regular; ++i) {
        regular = a[i * (m + 1) + i] > 1e-12;
        for (std::size_t l = 0; l < m && regular; ++l) {
          if (l == i) continue;
          const double factor = a[l * (m + 1) + i] / a[i * (m + 1) + i];
          for (std::size_t c = i; c <= m; ++c) a[l * (m + 1) + c] -= factor * a[i * (m + 1) + c];
        }
      }
      if (regular) {
        double rest = 1, square = 0;
        bool inside = true;
        std::vector<double> x(o, o + s.d);
        for (std::size_t i = 0; i < m; ++i) {
          const double w = a[i * (m + 1) + m] / a[i * (m + 1) + i];
          inside &= w >= 0;
          rest -= w;
          for (unsigned j = 0; j < s.d; ++j) x[j] += w * e[i * s.d + j];
        }
        for (unsigned j = 0; j < s.d; ++j) square += (x[j] - q[j]) * (x[j] - q[j]);
        if (inside && rest >= 0) best = std::min(best, std::sqrt(square));
      }
    }
    if (chosen.size() == s.d) return;
    for (std::size_t i = from; i < n; ++i) {
      chosen.push_back(i);
      self(self, i + 1);
      chosen.pop_back();
    }
  };
  visit(visit, 0);
  return best;
}

TEST(HullQuery, distances_to_small_hulls) {
  std::vector<PointSet> sets{random_set("gauss", 12, 2, 1), random_set("gauss", 12, 3, 2),
                             random_set("gauss", 10, 4, 3), cube_with_centres(3),
                             flat(20, 2, 3, 4, 5),          flat(20, 1, 3, 4, 5)};
  for (const PointSet& set : sets) {
    const Subject s(set);
    const HullQuery query(view_of(set), s.hull);
    const std::vector<double> points = awkward_points(s, 80, 9);
    std::vector<double> batch(80);
    query.signed_distances(PointView::row_major(points.data(), 80, s.d), batch.data());
    for (unsigned i = 0; i < 80; ++i) {
      const double* q = points.data() + std::size_t{i} * s.d;
      const NearestFacet near = query.nearest_facet(q);
      ASSERT_EQ(batch[i], near.distance);
      const Side side = s.side(q);
      ASSERT_EQ(near.distance > 0 ? 1 : near.distance < 0 ? -1 : 0, static_cast<int>(side));
      const double* plane = s.hull.facet_planes.data() + std::size_t{near.facet} * (s.d + 1);
      double height = plane[s.d];
      for (unsigned j = 0; j < s.d; ++j) height += plane[j] * q[j];
      if (side == Side::outside) {
        EXPECT_NEAR(near.distance, slow_distance(s, q), 1e-9 * (1 + near.distance)) << set.name;
        EXPECT_LE(height, near.distance * (1 + 1e-9) + 1e-9) << set.name;
      } else {
        double most = -std::numeric_limits<double>::infinity();
        for (std::size_t f = 0; f < s.hull.facet_count(); ++f) {
          double v = s.hull.facet_planes[f * (s.d + 1) + s.d];
          for (unsigned j = 0; j < s.d; ++j) v += s.hull.facet_planes[f * (s.d + 1) + j] * q[j];
          most = std::max(most, v);
        }
        EXPECT_NEAR(near.distance, std::min(most, 0.0), 1e-12) << set.name;
        EXPECT_NEAR(height, most, 1e-12) << set.name;
      }
    }
  }
}

TEST(HullQuery, rays_meet_the_planes_they_should) {
  int hits = 0, misses = 0;
  for (const PointSet& set : subjects()) {
    const Subject s(set);
    if (s.k < s.d || set.name.find("magnitudes") != std::string::npos) continue;
    const bool thin = set.name.find("thin") != std::string::npos;
    const HullQuery query(view_of(set), s.hull);
    Random r(10);
    for (unsigned i = 0; i < 100; ++i) {
      std::vector<double> o(s.d), u(s.d);
      for (unsigned j = 0; j < s.d; ++j) {
        o[j] = 2 * r.normal();
        u[j] = r.normal() - (i % 2 ? o[j] : 0);
      }
      double enter = -std::numeric_limits<double>::infinity(), exit = -enter;
      for (std::size_t f = 0; f < s.hull.facet_count(); ++f) {
        const double* plane = s.hull.facet_planes.data() + f * (s.d + 1);
        double height = plane[s.d], rise = 0;
        for (unsigned j = 0; j < s.d; ++j) {
          height += plane[j] * o[j];
          rise += plane[j] * u[j];
        }
        if (rise > 0) exit = std::min(exit, -height / rise);
        if (rise < 0) enter = std::max(enter, -height / rise);
      }
      if (thin || std::fabs(exit - enter) < 1e-6) continue;  // touching
      const RayHit hit = query.ray(o.data(), u.data());
      ASSERT_EQ(hit.hit, enter <= exit) << set.name << ' ' << i << ' ' << enter << ' ' << exit;
      hits += hit.hit;
      misses += !hit.hit;
      if (!hit.hit) continue;
      ASSERT_NEAR(hit.enter, enter, 1e-9 * (1 + std::fabs(enter))) << set.name;
      ASSERT_NEAR(hit.exit, exit, 1e-9 * (1 + std::fabs(exit))) << set.name;
      ASSERT_LT(hit.enter_facet, s.hull.facet_count());
      ASSERT_LT(hit.exit_facet, s.hull.facet_count());
    }
  }
  EXPECT_GT(hits, 200);
  EXPECT_GT(misses, 200);
}

TEST(HullQuery, refuses_what_makes_no_sense) {
  const PointSet set = random_set("ball", 50, 3, 1);
  const Hull hull = convex_hull(view_of(set));
  const HullQuery query(view_of(set), hull);
  const double nan[] = {0, std::nan(""), 0}, zero[] = {0, 0, 0};
  error_of(ErrorCode::not_finite, [&] { query.side(nan); });
  error_of(ErrorCode::invalid_argument, [&] { query.ray(zero, zero); });
  error_of(ErrorCode::invalid_argument, [&] { HullQuery(view_of(set), Hull{}); });
  std::vector<double> many(30000, 0.25);
  many[3 * 7001 + 1] = std::numeric_limits<double>::infinity();
  std::vector<std::uint8_t> out(10000);
  EXPECT_TRUE(has(
      error_of(ErrorCode::not_finite,
               [&] { query.contains(PointView::row_major(many.data(), 10000, 3), out.data()); }),
      "7001"));
  error_of(ErrorCode::invalid_argument,
           [&] { query.contains(PointView::row_major(many.data(), 10, 2), out.data()); });
  error_of(ErrorCode::cancelled, [&] {
    query.contains(PointView::row_major(many.data(), 1000, 3), out.data(), stopped());
  });
}

}  // namespace cullhull::query_test
