#include "exact/orientation/orientation.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "slow_elimination.hpp"

namespace cullhull::internal {
namespace orientation_test {

/// The slow, obvious reference: rational Gaussian elimination.
Sign reference(unsigned d, const std::vector<std::vector<double>>& p) {
  std::vector<testing_support::Rationals> m(d);
  for (unsigned i = 0; i < d; ++i)
    for (unsigned j = 0; j < d; ++j) m[i].push_back(mpq_class(p[i + 1][j]) - mpq_class(p[0][j]));
  mpq_class determinant;
  testing_support::echelon(m, &determinant);
  return static_cast<Sign>(sgn(determinant));
}

std::vector<const double*> pointers(const std::vector<std::vector<double>>& p) {
  std::vector<const double*> r;
  for (const auto& x : p) r.push_back(x.data());
  return r;
}

void expect_same(unsigned d, const std::vector<std::vector<double>>& p) {
  const auto q = pointers(p);
  const Sign want = reference(d, p);
  EXPECT_EQ(orientation(d, q.data()), want) << "d = " << d;
  EXPECT_EQ(orientation_exact(d, q.data()), want) << "d = " << d;
}

TEST(Orientation, MatchesRationalsOnRandomPoints) {
  std::mt19937_64 rng(1);
  std::normal_distribution<double> gauss;
  for (unsigned d = 1; d <= 10; ++d)
    for (int k = 0; k < 40; ++k) {
      std::vector<std::vector<double>> p(d + 1, std::vector<double>(d));
      for (auto& x : p)
        for (auto& c : x) c = gauss(rng);
      expect_same(d, p);
    }
}

TEST(Orientation, MatchesRationalsOnSmallGrids) {
  std::mt19937_64 rng(2);
  for (unsigned d = 1; d <= 9; ++d)
    for (int k = 0; k < 60; ++k) {
      std::vector<std::vector<double>> p(d + 1, std::vector<double>(d));
      const double shift = k % 2 == 0 ? 0 : 0x1p40;
      for (auto& x : p)
        for (auto& c : x) c = static_cast<double>(rng() % 3) + shift;
      expect_same(d, p);
    }
}

TEST(Orientation, MatchesRationalsOneUlpFromTheHyperplane) {
  std::mt19937_64 rng(3);
  std::uniform_real_distribution<double> u(-1, 1);
  for (unsigned d = 2; d <= 8; ++d)
    for (int k = 0; k < 40; ++k) {
      std::vector<std::vector<double>> p(d + 1, std::vector<double>(d));
      for (auto& x : p)
        for (auto& c : x) c = u(rng);
      for (unsigned j = 0; j < d; ++j) p[d][j] = 0.5 * (p[0][j] + p[1][j]);
      expect_same(d, p);
      for (int step = 0; step < 3; ++step) {
        p[d][0] = std::nextafter(p[d][0], 2);
        expect_same(d, p);
      }
    }
}

TEST(Orientation, MatchesRationalsAcrossAllMagnitudes) {
  std::mt19937_64 rng(4);
  for (unsigned d = 2; d <= 6; ++d)
    for (int k = 0; k < 60; ++k) {
      std::vector<std::vector<double>> p(d + 1, std::vector<double>(d));
      for (auto& x : p)
        for (auto& c : x) {
          const int e = static_cast<int>(rng() % 2098) - 1074;
          c = std::ldexp(static_cast<double>(rng() % 7) - 3, e > 1021 ? 1021 : e);
        }
      expect_same(d, p);
    }
  const double big = std::numeric_limits<double>::max();
  const double tiny = std::numeric_limits<double>::denorm_min();
  expect_same(2, {{-big, -big}, {big, big}, {tiny, 0}});
  expect_same(2, {{-big, -big}, {big, big}, {0, 0}});
  expect_same(3, {{0, 0, 0}, {tiny, 0, 0}, {0, tiny, 0}, {0, 0, tiny}});
}

TEST(Orientation, RungsAreThoseTheLadderPromises) {
  Rung rung = Rung::plane;
  const std::vector<std::vector<double>> easy = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  EXPECT_EQ(orientation(3, pointers(easy).data(), &rung), Sign::positive);
  EXPECT_EQ(rung, Rung::filter);
  auto flat = easy;
  flat[3] = {0.25, 0.25, 0};
  EXPECT_EQ(orientation(3, pointers(flat).data(), &rung), Sign::zero);
  EXPECT_EQ(rung, Rung::filter);  // equal on one axis
  flat = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0.25, 0.25, 0.5}};
  EXPECT_EQ(orientation(3, pointers(flat).data(), &rung), Sign::zero);
  EXPECT_EQ(rung, Rung::exact);
  auto near = easy;
  near[3] = {0.25, 0.25, 0x1p-330};  // tiny, but its permanent is as tiny: the filter knows
  EXPECT_EQ(orientation(3, pointers(near).data(), &rung), Sign::positive);
  near = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1.0 / 3, 1.0 / 3, 1.0 / 3}};  // 1/3 is rounded down
  EXPECT_EQ(orientation(3, pointers(near).data(), &rung), Sign::negative);
  EXPECT_EQ(rung, Rung::exact);
}

