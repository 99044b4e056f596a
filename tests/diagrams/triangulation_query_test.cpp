// Questions to triangulations against their definition in rational numbers: at vertices, on shared
// faces, inside, outside, off the flat.
#include "cullhull/triangulation_query.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "cullhull/alpha_shape.hpp"
#include "cullhull/error.hpp"
#include "cullhull/interpolate.hpp"
#include "cullhull/proximity_graphs.hpp"
#include "cullhull/voronoi.hpp"
#include "diagrams/slow_cells.hpp"
#include "thrown.hpp"

namespace cullhull {
namespace triangulation_query_test {

using namespace testing_support;

/// Vertices, middles of pairs, random mixtures, points around and far away.
std::vector<double> questions(const LiftedSet& s, std::uint64_t seed, unsigned count) {
  std::mt19937_64 random(seed);
  const unsigned d = s.dimension;
  std::vector<double> rows;
  const auto row = [&] { return s.rows.data() + random() % s.count() * d; };
  for (unsigned i = 0; i < count && s.count() > 0; ++i) {
    const double *a = row(), *b = row();
    for (unsigned j = 0; j < d; ++j) switch (i % 5) {
        case 0:
          rows.push_back(a[j]);
          break;
        case 1:
          rows.push_back(a[j] / 2 + b[j] / 2);
          break;
        case 2:
          rows.push_back(row()[j]);
          break;
        case 3:
          rows.push_back(a[j] + static_cast<double>(random() % 9) / 4 - 1);
          break;
        default:
          rows.push_back(a[j] + (b[j] / 64 - a[j] / 64) * static_cast<double>(random() % 65));
      }
  }
  rows.insert(rows.end(), d, 0.0);
  rows.insert(rows.end(), d, 1e308);
  rows.insert(rows.end(), d, -5e-324);
  return rows;
}

void check(const LiftedSet& s, unsigned count, bool furthest = false) {
  TriangulationOptions o;
  o.furthest_site = furthest;
  const Triangulation t = triangulate(s, o);
  const TriangulationQuery query(view_of(s), t, s.weights);
  ASSERT_EQ(query.corners(), t.corners());
  const std::vector<double> rows = questions(s, 5, count);
  const std::size_t n = rows.size() / s.dimension;
  const PointView asked = PointView::row_major(rows.data(), n, s.dimension);
  std::vector<std::uint32_t> cells(n), nearest(n);
  std::vector<double> shares(n * t.corners());
  query.find(asked, cells.data());
  query.nearest(asked, nearest.data());
  query.barycentric(asked, cells.data(), shares.data());
  std::vector<double> values(3 * s.count()), between(3 * n);
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<double>(i % 17) - 8;
  query.interpolate(asked, values.data(), 3, std::vector{-7.0, 9.0}, between.data());
  const double tolerance = 0x1p-24;
  std::vector<std::uint32_t> tolerant(n);
  query.find(asked, tolerant.data(), {}, tolerance);
  std::vector<double> single(t.corners());
  for (std::size_t i = 0; i < n; ++i) {
    const double* p = rows.data() + i * s.dimension;
    const Rationals q = rational_row(p, s.dimension);
    ASSERT_EQ(cells[i], slow_find(s, t, q)) << s.name << ", question " << i;
    ASSERT_EQ(nearest[i], slow_nearest(s, t, q)) << s.name << ", question " << i;
    EXPECT_EQ(query.find(p), cells[i]);
    EXPECT_EQ(query.nearest(p), nearest[i]);
    query.barycentric(p, cells[i], single.data());
    for (unsigned m = 0; m < 3; ++m) {
      double sum = cells[i] == no_index ? (m == 1 ? 9 : -7) : 0;
      for (unsigned j = 0; j < t.corners() && cells[i] != no_index; ++j)
        sum += single[j] * values[3 * t.cell(cells[i])[j] + m];
      ASSERT_EQ(between[3 * i + m], sum) << s.name << ", question " << i;
    }
    if (cells[i] != no_index) {
      ASSERT_EQ(tolerant[i], cells[i]) << s.name << ", question " << i;
    } else if (tolerant[i] != no_index) {
      const auto beyond = slow_barycentric(s, t.cell(tolerant[i]), q);
      for (const mpq_class& share : *beyond)
        ASSERT_TRUE(share >= -tolerance) << s.name << ", question " << i;
    }
    for (unsigned j = 0; j < t.corners(); ++j) {
      const double share = shares[i * t.corners() + j];
      if (cells[i] == no_index) {
        ASSERT_TRUE(std::isnan(share) && std::isnan(single[j]));
        continue;
      }
      ASSERT_EQ(share, single[j]);
      const mpq_class x = (*slow_barycentric(s, t.cell(cells[i]), q))[j];
      ASSERT_TRUE(near(share, x, 0x1p-50, 1)) << s.name << ", question " << i;
      ASSERT_EQ(share == 0, x <= mpq_class(5e-324) / 2) << s.name << ", question " << i;
      ASSERT_GE(share, 0);
    }
  }
}

TEST(TriangulationQuery, SmallSetsAreAsDefined) {
  for (unsigned d = 1; d <= 4; ++d)
    for (const LiftedSet& s : small_lifted_sets(d, 3)) check(s, d <= 3 ? 40 : 15);
}

TEST(TriangulationQuery, RandomSmallSetsAreAsDefined) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed)
    for (unsigned d = 1; d <= 4; ++d) check(random_lifted_set(d, seed), 15);
}

