// Eight simplices at a time give the bits that eliminating one at a time gives: the same pivots,
// also where several entries are largest, and the same operations.
#include "result/facets/normal_block.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <random>
#include <vector>

#include "exact/numbers/double_double.hpp"
#include "exact/planes/elimination.hpp"
#include "result/facets/facet_plane.hpp"

namespace cullhull::internal {
namespace normal_block_test {

std::uint64_t bits(double v) { return std::bit_cast<std::uint64_t>(v); }

enum class Kind { random, lattice, dependent, thin, far };

using Corners = std::vector<std::vector<double>>;

Corners draw(std::mt19937_64& random, unsigned k, Kind kind) {
  std::uniform_real_distribution<double> unit(-1, 1);
  Corners corners(k, std::vector<double>(k));
  for (auto& row : corners)
    for (double& v : row) {
      v = unit(random);
      // Zeros of both signs and equal coordinates: many pivots to choose from.
      if (kind == Kind::lattice) v = std::copysign(static_cast<double>(random() % 3), v);
      if (kind == Kind::far) v = std::ldexp(v, static_cast<int>(random() % 100) - 90);
    }
  if (kind == Kind::dependent) {
    corners[k - 1] = corners[1 + random() % (k - 2)];
  } else if (kind == Kind::thin) {  // the last corner nearly in the plane of others
    for (unsigned c = 0; c < k; ++c)
      corners[k - 1][c] = (corners[0][c] + corners[1][c] + corners[2][c]) / 3 +
                          std::ldexp(unit(random), -20 - static_cast<int>(random() % 30));
  }
  return corners;
}

template <class Real>
std::vector<double> alone(const Corners& corners) {
  const auto k = static_cast<unsigned>(corners.size());
  std::vector<Real> rows((k - 1) * elimination_stride(k), Real(0)), normal(k);
  for (unsigned i = 1; i < k; ++i)
    for (unsigned c = 0; c < k; ++c)
      rows[(i - 1) * elimination_stride(k) + c] = difference<Real>(corners[i][c], corners[0][c]);
  eliminate_normal(rows, k, normal.data());
  std::vector<double> rounded;
  for (const Real& v : normal) rounded.push_back(value(v));
  return rounded;
}

TEST(NormalBlock, GivesTheBitsOfOneSimplexAtATime) {
  std::mt19937_64 random(1);
  unsigned zero = 0;
  for (unsigned round = 0; round < 150; ++round) {
    const unsigned k = round % 10 == 9 ? 20 + static_cast<unsigned>(random() % 29) : 3 + round % 12;
    NormalBlock block(k);
    std::vector<Corners> sets;
    for (unsigned lane = 0; lane < NormalBlock::lanes; ++lane) {
      // All kinds beside each other in a block: lanes do not disturb one another.
      sets.push_back(draw(random, k, static_cast<Kind>((round + lane) % 5)));
      for (unsigned j = 0; j < k; ++j)
        for (unsigned c = 0; c < k; ++c) block.corner(j, c)[lane] = sets[lane][j][c];
    }
    for (const bool careful : {false, true}) {
      careful ? block.compute_carefully() : block.compute();
      for (unsigned lane = 0; lane < NormalBlock::lanes; ++lane) {
        const Corners& corners = sets[lane];
        const std::vector<double> n =
            careful ? alone<DoubleDouble>(corners) : alone<double>(corners);
        for (unsigned c = 0; c < k; ++c)
          ASSERT_EQ(bits(block.normal(lane, c)), bits(n[c]))
              << k << "D, round " << round << ", lane " << lane << ", coordinate " << c
              << (careful ? ", double-doubles" : "");
        ASSERT_EQ(bits(block.length(lane)), bits(length(n.data(), k)));
        zero += block.length(lane) == 0;
        double lengths = 1;
        for (unsigned i = 1; i < k; ++i) {
          double square = 0;
          for (unsigned c = 0; c < k; ++c) {
            const double e = corners[i][c] - corners[0][c];
            square += e * e;
          }
          lengths *= std::sqrt(square);
        }
        ASSERT_EQ(bits(block.edges(lane)), bits(lengths));
      }
    }
  }
  EXPECT_GT(zero, 10U);  // dependent edges were tried
}

}  // namespace normal_block_test
}  // namespace cullhull::internal
