// Rings of clipped cells after rounding: simple, and the cells still parts of one map.
#include <gmpxx.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "agreement/random_seeds.hpp"
#include "cullhull/triangulation.hpp"
#include "cullhull/voronoi.hpp"

namespace cullhull {
namespace simple_rings_test {

using namespace testing_support;
using Point = std::array<double, 2>;
using Ring = std::vector<Point>;

int turn(const Point& a, const Point& b, const Point& c) {
  const double left = (b[0] - a[0]) * (c[1] - a[1]), right = (b[1] - a[1]) * (c[0] - a[0]);
  const double bound = (std::abs(left) + std::abs(right)) * 1e-15;
  if (std::isfinite(bound) && bound > 1e-290 && std::abs(left - right) > bound)
    return left > right ? 1 : -1;
  const mpq_class x(a[0]), y(a[1]);
  return sgn(mpq_class((mpq_class(b[0]) - x) * (mpq_class(c[1]) - y) -
                       (mpq_class(b[1]) - y) * (mpq_class(c[0]) - x)));
}

bool within(const Point& a, const Point& b, const Point& x) {
  for (unsigned j = 0; j < 2; ++j)
    if (x[j] < std::min(a[j], b[j]) || x[j] > std::max(a[j], b[j])) return false;
  return true;
}

/// Whether two segments have a common point other than one that is an end of both.
bool meet_wrongly(const Point& a, const Point& b, const Point& c, const Point& d) {
  for (unsigned j = 0; j < 2; ++j)
    if (std::max(a[j], b[j]) < std::min(c[j], d[j]) || std::max(c[j], d[j]) < std::min(a[j], b[j]))
      return false;
  const auto inner = [](const Point& p, const Point& q, const Point& x) {
    return x != p && x != q && within(p, q, x) && turn(p, q, x) == 0;
  };
  if (inner(a, b, c) || inner(a, b, d) || inner(c, d, a) || inner(c, d, b)) return true;
  if ((a == c && b == d) || (a == d && b == c)) return true;
  return turn(a, b, c) * turn(a, b, d) < 0 && turn(c, d, a) * turn(c, d, b) < 0;
}

/// Twice the area, exactly.
mpq_class area_of(const Ring& ring) {
  mpq_class sum = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point &a = ring[i], &b = ring[(i + 1) % ring.size()];
    sum += mpq_class(a[0]) * mpq_class(b[1]) - mpq_class(a[1]) * mpq_class(b[0]);
  }
  return sum;
}

/// Whether x is inside the ring and not on it.
bool inside(const Ring& ring, const Point& x) {
  bool in = false;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    const Point &a = ring[i], &b = ring[(i + 1) % ring.size()];
    if (within(a, b, x) && turn(a, b, x) == 0) return false;
    if ((a[1] > x[1]) == (b[1] > x[1])) continue;
    if ((turn(a, b, x) > 0) == (b[1] > a[1])) in = !in;
  }
  return in;
}

std::vector<Ring> rings_of(const ClippedCells& cells, std::uint64_t polygon) {
  std::vector<Ring> rings;
  for (std::uint64_t r = cells.polygon_rings[polygon]; r < cells.polygon_rings[polygon + 1]; ++r) {
    rings.emplace_back();
    for (std::uint64_t v = cells.ring_starts[r]; v < cells.ring_starts[r + 1]; ++v)
      rings.back().push_back({cells.vertices[2 * v], cells.vertices[2 * v + 1]});
  }
  return rings;
}