TEST(TriangulationQuery, FurthestSite) {
  for (unsigned d = 1; d <= 3; ++d)
    for (const LiftedSet& s : small_lifted_sets(d, 19)) check(s, 15, true);
}

/// The furthest of all points, not only of the vertices, where equal points have different weights.
TEST(TriangulationQuery, FurthestOfEqualPointsOfDifferentWeights) {
  TriangulationOptions o;
  o.furthest_site = true;
  const auto furthest = [&](const LiftedSet& s, const double* q) {
    const TriangulationQuery query(view_of(s), triangulate(s, o), s.weights);
    return query.nearest(q);
  };
  const double left[] = {-5, 1};
  EXPECT_EQ(furthest({"corners", 2, {0, 0, 4, 0, 0, 4, 4, 0}, {0, 0, 0, 2}}, left), 1U);
  for (std::uint64_t seed = 0; seed < 100; ++seed) {
    const LiftedSet s = with_weights(drawn_grid(2, 12, 3, 1, 0, seed), 3, seed, true);
    const Rationals at = rational_row(left, 2);
    mpq_class most = slow_power(s, 0, at);
    for (std::uint32_t i = 1; i < s.count(); ++i) most = std::max(most, slow_power(s, i, at));
    EXPECT_TRUE(slow_power(s, furthest(s, left), at) == most) << s.name << ", seed " << seed;
  }
}

TEST(TriangulationQuery, FewPoints) {
  for (unsigned d = 1; d <= 4; ++d) {
    for (const LiftedSet& s : few_points(d, 10)) check(s, 20);
    LiftedSet equal = few_points(d).back();
    for (double& v : equal.rows) v = 0.5;
    check(equal, 20);
  }
}

/// Coordinates beyond a cell are told as well.
TEST(TriangulationQuery, BarycentricBeyondTheCell) {
  const std::vector<double> rows{0, 0, 4, 0, 0, 4};
  const PointView points = PointView::row_major(rows.data(), 3, 2);
  const Triangulation t = delaunay(points);
  const TriangulationQuery query(points, t);
  const double outside[2] = {-4, 6};
  double shares[3];
  query.barycentric(outside, 0, shares);
  EXPECT_EQ(shares[0], 0.5);
  EXPECT_EQ(shares[1], -1);
  EXPECT_EQ(shares[2], 1.5);
  EXPECT_EQ(query.find(outside), no_index);
}

