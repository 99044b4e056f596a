// The 3D ladder against exact arithmetic alone, on points chosen to be hard: nearly or exactly
// coplanar, thin, on lattices of every width.
#include "exact/orientation/orientation_3d.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

namespace cullhull::internal {
namespace orientation_3d_test {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double symmetric() { return std::ldexp(static_cast<double>(engine_() >> 11), -52) - 1; }
  std::uint32_t below(std::uint32_t n) { return static_cast<std::uint32_t>(engine_() % n); }

 private:
  std::mt19937_64 engine_;
};

struct Cloud {
  std::vector<double> rows;
  std::uint32_t simplex[4];
  LocalPoints points;

  explicit Cloud(std::vector<double>&& from) : rows(std::move(from)) {
    points.dimension = 3;
    points.count = static_cast<std::uint32_t>(rows.size() / 3);
    points.coordinates = points.exact = rows.data();
  }
  bool find_simplex(Random& random) {
    for (unsigned attempt = 0; attempt < 1000; ++attempt) {
      const double* p[4];
      for (unsigned i = 0; i < 4; ++i) p[i] = points.row(simplex[i] = random.below(points.count));
      if (orientation_exact(3, p) != Sign::zero) return true;
    }
    return false;
  }
};

struct Seen {
  RungCounts rungs;
  std::uint64_t zeros = 0;
};

/// Every answer must be that of exact arithmetic.
Seen attack(Cloud&& cloud, std::uint64_t seed, unsigned count = 20000) {
  Random random(seed);
  Seen seen;
  if (!cloud.find_simplex(random)) {
    ADD_FAILURE() << "flat";
    return seen;
  }
  const Orientation3D ladder(cloud.points, cloud.simplex);
  for (unsigned k = 0; k < count; ++k) {
    Orientation3D::Point p[4];
    const double* rows[4];
    const double* simplex[4];
    for (unsigned i = 0; i < 4; ++i) {
      std::uint32_t id = 0;
      do {  // different points, or most zeros would be of no interest
        id = random.below(cloud.points.count);
      } while (std::any_of(p, p + i, [&](const auto& q) { return q.id == id; }));
      rows[i] = cloud.points.row(id);
      p[i] = {rows[i], id};
      simplex[i] = cloud.points.row(cloud.simplex[i]);
    }
    const Sign side = orientation_exact(3, rows);
    EXPECT_EQ(ladder.side(p[0], p[1], p[2], p[3], seen.rungs), side) << "seed " << seed;
    const Sign cone = orientation_from_centroid_exact(3, rows, simplex);
    EXPECT_EQ(ladder.cone_side(p[0], p[1], p[2], seen.rungs), cone) << "seed " << seed;
    seen.zeros += static_cast<std::uint64_t>(side == Sign::zero);
    if (::testing::Test::HasFailure()) break;
  }
  return seen;
}

/// A plane through the origin that no double but a few lie on.
std::vector<double> near_plane(Random& random, unsigned n, double extent, double thickness) {
  std::vector<double> rows;
  for (unsigned i = 0; i < n; ++i) {
    const double x = extent * random.symmetric(), y = extent * random.symmetric();
    rows.insert(rows.end(),
                {0.3 + x, -0.2 + y, 0.1 + x / 3 + y / 7 + thickness * random.symmetric()});
  }
  return rows;
}

TEST(Orientation3D, GeneralPosition) {
  Random random(1);
  std::vector<double> rows(3 * 2000);
  for (double& v : rows) v = random.symmetric();
  const Seen seen = attack(Cloud(std::move(rows)), 1);
  EXPECT_EQ(seen.rungs.of[2], 0U);
}

TEST(Orientation3D, AsThinAsRounding) {
  for (const double extent : {0.5, 1e-3, 1e-7})
    for (const double thickness : {0.0, 1e-16, 1e-14, 1e-9}) {
      Random random(2);
      const Seen seen = attack(Cloud(near_plane(random, 500, extent, thickness * extent)), 3);
      if (thickness <= 1e-16) {
        EXPECT_GT(seen.rungs.of[2], 0U);
      }
    }
}

// The double-double filter must not decide what it cannot: heights far below its resolution.
TEST(Orientation3D, BelowDoubleDoubles) {
  Random random(4);
  std::vector<double> rows;
  for (unsigned i = 0; i < 300; ++i)
    rows.insert(rows.end(), {random.symmetric(), random.symmetric(),
                             i % 3 == 0 ? 0x1p-400 * random.symmetric() : 0.0});
  const Seen seen = attack(Cloud(std::move(rows)), 5);
  EXPECT_GT(seen.zeros, 0U);
  rows.clear();
  for (unsigned i = 0; i < 300; ++i) {
    // On x = y but for denormals; z tells the three points apart.
    const double x = random.symmetric();
    rows.insert(rows.end(), {x, i % 4 == 0 ? std::nextafter(x, 2) : x, random.symmetric()});
  }
  attack(Cloud(std::move(rows)), 6);
}

TEST(Orientation3D, Lattices) {
  for (const unsigned bits : {2U, 5U, 15U, 30U, 38U, 41U, 52U}) {
    Random random(bits);
    std::vector<double> rows(3 * 300);
    for (double& v : rows)
      v = std::round(std::ldexp(random.symmetric(), bits)) / std::ldexp(1, bits);
    // Exactly coplanar ones too.
    for (std::size_t i = 0; i < 150; i += 3) rows[i + 2] = rows[i] - rows[i + 1] / 2;
    for (std::size_t i = 0; i < 150; i += 3)
      if (std::abs(rows[i + 2]) > 1) rows[i + 2] = rows[i];
    Cloud cloud(std::move(rows));
    if (bits <= 5) cloud.points.small_lattice = true;  // (5 + 2) * 3 + 3 bits: exact in doubles
    const Seen seen = attack(std::move(cloud), 7);
    if (bits == 2) {
      EXPECT_GT(seen.zeros, 0U);
    }
  }
}

TEST(Orientation3D, AxisPlanes) {
  Random random(8);
  std::vector<double> rows(3 * 400);
  for (double& v : rows) v = random.symmetric();
  for (std::size_t i = 0; i < rows.size(); i += 3) rows[i + i / 3 % 3] = i % 2 == 0 ? 1 : -1;
  const Seen seen = attack(Cloud(std::move(rows)), 9);
  EXPECT_GT(seen.zeros, 0U);
}

}  // namespace orientation_3d_test
}  // namespace cullhull::internal
