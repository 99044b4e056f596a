#include "filter/lattice/lattice_cull.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <stop_token>

#include "call_options.hpp"
#include "cullhull/cullhull.hpp"
#include "parallel/threads/run.hpp"
#include "thrown.hpp"

namespace cullhull::internal {
namespace lattice_cull_test {

bool thin(const std::vector<double>& rows, std::uint32_t count, unsigned d,
          std::vector<std::uint32_t>& kept, unsigned threads = 1) {
  const Options options;
  return lattice_cull(Array<double>(rows.begin(), rows.end()), count, d,
                      internal::Run(options).with_threads(threads), kept);
}

/// The obvious reference: a point goes if an equal point comes before it, or if its line along some
/// axis has points of the set on both sides of it.
bool strictly_between(const std::vector<double>& rows, std::uint32_t count, unsigned d,
                      std::uint32_t i) {
  for (unsigned axis = 0; axis < d; ++axis) {
    bool below = false, above = false;
    for (std::uint32_t k = 0; k < count; ++k) {
      bool line = true;
      for (unsigned j = 0; j < d; ++j)
        line = line && (j == axis || rows[k * d + j] == rows[i * d + j]);
      below = below || (line && rows[k * d + axis] < rows[i * d + axis]);
      above = above || (line && rows[k * d + axis] > rows[i * d + axis]);
    }
    if (below && above) return true;
  }
  return false;
}

TEST(LatticeCull, DropsOnlyDuplicatesAndPointsBetweenOthers) {
  std::mt19937_64 rng(1);
  for (unsigned d = 1; d <= 5; ++d)
    for (const double shift : {0.0, 0x1p40, -3.5}) {
      const std::uint32_t n = 300;
      std::vector<double> rows(n * d);
      for (double& v : rows) v = static_cast<double>(rng() % 4) * 0.25 + shift;
      std::vector<std::uint32_t> kept;
      ASSERT_TRUE(thin(rows, n, d, kept));
      EXPECT_TRUE(std::is_sorted(kept.begin(), kept.end()));
      const std::set<std::uint32_t> in(kept.begin(), kept.end());
      EXPECT_LT(in.size(), n);
      std::set<std::vector<double>> seen;
      for (std::uint32_t i = 0; i < n; ++i) {
        const std::vector<double> p(rows.begin() + i * d, rows.begin() + (i + 1) * d);
        const bool first = seen.insert(p).second;
        if (in.count(i) == 0) {
          EXPECT_TRUE(!first || strictly_between(rows, n, d, i)) << "d " << d << " point " << i;
        } else {
          EXPECT_TRUE(first) << "duplicate kept, d " << d << " point " << i;
        }
      }
    }
}

TEST(LatticeCull, AFullGridLeavesItsCorners) {
  std::vector<double> rows;
  for (int x = 0; x < 5; ++x)
    for (int y = 0; y < 7; ++y)
      for (int z = 0; z < 3; ++z) rows.insert(rows.end(), {double(x), double(y), double(z)});
  std::vector<std::uint32_t> kept;
  ASSERT_TRUE(thin(rows, 105, 3, kept));
  EXPECT_EQ(kept.size(), 8U);
}

TEST(LatticeCull, DeclinesWhatDoesNotPack) {
  std::mt19937_64 rng(2);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<double> rows(3000);
  for (double& v : rows) v = u(rng);
  std::vector<std::uint32_t> kept;
  EXPECT_FALSE(thin(rows, 1000, 3, kept));
  for (double& v : rows) v *= 1e-25;  // too small to be told apart by a fixed spacing
  EXPECT_FALSE(thin(rows, 1000, 3, kept));
}

TEST(LatticeCull, IsBlindToScale) {
  // The same grid at every magnitude, spacing that no double holds exactly, uneven spacing.
  std::mt19937_64 rng(3);
  std::vector<double> grid(3 * 400);
  for (double& v : grid) v = static_cast<double>(rng() % 6);
  std::vector<std::uint32_t> want, kept;
  ASSERT_TRUE(thin(grid, 400, 3, want));
  EXPECT_LT(want.size(), 400U);
  const auto expect_same = [&](const auto& map) {
    std::vector<double> rows = grid;
    for (double& v : rows) v = map(v);
    ASSERT_TRUE(thin(rows, 400, 3, kept));
    EXPECT_EQ(kept, want);
  };
  for (int e = -1074; e <= 1020; e += 61) expect_same([e](double v) { return std::ldexp(v, e); });
  expect_same([](double v) { return 0.1 * v - 0.2; });
  const double uneven[] = {-1e308, -1, -5e-324, 0, 1e-300, 1e308};
  expect_same([&](double v) { return uneven[static_cast<int>(v)]; });
}

TEST(LatticeCull, ThePipelineKeepsTinyPoints) {
  // Enough points for the thinning to run, one axis far below the others.
  std::mt19937_64 rng(4);
  std::normal_distribution<double> gauss;
  for (const double scale : {1e-22, 1e-25, 1e-300}) {
    std::vector<double> cloud(3 * 400), plate(3 * 400);
    for (double& v : cloud) v = gauss(rng) * scale;
    for (std::size_t i = 0; i < 400; ++i) {
      plate[3 * i] = static_cast<double>(rng() % 10);
      plate[3 * i + 1] = static_cast<double>(rng() % 10);
      plate[3 * i + 2] = gauss(rng) * scale;
    }
    for (const auto& p : {cloud, plate}) {
      const PointView v = PointView::row_major(p.data(), 400, 3);
      const Hull hull = convex_hull(v);
      EXPECT_EQ(hull.affine_dimension, 3);
      const Certificate c = cullhull::certify(v, hull);
      EXPECT_TRUE(c.valid) << c.reason;
    }
  }
}

/// Ends of lines along the last axis, then the one before, ..., the obvious way.
std::vector<std::uint32_t> thinned_by_maps(const std::vector<double>& rows, std::uint32_t count,
                                           unsigned d) {
  std::vector<std::uint32_t> left(count);
  for (std::uint32_t i = 0; i < count; ++i) left[i] = i;
  for (unsigned axis = d; axis-- > 0;) {
    std::map<std::vector<double>, std::pair<std::uint32_t, std::uint32_t>> ends;
    for (const std::uint32_t i : left) {
      std::vector<double> line(rows.begin() + i * d, rows.begin() + (i + 1) * d);
      line.erase(line.begin() + axis);
      auto& [low, high] = ends.try_emplace(line, i, i).first->second;
      if (rows[i * d + axis] < rows[low * d + axis]) low = i;
      if (rows[i * d + axis] > rows[high * d + axis]) high = i;
    }
    std::set<std::uint32_t> kept;
    for (const auto& line : ends) kept.insert({line.second.first, line.second.second});
    left.assign(kept.begin(), kept.end());
  }
  return left;
}

TEST(LatticeCull, IsThatOfMapsForAnyNumberOfThreads) {
  std::mt19937_64 rng(5);
  const std::uint32_t n = 60000;
  std::vector<std::uint32_t> kept;
  const auto expect_maps = [&](const std::vector<double>& rows, unsigned d, const char* what) {
    const auto want = thinned_by_maps(rows, n, d);
    EXPECT_LT(want.size(), n) << what;
    for (const unsigned threads : {1U, 2U, 3U, 4U, 8U}) {
      kept.clear();
      ASSERT_TRUE(thin(rows, n, d, kept, threads)) << what;
      EXPECT_EQ(kept, want) << what << ", threads " << threads;
    }
  };
  for (const unsigned d : {2U, 3U, 4U}) {
    const double values = std::floor(std::pow(n / 3.0, d > 2 ? 1.0 / (d - 1) : 0.5));
    std::vector<double> rows(n * d);
    for (double& v : rows) v = std::floor(std::uniform_real_distribution<double>(0, values)(rng));
    expect_maps(rows, d, "even steps");
    for (double& v : rows) v = 0.1 * v - 1;
    expect_maps(rows, d, "steps that are rounded");
    for (double& v : rows) v = v * v * v;
    expect_maps(rows, d, "uneven steps");
    for (std::size_t i = 0; i < rows.size(); i += 997) rows[i] = -rows[i];
    expect_maps(rows, d, "minus zero");
  }
  // Few points on many lines: these are found by hashing.
  std::vector<double> rows;
  while (rows.size() < 3 * n) {
    const auto x = static_cast<double>(rng() % 100000), y = static_cast<double>(rng() % 100000);
    for (int k = 0; k < 4; ++k)
      rows.insert(rows.end(), {x, y, static_cast<double>(rng() % 100000)});
  }
  expect_maps(rows, 3, "few lines of many");
}

TEST(LatticeCull, DeclinesWhereLinesAreNotShared) {
  // A third of each axis's values is 1 or -1, and yet no two points share a line.
  const std::vector<double> cube = generate("cube-surface", 5000, 3);
  std::vector<std::uint32_t> kept;
  EXPECT_FALSE(thin(cube, 5000, 3, kept));
  // One line with many points among points that share nothing.
  std::vector<double> rows = generate("ball", 5000, 3);
  for (std::size_t i = 0; i < 1000; ++i) rows[15 * i] = rows[15 * i + 1] = 0.5;
  EXPECT_FALSE(thin(rows, 5000, 3, kept));
  // Each point twice.
  rows = generate("ball", 2500, 3);
  const std::vector<double> again = rows;
  rows.insert(rows.end(), again.begin(), again.end());
  EXPECT_FALSE(thin(rows, 5000, 3, kept));
}

TEST(LatticeCull, Stops) {
  const Options options = testing_support::stopped();
  const std::vector<double> rows = generate("grid:8", 5000, 3);
  std::vector<std::uint32_t> kept;
  testing_support::error_of(ErrorCode::cancelled, [&] {
    lattice_cull(Array<double>(rows.begin(), rows.end()), 5000, 3,
                 internal::Run(options).with_threads(2), kept);
  });
}

TEST(LatticeCull, EqualPointsLeaveTheFirst) {
  std::vector<double> rows(300, 2.5);
  std::vector<std::uint32_t> kept;
  ASSERT_TRUE(thin(rows, 100, 3, kept));
  EXPECT_EQ(kept, std::vector<std::uint32_t>{0});
}

}  // namespace lattice_cull_test
}  // namespace cullhull::internal