/// A point beyond the middle of a facet of the hull, by a share of the cell's height: in that cell
/// if the tolerance is larger. So it is with maps of cells and by walks, which more cells have.
TEST(TriangulationQuery, AToleranceTakesPointsNearBy) {
  for (const auto& [d, n] :
       {std::pair{1U, 50U}, {2U, 50U}, {3U, 50U}, {4U, 50U}, {5U, 20U}, {2U, 120'000U}}) {
    const LiftedSet s = random_points(d, n, 3);
    const Triangulation t = triangulate(s);
    const TriangulationQuery query(view_of(s), t);
    std::vector<double> rows;
    std::vector<std::uint32_t> cells;
    for (std::uint32_t c = 0; c < t.size() && cells.size() < 200; ++c)
      for (unsigned facet = 0; facet <= d; ++facet) {
        if (t.neighbours_of(c)[facet] != no_index) continue;
        cells.push_back(c);
        for (unsigned j = 0; j < d; ++j) {
          double x = 0;  // of shares -2^-30 for the corner across, equal ones for the others
          for (unsigned i = 0; i <= d; ++i)
            x += s.rows[std::size_t{t.cell(c)[i]} * d + j] *
                 (i == facet ? -0x1p-30 : (1 + 0x1p-30) / d);
          rows.push_back(x);
        }
      }
    const PointView asked = PointView::row_major(rows.data(), cells.size(), d);
    std::vector<std::uint32_t> found(cells.size());
    query.find(asked, found.data(), {}, 0x1p-28);
    EXPECT_EQ(found, cells) << d;
    for (const double less : {0.0, 0x1p-32}) {
      query.find(asked, found.data(), {}, less);
      EXPECT_EQ(std::count(found.begin(), found.end(), no_index),
                static_cast<std::ptrdiff_t>(cells.size()))
          << d;
    }
  }
}

/// By walks, as the first question has them, and by maps, which many questions pay for; far from
/// the origin, where a step towards the middle is a rounding or two.
TEST(TriangulationQuery, AnswersDoNotDependOnQuestionsBefore) {
  std::mt19937_64 random(3);
  const auto unit = [&] { return static_cast<double>(random() % 1048577) / 1048576; };
  for (const double far : {0.0, 0x1p20, 0x1p32}) {
    LiftedSet s{"far", 2, {}, {}};
    for (int i = 0; i < 900; ++i) {
      s.rows.push_back(far + (i % 8 == 0 ? 1 : unit()));
      s.rows.push_back(unit());
    }
    const Triangulation t = triangulate(s);
    ASSERT_GT(t.size(), 1024U);
    std::vector<double> rows = questions(s, 5, 500), values(s.count());
    for (int i = 0; i < 500; ++i) {
      rows.push_back(far + 1 + (i % 3) * std::max(far * 0x1p-52, 0x1p-40));
      rows.push_back(unit());
    }
    for (double& value : values) value = unit();
    const std::size_t n = rows.size() / 2;
    for (const double tolerance : {0.0, 1e-14, 0x1p-24, 1e-4}) {
      std::vector<std::uint32_t> first(n), later(n);
      std::vector<double> between(n), again(n);
      const std::vector<double> outside{-7};
      for (std::size_t i = 0; i < n; ++i) {
        if (i % 8 == 0 || i + 500 >= n) {
          const TriangulationQuery query(view_of(s), t);
          const PointView one = PointView::row_major(rows.data() + 2 * i, 1, 2);
          query.find(one, &first[i], {}, tolerance);
          query.interpolate(one, values.data(), 1, outside, &between[i], {}, tolerance);
        }
      }
      const TriangulationQuery query(view_of(s), t);
      const PointView all = PointView::row_major(rows.data(), n, 2);
      for (int turn = 0; turn < 3; ++turn) {
        query.find(all, later.data(), {}, tolerance);
        query.interpolate(all, values.data(), 1, outside, again.data(), {}, tolerance);
      }
      for (std::size_t i = 0; i < n; ++i)
        if (i % 8 == 0 || i + 500 >= n) {
          ASSERT_EQ(first[i], later[i]) << far << ", " << tolerance << ", question " << i;
          ASSERT_EQ(between[i], again[i]) << far << ", " << tolerance << ", question " << i;
        }
    }
  }
}

/// Shares are the doubles nearest to the exact ones, whatever the cells' shapes and scales are.
TEST(TriangulationQuery, CellsOfManyScales) {
  for (unsigned d = 2; d <= 4; ++d)
    for (const double scale : {1e-300, 1e-160, 1e-12, 1e12, 1e160, 1e300}) {
      LiftedSet s = random_points(d, d == 4 ? 12 : 40, 5);
      for (std::size_t i = 0; i < s.rows.size(); i += d) s.rows[i] *= scale;
      check(s, 60);
      for (double& x : s.rows) x = 1e6 + x * 1e-3;
      check(s, 60);
    }
}

/// Many questions: the same for any threads, in the cell they name, and the lowest of those that
/// meet where a vertex is asked for.
TEST(TriangulationQuery, LargerSets) {
  for (unsigned d = 1; d <= 4; ++d)
    for (const LiftedSet& s : large_lifted_sets(d, d <= 3 ? 3000 : 300)) {
      const Triangulation t = triangulate(s);
      const TriangulationQuery query(view_of(s), t, s.weights);
      const std::vector<double> rows = questions(s, 8, 20000);
      const std::size_t n = rows.size() / d;
      const PointView asked = PointView::row_major(rows.data(), n, d);
      std::vector<std::uint32_t> cells(n), nearest(n), again(n);
      Options o;
      o.threads = 1;
      query.find(asked, cells.data(), o);
      query.nearest(asked, nearest.data(), o);
      for (const unsigned threads : {2U, 3U, 8U}) {
        o.threads = threads;
        query.find(asked, again.data(), o);
        ASSERT_EQ(again, cells) << s.name;
        query.nearest(asked, again.data(), o);
        ASSERT_EQ(again, nearest) << s.name;
      }
      for (std::size_t i = 0; i < n; i += 97) {
        const Rationals q = rational_row(rows.data() + i * d, d);
        ASSERT_EQ(query.find(rows.data() + i * d), cells[i]);
        if (cells[i] == no_index) continue;
        const auto x = slow_barycentric(s, t.cell(cells[i]), q);
        ASSERT_TRUE(x) << s.name;
        for (const mpq_class& v : *x) ASSERT_TRUE(v >= 0) << s.name;
      }
      std::vector<std::uint32_t> lowest(s.count(), no_index), found(s.count());
      for (std::uint32_t c = 0; c < t.size(); ++c)
        for (const std::uint32_t v : t.cell(c)) lowest[v] = std::min(lowest[v], c);
      for (const DuplicatePoint& p : t.duplicates) lowest[p.id] = lowest[p.representative];
      query.find(view_of(s), found.data());
      for (std::uint32_t i = 0; i < s.count(); ++i)
        ASSERT_TRUE(lowest[i] == no_index || found[i] == lowest[i]) << s.name;
    }
}

TEST(TriangulationQuery, ScalarTypesOfEqualValueAgree) {
  LiftedSet s = drawn_grid(2, 400, 90, 1, 0, 3);
  const Triangulation t = triangulate(s);
  const TriangulationQuery query(view_of(s), t);
  const LiftedSet asked = drawn_grid(2, 500, 110, 1, 0, 4);
  const std::vector<float> floats(asked.rows.begin(), asked.rows.end());
  const std::vector<std::uint8_t> bytes(asked.rows.begin(), asked.rows.end());
  std::vector<std::uint32_t> a(500), b(500), c(500);
  query.find(view_of(asked), a.data());
  query.find(PointView::row_major(floats.data(), 500, 2), b.data());
  query.find(PointView::row_major(bytes.data(), 500, 2), c.data());
  EXPECT_EQ(a, b);
  EXPECT_EQ(a, c);
}

TEST(TriangulationQuery, RefusesWhatIsNone) {
  const LiftedSet s = random_points(2, 20, 1);
  const Triangulation t = triangulate(s);
  const TriangulationQuery query(view_of(s), t);
  std::vector<double> rows{0, 0, 0.5, std::nan(""), std::numeric_limits<double>::infinity(), 0};
  std::vector<std::uint32_t> out(3);
  const PointView asked = PointView::row_major(rows.data(), 3, 2);
  EXPECT_NE(error_of(ErrorCode::not_finite, [&] { query.find(asked, out.data()); }).find("point 1"),
            std::string::npos);
  EXPECT_EQ(error_of(ErrorCode::not_finite, [&] { query.find(rows.data() + 2); }),
            "coordinate 1 is NaN");
  EXPECT_EQ(error_of(ErrorCode::not_finite, [&] { query.nearest(rows.data() + 4); }),
            "coordinate 0 is infinite");
  double shares[3];
  EXPECT_EQ(
      error_of(ErrorCode::invalid_argument, [&] { query.barycentric(rows.data(), 4000, shares); }),
      "there is no cell 4000");
  EXPECT_EQ(error_of(ErrorCode::invalid_argument,
                     [&] { query.find(PointView::row_major(rows.data(), 2, 3), out.data()); }),
            "points of dimension 3 asked of a triangulation in dimension 2");
  EXPECT_EQ(error_of(ErrorCode::invalid_argument, [&] { TriangulationQuery(asked, t); }),
            "the triangulation is of 20 points in dimension 2, not of 3 in dimension 2");
  std::stop_source stop;
  stop.request_stop();
  Options o;
  o.stop = stop.get_token();
  rows = {0, 0};
  error_of(ErrorCode::cancelled,
           [&] { query.find(PointView::row_major(rows.data(), 1, 2), out.data(), o); });
}

/// Whether every function that takes the triangulation returns or throws Error{invalid_argument}.
void expect_answers_or_errors(const LiftedSet& s, const Triangulation& t) {
  const PointView points = view_of(s);
  const auto attempt = [](const auto& call) {
    try {
      call();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::invalid_argument) << e.what();
    }
  };
  attempt([&] {
    const TriangulationQuery query(points, t, s.weights);
    std::vector<std::uint32_t> found(s.count());
    std::vector<double> shares(s.count() * std::max(t.corners(), 1U));
    query.nearest(points, found.data());
    query.find(points, found.data());
    query.barycentric(points, found.data(), shares.data());
  });
  const Voronoi none;
  attempt([&] { voronoi(points, t, s.weights); });
  const std::vector<double> low(s.dimension, -1), high(s.dimension, 2);
  attempt([&] { clip_voronoi(points, t, low, high, s.weights); });
  attempt([&] { alpha_shape(points, t, 0.5); });
  attempt([&] { critical_alpha(points, t, true); });
  attempt([&] { concave_hull(points, t, 0.1); });
  attempt([&] { concave_length(points, t, 0.5); });
  attempt([&] {
    std::vector<std::uint32_t> some;
    for (std::uint32_t c = 0; c < t.size(); c += 2) some.push_back(c);
    cell_polygons(points, t, some);
  });
  attempt([&] { minimum_spanning_tree(points, t); });
  attempt([&] { gabriel_graph(points, t); });
  attempt([&] { relative_neighbourhood_graph(points, t); });
  attempt([&] {
    std::vector<double> out(s.count());
    const Interpolator values(points, t, s.rows.data(), 1);
    values.linear(points, out.data());
    values.natural(points, out.data());
  });
  attempt([&] { certify(points, t); });
}

/// A neighbour, a corner, a group or an axis that is wrong, or two that are exchanged: an error, or
/// an answer that means nothing, but no walk without end and nothing read beyond a list.
TEST(TriangulationQuery, WrongListsEnd) {
  std::mt19937_64 random(5);
  for (unsigned d = 1; d <= 4; ++d)
    for (const LiftedSet& s : {random_points(d, 12, d), drawn_grid(d, 30, 4, 1, 0, d)}) {
      const Triangulation whole = triangulate(s);
      for (unsigned i = 0; i < 400; ++i) {
        Triangulation t = whole;
        Array<std::uint32_t>* const lists[] = {&t.neighbours,  &t.neighbours,  &t.cells,
                                               &t.cell_groups, &t.hull_facets, &t.hull_cells};
        Array<std::uint32_t>& list = *lists[random() % std::size(lists)];
        if (list.empty()) continue;
        std::uint32_t& item = list[random() % list.size()];
        const std::uint64_t kind = random() % 4;
        if (kind == 0)
          item = static_cast<std::uint32_t>(random());
        else if (kind == 1)
          std::swap(item, list[random() % list.size()]);
        else if (kind == 2)
          item = list[random() % list.size()];
        else
          list.pop_back();
        expect_answers_or_errors(s, t);
        if (HasFailure()) FAIL() << s.name << ", change " << i;
      }
      for (std::uint32_t axis : {0U, 1U, 7U}) {
        Triangulation t = whole;
        t.axes.back() = axis;
        expect_answers_or_errors(s, t);
        t.axes.push_back(0);
        expect_answers_or_errors(s, t);
      }
    }
}

/// Neighbours of two cells that refer to each other only; and cells whose points have moved,
/// between which a visibility walk goes in a circle.
TEST(TriangulationQuery, WalksRoundAPointEnd) {
  const LiftedSet s = random_points(2, 200, 7);
  Triangulation t = triangulate(s);
  for (std::size_t i = 0; i < t.neighbours.size(); ++i)
    if (t.neighbours[i] == no_index) t.neighbours[i] = 0;
  EXPECT_THROW(voronoi(view_of(s), t), Error);
  std::mt19937_64 random(1);
  for (unsigned i = 0; i < 50; ++i) {
    LiftedSet moved = s;
    std::shuffle(moved.rows.begin(), moved.rows.end(), random);
    expect_answers_or_errors(moved, triangulate(s));
  }
}

}  // namespace triangulation_query_test
}  // namespace cullhull
