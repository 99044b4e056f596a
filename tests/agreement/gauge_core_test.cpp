// What comes before the GaugeMap's own test, its core, changes no survivor.
#include <gtest/gtest.h>
#include <hwy/highway.h>

#include <cmath>
#include <limits>
#include <random>
#include <string>

#include "cullhull/generate.hpp"
#include "cullhull/options.hpp"
#include "filter/gauge/gauge_build.hpp"
#include "filter/gauge/gauge_map.hpp"
#include "filter/gauge/gauge_table.hpp"
#include "flow/sample_map.hpp"
#include "parallel/threads/run.hpp"
#include "tests/made_sets.hpp"

namespace cullhull::internal::gauge_core_test {

using namespace testing_support;

const double bad[] = {NAN, INFINITY, -INFINITY, 1e308, 1e39, 0, -0.0, 1e-310};

std::unique_ptr<GaugeMap> map_of(Array<double>&& sample, unsigned d, unsigned resolution = 0) {
  return GaugeMap::build(inner_polytope(std::move(sample), d, internal::short_run()), resolution);
}

std::vector<std::uint32_t> survivors(const GaugeTable& t, const PointView& view,
                                     const GaugeCore* core = nullptr) {
  std::vector<std::uint32_t> ids(view.count);
  ids.resize(gauge_survivors(t, view, 0, view.count, ids.data(), core));
  return ids;
}

/// Points in the map's frame, as columns.
std::vector<float> frame_columns(const GaugeTable& t, const std::vector<double>& rows) {
  const std::size_t d = t.dimension, n = rows.size() / d;
  std::vector<float> columns(rows.size());
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < d; ++j)
      columns[j * n + i] = static_cast<float>(rows[i * d + j] * t.scale[j] - t.offset[j]);
  return columns;
}

std::optional<GaugeCore> core_for(const GaugeTable& t, const std::vector<double>& rows,
                                  unsigned threads = 1) {
  return make_core(t, frame_columns(t, rows), static_cast<std::uint32_t>(rows.size() / t.dimension),
                   threads);
}

/// As the kernel tests it.
bool in_core(const GaugeCore& c, unsigned d, const double* y) {
  double square = 0, most = 0, sum = 0, least = std::numeric_limits<double>::infinity();
  for (unsigned j = 0; j < d; ++j) {
    const double z = c.weight[j] * std::abs(y[j]);
    square += z * std::abs(y[j]);
    most = std::max(most, z);
    least = std::min(least, z);
    sum += z;
  }
  return c.kind == GaugeCore::Kind::round
             ? square < c.radius[0]
             : most < c.radius[0] && sum - least < c.radius[1] && sum < c.radius[2];
}

struct Views {
  Views(const std::vector<double>& from, unsigned d)
      : rows(from), single(from.begin(), from.end()), columns(transposed(from, d)) {
    const std::uint64_t n = rows.size() / d;
    all = {PointView::row_major(rows.data(), n, d), PointView::row_major(single.data(), n, d),
           PointView::column_major(columns.data(), n, d)};
  }
  std::vector<double> rows;
  std::vector<float> single;
  std::vector<double> columns;
  std::vector<PointView> all;
};

/// In all layouts and scalars, and for all instruction sets.
void expect_same(const GaugeTable& t, const std::vector<double>& rows, const GaugeCore& core,
                 const std::string& what) {
  for (const PointView& view : Views(rows, t.dimension).all)
    for (const std::int64_t target : hwy::SupportedAndGeneratedTargets()) {
      hwy::SetSupportedTargetsForTest(target);
      const auto without = survivors(t, view);
      EXPECT_EQ(survivors(t, view, &core), without) << what << ", " << hwy::TargetName(target);
      EXPECT_LT(without.size(), view.count) << what;
    }
  hwy::SetSupportedTargetsForTest(0);
}

std::vector<double> thin(std::vector<double> rows, unsigned d) {
  for (std::size_t i = 0; i < rows.size(); i += d) rows[i] *= 0.03;
  return rows;
}

TEST(GaugeCore, DropsNothingElseIn3D) {
  unsigned cores = 0;
  for (const char* shape : {"octahedron", "ball", "cube", "cone"})
    for (const unsigned resolution : {0U, 2U, 7U, 33U, 81U, 300U}) {
      const std::vector<double> made = thin(generate(shape, 3000, 3), 3);
      const auto map = map_of({made.begin(), made.end()}, 3, resolution);
      ASSERT_TRUE(map);
      const GaugeTable& t = map->table();
      const auto core = core_for(t, made);
      if (!core) continue;
      ++cores;
      // Odd, so that blocks and chunks end before they are full.
      std::vector<double> rows = thin(generate(shape, gauge_chunk - 11, 3, 2), 3);
      for (std::size_t e = 0; e < 200; ++e) rows[e * 7] = bad[e % std::size(bad)];
      const std::string what = std::string(shape) + ", resolution " + std::to_string(resolution);
      expect_same(t, rows, *core, what);
    }
  EXPECT_GE(cores, 12U);
}

TEST(GaugeCore, DropsNothingElseInAnyDimension) {
  const unsigned samples[] = {0, 0, 3000, 3000, 2000, 1000, 400};
  unsigned round = 0, cut = 0;
  for (unsigned d = 2; d <= 6; ++d)
    for (const char* shape : {"octahedron", "ball", "cube", "gauss"}) {
      const std::vector<double> made = thin(generate(shape, samples[d], d), d);
      const auto map = map_of({made.begin(), made.end()}, d);
      ASSERT_TRUE(map);
      const GaugeTable& t = map->table();
      std::vector<double> rows = thin(generate(shape, 5003, d, 2), d);
      std::vector<double> nearer = rows;
      for (double& x : nearer) x *= d <= 3 ? 1 : 0.6;  // so that a core pays in 6D as well
      const auto core = core_for(t, nearer);
      if (!core) continue;
      (core->kind == GaugeCore::Kind::round ? round : cut) += 1;
      for (std::size_t e = 0; e < 200; ++e) rows[e * 7] = bad[e % std::size(bad)];
      expect_same(t, rows, *core, std::string(shape) + " " + std::to_string(d) + "D");
    }
  EXPECT_GE(round, 5U);
  EXPECT_GE(cut, 2U);
}

