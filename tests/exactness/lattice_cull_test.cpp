#include "cull/lattice_cull.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <set>

#include "cullhull/cullhull.hpp"

namespace cullhull::internal {
namespace {

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
      ASSERT_TRUE(lattice_cull(Array<double>(rows.begin(), rows.end()), n, d, kept));
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
  ASSERT_TRUE(lattice_cull(Array<double>(rows.begin(), rows.end()), 105, 3, kept));
  EXPECT_EQ(kept.size(), 8U);
}

TEST(LatticeCull, DeclinesWhatDoesNotPack) {
  std::mt19937_64 rng(2);
  std::uniform_real_distribution<double> u(-1, 1);
  std::vector<double> rows(3000);
  for (double& v : rows) v = u(rng);
  std::vector<std::uint32_t> kept;
  EXPECT_FALSE(lattice_cull(Array<double>(rows.begin(), rows.end()), 1000, 3, kept));
  for (double& v : rows) v *= 1e-25;  // too small to be told apart by a fixed spacing
  EXPECT_FALSE(lattice_cull(Array<double>(rows.begin(), rows.end()), 1000, 3, kept));
}

TEST(LatticeCull, IsBlindToScale) {
  // The same grid at every magnitude, spacing that no double holds exactly, uneven spacing.
  std::mt19937_64 rng(3);
  std::vector<double> grid(3 * 400);
  for (double& v : grid) v = static_cast<double>(rng() % 6);
  std::vector<std::uint32_t> want, kept;
  ASSERT_TRUE(lattice_cull(Array<double>(grid.begin(), grid.end()), 400, 3, want));
  EXPECT_LT(want.size(), 400U);
  const auto expect_same = [&](const auto& map) {
    std::vector<double> rows = grid;
    for (double& v : rows) v = map(v);
    ASSERT_TRUE(lattice_cull(Array<double>(rows.begin(), rows.end()), 400, 3, kept));
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
      const Certificate c = certify(v, hull);
      EXPECT_TRUE(c.valid) << c.reason;
    }
  }
}

TEST(LatticeCull, EqualPointsLeaveTheFirst) {
  std::vector<double> rows(300, 2.5);
  std::vector<std::uint32_t> kept;
  ASSERT_TRUE(lattice_cull(Array<double>(rows.begin(), rows.end()), 100, 3, kept));
  EXPECT_EQ(kept, std::vector<std::uint32_t>{0});
}

}  // namespace
}  // namespace cullhull::internal
