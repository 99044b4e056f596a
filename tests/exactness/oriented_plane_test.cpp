// Planes by elimination and the rungs above them, against rational arithmetic and exact rungs.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "exact/orientation/orientation.hpp"
#include "exact/planes/exact_plane.hpp"

namespace cullhull::internal {
namespace oriented_plane_test {

using Points = std::vector<std::vector<double>>;

std::vector<const double*> pointers(const Points& p) {
  std::vector<const double*> r;
  for (const auto& x : p) r.push_back(x.data());
  return r;
}

Points random_points(unsigned count, unsigned d, std::mt19937_64& random) {
  std::uniform_real_distribution<double> uniform(-1, 1);
  Points p(count, std::vector<double>(d));
  for (auto& x : p)
    for (auto& c : x) c = uniform(random);
  return p;
}

/// Sign of the plane through all points but the last against the last; the rung that decided.
Rung decide(unsigned d, const Points& p, Sign& sign) {
  const auto q = pointers(p);
  OrientedPlane plane;
  plane.set(d, q.data());
  Rung rung = Rung::plane;
  sign = plane.side(q[d], &rung);
  return rung;
}

TEST(OrientedPlane, DoublesDecideRandomPointsInAnyDimension) {
  std::mt19937_64 random(1);
  for (const unsigned d : {2U, 3U, 7U, 9U, 12U, 16U, 20U, 25U, 30U, 40U, 50U})
    for (int k = 0; k < (d > 30 ? 3 : 12); ++k) {
      const Points p = random_points(d + 1, d, random);
      Sign sign = Sign::zero;
      EXPECT_EQ(decide(d, p, sign), Rung::filter) << d;
      EXPECT_EQ(sign, orientation_exact(d, pointers(p).data())) << d;
      if (d < 7) continue;
      Rung rung = Rung::plane;
      EXPECT_EQ(orientation(d, pointers(p).data(), &rung), sign);
      EXPECT_EQ(rung, Rung::filter);
    }
}

TEST(OrientedPlane, DoubleDoublesDecideWhatDoublesCannot) {
  std::mt19937_64 random(2);
  for (const unsigned d : {3U, 9U, 12U, 20U})
    for (int k = 0; k < 12; ++k) {
      // Off the plane by about 2^-70 of its extent: far less than doubles can see of this sum.
      Points p = random_points(d + 1, d, random);
      for (auto& x : p) x[0] = std::ldexp(std::round(std::ldexp(x[0], 20)), -20);
      for (unsigned j = 0; j < d; ++j) {
        for (unsigned i = 0; i < 2; ++i)
          p[i][j] = std::ldexp(std::round(std::ldexp(p[i][j], 40)), -40);
        p[d][j] = 0.5 * (p[0][j] + p[1][j]);
      }
      p[d][0] = p[0][0] = p[1][0] = 0;
      p[d][0] = k % 2 == 0 ? 0x1p-70 : -0x1p-70;
      EliminatedPlane doubles;
      const auto q = pointers(p);
      bool known = true;
      ASSERT_TRUE(doubles.set(d, q.data()));
      doubles.side(q[d], known);
      EXPECT_FALSE(known) << d;
      ASSERT_TRUE(doubles.refine());
      const Sign sign = doubles.refined_side(q[d], known);
      EXPECT_TRUE(known) << d;
      EXPECT_EQ(sign, orientation_exact(d, q.data()));
      Sign found = Sign::zero;
      EXPECT_EQ(decide(d, p, found), Rung::filter);
      EXPECT_EQ(found, sign);
    }
}

TEST(OrientedPlane, LatticesNeedNoIntegers) {
  std::mt19937_64 random(3);
  int zeros = 0;
  for (const unsigned d : {7U, 9U, 12U, 20U})
    for (int k = 0; k < 60; ++k) {
      Points p(d + 1, std::vector<double>(d));
      for (auto& x : p)
        for (auto& c : x) c = static_cast<double>(random() % 2) + (k % 2 == 0 ? 0 : 0x1p30);
      // Twice the sum of two edges is in the plane, and not equal to a corner.
      if (k % 3 == 0)
        for (unsigned j = 0; j < d; ++j) p[d][j] = p[1][j] + p[2][j] - p[0][j];
      const auto q = pointers(p);
      EliminatedPlane independent;
      const bool proper = independent.set(d, q.data());
      Sign sign = Sign::positive;
      const Rung rung = decide(d, p, sign);
      EXPECT_EQ(sign, orientation_exact(d, q.data())) << d;
      EXPECT_TRUE(!proper || rung == Rung::filter) << d;
      zeros += proper && sign == Sign::zero;
    }
  EXPECT_GT(zeros, 40);
}

TEST(OrientedPlane, IntegersDecideWhatIsExactlyFlat) {
  std::mt19937_64 random(4);
  for (const unsigned d : {7U, 9U, 12U, 20U, 24U})
    for (int k = 0; k < 6; ++k) {
      // p[d] = p[0] + p[1] - p[2] without rounding, with mantissas too long for any other rung.
      Points p = random_points(d + 1, d, random);
      for (auto& x : p)
        for (auto& c : x) c = std::ldexp(std::round(std::ldexp(c, 50)), -50);
      for (unsigned j = 0; j < d; ++j) p[d][j] = (p[0][j] + p[1][j]) - p[2][j];
      Sign sign = Sign::positive;
      EXPECT_EQ(decide(d, p, sign), Rung::exact) << d;
      EXPECT_EQ(sign, Sign::zero) << d;
      for (int step = 0; step < 2; ++step) {
        p[d][d / 2] = std::nextafter(p[d][d / 2], 4);
        decide(d, p, sign);
        EXPECT_EQ(sign, orientation_exact(d, pointers(p).data())) << d;
        EXPECT_NE(sign, Sign::zero) << d;
      }
    }
}

TEST(OrientedPlane, OneExactPlaneServesManyPoints) {
  std::mt19937_64 random(5);
  for (const unsigned d : {3U, 9U, 15U}) {
    Points p = random_points(d, d, random);
    for (auto& x : p)
      for (auto& c : x) c = std::ldexp(std::round(std::ldexp(c, 50)), -50);
    auto q = pointers(p);
    ExactPlane plane;
    plane.set(d, q.data());
    q.push_back(nullptr);
    for (int k = 0; k < 60; ++k) {
      std::vector<double> x(d);
      for (unsigned j = 0; j < d; ++j) {
        x[j] = (p[0][j] + p[1][j]) - p[2][j];
        if (k % 4 == 1) x[j] = std::ldexp(x[j], static_cast<int>(random() % 1500) - 900);
        if (k % 4 == 2) x[j] = std::nextafter(x[j], random() % 2 == 0 ? 4 : -4);
        if (k % 4 == 3 && random() % 2 == 0) x[j] = p[0][j];
      }
      q[d] = x.data();
      EXPECT_EQ(plane.side(x.data()), orientation_exact(d, q.data())) << d << ' ' << k;
    }
  }
}

TEST(OrientedPlane, AllMagnitudes) {
  std::mt19937_64 random(6);
  const double big = std::numeric_limits<double>::max();
  for (const unsigned d : {2U, 5U, 9U, 11U})
    for (int k = 0; k < 150; ++k) {
      Points p(d + 1, std::vector<double>(d));
      std::vector<int> axis(d);
      for (int& e : axis) e = static_cast<int>(random() % 2098) - 1074;
      for (auto& x : p)
        for (unsigned j = 0; j < d; ++j) {
          const int any = static_cast<int>(random() % 2098) - 1074;
          const int e = k % 3 == 0 ? any : k % 3 == 1 ? axis[j] : axis[0] / 4;
          x[j] = std::ldexp(static_cast<double>(random() % 7) - 3, std::min(e, 1021));
          if (k % 30 == 29 && random() % 8 == 0) x[j] = random() % 2 == 0 ? big : -big;
        }
      Sign sign = Sign::zero;
      decide(d, p, sign);
      EXPECT_EQ(sign, orientation_exact(d, pointers(p).data())) << d << ' ' << k;
    }
}

/// Nearly dependent edges, of every degree: bounds must grow as the condition does.
TEST(OrientedPlane, Slivers) {
  std::mt19937_64 random(7);
  for (const unsigned d : {3U, 6U, 9U, 14U})
    for (int e = 0; e < 120; e += 3) {
      Points p = random_points(d + 1, d, random);
      // The last corner near the span of the others, the point near the plane.
      for (unsigned j = 0; j < d; ++j) {
        p[d - 1][j] = 0.5 * (p[0][j] + p[1][j]) + std::ldexp(p[d - 1][j], -e);
        p[d][j] = 0.25 * p[0][j] + 0.75 * p[1][j] + std::ldexp(p[d][j], -(e % 60));
      }
      Sign sign = Sign::zero;
      decide(d, p, sign);
      EXPECT_EQ(sign, orientation_exact(d, pointers(p).data())) << d << ' ' << e;
    }
}

TEST(OrientedPlane, DependentPointsSpanNoPlane) {
  std::mt19937_64 random(8);
  for (const unsigned d : {3U, 9U, 12U}) {
    Points p = random_points(d + 1, d, random);
    OrientedPlane plane;
    plane.set(d, pointers(p).data());
    EXPECT_TRUE(plane.proper());
    p[d - 1] = p[0];
    plane.set(d, pointers(p).data());
    EXPECT_FALSE(plane.proper());
    EXPECT_EQ(plane.side(p[d].data()), Sign::zero);
  }
}

}  // namespace oriented_plane_test
}  // namespace cullhull::internal