// Where the core comes closest to the border of what the map drops: through nodes, along cells'
// edges, and in any direction. A core a little larger would hold points that the map keeps.
TEST(GaugeCore, TouchesTheMapFromInside) {
  const unsigned samples[] = {0, 0, 100, 400, 300, 200, 100};
  unsigned round = 0, cut = 0;
  for (unsigned d = 2; d <= 6; ++d)
    for (const char* shape : {"octahedron", "ball", "cube"}) {
      const std::vector<double> made = generate(shape, samples[d], d, 5);
      const auto map = map_of({made.begin(), made.end()}, d);
      ASSERT_TRUE(map);
      const GaugeTable& t = map->table();
      std::vector<double> some = made;
      for (double& x : some) x *= d <= 3 ? 0.8 : 0.5;  // so that a core pays
      const auto core = core_for(t, some);
      if (!core) continue;
      (core->kind == GaugeCore::Kind::round ? round : cut) += 1;
      std::mt19937_64 random(d);
      std::normal_distribution<double> normal;
      std::vector<double> rows, larger;
      // Radii come in steps of a sixteenth; beyond 4D cells are wide.
      const double slack = d <= 4 ? 1.15 : 1.3;
      for (unsigned k = 0; k < 30000; ++k) {
        double v[6], norm = 0;
        for (unsigned j = 0; j < d; ++j) {
          v[j] = normal(random);
          norm = std::max(norm, std::abs(v[j]));
        }
        for (unsigned j = 0; j < d; ++j) {
          v[j] /= norm;
          // To a line of the grid, or nearly.
          if (k % 3 == 0 || (k % 3 == 1 && random() % 2))
            v[j] = std::round((v[j] + 1) / 2 * t.cells) * 2 / t.cells - 1;
          if (random() % 8 == 0) v[j] = std::nextafter(static_cast<float>(v[j]), 0.0F);
        }
        double low = 0, high = 64;
        for (unsigned step = 0; step < 40; ++step) {
          const double along = (low + high) / 2;
          double y[6];
          for (unsigned j = 0; j < d; ++j) y[j] = along * v[j];
          (in_core(*core, d, y) ? low : high) = along;
        }
        for (unsigned j = 0; j < d; ++j) {
          rows.push_back((low * v[j] + t.offset[j]) / t.scale[j]);
          larger.push_back((slack * low * v[j] + t.offset[j]) / t.scale[j]);
        }
      }
      const auto view = [&](const std::vector<double>& r) {
        return PointView::row_major(r.data(), r.size() / d, d);
      };
      const std::string what = std::string(shape) + " " + std::to_string(d) + "D";
      EXPECT_TRUE(survivors(t, view(rows)).empty()) << what;
      EXPECT_FALSE(survivors(t, view(larger)).empty()) << what << ": the core could be larger";
    }
  EXPECT_GE(round, 4U);
  EXPECT_GE(cut, 2U);
}

TEST(GaugeCore, OnlyWhereItHoldsMuch) {
  const auto map = map_of(
      [] {
    const std::vector<double> made = generate("ball", 3000, 3);
    return Array<double>(made.begin(), made.end());
      }(),
      3);
  ASSERT_TRUE(map);
  EXPECT_FALSE(core_for(map->table(), generate("sphere", 1000, 3)));
  const std::vector<double> ball = generate("ball", 1000, 3);
  const auto one = core_for(map->table(), ball), two = core_for(map->table(), ball, 3);
  ASSERT_TRUE(one && two);
  EXPECT_EQ(one->kind, GaugeCore::Kind::round);
  EXPECT_EQ(one->kind, two->kind);
  for (unsigned j = 0; j < 3; ++j) {
    EXPECT_EQ(one->weight[j], two->weight[j]);
    EXPECT_EQ(one->radius[j], two->radius[j]);
  }
}

// Stretches where the core drops nothing, others where it drops all: it rests and comes back.
TEST(GaugeCore, RestsAndComesBack) {
  const auto map = GaugeMap::build(cross_polytope(3, 0.125, 1), 20);
  ASSERT_TRUE(map);
  const GaugeTable& t = map->table();
  const std::vector<double> ball = generate("ball", 1000, 3);
  std::vector<double> near;
  for (const double x : ball) near.push_back(0.125 + 0.4 * x);
  const auto core = core_for(t, near);
  ASSERT_TRUE(core);
  std::mt19937_64 random(4);
  std::normal_distribution<double> normal;
  for (const unsigned stretch : {1U, 63U, 64U, 65U, 256U, 300U, 1000U, 5000U}) {
    std::vector<double> rows;
    for (unsigned k = 0; rows.size() < 3 * gauge_chunk; ++k) {
      // Deep inside, between core and border, beyond.
      const double reach[] = {0.2, 0.95, 1.5};
      double v[3], sum = 0;
      for (double& x : v) x = normal(random), sum += std::abs(x);
      for (const double x : v) rows.push_back(0.125 + x / sum * reach[k / stretch % 3]);
    }
    expect_same(t, rows, *core, "stretches of " + std::to_string(stretch));
  }
}

}  // namespace cullhull::internal::gauge_core_test