TEST(OrientationFromCentroid, MatchesRationals) {
  std::mt19937_64 rng(6);
  std::normal_distribution<double> gauss;
  for (unsigned d = 2; d <= 9; ++d)
    for (int k = 0; k < 40; ++k) {
      // Twice the same simplex size keeps the centroid a double, so the reference can use it.
      std::vector<std::vector<double>> p(d, std::vector<double>(d)),
          s(d + 1, std::vector<double>(d));
      const bool grid = k % 2 == 0;
      for (auto* list : {&p, &s})
        for (auto& x : *list)
          for (auto& c : x) c = grid ? static_cast<double>(rng() % 3) : gauss(rng);
      std::vector<double> o(d);
      for (unsigned j = 0; j < d; ++j) {
        if (!grid)
          for (auto& x : s) x[j] = std::ldexp(std::round(std::ldexp(x[j], 20)), -20);
        double sum = 0;
        for (unsigned i = 1; i <= d; ++i) sum += s[i][j];
        s[0][j] = (d + 1) * std::round(sum) - sum;  // centroid: round(sum)
        o[j] = std::round(sum);
      }
      std::vector<std::vector<double>> q = {o};
      q.insert(q.end(), p.begin(), p.end());
      EXPECT_EQ(orientation_from_centroid_exact(d, pointers(p).data(), pointers(s).data()),
                reference(d, q))
          << "d = " << d;
    }
}

TEST(AffineRank, FindsFlatsAndTheirColumns) {
  unsigned columns[4];
  const std::vector<std::vector<double>> line = {{1, 2, 3}, {1, 4, 7}, {1, 3, 5}};
  EXPECT_EQ(affine_rank_exact(3, pointers(line).data(), 3, columns), 1U);
  EXPECT_EQ(columns[0], 1U);
  const std::vector<std::vector<double>> plane = {
      {0, 0, 0, 0}, {1, 1, 0, 0}, {0, 0, 0, 5}, {2, 2, 0, 5}};
  EXPECT_EQ(affine_rank_exact(4, pointers(plane).data(), 4, columns), 2U);
  EXPECT_EQ(columns[0], 0U);
  EXPECT_EQ(columns[1], 3U);
  const std::vector<std::vector<double>> same = {{1, 1}, {1, 1}};
  EXPECT_EQ(affine_rank_exact(2, pointers(same).data(), 2), 0U);
  EXPECT_EQ(affine_rank_exact(2, pointers(same).data(), 1), 0U);
}

TEST(PlaneExact, AgreesWithOrientation) {
  std::mt19937_64 rng(5);
  std::normal_distribution<double> gauss;
  for (unsigned d = 2; d <= 9; ++d)
    for (int k = 0; k < 30; ++k) {
      std::vector<std::vector<double>> p(d + 1, std::vector<double>(d));
      for (auto& x : p)
        for (auto& c : x) c = gauss(rng);
      std::vector<double> n(d);
      const auto q = pointers(p);
      ASSERT_TRUE(plane_exact(d, q.data(), n.data()));
      double dot = 0, largest = 0;
      for (unsigned j = 0; j < d; ++j) {
        dot += n[j] * (p[d][j] - p[0][j]);
        largest = std::max(largest, std::abs(n[j]));
      }
      EXPECT_EQ(sign_of(dot), orientation(d, q.data())) << "d = " << d;
      EXPECT_GE(largest, 0.5);
      EXPECT_LE(largest, 1.0);
    }
}

TEST(PlaneExact, IsAccurateOnSlivers) {
  // The exact normal of these three points is (-e, -e, 1) / (scale); doubles lose it entirely.
  const double e = 0x1p-60;
  const std::vector<std::vector<double>> p = {{1, 0, e}, {0, 1, e}, {0.5, 0.5 + 0x1p-53, e}};
  double n[3];
  ASSERT_TRUE(plane_exact(3, pointers(p).data(), n));
  EXPECT_EQ(n[0], 0);
  EXPECT_EQ(n[1], 0);
  EXPECT_NE(n[2], 0);
  const std::vector<std::vector<double>> dependent = {{0, 0, 0}, {1, 1, 1}, {3, 3, 3}};
  EXPECT_FALSE(plane_exact(3, pointers(dependent).data(), n));
}

}  // namespace orientation_test
}  // namespace cullhull::internal
