// The facet tests that drop points from 4D on: nothing is dropped that lies on or above a facet.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "agreement/point_sets.hpp"
#include "hull/general/facet_planes.hpp"
#include "parallel/dispatch.hpp"

namespace cullhull::internal {
namespace facet_sieve_test {

using testing_support::Random;

constexpr float infinite = std::numeric_limits<float>::infinity();

struct Case {
  unsigned d;
  std::vector<float> planes;
  std::vector<float> y;

  explicit Case(unsigned dimension) : d(dimension), y(d * sieve_block, 0.0F) {}
  void add(const std::vector<float>& normal, float level) {
    planes.insert(planes.end(), normal.begin(), normal.end());
    planes.push_back(level);
  }
  std::vector<std::uint8_t> beneath() const {
    std::vector<std::uint8_t> result(sieve_block, 7);
    beneath_facets(d, planes.data(), planes.size() / (d + 1), y.data(), result.data());
    return result;
  }
};

TEST(FacetSieve, DecidesToTheLastBit) {
  for (unsigned d = sieve_min_dimension; d <= sieve_max_dimension; ++d)
    for (unsigned axis = 0; axis < d; ++axis) {
      Case c(d);
      std::vector<float> normal(d, 0.0F);
      normal[axis] = 1;
      c.add(normal, 0.75F);
      float* y = c.y.data() + axis * sieve_block;
      y[0] = 0.75F;
      y[1] = std::nextafter(0.75F, 0.0F);
      y[2] = std::nextafter(0.75F, 1.0F);
      y[sieve_block - 1] = 0.75F;
      y[sieve_block - 2] = -3;
      const std::vector<std::uint8_t> beneath = c.beneath();
      for (std::size_t k = 0; k < sieve_block; ++k)
        EXPECT_EQ(beneath[k], k == 0 || k == 2 || k + 1 == sieve_block ? 0 : 1) << d << " " << k;
    }
}

TEST(FacetSieve, APlaneThatIsNotKnownDropsNothing) {
  for (unsigned d = sieve_min_dimension; d <= sieve_max_dimension; ++d)
    for (const unsigned facets : {1U, 65U, 200U}) {
      Case c(d);
      for (unsigned i = 0; i + 1 < facets; ++i) c.add(std::vector<float>(d, 0.1F), 0.9F);
      c.add(std::vector<float>(d, 0.0F), -infinite);  // 1 - E, E infinite
      for (const std::uint8_t b : c.beneath()) EXPECT_EQ(b, 0);
    }
}

/// Sums of products of floats in doubles tell all but the closest cases.
TEST(FacetSieve, IsThatOfEveryFacetByItself) {
  Random r(3);
  std::size_t inside = 0, outside = 0;
  for (unsigned d = sieve_min_dimension; d <= sieve_max_dimension; ++d)
    for (const unsigned facets : {1U, 2U, 63U, 64U, 65U, 129U, 1000U}) {
      Case c(d);
      for (unsigned i = 0; i < facets; ++i) {
        std::vector<float> normal(d);
        for (float& n : normal) n = static_cast<float>(r.between(-1, 1));
        c.add(normal, static_cast<float>(r.between(0.5, 1)));
      }
      for (float& v : c.y) v = static_cast<float>(r.between(-0.45, 0.45));
      const std::vector<std::uint8_t> beneath = c.beneath();
      for (std::size_t k = 0; k < sieve_block; ++k) {
        double highest = -1;
        for (unsigned i = 0; i < facets; ++i) {
          const float* n = c.planes.data() + i * (d + 1);
          double sum = -n[d];
          for (unsigned j = 0; j < d; ++j)
            sum += static_cast<double>(n[j]) * c.y[j * sieve_block + k];
          highest = std::max(highest, sum);
        }
        if (std::abs(highest) < 1e-5) continue;
        EXPECT_EQ(beneath[k], highest < 0 ? 1 : 0) << d << "D, " << facets << " facets";
        ++(highest < 0 ? inside : outside);
      }
    }
  EXPECT_GT(inside, 100U);
  EXPECT_GT(outside, 100U);
}

/// One point against groups of facets: every comparison by itself, exactly at its borders.
TEST(SeenFacets, IsThatOfEveryFacetByItself) {
  Random r(5);
  for (unsigned d = sieve_min_dimension; d <= sieve_max_dimension; ++d)
    with_dimension<4, 7, 8>(d, [&](auto k) {
      constexpr unsigned D = k, size = PlaneGroup<D>::size;
      for (const std::size_t count : {1U, 2U, 9U}) {
        std::vector<PlaneGroup<D>> groups(count);
        std::vector<float> y(D);
        for (float& v : y) v = static_cast<float>(r.between(-1, 1));
        y[0] = 0.5F;
        const auto plane = [&](unsigned i, unsigned j) -> float& {
          return groups[i / size].entry[j][i % size];
        };
        for (unsigned i = 0; i < count * size; ++i) {
          if (i % 5 == 0) continue;  // no facet
          for (unsigned j = 0; j < D; ++j) plane(i, j) = static_cast<float>(r.between(-1.5, 1.5));
          plane(i, D) = i % 5 == 1 ? infinite : static_cast<float>(r.between(0, 0.2));
          if (i % 5 != 2) continue;  // the gauge is 1 + E, 1 - E or next to them
          for (unsigned j = 0; j < D; ++j) plane(i, j) = 0;
          plane(i, D) = 0.125F;
          const float level = i % 2 == 0 ? 2.25F : 1.75F, away = i % 3 == 0 ? 0.0F : 4.0F;
          plane(i, 0) = i % 3 == 1 ? level : std::nextafter(level, away);
        }
        std::vector<std::uint8_t> seen(2 * count + seen_room, 0xA5),
            open(2 * count + seen_room, 0x5A);
        const bool any =
            seen_facets(D, groups[0].entry[0], count, y.data(), seen.data(), open.data());
        bool some = false;
        for (unsigned i = 0; i < count * size; ++i) {
          double gauge = 0;
          for (unsigned j = 0; j < D; ++j) gauge += static_cast<double>(plane(i, j)) * y[j];
          const double error = plane(i, D);
          const bool is_seen = (seen[i / 8] >> i % 8 & 1) != 0,
                     is_open = (open[i / 8] >> i % 8 & 1);
          some = some || is_open;
          if (i % 5 != 2 &&
              (std::abs(gauge - 1 - error) < 1e-5 || std::abs(gauge - 1 + error) < 1e-5))
            continue;
          EXPECT_EQ(is_seen, gauge > 1 + error) << D << "D, facet " << i;
          EXPECT_EQ(is_open, !(gauge < 1 - error)) << D << "D, facet " << i;
        }
        EXPECT_EQ(any, some);
      }
    });
}

TEST(SeenFacets, OfNoFacetsIsNone) {
  PlaneGroup<4> group;
  const float y[4] = {1, -1, 1e30F, 0};
  std::uint8_t seen[2 + seen_room], open[2 + seen_room];
  EXPECT_FALSE(seen_facets(4, group.entry[0], 1, y, seen, open));
}

}  // namespace facet_sieve_test
}  // namespace cullhull::internal
