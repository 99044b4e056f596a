// Interpolation against barycentric coordinates and distances in rational numbers.
#include "cullhull/interpolate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "agreement/random_seeds.hpp"
#include "cullhull/error.hpp"
#include "diagrams/slow_cells.hpp"
#include "diagrams/slow_volume.hpp"

namespace cullhull {
namespace interpolate_test {

using namespace testing_support;

void check(const LiftedSet& s) {
  const Triangulation t = triangulate(s);
  const unsigned d = s.dimension;
  std::mt19937_64 random(d);
  std::vector<double> values(2 * s.count());
  for (double& v : values) v = static_cast<double>(random() % 1000) - 500;
  const Interpolator of(view_of(s), t, values.data(), 2);
  std::vector<double> rows = s.rows;
  for (unsigned i = 0; i < 20 && s.count() > 0; ++i) {
    const double share = static_cast<double>(random() % 65) / 64;
    const double *a = s.rows.data() + random() % s.count() * d,
                 *b = s.rows.data() + random() % s.count() * d;
    for (unsigned j = 0; j < d; ++j) rows.push_back(a[j] * share + b[j] * (1 - share));
  }
  const std::size_t n = rows.size() / d;
  std::vector<double> linear(2 * n), nearest(2 * n);
  const PointView asked = PointView::row_major(rows.data(), n, d);
  of.linear(asked, linear.data(), -7);
  of.nearest(asked, nearest.data(), -7);
  for (std::size_t i = 0; i < n; ++i) {
    const Rationals q = rational_row(rows.data() + i * d, d);
    const std::uint32_t c = slow_find(s, t, q), v = slow_nearest(s, t, q);
    for (unsigned m = 0; m < 2; ++m) {
      EXPECT_EQ(nearest[2 * i + m], v == no_index ? -7 : values[2 * v + m]) << s.name;
      if (c == no_index) {
        EXPECT_EQ(linear[2 * i + m], -7) << s.name;
        continue;
      }
      const Rationals shares = *slow_barycentric(s, t.cell(c), q);
      mpq_class sum = 0;
      for (unsigned j = 0; j < t.corners(); ++j)
        sum += shares[j] * mpq_class(values[2 * t.cell(c)[j] + m]);
      EXPECT_TRUE(near(linear[2 * i + m], sum, 1e-14, 500)) << s.name;
      // At a vertex its own value, or that of the point that stands in.
      if (i < s.count() && std::count(shares.begin(), shares.end(), 0) + 1 == t.corners()) {
        EXPECT_EQ(linear[2 * i + m], nearest[2 * i + m]) << s.name;
      }
    }
  }
}

TEST(Interpolator, SmallSetsAreAsDefined) {
  for (unsigned d = 1; d <= 3; ++d)
    for (const LiftedSet& s : small_lifted_sets(d, 41))
      if (s.weights.empty()) check(s);
}

TEST(Interpolator, FewPoints) {
  for (unsigned d = 1; d <= 3; ++d)
    for (const LiftedSet& s : few_points(d)) check(s);
}

/// What is linear stays so, for many points and any threads.
TEST(Interpolator, LinearValuesStayLinear) {
  const LiftedSet s = random_points(2, 5000, 1), asked = random_points(2, 30000, 2);
  std::vector<double> values;
  for (std::uint64_t i = 0; i < s.count(); ++i)
    values.push_back(3 * s.rows[2 * i] - 2 * s.rows[2 * i + 1] + 1);
  const Interpolator of(view_of(s), triangulate(s), values.data());
  std::vector<double> one(asked.count()), many(asked.count());
  Options o;
  o.threads = 1;
  of.linear(view_of(asked), one.data(), NAN, o);
  o.threads = 3;
  of.linear(view_of(asked), many.data(), 9, o);
  unsigned inside = 0;
  for (std::uint64_t i = 0; i < asked.count(); ++i) {
    if (std::isnan(one[i])) {
      EXPECT_EQ(many[i], 9);
      continue;
    }
    ++inside;
    EXPECT_EQ(one[i], many[i]);
    EXPECT_NEAR(one[i], 3 * asked.rows[2 * i] - 2 * asked.rows[2 * i + 1] + 1, 1e-13);
  }
  EXPECT_GT(inside, 29000U);
}

/// What each cell of the set loses to that of q, over the sum, by halfspaces; d dimensions.
std::vector<mpq_class> slow_shares(const LiftedSet& s, const Triangulation& t, const Rationals& q) {
  std::vector<Rationals> rows;
  for (std::uint32_t i = 0; i < s.count(); ++i) {
    const Rationals p = rational_point(s, i);
    Rationals row;
    mpq_class right = 0;
    for (unsigned j = 0; j < s.dimension; ++j) {
      row.push_back(2 * (p[j] - q[j]));
      right += p[j] * p[j] - q[j] * q[j];
    }
    row.push_back(right);
    rows.push_back(row);
  }
  std::vector<mpq_class> shares;
  mpq_class sum = 0;
  for (std::uint32_t i = 0; i < s.count(); ++i) {
    shares.push_back(slow_cell(s, t, i, rows));
    sum += shares.back();
  }
  for (mpq_class& share : shares) share /= sum;
  return shares;
}

void check_shares(const LiftedSet& s, const Interpolator& of, const double* point,
                  const std::vector<mpq_class>& exact, const std::string& what) {
  const NaturalNeighbours found = of.natural_neighbours(point);
  std::vector<double> shares(s.count());
  for (std::size_t i = 0; i < found.ids.size(); ++i) {
    EXPECT_TRUE(i == 0 || found.ids[i - 1] < found.ids[i]);
    shares[found.ids[i]] = found.weights[i];
  }
  for (std::size_t i = 0; i < exact.size(); ++i)
    EXPECT_TRUE(abs(mpq_class(shares[i]) - exact[i]) <= mpq_class(0x1p-51))
        << what << ", point " << i;
}

/// Strictly inside the hull the cell of a new point is bounded.
void check_natural(const LiftedSet& s, unsigned questions) {
  const Triangulation t = triangulate(s);
  if (t.affine_dimension != static_cast<int>(s.dimension)) return;
  const std::vector<double> values(s.count(), 1);
  const Interpolator of(view_of(s), t, values.data());
  std::mt19937_64 random(s.count());
  for (unsigned i = 0; i < questions; ++i) {
    // A mean of corners of a cell is inside; of coarse numbers it is often on circles and faces.
    const auto cell = t.cell(random() % t.size());
    std::vector<double> q(s.dimension);
    double sum = 0;
    for (const std::uint32_t v : cell) {
      const double share = static_cast<double>(1 + random() % 8) / 64;  // no overflow
      sum += share;
      for (unsigned j = 0; j < s.dimension; ++j) q[j] += share * s.rows[v * s.dimension + j];
    }
    for (double& v : q) v /= sum;
    const auto at = slow_find(s, t, rational_row(q.data(), s.dimension));
    if (at == no_index) continue;
    const Rationals inside = *slow_barycentric(s, t.cell(at), rational_row(q.data(), s.dimension));
    bool on_hull = false;
    for (unsigned j = 0; j < t.corners(); ++j) on_hull = on_hull || inside[j] == 0;
    if (on_hull) continue;
    check_shares(s, of, q.data(), slow_shares(s, t, rational_row(q.data(), s.dimension)), s.name);
  }
}

TEST(NaturalNeighbours, SharesAreThoseOfCells) {
  for (unsigned d = 2; d <= 3; ++d)
    for (const LiftedSet& s : sampled(small_lifted_sets(d, 83)))
      if (s.weights.empty()) check_natural(s, d == 2 ? 8 : 1);
  check_natural(random_points(2, 40, 5), 10);
  check_natural(drawn_grid(2, 40, 7, 1, 0, 5), 10);
}

/// Where its cell is huge and thin.
TEST(NaturalNeighbours, NearTheHull) {
  LiftedSet s = random_points(2, 12, 6);
  s.rows.insert(s.rows.end(), {-1, -1, 2, -1, 2, 2, -1, 2});
  const Triangulation t = triangulate(s);
  const std::vector<double> values(s.count(), 1);
  const Interpolator of(view_of(s), t, values.data());
  for (int e = 1; e < 52; e += 5)
    for (const double x : {0.25, 1.1}) {
      const double q[] = {x, -1 + std::ldexp(1.0, -e)};
      check_shares(s, of, q, slow_shares(s, t, rational_row(q, 2)), "2^-" + std::to_string(e));
    }
}

/// On a face of the hull in space as in the plane; on its edges, and the plane's, linear.
TEST(NaturalNeighbours, OnTheHull) {
  LiftedSet flat = drawn_grid(2, 14, 6, 1, 0, 7), solid{"prism", 3, {}, {}};
  flat.rows.insert(flat.rows.end(), {-1, -1, 7, -1, 7, 7, -1, 7});
  for (std::size_t i = 0; i < flat.rows.size(); i += 2)  // in the plane x + z = 3
    solid.rows.insert(solid.rows.end(), {flat.rows[i], flat.rows[i + 1], 3 - flat.rows[i]});
  LiftedSet stretched = flat;  // with that plane's lengths
  for (std::size_t i = 0; i < flat.rows.size(); i += 2) stretched.rows[i] *= std::sqrt(2.0);
  solid.rows.insert(solid.rows.end(), {9, 3, 9, 10, 1, 8});
  std::vector<double> values(solid.count(), 1);
  const Interpolator of(view_of(solid), triangulate(solid), values.data());
  const Interpolator below(view_of(stretched), triangulate(stretched), values.data());
  for (const auto& [x, y] : {std::pair(2.5, 3.25), std::pair(0.5, 0.75), std::pair(4.0, 1.5)}) {
    const double q[] = {x, y, 3 - x}, p[] = {x * std::sqrt(2.0), y};
    const NaturalNeighbours in = of.natural_neighbours(q), out = below.natural_neighbours(p);
    std::vector<double> shares(solid.count());
    for (std::size_t i = 0; i < in.ids.size(); ++i) shares[in.ids[i]] = in.weights[i];
    for (std::size_t i = 0; i < out.ids.size(); ++i) shares[out.ids[i]] -= out.weights[i];
    for (const double v : shares) EXPECT_NEAR(v, 0, 1e-9);  // sqrt(2) is rounded
    EXPECT_GT(in.ids.size(), 3U);
  }
  const double edge[] = {1, -1}, corner[] = {7, 7};
  const Interpolator plane(view_of(flat), triangulate(flat), values.data());
  const auto n = static_cast<std::uint32_t>(flat.count());
  EXPECT_EQ(plane.natural_neighbours(edge).ids, (std::vector<std::uint32_t>{n - 4, n - 3}));
  EXPECT_EQ(plane.natural_neighbours(edge).weights, (std::vector<double>{0.75, 0.25}));
  EXPECT_EQ(plane.natural_neighbours(corner).ids, (std::vector<std::uint32_t>{n - 2}));
  const double outside[] = {7, 8};
  EXPECT_TRUE(plane.natural_neighbours(outside).ids.empty());
}

/// Linear values stay so, in the plane, in space and in flats, for any threads.
TEST(NaturalNeighbours, LinearValuesStayLinear) {
  for (const LiftedSet& s :
       {random_points(2, 3000, 1), drawn_grid(2, 900, 40, 1, 0, 2), random_points(3, 800, 3),
        drawn_grid(3, 400, 9, 0.5, 100, 3), in_a_flat(3, 2, 60, 4), in_a_flat(4, 3, 60, 5),
        in_a_flat(2, 1, 20, 6)}) {
    const unsigned d = s.dimension;
    const Triangulation t = triangulate(s);
    const auto linear = [&](const double* p) {
      double sum = 1;
      for (unsigned j = 0; j < d; ++j) sum += (j + 2.0) * p[j];
      return sum;
    };
    std::vector<double> values, rows = s.rows;
    for (std::uint64_t i = 0; i < s.count(); ++i) values.push_back(linear(s.rows.data() + i * d));
    std::mt19937_64 random(d);
    for (unsigned i = 0; i < 600; ++i) {  // between points; many on faces
      const double* a = s.rows.data() + random() % s.count() * d;
      const double* b = s.rows.data() + random() % s.count() * d;
      for (unsigned j = 0; j < d; ++j) rows.push_back(a[j] * 0.75 + b[j] * 0.25);
    }
    const Interpolator of(view_of(s), t, values.data());
    const std::uint64_t n = rows.size() / d;
    const PointView asked = PointView::row_major(rows.data(), n, d);
    std::vector<double> one(n), many(n);
    Options o;
    o.threads = 1;
    of.natural(asked, one.data(), -1e9, o);
    o.threads = 3;
    of.natural(asked, many.data(), -1e9, o);
    EXPECT_EQ(one, many);
    double size = 0;
    unsigned inside = 0;
    for (const double v : values) size = std::max(size, std::abs(v));
    for (std::uint64_t i = 0; i < n; ++i) {
      if (one[i] == -1e9) continue;
      ++inside;
      EXPECT_NEAR(one[i], linear(rows.data() + i * d), 1e-13 * size) << s.name;
    }
    EXPECT_GT(inside, n / 2) << s.name;
  }
}

TEST(NaturalNeighbours, HugeAndTinyNumbers) {
  for (const double scale : {1e-300, 1e300}) {
    LiftedSet s = random_points(2, 30, 9);
    for (double& v : s.rows) v *= scale;
    check_natural(s, 5);
  }
  LiftedSet wide{"wide", 2, {0, 0, 1e300, 0, 0, 1e300, 1e300, 1e300, 1, 1}, {}};
  const std::vector<double> values(5, 1);
  const Interpolator of(view_of(wide), triangulate(wide), values.data());
  const double q[] = {1e-300, 1e-300};
  check_shares(wide, of, q, slow_shares(wide, triangulate(wide), rational_row(q, 2)), "wide");
}

TEST(NaturalNeighbours, RefusesHigherDimensions) {
  const LiftedSet s = random_points(4, 20, 1);
  const std::vector<double> values(20);
  const Interpolator of(view_of(s), triangulate(s), values.data());
  EXPECT_THROW(of.natural_neighbours(s.rows.data()), Error);
}

TEST(Interpolator, RefusesWhatIsNone) {
  const LiftedSet s = random_points(2, 20, 1);
  const std::vector<double> values(20);
  EXPECT_THROW(Interpolator(view_of(s), triangulate(s), values.data(), 0), Error);
  EXPECT_THROW(Interpolator(view_of(s), triangulate(s), nullptr), Error);
  TriangulationOptions furthest;
  furthest.furthest_site = true;
  EXPECT_THROW(Interpolator(view_of(s), delaunay(view_of(s), furthest), values.data()), Error);
  EXPECT_THROW(Interpolator(view_of(s), regular_triangulation(view_of(s), values), values.data()),
               Error);
  EXPECT_NO_THROW(Interpolator(view_of(s), delaunay(view_of(s)), values.data()));
}

}  // namespace interpolate_test
}  // namespace cullhull
