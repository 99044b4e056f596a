// Halfspace intersection: polytopes whose vertices are known, and random ones against their planes.
#include "cullhull/halfspaces.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "agreement/point_sets.hpp"
#include "cullhull/error.hpp"
#include "thrown.hpp"

namespace cullhull::halfspaces_test {

using namespace testing_support;

PointView rows_of(const std::vector<double>& rows, unsigned d) {
  return PointView::row_major(rows.data(), rows.size() / (d + 1), d + 1);
}

/// |x_j - centre| <= 1.
std::vector<double> cube(unsigned d, double centre) {
  std::vector<double> rows;
  for (unsigned j = 0; j < d; ++j)
    for (const double sign : {-1.0, 1.0}) {
      std::vector<double> row(d + 1, 0);
      row[j] = sign;
      row[d] = -1 - sign * centre;
      rows.insert(rows.end(), row.begin(), row.end());
    }
  return rows;
}

std::vector<std::vector<double>> sorted_rows(const std::vector<double>& flat, unsigned d) {
  std::vector<std::vector<double>> rows;
  for (std::size_t i = 0; i < flat.size(); i += d)
    rows.emplace_back(flat.begin() + static_cast<std::ptrdiff_t>(i),
                      flat.begin() + static_cast<std::ptrdiff_t>(i + d));
  std::sort(rows.begin(), rows.end());
  return rows;
}

TEST(Halfspaces, a_cube_has_its_corners) {
  for (unsigned d = 1; d <= 5; ++d)
    for (const double centre : {0.0, 3.0, -1000.0}) {
      const std::vector<double> rows = cube(d, centre);
      const std::vector<double> middle(d, centre);
      for (const double* interior : {static_cast<const double*>(nullptr), middle.data()}) {
        const HalfspaceIntersection h = intersect_halfspaces(rows_of(rows, d), interior);
        EXPECT_TRUE(h.bounded);
        EXPECT_EQ(h.dual.vertices.size(), 2 * d);
        ASSERT_EQ(h.vertices.size(), (std::size_t{1} << d) * d);
        for (const double v : h.vertices)
          EXPECT_NEAR(std::fabs(v - centre), 1, 1e-12 * (1 + std::fabs(centre)));
      }
    }
}

TEST(Halfspaces, redundant_ones_are_no_vertices_of_the_dual) {
  std::vector<double> rows = cube(3, 0);
  for (int i = 0; i < 20; ++i) {
    const double row[] = {std::cos(i), std::sin(i), 0.5, -2.5};  // sqrt(2) + 0.5 < 2.5
    rows.insert(rows.end(), row, row + 4);
  }
  const HalfspaceIntersection h = intersect_halfspaces(rows_of(rows, 3));
  EXPECT_EQ(h.dual.vertices, (std::vector<std::uint64_t>{0, 1, 2, 3, 4, 5}));
  EXPECT_EQ(h.vertices.size(), 24U);
}

TEST(Halfspaces, random_tangent_planes) {
  for (unsigned d = 2; d <= 5; ++d)
    for (std::uint64_t seed = 1; seed <= 5; ++seed) {
      const PointSet normals = random_set("gauss", 40 * d, d, seed);
      const std::size_t n = normals.coordinates.size() / d;
      Random r(seed);
      std::vector<double> at(d);
      for (double& v : at) v = 10 * r.normal();
      std::vector<double> rows;
      for (std::size_t i = 0; i < n; ++i) {
        double b = 0, square = 0;
        for (unsigned j = 0; j < d; ++j) {
          const double a = normals.coordinates[i * d + j];
          rows.push_back(a);
          b -= a * at[j];
          square += a * a;
        }
        rows.push_back(b - std::sqrt(square) * r.between(1, 1.5));
      }
      const HalfspaceIntersection h = intersect_halfspaces(rows_of(rows, d));
      ASSERT_TRUE(h.bounded);
      ASSERT_EQ(h.vertices.size(), h.dual.facet_count() * d);
      // Each vertex is in all halfspaces and on the borders of those of its dual facet.
      for (std::size_t f = 0; f < h.dual.facet_count(); ++f) {
        const double* x = h.vertices.data() + f * d;
        for (std::size_t i = 0; i < n; ++i) {
          double value = rows[i * (d + 1) + d];
          for (unsigned j = 0; j < d; ++j) value += rows[i * (d + 1) + j] * x[j];
          const auto begin = h.dual.facets.items.begin();
          const bool on =
              std::count(begin + static_cast<std::ptrdiff_t>(h.dual.facets.offsets[f]),
                         begin + static_cast<std::ptrdiff_t>(h.dual.facets.offsets[f + 1]), i) > 0;
          if (on)
            EXPECT_NEAR(value, 0, 1e-7);
          else
            EXPECT_LT(value, 1e-9);
        }
      }
      // The other way round: the centre does not matter.
      const HalfspaceIntersection g = intersect_halfspaces(rows_of(rows, d), at.data());
      ASSERT_EQ(g.dual.vertices.size(), h.dual.vertices.size());
      const auto a = sorted_rows(h.vertices, d), b = sorted_rows(g.vertices, d);
      ASSERT_EQ(a.size(), b.size());
      for (std::size_t i = 0; i < a.size(); ++i)
        for (unsigned j = 0; j < d; ++j) EXPECT_NEAR(a[i][j], b[i][j], 1e-6);
    }
}

TEST(Halfspaces, unbounded_and_empty) {
  // A quadrant: one vertex, two facets of the dual without.
  const std::vector<double> quadrant{-1, 0, 0, 0, -1, 0, -1, -1, -5};
  const HalfspaceIntersection h = intersect_halfspaces(rows_of(quadrant, 2));
  EXPECT_FALSE(h.bounded);
  EXPECT_GT(h.interior_point[0], 0);
  EXPECT_GT(h.interior_point[1], 0);
  const auto nans =
      std::count_if(h.vertices.begin(), h.vertices.end(), [](double v) { return std::isnan(v); });
  EXPECT_EQ(nans, 4);  // two rows

  const auto refusal = [](const std::vector<double>& rows, const double* interior) {
    return error_of(ErrorCode::invalid_argument,
                    [&] { intersect_halfspaces(rows_of(rows, 2), interior); });
  };
  const std::vector<double> empty{1, 0, 1, -1, 0, 1};           // x <= -1 and x >= 1
  const std::vector<double> line{1, 0, 0, -1, 0, 0, 0, 1, -1};  // x = 0
  EXPECT_TRUE(has(refusal(empty, nullptr), "no interior point"));
  EXPECT_TRUE(has(refusal(line, nullptr), "no interior point"));
  const double outside[] = {2, 0}, inside[] = {0, 0};
  EXPECT_TRUE(has(refusal(cube(2, 0), outside), "halfspace 1"));
  std::vector<double> none = cube(2, 0);
  none.insert(none.end(), {0, 0, -1});
  EXPECT_TRUE(has(refusal(none, nullptr), "halfspace 4"));
  none[3] = std::numeric_limits<double>::infinity();
  EXPECT_THROW(intersect_halfspaces(rows_of(none, 2), inside), Error);
}

TEST(Halfspaces, many_planes_and_extreme_units) {
  for (const double unit : {1.0, 1e200, 1e-200}) {
    const PointSet normals = random_set("sphere", 5000, 3, 4);
    std::vector<double> rows;
    for (std::size_t i = 0; i < 5000; ++i) {
      const double* a = normals.coordinates.data() + i * 3;
      const double scale = i % 3 == 0 ? 1e-3 : 1;
      rows.insert(rows.end(),
                  {a[0] * scale, a[1] * scale, a[2] * scale, (-1 - 0.5 * a[0]) * unit * scale});
    }
    const HalfspaceIntersection h = intersect_halfspaces(rows_of(rows, 3));
    EXPECT_TRUE(h.bounded);
    EXPECT_EQ(h.dual.vertices.size(), 5000U);
    EXPECT_NEAR(h.interior_point[0] / unit, 0.5, 0.1);
  }
}

}  // namespace cullhull::halfspaces_test