/// What is wrong with a polygon; empty: nothing.
std::string fault_of(const std::vector<Ring>& rings) {
  std::vector<std::pair<Point, Point>> edges;
  for (const Ring& ring : rings) {
    if (ring.size() < 3) return "a ring of fewer than three corners";
    if (std::set<Point>(ring.begin(), ring.end()).size() != ring.size())
      return "a ring goes through one point twice";
    for (std::size_t i = 0; i < ring.size(); ++i)
      edges.emplace_back(ring[i], ring[(i + 1) % ring.size()]);
    if (sgn(area_of(ring)) != (&ring == &rings[0] ? 1 : -1)) return "a ring runs the wrong way";
    if (&ring != &rings[0] &&
        std::none_of(ring.begin(), ring.end(), [&](const Point& x) { return inside(rings[0], x); }))
      return "a hole outside its outline";
  }
  std::sort(edges.begin(), edges.end(), [](const auto& a, const auto& b) {
    return std::min(a.first, a.second) < std::min(b.first, b.second);
  });
  for (std::size_t i = 0; i < edges.size(); ++i)
    for (std::size_t j = i + 1; j < edges.size(); ++j) {
      const auto& [a, b] = edges[i];
      const auto& [c, d] = edges[j];
      if (std::min(c[0], d[0]) > std::max(a[0], b[0])) break;
      if (meet_wrongly(a, b, c, d)) return "edges cross or touch";
    }
  return {};
}

struct Region {
  std::vector<double> corners;
  std::vector<std::uint64_t> offsets{0};

  void add(const Ring& ring) {
    for (const Point& x : ring) corners.insert(corners.end(), x.begin(), x.end());
    offsets.push_back(corners.size() / 2);
  }
};

/// Sites, and what their diagram is clipped to: rings, or the box of `region`'s two corners.
struct Case {
  std::string name;
  std::vector<double> sites;
  Region region;
  bool box = true;
};

/// Whether x is on the region's boundary, up to rounding.
bool on_boundary(const Case& c, const Point& x) {
  const std::vector<double>& r = c.region.corners;
  if (c.box) return x[0] == r[0] || x[0] == r[2] || x[1] == r[1] || x[1] == r[3];
  for (std::size_t k = 0; k + 1 < c.region.offsets.size(); ++k)
    for (auto i = c.region.offsets[k]; i < c.region.offsets[k + 1]; ++i) {
      const auto j = i + 1 < c.region.offsets[k + 1] ? i + 1 : c.region.offsets[k];
      const double ax = r[2 * i], ay = r[2 * i + 1], ux = r[2 * j] - ax, uy = r[2 * j + 1] - ay,
                   length = std::hypot(ux, uy);
      if (length == 0) continue;
      const double along = std::clamp(((x[0] - ax) * ux + (x[1] - ay) * uy) / length, 0.0, length),
                   dx = x[0] - ax - along * ux / length, dy = x[1] - ay - along * uy / length;
      if (std::hypot(dx, dy) <= 1e-14 * (std::hypot(ax, ay) + length)) return true;
    }
  return false;
}

/// Every ring is simple; each edge is that of another cell the other way round, or on the region's
/// boundary; areas are the measures up to rounding.
void check(const Case& c, const ClippedCells& cells) {
  std::map<std::pair<Point, Point>, std::uint32_t> owner;
  double largest = 0;
  for (const double x : c.region.corners) largest = std::max(largest, std::abs(x));
  for (std::uint32_t i = 0; i < cells.point_count; ++i) {
    double around = largest * largest;  // for what is too thin to have polygons
    mpq_class area = 0;
    for (std::uint64_t p = cells.polygon_offsets[i]; p < cells.polygon_offsets[i + 1]; ++p) {
      const std::vector<Ring> rings = rings_of(cells, p);
      EXPECT_EQ(fault_of(rings), "") << c.name << ", cell " << i;
      for (const Ring& ring : rings) {
        area += area_of(ring) / 2;
        for (std::size_t k = 0; k < ring.size(); ++k) {
          const Point &a = ring[k], &b = ring[(k + 1) % ring.size()];
          around += std::abs(a[0] * b[1]) + std::abs(a[1] * b[0]);
          EXPECT_TRUE(owner.try_emplace(std::pair(a, b), i).second)
              << c.name << ": an edge of cell " << i << " twice";
        }
      }
    }
    EXPECT_NEAR(area.get_d(), cells.measures[i], around * 1e-15) << c.name << ", cell " << i;
  }
  for (std::uint32_t i = 0; i < cells.point_count; ++i)
    for (std::uint64_t r = cells.polygon_rings[cells.polygon_offsets[i]];
         r < cells.polygon_rings[cells.polygon_offsets[i + 1]]; ++r)
      for (std::uint64_t v = cells.ring_starts[r]; v < cells.ring_starts[r + 1]; ++v) {
        const std::uint64_t w = v + 1 < cells.ring_starts[r + 1] ? v + 1 : cells.ring_starts[r];
        const Point a{cells.vertices[2 * v], cells.vertices[2 * v + 1]},
            b{cells.vertices[2 * w], cells.vertices[2 * w + 1]};
        const std::uint32_t other = cells.neighbours[v];
        const auto across = owner.find({b, a});
        if (across == owner.end()) {
          EXPECT_TRUE(on_boundary(c, a) && on_boundary(c, b))
              << c.name << ": only cell " << i << " has the edge at " << a[0] << " " << a[1];
        } else if (other != across->second) {
          // A cell, a part of one or a gap in the region that is too thin to be seen lies between.
          EXPECT_TRUE(other == no_index ? on_boundary(c, a) && on_boundary(c, b)
                                        : !c.box || cells.polygon_offsets[other] ==
                                                        cells.polygon_offsets[other + 1])
              << c.name << ": cell " << across->second << ", not " << other
              << ", is beyond the edge"
              << " of cell " << i << " at " << a[0] << " " << a[1];
        }
      }
}

