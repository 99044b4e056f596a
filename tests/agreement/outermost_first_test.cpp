// From 4D on the outermost points are hulled first and what their hull has inside is dropped: the
// result is that of the extreme points alone, bit for bit, for any number of threads.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "agreement/canonical_hash.hpp"
#include "agreement/point_sets.hpp"
#include "call_options.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/hull.hpp"

namespace cullhull::outermost_first_test {

using namespace testing_support;

std::vector<double> rows_of(const std::string& shape, unsigned n, unsigned d, std::uint64_t seed) {
  Random r(seed);
  std::vector<double> rows;
  const bool lattice = shape == "lattice", flat = shape == "flat";
  for (unsigned i = 0; i < n; ++i) {
    std::vector<double> p(d);
    double two = 0;
    for (double& v : p) {
      v = lattice ? static_cast<double>(r.integer(-3, 3)) : r.normal();
      two += v * v;
    }
    const double ball = std::pow(r.unit(), 1.0 / d) / std::sqrt(two);
    for (unsigned j = 0; j < d; ++j) {
      if (shape == "ball" || shape == "twice" || flat) p[j] *= ball;
      if (shape == "sphere") p[j] /= std::sqrt(two);
      if (shape == "huge") p[j] *= 1e300;
      if (shape == "tiny") p[j] *= 1e-306;
      if (shape == "mixed") p[j] = std::ldexp(p[j], static_cast<int>(j * 30) - 60);
    }
    if (flat) p[d - 1] = p[0] + p[1];  // rounded: nearly flat
    if (shape == "twice" && i % 2 == 1) std::copy_n(rows.end() - d, d, p.begin());
    rows.insert(rows.end(), p.begin(), p.end());
  }
  return rows;
}

/// The extreme points by themselves, ids of the whole put back.
std::vector<std::uint64_t> vertices_of_vertices(const std::vector<double>& rows, unsigned d,
                                                const Hull& hull, double& volume) {
  std::vector<double> few;
  for (const std::uint64_t v : hull.vertices)
    few.insert(few.end(), rows.begin() + static_cast<std::ptrdiff_t>(v * d),
               rows.begin() + static_cast<std::ptrdiff_t>((v + 1) * d));
  const Hull alone =
      convex_hull(PointView::row_major(few.data(), hull.vertices.size(), d), options_of(1));
  volume = alone.volume;
  std::vector<std::uint64_t> ids;
  for (const std::uint64_t v : alone.vertices) ids.push_back(hull.vertices[v]);
  return ids;
}

TEST(OutermostFirst, IsTheHullOfTheExtremePointsForAnyNumberOfThreads) {
  std::uint64_t seed = 0;
  for (const char* shape :
       {"ball", "sphere", "normal", "lattice", "twice", "flat", "huge", "tiny", "mixed"})
    for (const unsigned d : {4U, 5U, 6U})
      for (const unsigned n : {d + 2, 40U, 70U, 100U, 300U, 2000U}) {
        if (n > (d == 4 ? 2000U : d == 5 ? 300U : 100U)) continue;
        SCOPED_TRACE(std::string(shape) + " " + std::to_string(n) + " in " + std::to_string(d));
        const std::vector<double> rows = rows_of(shape, n, d, ++seed);
        const PointView points = PointView::row_major(rows.data(), n, d);
        Options options = options_of(1);
        const Hull hull = convex_hull(points, options);
        double volume = -1;
        EXPECT_EQ(vertices_of_vertices(rows, d, hull, volume), hull.vertices);
        EXPECT_EQ(volume, hull.volume);
        const Certificate certificate = certify(points, hull);
        EXPECT_TRUE(certificate.valid) << certificate.reason;
        for (const unsigned threads : {2U, 3U, 8U}) {
          options.threads = threads;
          EXPECT_EQ(canonical_hash(convex_hull(points, options)), canonical_hash(hull)) << threads;
        }
      }
}

}  // namespace cullhull::outermost_first_test
