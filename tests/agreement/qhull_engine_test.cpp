// Qhull behind our filter: the same canonical result, or an honest refusal.
#include <gtest/gtest.h>

#include "canonical_hash.hpp"
#include "cullhull/cullhull.hpp"
#include "hull/engine.hpp"

namespace cullhull::testing_support {
namespace qhull_engine_test {

TEST(QhullEngine, AgreesInGeneralPosition) {
  if (!internal::qhull_available()) {
    Options options;
    options.engine = Engine::qhull;
    const double p[] = {0, 0, 1, 0, 0, 1};
    try {
      convex_hull(PointView::row_major(p, 3, 2), options);
      FAIL() << "a missing engine must be refused";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::backend_unavailable);
    }
    return;
  }
  for (unsigned d = 2; d <= 5; ++d)
    for (const char* shape : {"ball", "gauss", "sphere"}) {
      const std::uint64_t n = d == 5 ? 300 : 3000;
      const std::vector<double> p = generate(shape, n, d, 7);
      const PointView v = PointView::row_major(p.data(), n, d);
      Options options;
      const Hull native = convex_hull(v, options);
      options.engine = Engine::qhull;
      const Hull qhull = convex_hull(v, options);
      EXPECT_EQ(canonical_hash(qhull), canonical_hash(native)) << shape << " " << d << "D";
      EXPECT_EQ(qhull.statistics.engine, Engine::qhull);
    }
}

TEST(QhullEngine, NeverReturnsAHullThatIsNot) {
  if (!internal::qhull_available()) return;
  // Points around a lattice, rotated: within Qhull's tolerance of one another's planes.
  std::vector<double> p;
  for (int x = 0; x < 6; ++x)
    for (int y = 0; y < 6; ++y)
      for (int z = 0; z < 6; ++z) {
        const double a = 0.6 * x - 0.8 * y, b = 0.8 * x + 0.6 * y;
        p.insert(p.end(), {a, 0.28 * b - 0.96 * z, 0.96 * b + 0.28 * z});
      }
  const PointView v = PointView::row_major(p.data(), p.size() / 3, 3);
  const Hull native = convex_hull(v);
  EXPECT_TRUE(certify(v, native).valid);
  Options options;
  options.engine = Engine::qhull;
  try {
    EXPECT_EQ(canonical_hash(convex_hull(v, options)), canonical_hash(native));
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::not_exact) << e.what();
  }
}

}  // namespace qhull_engine_test
}  // namespace cullhull::testing_support