ClippedCells cells_of(const Case& c) {
  const PointView sites = PointView::row_major(c.sites.data(), c.sites.size() / 2, 2);
  const Triangulation t = delaunay(sites);
  const std::vector<double>& x = c.region.corners;
  if (!c.box)
    return clip_voronoi(sites, t, PointView::row_major(x.data(), x.size() / 2, 2),
                        c.region.offsets);
  return clip_voronoi(sites, t, std::vector<double>{x[0], x[1]}, std::vector<double>{x[2], x[3]});
}

/// Up to some units in the last place beside x.
double beside(double x, std::mt19937_64& random) {
  for (auto steps = random() % 4; steps > 0; --steps)
    x = std::nextafter(x, random() % 2 == 0 ? INFINITY : -INFINITY);
  return x;
}

std::vector<double> hostile_sites(std::mt19937_64& random, double unit, double shift_x,
                                  double shift_y) {
  std::vector<double> sites;
  const auto kind = random() % 4;
  const unsigned n = 2 + static_cast<unsigned>(random() % 14);
  for (unsigned i = 0; i < n; ++i) {
    double x, y;
    if (kind == 2) {  // on circles of few centres
      const double angle = 2 * std::numbers::pi * static_cast<double>(random() % 12) / 12;
      x = 2 * std::cos(angle) + 3 * static_cast<double>(random() % 2);
      y = 2 * std::sin(angle);
    } else {
      x = static_cast<double>(random() % 5) / (kind == 3 ? 3 : 1);
      y = static_cast<double>(random() % 5) * (kind == 1 ? std::sqrt(3) / 2 : 1);
      if (kind == 1 && random() % 2 == 0) x += 0.5;
    }
    sites.push_back(shift_x + unit * x);
    sites.push_back(shift_y + unit * y);
  }
  return sites;
}

/// A corner on or beside a vertex or an edge of the cells.
Point near_diagram(const ClippedCells& cells, std::mt19937_64& random) {
  const std::uint64_t rows = cells.vertices.size() / 2;
  const std::uint64_t v = random() % rows, w = random() % 3 == 0 ? random() % rows : v;
  Point x;
  for (unsigned j = 0; j < 2; ++j)
    x[j] = beside((cells.vertices[2 * v + j] + cells.vertices[2 * w + j]) / 2, random);
  return x;
}

