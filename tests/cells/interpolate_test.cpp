// Interpolation against barycentric coordinates and distances in rational numbers.
#include "cullhull/interpolate.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "cells/slow_cells.hpp"
#include "cullhull/error.hpp"

namespace cullhull {
namespace {

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
      EXPECT_EQ(nearest[2 * i + m], v == no_cell ? -7 : values[2 * v + m]) << s.name;
      if (c == no_cell) {
        EXPECT_EQ(linear[2 * i + m], -7) << s.name;
        continue;
      }
      const Rationals shares = *slow_barycentric(s, t.cell(c), q);
      mpq_class sum = 0;
      for (unsigned j = 0; j < t.corners(); ++j)
        sum += shares[j] * mpq_class(values[2 * t.cell(c)[j] + m]);
      EXPECT_TRUE(near(linear[2 * i + m], sum, 1e-14, 500)) << s.name;
      // At a vertex its own value, or that of the point that stands in.
      if (i < s.count() && std::count(shares.begin(), shares.end(), 0) + 1 == t.corners())
        EXPECT_EQ(linear[2 * i + m], nearest[2 * i + m]) << s.name;
    }
  }
}

TEST(Interpolator, SmallSetsAreAsDefined) {
  for (unsigned d = 1; d <= 3; ++d)
    for (const LiftedSet& s : small_lifted_sets(d, 41))
      if (s.weights.empty()) check(s);
}

TEST(Interpolator, FewPoints) {
  for (unsigned d = 1; d <= 3; ++d) {
    LiftedSet s;
    s.dimension = d;
    s.name = "few";
    std::mt19937_64 random(d);
    for (unsigned n = 0; n <= d + 2; ++n) {
      check(s);
      for (unsigned j = 0; j < d; ++j) s.rows.push_back(static_cast<double>(random() % 5));
    }
  }
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

TEST(Interpolator, RefusesWhatIsNone) {
  const LiftedSet s = random_points(2, 20, 1);
  const std::vector<double> values(20);
  EXPECT_THROW(Interpolator(view_of(s), triangulate(s), values.data(), 0), Error);
  EXPECT_THROW(Interpolator(view_of(s), triangulate(s), nullptr), Error);
}

}  // namespace
}  // namespace cullhull
