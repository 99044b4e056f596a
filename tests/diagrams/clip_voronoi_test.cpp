// Clipped cells: measures against exact rational ones, corners that neighbours share bit for bit.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <tuple>

#include "agreement/random_seeds.hpp"
#include "cullhull/error.hpp"
#include "cullhull/voronoi.hpp"
#include "diagrams/slow_volume.hpp"
#include "thrown.hpp"

namespace cullhull {
namespace clip_voronoi_test {

using namespace testing_support;

struct Box {
  std::vector<double> low, high;
  double measure() const {
    double m = 1;
    for (std::size_t j = 0; j < low.size(); ++j) m *= high[j] - low[j];
    return m;
  }
};

/// Around the points, less a part of them where `within`.
Box box_of(const LiftedSet& s, bool within) {
  Box box{std::vector<double>(s.dimension, 0.0), std::vector<double>(s.dimension, 1.0)};
  for (unsigned j = 0; j < s.dimension && s.count() > 0; ++j) {
    double low = s.rows[j], high = low;
    for (std::uint64_t i = 0; i < s.count(); ++i) {
      low = std::min(low, s.rows[i * s.dimension + j]);
      high = std::max(high, s.rows[i * s.dimension + j]);
    }
    const double margin = high > low ? (high - low) / 8 : 1;
    box.low[j] = low + (within ? margin : -margin);
    box.high[j] = high + (within && high > low ? -margin : 3 * margin);
  }
  return box;
}

double sum_of(const Array<double>& measures) {
  long double sum = 0;
  for (const double m : measures) sum += m;
  return static_cast<double>(sum);
}

using Corner = std::vector<double>;

Corner corner_of(const ClippedCells& cells, std::uint64_t row) {
  const double* x = cells.vertices.data() + row * cells.dimension;
  return {x, x + cells.dimension};
}

/// What one cell lists on its side of a face towards another one the other lists, too: the same
/// edges the other way round, the same corners of a face.
void check_plane_neighbours(const std::string& name, const ClippedCells& cells) {
  std::set<std::tuple<std::uint64_t, std::uint32_t, Corner, Corner>> edges;
  ASSERT_EQ(cells.neighbours.size() * 2, cells.vertices.size()) << name;
  ASSERT_EQ(cells.polygon_offsets.size(), cells.point_count + 1);
  ASSERT_EQ(cells.polygon_rings.size(), cells.polygon_offsets.back() + 1);
  ASSERT_EQ(cells.ring_starts.size(), cells.polygon_rings.back() + 1);
  ASSERT_EQ(cells.ring_starts.back(), cells.neighbours.size());
  for (std::uint64_t i = 0; i < cells.point_count; ++i) {
    const std::uint64_t first_ring = cells.polygon_rings[cells.polygon_offsets[i]],
                        last_ring = cells.polygon_rings[cells.polygon_offsets[i + 1]];
    ASSERT_EQ(cells.ring_starts[first_ring], cells.vertex_offsets[i]);
    ASSERT_EQ(cells.ring_starts[last_ring], cells.vertex_offsets[i + 1]);
    for (std::uint64_t r = first_ring; r < last_ring; ++r) {
      const std::uint64_t begin = cells.ring_starts[r], end = cells.ring_starts[r + 1];
      ASSERT_GE(end - begin, 3U) << name;
      for (std::uint64_t v = begin; v < end; ++v) {
        const Corner a = corner_of(cells, v), b = corner_of(cells, v + 1 < end ? v + 1 : begin);
        EXPECT_NE(a, b) << name;
        EXPECT_LE(corner_of(cells, begin), a) << name;
        if (cells.neighbours[v] != no_index) edges.emplace(i, cells.neighbours[v], a, b);
      }
    }
  }
  for (const auto& [cell, other, a, b] : edges) {
    if (cells.polygon_offsets[other] == cells.polygon_offsets[other + 1]) continue;  // a sliver
    EXPECT_TRUE(edges.count({other, static_cast<std::uint32_t>(cell), b, a}))
        << name << ": edge between " << cell << " and " << other << " at " << a[0] << " " << a[1];
  }
}

void check_space_neighbours(const std::string& name, const ClippedCells& cells) {
  std::map<std::pair<std::uint64_t, std::uint64_t>, std::set<Corner>> faces;
  ASSERT_EQ(cells.face_offsets.size(), cells.point_count + 1);
  ASSERT_EQ(cells.face_offsets.back(), cells.faces.size());
  ASSERT_EQ(cells.faces.offsets.back(), cells.faces.items.size());
  ASSERT_EQ(cells.neighbours.size(), cells.faces.size());
  for (std::uint64_t i = 0; i < cells.point_count; ++i) {
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    const std::uint64_t count = cells.vertex_offsets[i + 1] - cells.vertex_offsets[i];
    EXPECT_EQ(count > 0, cells.face_offsets[i] < cells.face_offsets[i + 1]);
    for (std::uint64_t f = cells.face_offsets[i]; f < cells.face_offsets[i + 1]; ++f) {
      const std::uint64_t begin = cells.faces.offsets[f], end = cells.faces.offsets[f + 1];
      EXPECT_GE(end - begin, 3U) << name;
      for (std::uint64_t v = begin; v < end; ++v) {
        const std::uint32_t a = cells.faces.items[v],
                            b = cells.faces.items[v + 1 < end ? v + 1 : begin];
        ASSERT_LT(a, count);
        ++edges[{a, b}];
        --edges[{b, a}];
        if (cells.neighbours[f] != no_index)
          faces[{i, cells.neighbours[f]}].insert(corner_of(cells, cells.vertex_offsets[i] + a));
      }
    }
    for (const auto& [edge, n] : edges) ASSERT_EQ(n, 0) << name << ": not closed";
  }
  for (const auto& [pair, corners] : faces)
    EXPECT_EQ(corners, (faces[{pair.second, pair.first}])) << name;
}

void check_shapes(const LiftedSet& s, const ClippedCells& cells) {
  ASSERT_EQ(cells.vertex_offsets.size(), s.count() + 1);
  if (s.dimension == 1)
    EXPECT_EQ(cells.neighbours.size(), cells.vertices.size());
  else if (s.dimension == 2)
    check_plane_neighbours(s.name, cells);
  else
    check_space_neighbours(s.name, cells);
}

/// No corner is outside, and the vertices of the diagram that are inside the box are corners of the
/// cells that they belong to.
void check_corners(const LiftedSet& s, const Triangulation& t, const Box& box,
                   const ClippedCells& cells) {
  const unsigned d = s.dimension;
  for (std::size_t i = 0; i < cells.vertices.size(); ++i) {
    EXPECT_LE(box.low[i % d], cells.vertices[i]) << s.name;
    EXPECT_GE(box.high[i % d], cells.vertices[i]) << s.name;
  }
  if (t.affine_dimension != static_cast<int>(d)) return;
  const Voronoi diagram = voronoi(view_of(s), t, s.weights);
  for (std::uint64_t i = 0; i < s.count(); ++i) {
    std::set<Corner> corners;
    for (std::uint64_t v = cells.vertex_offsets[i]; v < cells.vertex_offsets[i + 1]; ++v)
      corners.insert(corner_of(cells, v));
    for (const std::uint32_t v : diagram.region(i)) {
      if (v == at_infinity || corners.empty()) continue;
      const double* x = diagram.vertices.data() + std::size_t{v} * d;
      bool inside = true;
      for (unsigned j = 0; j < d; ++j) inside = inside && box.low[j] < x[j] && x[j] < box.high[j];
      if (inside) {
        EXPECT_TRUE(corners.count(Corner(x, x + d))) << s.name;
      }
    }
  }
}

constexpr double measure_error = 0x1p-42;

void check(const LiftedSet& s, const Box& box, bool furthest = false) {
  TriangulationOptions o;
  o.furthest_site = furthest;
  const Triangulation t = triangulate(s, o);
  const ClippedCells cells = clip_voronoi(view_of(s), t, box.low, box.high, s.weights);
  ASSERT_EQ(cells.measures.size(), s.count());
  const mpq_class whole = slow_volume(box_rows(box.low, box.high), s.dimension);
  const mpq_class largest(1.7e308), least(0x1p-1022);
  mpq_class sum = 0;
  for (std::uint32_t i = 0; i < s.count(); ++i) {
    const mpq_class exact = slow_cell(s, t, i, box_rows(box.low, box.high));
    sum += exact;
    if (exact > largest)
      EXPECT_TRUE(std::isinf(cells.measures[i])) << s.name;
    else
      EXPECT_TRUE(near(cells.measures[i], exact, measure_error, least))
          << s.name << ": " << cells.measures[i] << ", not " << exact.get_d();
  }
  if (s.count() > 0) {
    EXPECT_TRUE(sum == whole) << s.name;
  }
  check_shapes(s, cells);
  check_corners(s, t, box, cells);
}

void check(const LiftedSet& s, bool within, bool furthest = false) {
  check(s, box_of(s, within), furthest);
}

TEST(ClipVoronoi, SmallSetsAreAsDefined) {
  for (unsigned d = 1; d <= 3; ++d)
    for (const LiftedSet& s : sampled(small_lifted_sets(d, 31))) {
      check(s, false);
      check(s, true);
    }
}

TEST(ClipVoronoi, RandomSmallSetsAreAsDefined) {
  for (std::uint64_t seed = 1; seed <= 25; ++seed)
    for (unsigned d = 1; d <= 3; ++d) check(random_lifted_set(d, seed), seed % 2 == 0);
}

TEST(ClipVoronoi, FurthestSite) {
  for (unsigned d = 1; d <= 3; ++d)
    for (const LiftedSet& s : small_lifted_sets(d, 37)) check(s, false, true);
}

TEST(ClipVoronoi, FewPoints) {
  for (unsigned d = 1; d <= 3; ++d)
    for (const LiftedSet& s : few_points(d)) check(s, false);
}

TEST(ClipVoronoi, LargerSetsAddUp) {
  for (unsigned d = 1; d <= 3; ++d)
    for (const LiftedSet& s : sampled(large_lifted_sets(d, d < 3 ? 20000 : 3000))) {
      const Box box = box_of(s, false);
      const Triangulation t = triangulate(s);
      const ClippedCells cells =
          clip_voronoi(view_of(s), t, box.low, box.high, s.weights, {.threads = 1});
      EXPECT_NEAR(sum_of(cells.measures) / box.measure(), 1, 1e-12) << s.name;
      check_shapes(s, cells);
      const ClippedCells again = clip_voronoi(view_of(s), t, box.low, box.high, s.weights,
                                              {.threads = 3, .shapes = false});
      EXPECT_EQ(cells.measures, again.measures);
      EXPECT_TRUE(again.vertices.empty());
    }
}

/// A triangle and a tetrahedron as regions; a box as the hull of its corners is the box.
TEST(ClipVoronoi, ConvexRegions) {
  for (unsigned d = 1; d <= 3; ++d) {
    const LiftedSet s = random_points(d, 200, d);
    const Triangulation t = triangulate(s);
    std::vector<double> corners(d, -0.25);
    for (unsigned j = 0; j < d; ++j) {
      std::vector<double> corner(d, -0.25);
      corner[j] = 2.75;
      corners.insert(corners.end(), corner.begin(), corner.end());
    }
    const ClippedCells cells =
        clip_voronoi(view_of(s), t, PointView::row_major(corners.data(), d + 1, d));
    const double whole = d == 1 ? 3 : d == 2 ? 4.5 : 4.5;
    EXPECT_NEAR(sum_of(cells.measures) / whole, 1, 1e-13) << d;
    check_shapes(s, cells);
    std::vector<double> box;
    for (unsigned i = 0; i < 1U << d; ++i)
      for (unsigned j = 0; j < d; ++j)
        box.push_back(((d == 2 ? i ^ i >> 1 : i) >> j & 1U) != 0 ? 1 : 0);
    const ClippedCells in_hull =
        clip_voronoi(view_of(s), t, PointView::row_major(box.data(), 1U << d, d));
    const ClippedCells in_box =
        clip_voronoi(view_of(s), t, std::vector<double>(d, 0), std::vector<double>(d, 1));
    for (std::uint32_t i = 0; i < s.count(); ++i)
      EXPECT_EQ(in_hull.measures[i], in_box.measures[i]);
    EXPECT_EQ(in_hull.vertices.size(), in_box.vertices.size());
  }
}

TEST(ClipVoronoi, RefusesWhatIsNone) {
  const LiftedSet s = random_points(2, 20, 1);
  const Triangulation t = triangulate(s);
  const auto message = [](const auto& body) { return error_of(ErrorCode::invalid_argument, body); };
  using Numbers = std::vector<double>;
  EXPECT_EQ(message([&] {
              clip_voronoi(view_of(s), t, Numbers{0, 1}, Numbers{1, 1});
            }),
            "the box is empty or not finite along axis 1");
  EXPECT_EQ(message([&] { clip_voronoi(view_of(s), t, Numbers{0}, Numbers{1}); }),
            "a box in dimension 2 needs as many numbers for each corner");
  const Numbers line{0, 0, 1, 1, 2, 2};
  EXPECT_EQ(message([&] { clip_voronoi(view_of(s), t, PointView::row_major(line.data(), 3, 2)); }),
            "the region spans dimension 1 only");
  const auto of_rings = [&](const Numbers& corners, std::vector<std::uint64_t> offsets) {
    const PointView view = PointView::row_major(corners.data(), corners.size() / 2, 2);
    return message([&] { clip_voronoi(view_of(s), t, view, offsets); });
  };
  EXPECT_EQ(of_rings({0, 0, 1, 1}, {0, 2}),
            "ring 0 of the polygon has 2 corners; three are needed");
  EXPECT_EQ(of_rings({0, 0, 1, 1, 0, 0}, {0, 3}),
            "ring 0 of the polygon has 2 corners; three are needed");
  EXPECT_EQ(of_rings({0, 0, 1, 0, 0, 1}, {0, 2}),
            "the rings' offsets do not ascend from 0 to the number of corners");
  EXPECT_EQ(of_rings({7, 0, 4, 0, 46, 0, 7, 0, 7, 1}, {0, 5}),
            "the polygon has no inside: its edges are there an even number of times");
  EXPECT_EQ(of_rings({0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}, {0, 3, 6}),
            "the polygon has no inside: its edges are there an even number of times");
  EXPECT_EQ(of_rings({0, 0, 1, 1, 0, 1, 1, 0}, {0, 4}).substr(0, 41),
            "the boundary of the polygon crosses itsel");
  const LiftedSet far = random_points(4, 20, 1);
  EXPECT_EQ(
      message([&] { clip_voronoi(view_of(far), triangulate(far), Numbers(4, 0), Numbers(4, 1)); }),
      "cells are clipped in dimensions 1 to 3, not in 4");
}

/// Sites and boxes that are far apart, or far from the origin, or of different sizes.
TEST(ClipVoronoi, HostileSetsAreAsDefined) {
  for_random_seeds(60, [&](std::uint64_t seed) {
    std::mt19937_64 random(seed);
    const unsigned d = 1 + static_cast<unsigned>(random() % 3);
    LiftedSet s = random() % 2 == 0 ? random_points(d, 3 + random() % 8, seed)
                                    : drawn_grid(d, 3 + random() % 8, 3, 1, 0, seed);
    const double scales[] = {1, 1e150, 1e-150, 1e16, 1e308, 1e-300, 1e6};
    const double scale = scales[random() % 7];
    for (double& x : s.rows) {
      if (random() % 4 == 0) x = -x;
      x *= random() % 5 == 0 ? scales[random() % 7] : scale;
      if (!std::isfinite(x)) x = 1e308;
    }
    s.name = "hostile " + std::to_string(seed);
    const double half = random() % 2 == 0 ? scale * 0.5 : scales[random() % 7];
    Box box{std::vector<double>(d, -half), std::vector<double>(d, half)};
    if (random() % 3 == 0) box.low[0] = 0;
    check(s, box);
    if (random() % 4 == 0) check(s, box, true);
  });
}

/// Inner cells do not feel how large the box is.
TEST(ClipVoronoi, InnerCellsInLargeBoxes) {
  const LiftedSet s = random_points(2, 300, 5);
  const Triangulation t = triangulate(s);
  const auto in = [&](double half) {
    return clip_voronoi(view_of(s), t, std::vector<double>(2, -half), std::vector<double>(2, half));
  };
  const ClippedCells small = in(8), large = in(1e8), huge = in(1e15);
  std::vector<bool> bounded(s.count(), true);
  for (const std::uint32_t v : t.hull_facets) bounded[v] = false;
  const Voronoi diagram = voronoi(view_of(s), t);
  int inner = 0;
  for (std::uint64_t i = 0; i < s.count(); ++i) {
    bool near = bounded[i];
    for (const std::uint32_t v : diagram.region(i))
      near = near && v != at_infinity && std::abs(diagram.vertices[2 * v]) < 8 &&
             std::abs(diagram.vertices[2 * v + 1]) < 8;
    if (!near) continue;
    ++inner;
    EXPECT_EQ(small.measures[i], large.measures[i]);
    EXPECT_EQ(small.measures[i], huge.measures[i]);
  }
  EXPECT_GT(inner, 200);
}

// ---------------------------------------------------------------------------- polygons

/// Rings, the outer ones counterclockwise and holes clockwise.
struct Polygons {
  std::vector<double> corners;
  std::vector<std::uint64_t> offsets{0};

