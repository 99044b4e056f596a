// The 3D engine on its own paths: several threads, slivers, plateaus, thin bodies, duplicates.
// Every answer is certified and the same bits for any number of threads; small ones are held
// against rational arithmetic too.
#include <gtest/gtest.h>

#include <cmath>

#include "agreement/all_paths.hpp"
#include "agreement/point_sets.hpp"
#include "call_options.hpp"
#include "cullhull/generate.hpp"
#include "exact/orientation/orientation.hpp"
#include "geometry/local_frame.hpp"
#include "hull/engine.hpp"
#include "parallel/threads/run.hpp"
#include "thrown.hpp"

namespace cullhull::testing_support::engine_3d_test {

using Rows = std::vector<double>;

Rows turned(Rows rows) {  // about two axes; rounding makes faces that were flat nearly so
  for (std::size_t i = 0; i < rows.size(); i += 3) {
    double* p = rows.data() + i;
    const double x = 0.8 * p[0] - 0.6 * p[1], y = 0.6 * p[0] + 0.8 * p[1], z = p[2];
    p[0] = x;
    p[1] = y * 5 / 13 - z * 12 / 13;
    p[2] = y * 12 / 13 + z * 5 / 13;
  }
  return rows;
}

Rows scaled_z(Rows rows, double factor) {
  for (std::size_t i = 2; i < rows.size(); i += 3) rows[i] *= factor;
  return rows;
}

Rows two_circles(unsigned n) {
  const Rows circle = generate("sphere", n, 2, 5);
  Rows rows;
  for (unsigned i = 0; i < n; ++i)
    rows.insert(rows.end(), {circle[2 * i], circle[2 * i + 1], i % 2 == 0 ? -1.0 : 1.0});
  return rows;
}

Rows lattice_surface(int k) {
  Rows rows;
  for (int x = 0; x <= k; ++x)
    for (int y = 0; y <= k; ++y)
      for (int z = 0; z <= k; ++z)
        if (x == 0 || y == 0 || z == 0 || x == k || y == k || z == k)
          rows.insert(rows.end(), {x / double(k) - 0.5, y / double(k) - 0.5, z / double(k) - 0.5});
  return rows;
}

Rows repeated(const Rows& rows, unsigned times) {
  Rows out;
  for (unsigned k = 0; k < times; ++k) out.insert(out.end(), rows.begin(), rows.end());
  return out;
}

struct Set {
  const char* name;
  Rows rows;
};

std::vector<Set> sets(unsigned n) {
  return {
      {"sphere", generate("sphere", n, 3)},
      {"cylinder", generate("cylinder", n, 3)},
      {"turned cylinder", turned(generate("cylinder", n, 3))},
      {"cone", generate("cone", n, 3)},
      {"turned cone", turned(generate("cone", n, 3))},
      {"two circles", two_circles(n)},
      {"turned two circles", turned(two_circles(n))},
      {"squashed sphere", scaled_z(generate("sphere", n, 3), 1e-9)},
      {"turned squashed sphere", turned(scaled_z(generate("sphere", n, 3), 1e-9))},
      {"turned plane", turned(scaled_z(generate("cube", n, 3), 0))},
      {"turned lattice", turned(lattice_surface(static_cast<int>(std::sqrt(n / 6.0))))},
      {"cube's surface", generate("cube-surface", n, 3)},
      {"turned cube's surface", turned(generate("cube-surface", n, 3))},
      {"grid", generate("grid:16", n, 3)},
      {"wide grid", generate("grid:1000000000", n, 3)},
      {"moment curve", generate("cyclic", n, 3)},
      {"copies", repeated(generate("sphere", n / 4, 3), 4)},
      {"far and near", turned(scaled_z(generate("bumpy", n, 3), 1e6))},
  };
}

Hull hull_of(const Rows& rows, unsigned threads) {
  return convex_hull(PointView::row_major(rows.data(), rows.size() / 3, 3),
                     options_of(threads, CullMethod::none));
}

// Large enough for several pieces and for the order by normals.
TEST(Engine3D, SameForAnyThreadsAndCertified) {
  for (const Set& set : sets(20000)) {
    SCOPED_TRACE(set.name);
    const PointView view = PointView::row_major(set.rows.data(), set.rows.size() / 3, 3);
    const Hull one = hull_of(set.rows, 1);
    const Certificate certificate = certify(view, one);
    EXPECT_TRUE(certificate.valid) << certificate.reason;
    for (const unsigned threads : {2U, 3U, 4U, 8U})
      EXPECT_EQ(canonical_hash(hull_of(set.rows, threads)), canonical_hash(one)) << threads;
  }
}

// A round in pieces, then one where all threads look for the few points that see the surface.
TEST(Engine3D, ScreeningAfterPieces) {
  const Rows rows = generate("cube-surface", 200000, 3);
  const auto one = canonical_hash(hull_of(rows, 1));
  for (const unsigned threads : {2U, 8U}) EXPECT_EQ(canonical_hash(hull_of(rows, threads)), one);
}

// So many points in few cells of the curve that these are ordered once more.
TEST(Engine3D, CrowdedCells) {
  const Rows rows = two_circles(80000);
  const PointView view = PointView::row_major(rows.data(), rows.size() / 3, 3);
  const Hull one = hull_of(rows, 1);
  const Certificate certificate = certify(view, one);
  EXPECT_TRUE(certificate.valid) << certificate.reason;
  EXPECT_EQ(canonical_hash(hull_of(rows, 3)), canonical_hash(one));
}

TEST(Engine3D, AgreesWithRationalArithmetic) {
  for (const Set& set : sets(160)) {
    SCOPED_TRACE(set.name);
    PointSet points;
    points.dimension = 3;
    points.coordinates = set.rows;
    const Hull hull = hull_of(set.rows, 1);
    if (hull.affine_dimension < 3) continue;
    EXPECT_EQ(sorted_vertices(hull), exact_extreme_points(points));
  }
}

// The start lies in a face as thin as rounding: half of the points are on one circle, and it is
// those that the frame's stride meets.
TEST(Engine3D, DeepStartFromAFlatSimplex) {
  const Rows rows = turned(two_circles(4000));
  const internal::Run& run = internal::short_run();
  const internal::LocalFrame frame(Array<double>(rows.begin(), rows.end()), 4000, 3,
                                   run.with_threads(2));
  std::uint32_t flat[4] = {0, 2, 4, 6};  // on one circle; independent by rounding alone, or not
  const internal::LocalPoints& points = frame.points();
  const double* p[4];
  for (std::uint32_t k = 8; k < 4000; k += 2) {
    for (unsigned i = 0; i < 4; ++i) p[i] = points.exact_row(flat[i]);
    if (internal::orientation(3, p) != internal::Sign::zero) break;
    flat[3] = k;
  }
  ASSERT_NE(internal::orientation(3, p), internal::Sign::zero);
  const auto a =
      internal::hull_3d(points, flat, run.with_budget(std::uint64_t{1} << 32).with_threads(1));
  const auto b = internal::hull_3d(points, frame.simplex().data(),
                                   run.with_budget(std::uint64_t{1} << 32).with_threads(2));
  EXPECT_EQ(a.facet_count(), b.facet_count());
}

TEST(Engine3D, BudgetAndCancellation) {
  const Rows rows = generate("sphere", 50000, 3);
  std::stop_source stop;
  Options options;
  options.stop = stop.get_token();
  const internal::Run run(options);
  const internal::LocalFrame frame(Array<double>(rows.begin(), rows.end()), 50000, 3,
                                   run.with_threads(2));
  for (const unsigned threads : {1U, 4U}) {
    error_of(ErrorCode::out_of_budget, [&] {
      internal::hull_3d(frame.points(), frame.simplex().data(),
                        run.with_budget(1 << 20).with_threads(threads));
    });
  }
  stop.request_stop();
  for (const unsigned threads : {1U, 4U}) {
    error_of(ErrorCode::cancelled, [&] {
      internal::hull_3d(frame.points(), frame.simplex().data(),
                        run.with_budget(1 << 30).with_threads(threads));
    });
  }
}

}  // namespace cullhull::testing_support::engine_3d_test
