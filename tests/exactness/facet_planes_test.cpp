// Searches for violations of the error bound stored with a facet's plane: |g~ - g| <= E max(1,
// |g|), against rational arithmetic, on regular, thin, tiny, far and nearly degenerate facets.
#include "hull/general/facet_planes.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <numeric>
#include <vector>

#include "agreement/point_sets.hpp"
#include "exact/numbers/rationals.hpp"

namespace cullhull::internal {
namespace facet_planes_test {

using testing_support::Random;

/// n with n . (v_i - O) = 1 for the facet's vertices; empty if there is none.
std::vector<mpq_class> exact_plane(const PlaneFrame& frame, const std::uint32_t* facet) {
  const unsigned d = frame.dimension;
  RationalRows a(d, std::vector<mpq_class>(d + 1));
  for (unsigned i = 0; i < d; ++i) {
    for (unsigned j = 0; j < d; ++j)
      a[i][j] = mpq_class(frame.rows[std::size_t{facet[i]} * d + j]) - mpq_class(frame.centre[j]);
    a[i][d] = 1;
  }
  if (!solve(a)) return {};
  std::vector<mpq_class> plane(d);
  for (unsigned k = 0; k < d; ++k) plane[k] = a[k][d];
  return plane;
}

/// The largest share of its bound that the error of a plane reaches at a point; more than 1 is a
/// violation. `truth`: the points that the frame's may be off from.
double worst_error(const PlaneFrame& frame, const PlaneFrame& truth, std::uint32_t points,
                   const std::vector<float>& plane, const std::vector<mpq_class>& exact) {
  const unsigned d = frame.dimension;
  double worst = 0;
  for (std::uint32_t p = 0; p < points; ++p) {
    float computed = 0;
    mpq_class gauge;
    for (unsigned j = 0; j < d; ++j) {
      const std::size_t at = std::size_t{p} * d + j;
      computed += plane[j] * static_cast<float>(frame.rows[at] - frame.centre[j]);
      gauge += (mpq_class(truth.rows[at]) - mpq_class(truth.centre[j])) * exact[j];
    }
    const double error = std::abs(mpq_class(mpq_class(computed) - gauge).get_d());
    worst = std::max(worst, error / (plane[d] * std::max(1.0, std::abs(gauge.get_d()))));
  }
  return worst;
}

/// The largest error of a plane in doubles at a point.
double largest_error(const PlaneFrame& frame, std::uint32_t points,
                     const std::vector<double>& plane, const std::vector<mpq_class>& exact) {
  const unsigned d = frame.dimension;
  double largest = 0;
  for (std::uint32_t p = 0; p < points; ++p) {
    mpq_class error;
    for (unsigned j = 0; j < d; ++j)
      error += (mpq_class(frame.rows[std::size_t{p} * d + j]) - mpq_class(frame.centre[j])) *
               (mpq_class(plane[j]) - exact[j]);
    largest = std::max(largest, std::abs(error.get_d()));
  }
  return largest;
}

/// The same for a facet's plane.
double worst_share(const PlaneFrame& frame, const PlaneFrame& truth,
                   const std::vector<std::uint32_t>& facet, std::uint8_t slot, std::uint32_t points,
                   unsigned& useful) {
  const unsigned d = frame.dimension;
  std::vector<float> plane(d + 1);
  facet_planes(frame, facet[slot], facet.data(), &slot, 1, plane.data());
  if (!(plane[d] < std::numeric_limits<float>::infinity())) {
    for (unsigned j = 0; j < d; ++j) EXPECT_EQ(plane[j], 0);
    return 0;
  }
  ++useful;
  const std::vector<mpq_class> exact = exact_plane(truth, facet.data());
  if (exact.empty()) return 2;  // there is no plane, so no bound holds
  return worst_error(frame, truth, points, plane, exact);
}

class FacetPlanes : public ::testing::TestWithParam<unsigned> {};

TEST_P(FacetPlanes, BoundHolds) {
  const unsigned d = GetParam();
  Random r(d);
  unsigned useful = 0;
  double worst = 0;
  const int rounds = d <= 8 ? 400 : 40;
  for (int round = 0; round < rounds; ++round) {
    const std::uint32_t n = d + 4;
    std::vector<double> rows(std::size_t{n} * d), centre(d), reach(d, 0.0);
    const double size = std::ldexp(1.0, -static_cast<int>(r.integer(0, 12)));
    const double thin = round % 3 == 0 ? std::ldexp(1.0, -static_cast<int>(r.integer(0, 40))) : 1;
    // A facet about a point of the sphere, sometimes nearly flat within itself; a few points about
    // it, one nearly on it.
    std::vector<double> middle(d);
    double norm = 0;
    for (double& v : middle) {
      v = r.between(-1, 1);
      norm += v * v;
    }
    for (double& v : middle) v *= 0.5 / std::sqrt(norm);
    for (std::uint32_t i = 0; i < n; ++i)
      for (unsigned j = 0; j < d; ++j)
        rows[i * d + j] = middle[j] + size * r.between(-0.4, 0.4) * (j == 0 ? thin : 1);
    for (unsigned j = 0; j < d; ++j) {
      rows[(n - 1) * d + j] = 0;
      for (unsigned i = 0; i < d; ++i) rows[(n - 1) * d + j] += rows[i * d + j] / d;
      centre[j] = round % 2 == 0 ? 0 : r.between(-0.1, 0.1);
    }
    for (std::uint32_t i = 0; i < n; ++i)
      for (unsigned j = 0; j < d; ++j)
        reach[j] = std::max(reach[j], std::abs(rows[i * d + j] - centre[j]) * (1 + 1e-9));
    // Every fourth frame is of points and a centre that are off, far more than images are.
    const double off = round % 4 == 3 && d <= 8 ? 0x1p-20 : 0;
    std::vector<double> true_rows = rows, true_centre = centre;
    for (double& v : true_rows) v += r.integer(0, 1) == 0 ? -off : off;
    for (double& v : true_centre) v += r.integer(0, 1) == 0 ? -off : off;
    const PlaneFrame frame{d, rows.data(), centre.data(), reach.data(), 0, off == 0, 1.01 * off};
    const PlaneFrame truth{d, true_rows.data(), true_centre.data()};
    std::vector<std::uint32_t> facet(d);
    std::iota(facet.begin(), facet.end(), 0U);
    const auto slot = static_cast<std::uint8_t>(r.integer(0, static_cast<int>(d) - 1));
    const double share = worst_share(frame, truth, facet, slot, n, useful);
    EXPECT_LE(share, 1.0) << "dimension " << d << ", round " << round;
    worst = std::max(worst, share);
  }
  EXPECT_GT(useful, static_cast<unsigned>(rounds) / 4);  // else nothing was tried
  EXPECT_GT(worst, 1e-3);  // a bound a thousand times too large would hide mistakes
}

INSTANTIATE_TEST_SUITE_P(Dimensions, FacetPlanes, ::testing::Values(4, 5, 6, 7, 8, 9, 10));

/// Planes through one ridge, each between a plane that its point sees and one that it does not see:
/// their bounds hold, however long the chain.
TEST(FacetPlanes, PlanesBetweenOthersKeepTheirBounds) {
  unsigned made = 0, refused = 0, longest = 0, beneath = 0, off = 0;
  double worst = 0;
  for (unsigned round = 0; round < 60; ++round) {
    const unsigned d = 9 + round % 4, n = d + 40;
    Random r(round);
    const double thin = round % 3 == 0 ? std::ldexp(1.0, -static_cast<int>(r.integer(0, 30))) : 1;
    std::vector<double> rows(std::size_t{n} * d), centre(d), reach(d, 0.0);
    for (double& c : centre) c = round % 2 == 0 ? 0 : r.between(-0.1, 0.1);
    for (unsigned i = 0; i < n; ++i)  // the ridge's points first, then others about it
      for (unsigned j = 0; j < d; ++j)
        rows[i * d + j] =
            (j == 0 ? 0.6 : 0) + (i + 1 < d ? 0.3 : 0.2) * r.between(-1, 1) * (j == 1 ? thin : 1);
    PlaneFrame frame{d, rows.data(), centre.data(), reach.data(), 0, true};
    for (unsigned i = 0; i < n; ++i) {
      double square = 0;
      for (unsigned j = 0; j < d; ++j) {
        const double y = std::abs(rows[i * d + j] - centre[j]) * (1 + 1e-9);
        reach[j] = std::max(reach[j], y);
        square += y * y;
      }
      frame.radius = std::max(frame.radius, std::sqrt(square) * (1 + 1e-9));
    }
    std::vector<std::uint32_t> facet(d);
    std::iota(facet.begin(), facet.end(), 0U);
    std::vector<float> plane(d + 1);
    std::vector<double> seen(d + 1), unseen(d + 1), wide(d + 1);
    const auto start = [&](std::uint32_t point, std::vector<double>& to) {
      facet[d - 1] = point;
      facet_planes_any(frame, facet.data(), 1, plane.data(), to.data(), round % 2 == 0);
      const double error = largest_error(frame, n, to, exact_plane(frame, facet.data()));
      EXPECT_LE(error, to[d]);
      to[d] = error * (1 + 1e-9);  // the bounds of elimination are far from sharp
    };
    start(d - 1, seen);
    start(d, unseen);
    unsigned length = 0;
    for (std::uint32_t point = d + 1; point < n; ++point) {
      const auto gauge_of = [&](const std::vector<double>& of, std::uint32_t p) {
        double sum = 0;
        for (unsigned j = 0; j < d; ++j) sum += of[j] * (rows[p * d + j] - centre[j]);
        return sum;
      };
      // Points next to either plane are left out: which side they are on is decided exactly.
      if (gauge_of(seen, point) < 1) std::swap(seen, unseen);
      if (gauge_of(seen, point) < 1 + 2 * seen[d] || gauge_of(unseen, point) > 1 - 2 * unseen[d])
        continue;
      if (!plane_between(frame, seen.data(), unseen.data(), point, plane.data(), wide.data())) {
        ++refused;
        continue;
      }
      ++made;
      longest = std::max(longest, ++length);
      facet[d - 1] = point;
      const std::vector<mpq_class> exact = exact_plane(frame, facet.data());
      ASSERT_FALSE(exact.empty());
      const double error = largest_error(frame, n, wide, exact);
      EXPECT_LE(error, wide[d]) << "round " << round;
      worst = std::max(worst, error / wide[d]);
      EXPECT_LE(worst_error(frame, frame, n, plane, exact), 1.0) << "round " << round;
      const WideGauge gauge(frame, wide.data());
      for (std::uint32_t p = 0; p < n; ++p) {
        mpq_class height;
        for (unsigned j = 0; j < d; ++j)
          height += (mpq_class(rows[p * d + j]) - mpq_class(centre[j])) * exact[j];
        EXPECT_FALSE(height >= 1 && gauge.surely_beneath(p)) << "round " << round;
        EXPECT_FALSE(height == 1 && !gauge.may_contain(p)) << "round " << round;
        beneath += gauge.surely_beneath(p);
        off += !gauge.may_contain(p);
      }
      (round % 2 == 0 ? seen : unseen) = wide;
    }
  }
  EXPECT_GT(made, 100U);
  EXPECT_GT(longest, 3U);
  EXPECT_GT(refused, 0U);
  EXPECT_GT(beneath, made);  // else the gauges decide nothing
  EXPECT_GT(off, made);
  EXPECT_GT(worst, 1e-3);
}

TEST(FacetPlanes, DegenerateFacetsPromiseNothing) {
  for (const unsigned d : {4U, 6U, 8U}) {
    std::vector<double> rows(std::size_t{d} * d, 0.25), centre(d, 0.0), reach(d, 1.0);
    for (unsigned i = 0; i < d; ++i) rows[i * d] = 0.25 + i * 0.01;  // all on a line
    const PlaneFrame frame{d, rows.data(), centre.data(), reach.data(), 0, true};
    std::vector<std::uint32_t> facet(d);
    std::iota(facet.begin(), facet.end(), 0U);
    const std::uint8_t slot = 0;
    std::vector<float> plane(d + 1);
    facet_planes(frame, 0, facet.data(), &slot, 1, plane.data());
    EXPECT_EQ(plane[d], std::numeric_limits<float>::infinity());
    for (unsigned j = 0; j < d; ++j) EXPECT_EQ(plane[j], 0) << d << ' ' << j;
  }
}

/// No plane is made from one that has no bound, whatever its numbers and the other plane's are.
TEST(FacetPlanes, NoPlaneFromAnUnknownOne) {
  constexpr unsigned d = 9;
  constexpr double infinite = std::numeric_limits<double>::infinity();
  Random r(1);
  std::vector<double> rows(d), centre(d, 0.0), reach(d, 1.0), known(d + 1), unknown(d + 1, 0.0);
  unknown[d] = infinite;
  const PlaneFrame frame{d, rows.data(), centre.data(), reach.data(), 3, true};
  std::vector<float> plane(d + 1);
  std::vector<double> wide(d + 1);
  for (int round = 0; round < 100; ++round) {
    for (double& v : rows) v = r.between(-1, 1);
    for (double& v : known) v = r.between(-2, 2);
    known[d] = 0x1p-40;
    EXPECT_FALSE(plane_between(frame, unknown.data(), known.data(), 0, plane.data(), wide.data()));
    EXPECT_FALSE(plane_between(frame, known.data(), unknown.data(), 0, plane.data(), wide.data()));
  }
}

}  // namespace facet_planes_test
}  // namespace cullhull::internal