/// A star-shaped ring through the points, around their middle; they may be moved.
Ring star_through(std::vector<Point> points) {
  Point middle{0, 0};
  for (const Point& x : points)
    for (unsigned j = 0; j < 2; ++j) middle[j] += x[j] / static_cast<double>(points.size());
  std::sort(points.begin(), points.end(), [&](const Point& a, const Point& b) {
    return std::atan2(a[1] - middle[1], a[0] - middle[0]) <
           std::atan2(b[1] - middle[1], b[0] - middle[0]);
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

Case hostile_case(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  const double units[] = {0.1, 0.05, 0.01, 1.0 / 12, 0.3, 1e-5, 7e5, 1};
  const double shifts[] = {0, 147.275, -34.975, 0.1, 1e6 + 0.1, -4000.3, 1.0 / 3};
  const double unit = units[random() % 8], shift_x = shifts[random() % 7],
               shift_y = shifts[random() % 7];
  Case c{
      "hostile " + std::to_string(seed), hostile_sites(random, unit, shift_x, shift_y), {}, true};
  double low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
  for (std::size_t i = 0; i < c.sites.size(); ++i) {
    low[i % 2] = std::min(low[i % 2], c.sites[i]);
    high[i % 2] = std::max(high[i % 2], c.sites[i]);
  }
  const double margin = random() % 2 == 0 ? unit : unit / 7;
  c.region.add({{low[0] - margin, low[1] - margin}, {high[0] + margin, high[1] + margin}});
  if (random() % 3 == 0) return c;
  const ClippedCells whole = cells_of(c);
  if (random() % 4 == 0) {
    const Point a = near_diagram(whole, random), b = near_diagram(whole, random);
    for (unsigned j = 0; j < 2; ++j)
      if (a[j] != b[j]) {
        c.region.corners[j] = std::min(a[j], b[j]);
        c.region.corners[2 + j] = std::max(a[j], b[j]);
      }
    return c;
  }
  Case in{c.name + ", polygons", c.sites, {}, false};
  std::vector<Point> corners;
  for (auto n = 3 + random() % 7; n > 0; --n) corners.push_back(near_diagram(whole, random));
  in.region.add(star_through(corners));
  for (auto holes = random() % 3; holes > 0; --holes) {
    const Point x = near_diagram(whole, random), y = near_diagram(whole, random);
    const double r = unit / 64;
    if (random() % 2 == 0)
      in.region.add({{x[0] - r, x[1]}, {x[0], x[1] + r}, {x[0] + r, x[1]}, {x[0], x[1] - r}});
    else
      in.region.add(star_through({x, y, near_diagram(whole, random)}));
  }
  return in;
}

TEST(SimpleRings, HostileRegionsAndGrids) {
  std::uint64_t cells_seen = 0;
  for_random_seeds(20000, [&](std::uint64_t seed) {
    const Case c = hostile_case(seed);
    try {
      const ClippedCells cells = cells_of(c);
      check(c, cells);
      cells_seen += cells.point_count;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::invalid_argument) << c.name << ": " << e.what();
    }
  });
  EXPECT_GT(cells_seen, 20U);
}

/// Stations of real networks have coordinates of two to four decimals, on partly filled grids.
TEST(SimpleRings, StationsOnDecimalGrids) {
  for_random_seeds(130, [&](std::uint64_t seed) {
    std::mt19937_64 random(seed);
    const double steps[] = {0.05, 0.01, 0.1, 0.025, 0.25};
    const double step = steps[random() % 5];
    const auto decimal = [&](double x) { return std::round(x * 1e4) / 1e4; };
    const double x0 = decimal(100 + static_cast<double>(random() % 1000) * step),
                 y0 = decimal(-40 + static_cast<double>(random() % 1000) * step);
    Case c{"stations " + std::to_string(seed), {}, {}, true};
    for (unsigned i = 0; i < 40; ++i)
      for (unsigned j = 0; j < 40; ++j)
        if (random() % 8 < 5) {
          c.sites.push_back(decimal(x0 + i * step));
          c.sites.push_back(decimal(y0 + j * step));
        }
    c.region.add({{x0 - step, y0 - step}, {x0 + 41 * step, y0 + 41 * step}});
    check(c, cells_of(c));
  });
}

/// Four stations of a real network: the two Voronoi vertices are an ulp apart.
TEST(SimpleRings, FourStations) {
  Case c{"four stations",
         {147.275, -34.975, 147.325, -34.975, 147.375, -35.075, 147.375, -35.025},
         {},
         true};
  c.region.add({{147.2, -35.2}, {147.5, -34.9}});
  check(c, cells_of(c));
}

}  // namespace simple_rings_test
}  // namespace cullhull
