// Eight simplices at a time give the bits that one at a time gives.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <random>

#include "exact/determinants/cofactors.hpp"
#include "result/facets/facet_plane.hpp"

namespace cullhull::internal {
namespace facet_kernel_test {

std::uint64_t bits(double v) { return std::bit_cast<std::uint64_t>(v); }

template <unsigned K>
void compare(std::mt19937_64& random, bool lattice) {
  std::uniform_real_distribution<double> unit(-1, 1);
  FacetBlock<K> b;
  const auto draw = [&] {
    // Zeros of both signs and equal coordinates: where the sign of a zero could go astray.
    return lattice ? std::copysign(static_cast<double>(random() % 3), unit(random)) : unit(random);
  };
  for (unsigned lane = 0; lane < b.lanes; ++lane)
    for (unsigned c = 0; c < K; ++c) {
      b.origin[c][lane] = draw();
      for (unsigned j = 0; j < K; ++j) b.corner[j][c][lane] = draw();
    }
  facet_block(b);
  for (unsigned lane = 0; lane < b.lanes; ++lane) {
    double edges[K - 1][K], normal[K];
    double lengths = 1, reach = 1, square = 0;
    for (unsigned i = 1; i < K; ++i) {
      double length = 0, largest = 0;
      for (unsigned c = 0; c < K; ++c) {
        const double v = b.corner[i][c][lane] - b.corner[0][c][lane];
        edges[i - 1][c] = v;
        length += v * v;
        largest = std::max(largest, std::fabs(v));
      }
      lengths *= std::sqrt(length);
      reach *= largest;
    }
    cofactors<K, double>(edges, normal);
    for (unsigned c = 0; c < K; ++c) {
      square += normal[c] * normal[c];
      double sum = 0;
      for (unsigned j = 0; j < K; ++j) sum = sum + (b.corner[j][c][lane] - b.origin[c][lane]);
      ASSERT_EQ(bits(b.normal[c][lane]), bits(normal[c])) << K << "D, coordinate " << c;
      ASSERT_EQ(bits(b.sum[c][lane]), bits(sum)) << K << "D, coordinate " << c;
    }
    ASSERT_EQ(bits(b.length[lane]), bits(std::sqrt(square)));
    ASSERT_EQ(bits(b.edges[lane]), bits(lengths));
    ASSERT_EQ(bits(b.reach[lane]), bits(reach));
  }
}

TEST(FacetKernel, GivesTheBitsOfTheScalarCode) {
  std::mt19937_64 random(1);
  for (unsigned i = 0; i < 300; ++i) {
    const bool lattice = i % 2 == 1;
    compare<3>(random, lattice);
    compare<4>(random, lattice);
    compare<5>(random, lattice);
    compare<6>(random, lattice);
    compare<7>(random, lattice);
    compare<8>(random, lattice);
  }
}

}  // namespace facet_kernel_test
}  // namespace cullhull::internal
