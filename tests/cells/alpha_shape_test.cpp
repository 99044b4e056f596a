// Alpha shapes against exact rational radii.
#include "cullhull/alpha_shape.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "cells/slow_cells.hpp"
#include "cullhull/error.hpp"

namespace cullhull {
namespace {

using namespace testing_support;

/// Of the sphere around a cell within its flat, squared.
mpq_class slow_radius(const LiftedSet& s, std::span<const std::uint32_t> cell) {
  std::vector<Rationals> edges, m;
  const auto dot = [](const Rationals& a, const Rationals& b) {
    mpq_class sum = 0;
    for (std::size_t j = 0; j < a.size(); ++j) sum += a[j] * b[j];
    return sum;
  };
  for (std::size_t i = 1; i < cell.size(); ++i) {
    edges.push_back(rational_point(s, cell[i]));
    for (unsigned j = 0; j < s.dimension; ++j) edges.back()[j] -= rational_point(s, cell[0])[j];
  }
  for (const Rationals& e : edges) {
    Rationals row;
    for (const Rationals& o : edges) row.push_back(dot(e, o));
    row.emplace_back(dot(e, e) / 2);
    m.push_back(row);
  }
  const Rationals shares = *solved(m, edges.size());
  Rationals centre(s.dimension);
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (unsigned j = 0; j < s.dimension; ++j) centre[j] += shares[i] * edges[i][j];
  return dot(centre, centre);
}

void check(const LiftedSet& s) {
  const Triangulation t = triangulate(s);
  std::vector<mpq_class> radii;
  std::set<double> alphas{0, 1, std::numeric_limits<double>::infinity()};
  for (std::uint64_t c = 0; c < t.size(); ++c) {
    radii.push_back(slow_radius(s, t.cell(c)));
    const double a = std::sqrt(radii.back().get_d());
    if (!std::isfinite(a)) continue;
    for (const double v : {std::nextafter(a, 0), a, std::nextafter(a, INFINITY)})
      if (alphas.size() < 30 && std::isfinite(v)) alphas.insert(v);
  }
  for (const double alpha : alphas) {
    const AlphaShape shape = alpha_shape(view_of(s), t, alpha);
    std::set<std::uint32_t> kept;
    for (std::uint32_t c = 0; c < t.size(); ++c)
      if (std::isinf(alpha) || radii[c] <= mpq_class(alpha) * mpq_class(alpha)) kept.insert(c);
    EXPECT_TRUE(std::set<std::uint32_t>(shape.cells.begin(), shape.cells.end()) == kept)
        << s.name << ", alpha " << alpha;
    // Facets that an odd number of kept cells has.
    std::map<std::set<std::uint32_t>, std::set<std::uint32_t>> facets, found;
    for (const std::uint32_t c : kept)
      for (const std::uint32_t v : t.cell(c)) {
        std::set<std::uint32_t> facet(t.cell(c).begin(), t.cell(c).end());
        facet.erase(v);
        if (!facet.empty()) facets[facet].insert(c);
      }
    std::erase_if(facets, [](const auto& f) { return f.second.size() != 1; });
    const unsigned k = t.corners() > 0 ? t.corners() - 1 : 0;
    for (std::size_t f = 0; f < shape.facet_cells.size(); ++f)
      found[{shape.facets.begin() + static_cast<std::ptrdiff_t>(f * k),
             shape.facets.begin() + static_cast<std::ptrdiff_t>((f + 1) * k)}] = {
          shape.facet_cells[f]};
    EXPECT_TRUE(facets == found) << s.name << ", alpha " << alpha;
    if (!std::isinf(alpha) || t.affine_dimension < 1) continue;
    EXPECT_EQ(shape.facets, t.hull_facets) << s.name;
    EXPECT_EQ(shape.facet_cells, t.hull_cells) << s.name;
  }
}

TEST(AlphaShape, SmallSetsAreAsDefined) {
  for (unsigned d = 1; d <= 4; ++d)
    for (const LiftedSet& s : small_lifted_sets(d, 43))
      if (s.weights.empty()) check(s);
}

/// A square's half diagonal is no double: both of its neighbours tell the cells apart.
TEST(AlphaShape, ComparesExactly) {
  const std::vector<double> rows{0, 0, 1, 0, 0, 1, 1, 1};
  const PointView points = PointView::row_major(rows.data(), 4, 2);
  const Triangulation t = delaunay(points);
  EXPECT_EQ(alpha_shape(points, t, std::nextafter(std::sqrt(0.5), 0)).cells.size(), 0U);
  EXPECT_EQ(alpha_shape(points, t, std::nextafter(std::sqrt(0.5), 1)).cells.size(), 2U);
  const std::vector<double> wide{0, 0, 6, 0, 0, 8};  // a radius of 5
  const PointView triangle = PointView::row_major(wide.data(), 3, 2);
  EXPECT_EQ(alpha_shape(triangle, delaunay(triangle), 5).cells.size(), 1U);
  EXPECT_EQ(alpha_shape(triangle, delaunay(triangle), std::nextafter(5, 0)).cells.size(), 0U);
}

TEST(AlphaShape, RefusesWhatIsNone) {
  const LiftedSet s = random_points(2, 20, 1);
  const Triangulation t = triangulate(s);
  EXPECT_THROW(alpha_shape(view_of(s), t, -1), Error);
  EXPECT_THROW(alpha_shape(view_of(s), t, NAN), Error);
  EXPECT_THROW(alpha_shape(view_of(random_points(2, 19, 1)), t, 1), Error);
}

}  // namespace
}  // namespace cullhull