  void add(const std::vector<double>& ring) {
    corners.insert(corners.end(), ring.begin(), ring.end());
    offsets.push_back(corners.size() / 2);
  }
  PointView view() const { return PointView::row_major(corners.data(), corners.size() / 2, 2); }
};

/// Of the convex cell cut out of the polygons: triangles between the origin and each edge, by their
/// signs.
mpq_class slow_cell_in(const LiftedSet& s, const Triangulation& t, std::uint32_t site,
                       const Polygons& polygons) {
  mpq_class sum = 0;
  for (std::size_t r = 0; r + 1 < polygons.offsets.size(); ++r)
    for (std::uint64_t i = polygons.offsets[r]; i < polygons.offsets[r + 1]; ++i) {
      const std::uint64_t next = i + 1 < polygons.offsets[r + 1] ? i + 1 : polygons.offsets[r];
      const mpq_class ax = polygons.corners[2 * i], ay = polygons.corners[2 * i + 1],
                      bx = polygons.corners[2 * next], by = polygons.corners[2 * next + 1];
      const int sign = sgn(mpq_class(ax * by - ay * bx));
      if (sign == 0) continue;
      const std::vector<Rationals> triangle{
          {sign * ay, -sign * ax, 0},
          {-sign * by, sign * bx, 0},
          {sign * (by - ay), sign * (ax - bx), sign * ((by - ay) * ax + (ax - bx) * ay)}};
      sum += sign * slow_cell(s, t, site, triangle);
    }
  return sum;
}

/// A star around (x, y) with random radii of at most `size`, so that it has dents.
std::vector<double> star(std::mt19937_64& random, double x, double y, double size, unsigned n,
                         bool whole) {
  std::vector<double> ring;
  for (unsigned i = 0; i < n; ++i) {
    const double angle = 2 * 3.14159265358979 * i / n;
    const double radius = size * (0.3 + 0.7 * std::ldexp(static_cast<double>(random() >> 11), -53));
    const double dx = radius * std::cos(angle), dy = radius * std::sin(angle);
    ring.push_back(whole ? std::round(x + dx) : x + dx);
    ring.push_back(whole ? std::round(y + dy) : y + dy);
  }
  return ring;
}

std::vector<double> square(double x, double y, double half, bool hole) {
  std::vector<double> ring{x - half, y - half, x + half, y - half,
                           x + half, y + half, x - half, y + half};
  if (hole) {
    std::swap(ring[2], ring[6]);
    std::swap(ring[3], ring[7]);
  }
  return ring;
}

void check_in(const LiftedSet& s, const Polygons& polygons, bool furthest = false) {
  TriangulationOptions o;
  o.furthest_site = furthest;
  const Triangulation t = triangulate(s, o);
  const ClippedCells cells =
      clip_voronoi(view_of(s), t, polygons.view(), polygons.offsets, s.weights);
  for (std::uint32_t i = 0; i < s.count(); ++i) {
    const mpq_class exact = slow_cell_in(s, t, i, polygons);
    EXPECT_TRUE(near(cells.measures[i], exact, measure_error, mpq_class(0x1p-1022)))
        << s.name << ": " << cells.measures[i] << ", not " << exact.get_d();
    // Rings, of rounded corners, add up to the measure.
    double rings = 0, around = 0;
    for (std::uint64_t r = cells.polygon_rings[cells.polygon_offsets[i]];
         r < cells.polygon_rings[cells.polygon_offsets[i + 1]]; ++r)
      for (std::uint64_t v = cells.ring_starts[r]; v < cells.ring_starts[r + 1]; ++v) {
        const Corner a = corner_of(cells, v),
                     b = corner_of(cells,
                                   v + 1 < cells.ring_starts[r + 1] ? v + 1 : cells.ring_starts[r]);
        rings += (a[0] * b[1] - a[1] * b[0]) / 2;
        around += std::abs(a[0] * b[1]) + std::abs(a[1] * b[0]);
      }
    EXPECT_NEAR(rings, cells.measures[i], around * 1e-15) << s.name;
  }
  check_shapes(s, cells);
}

TEST(ClipVoronoi, PolygonsWithDentsAndHolesAreAsDefined) {
  for_random_seeds(100, [&](std::uint64_t seed) {
    std::mt19937_64 random(seed);
    const bool whole = random() % 2 == 0;
    const auto n = static_cast<unsigned>(1 + random() % 9);
    LiftedSet s = whole ? drawn_grid(2, n, 9, 1, -4, seed) : random_points(2, n, seed);
    if (!whole)
      for (double& x : s.rows) x = 8 * x - 4;
    if (random() % 4 == 0) s = with_weights(s, 4, seed, whole);
    s.name += " seed " + std::to_string(seed);
    Polygons polygons;
    polygons.add(star(random, 0, 0, 6, 5 + random() % 8, false));
    if (random() % 2 == 0) polygons.add(square(0, 0, 0.5, true));    // a hole
    if (random() % 2 == 0) polygons.add(square(0, 0, 0.25, false));  // perhaps an island in it
    if (polygons.offsets.size() == 3 && polygons.corners.back() == 0.25)
      polygons.offsets.pop_back(), polygons.corners.resize(2 * polygons.offsets.back());
    if (random() % 2 == 0) polygons.add(star(random, 20, 1, 5, 6, false));  // another part
    check_in(s, polygons, random() % 5 == 0);
  });
}

/// Corners on bisectors, edges along them, holes that touch them, bisectors through everything.
TEST(ClipVoronoi, PolygonsOnTheLinesOfALattice) {
  LiftedSet s{"lattice", 2, {}, {}};
  for (int i = 0; i < 5; ++i)
    for (int j = 0; j < 5; ++j) s.rows.insert(s.rows.end(), {2.0 * i, 2.0 * j});
  for_random_seeds(10, [&](std::uint64_t seed) {
    std::mt19937_64 random(seed);
    Polygons polygons;
    // Steps along the lattice's lines: corners at odd numbers are vertices of the diagram.
    const double a = 1.0 + static_cast<double>(random() % 3),
                 b = 5.0 + static_cast<double>(random() % 3);
    polygons.add({-1, -1, b, -1, b, a, 9, a, 9, 9, a, 9, a, b, -1, b});
    const double x = 3.0 + static_cast<double>(random() % 3) / 2;
    polygons.add(square(x, x, 0.5, true));
    polygons.add({6, 6, 5, 7, 6, 8, 7, 7});             // touches bisectors with its corners
    polygons.add({11, 0, 13, 0, 13, 2, 12, 1, 11, 2});  // a dent
    polygons.add({13, 2, 15, 2, 15, 4, 13, 4});         // touches the last one
    s.name = "lattice, run " + std::to_string(seed);
    check_in(s, polygons);
  });
}

/// What parts of a region share is no boundary of cells.
TEST(ClipVoronoi, ProvincesAreOneRegion) {
  const LiftedSet s = random_points(2, 40, 3);
  const Triangulation t = triangulate(s);
  Polygons provinces, whole;
  provinces.add({0, 0, 0.5, 0, 0.5, 0.5, 0.5, 1, 0, 1});
  provinces.add({0.5, 0, 1, 0, 1, 1, 0.5, 1, 0.5, 0.5});
  whole.add({0, 0, 1, 0, 1, 1, 0, 1});
  const ClippedCells a = clip_voronoi(view_of(s), t, provinces.view(), provinces.offsets);
  const ClippedCells b = clip_voronoi(view_of(s), t, whole.view(), whole.offsets);
  EXPECT_EQ(a.polygon_offsets, b.polygon_offsets);
  for (std::uint64_t i = 0; i < s.count(); ++i) EXPECT_NEAR(a.measures[i], b.measures[i], 1e-15);
  // A province that lies within another one.
  Polygons within;
  within.add({0, 0, 1, 0, 1, 1, 0, 1});
  within.add(square(0.5, 0.5, 0.25, true));
  within.add(square(0.5, 0.5, 0.25, false));
  const ClippedCells c = clip_voronoi(view_of(s), t, within.view(), within.offsets);
  EXPECT_EQ(c.polygon_offsets, b.polygon_offsets);
  EXPECT_EQ(c.polygon_rings, b.polygon_rings);
}

/// A diagram that the caller has changes no bit; one of other points is refused.
TEST(ClipVoronoi, TakesADiagramThatIsThere) {
  for (const unsigned d : {1U, 2U, 3U})
    for (const LiftedSet& s : {random_points(d, 60, 5), drawn_grid(d, 60, 5, 1, -2, 6)}) {
      const Triangulation t = triangulate(s);
      const Voronoi diagram = voronoi(view_of(s), t, s.weights);
      const Box box = box_of(s, true);
      const auto clip = [&](const Voronoi* known) {
        return clip_voronoi(view_of(s), t, box.low, box.high, s.weights, {.diagram = known});
      };
      const ClippedCells with = clip(&diagram), without = clip(nullptr);
      EXPECT_EQ(with.measures, without.measures) << s.name;
      EXPECT_EQ(with.vertices, without.vertices) << s.name;
      EXPECT_EQ(with.neighbours, without.neighbours) << s.name;

      const LiftedSet other = random_points(d, 59, 5);
      const Voronoi wrong = voronoi(view_of(other), triangulate(other), {});
      EXPECT_THROW(clip(&wrong), Error) << s.name;
      Voronoi damaged = diagram;
      damaged.ridge_points[0] = 60;
      EXPECT_THROW(clip(&damaged), Error) << s.name;
    }
}

TEST(ClipVoronoi, LargePolygonsAddUp) {
  std::mt19937_64 random(1);
  Polygons polygons;
  polygons.add(star(random, 0.5, 0.5, 0.6, 2000, false));
  polygons.add(square(0.5, 0.5, 0.125, true));
  double area = 0;
  for (std::size_t r = 0; r + 1 < polygons.offsets.size(); ++r)
    for (std::uint64_t i = polygons.offsets[r]; i < polygons.offsets[r + 1]; ++i) {
      const std::uint64_t next = i + 1 < polygons.offsets[r + 1] ? i + 1 : polygons.offsets[r];
      area += (polygons.corners[2 * i] * polygons.corners[2 * next + 1] -
               polygons.corners[2 * i + 1] * polygons.corners[2 * next]) /
              2;
    }
  for (const LiftedSet& s : large_lifted_sets(2, 5000)) {
    const Triangulation t = triangulate(s);
    const ClippedCells cells =
        clip_voronoi(view_of(s), t, polygons.view(), polygons.offsets, s.weights, {.threads = 1});
    EXPECT_NEAR(sum_of(cells.measures) / area, 1, 1e-12) << s.name;
    check_shapes(s, cells);
    const ClippedCells again =
        clip_voronoi(view_of(s), t, polygons.view(), polygons.offsets, s.weights, {.threads = 3});
    EXPECT_EQ(cells.measures, again.measures);
    EXPECT_EQ(cells.vertices, again.vertices);
    EXPECT_EQ(cells.ring_starts, again.ring_starts);
    EXPECT_EQ(cells.neighbours, again.neighbours);
  }
}

}  // namespace clip_voronoi_test
}  // namespace cullhull
