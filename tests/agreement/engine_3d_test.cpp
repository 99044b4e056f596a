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

PointSet scaled_z(PointSet s, double factor) {
  s.name += " scaled";
  for (std::size_t i = 2; i < s.coordinates.size(); i += 3) s.coordinates[i] *= factor;
  return s;
}

PointSet lattice_surface(int k) {
  PointSet s = named("surface of a lattice", 3);
  for (int x = 0; x <= k; ++x)
    for (int y = 0; y <= k; ++y)
      for (int z = 0; z <= k; ++z)
        if (x == 0 || y == 0 || z == 0 || x == k || y == k || z == k)
          s.add({x / double(k) - 0.5, y / double(k) - 0.5, z / double(k) - 0.5});
  return s;
}

PointSet repeated(PointSet s, unsigned times) {
  const std::vector<double> once = s.coordinates;
  for (unsigned k = 1; k < times; ++k)
    s.coordinates.insert(s.coordinates.end(), once.begin(), once.end());
  return s;
}

std::vector<PointSet> sets(unsigned n) {
  const auto made = [&](const char* shape) { return generated(shape, n, 3); };
  return {
      made("sphere"),
      made("cylinder"),
      turned(made("cylinder")),
      made("cone"),
      turned(made("cone")),
      two_circles(n, 5),
      turned(two_circles(n, 5)),
      scaled_z(made("sphere"), 1e-9),
      turned(scaled_z(made("sphere"), 1e-9)),
      turned(scaled_z(made("cube"), 0)),
      turned(lattice_surface(static_cast<int>(std::sqrt(n / 6.0)))),
      made("cube-surface"),
      turned(made("cube-surface")),
      made("grid:16"),
      made("grid:1000000000"),
      made("cyclic"),
      repeated(generated("sphere", n / 4, 3), 4),
      turned(scaled_z(made("bumpy"), 1e6)),
  };
}

Hull hull_of(const PointSet& set, unsigned threads) {
  return convex_hull(view_of(set), options_of(threads, CullMethod::none));
}

/// On one thread it is certified, and on others it is the same.
void expect_certified_for_any_threads(const PointSet& set, std::initializer_list<unsigned> others) {
  SCOPED_TRACE(set.name);
  const Hull one = hull_of(set, 1);
  const Certificate certificate = certify(view_of(set), one);
  EXPECT_TRUE(certificate.valid) << certificate.reason;
  for (const unsigned threads : others)
    EXPECT_EQ(canonical_hash(hull_of(set, threads)), canonical_hash(one)) << threads;
}

// Large enough for several pieces and for the order by normals.
TEST(Engine3D, SameForAnyThreadsAndCertified) {
  for (const PointSet& set : sets(20000))
    expect_certified_for_any_threads(set, {2, 3, 4, 8, 16, 64});
}

// A round in pieces, then one where all threads look for the few points that see the surface.
TEST(Engine3D, ScreeningAfterPieces) {
  expect_certified_for_any_threads(generated("cube-surface", 200000, 3), {2, 8});
}

// The points at the borders are cut again several times: on a sphere by turned curves, on a
// cylinder, where its caps meet the lateral surface, by planes too.
TEST(Engine3D, BordersAreCutAgain) {
  for (const char* shape : {"sphere", "cylinder"})
    expect_certified_for_any_threads(generated(shape, 200000, 3), {2, 16, 64});
}

// The measures are sums over runs of facets, and the buckets in which facets are sorted, which
// depend on the threads, cut these runs: also where a bucket has fewer facets than a run, or none.
TEST(Engine3D, SumsOverBordersOfBuckets) {
  for (unsigned n = 1030; n < 9000; n += n / 8)
    expect_certified_for_any_threads(generated("sphere", n, 3), {2, 3, 16, 64});
  PointSet set = named("poles, equator, cap", 3);
  set.add({0, 0, 1});
  set.add({0, 0, -1});
  for (int i = 0; i < 8000; ++i) set.add({std::cos(i * 7e-4), std::sin(i * 7e-4), 0});
  for (int i = 0; i < 50; ++i) {
    const double a = 1 + 0.003 * (i * 7 % 50), z = 0.6 + 0.003 * i;
    set.add({std::sqrt(1 - z * z) * std::cos(a), std::sqrt(1 - z * z) * std::sin(a), z});
  }
  expect_certified_for_any_threads(set, {2, 3, 16, 64});
}

// So many points in few cells of the curve that these are ordered once more.
TEST(Engine3D, CrowdedCells) { expect_certified_for_any_threads(two_circles(80000, 5), {3}); }

TEST(Engine3D, AgreesWithRationalArithmetic) {
  for (const PointSet& set : sets(160)) {
    const Hull hull = hull_of(set, 1);
    if (hull.affine_dimension < 3) continue;
    EXPECT_EQ(sorted_vertices(hull), exact_extreme_points(set)) << set.name;
  }
}

// The start lies in a face as thin as rounding: half of the points are on one circle, and it is
// those that the frame's stride meets.
TEST(Engine3D, DeepStartFromAFlatSimplex) {
  const std::vector<double> rows = turned(two_circles(4000, 5)).coordinates;
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
  const std::vector<double> rows = generate("sphere", 50000, 3);
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
