// Points on small lattices of whole numbers keep the ends of lines before anything else is done
// with them: held against the general flow, bit for bit.
#include "filter/lattice/small_lattice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "agreement/all_paths.hpp"
#include "agreement/canonical_hash.hpp"
#include "agreement/general_outcome.hpp"
#include "agreement/point_sets.hpp"
#include "call_options.hpp"
#include "cullhull/extreme_points.hpp"
#include "filter/lattice/whole_range.hpp"

namespace cullhull::small_lattice_test {

using namespace testing_support;
using namespace internal;

/// n points whose coordinate j is a whole number from 0 to most[j], times `unit`, plus `shift`.
PointSet lattice_set(Random& r, unsigned n, const std::vector<int>& most, double unit = 1,
                     double shift = 0) {
  PointSet s;
  s.dimension = static_cast<unsigned>(most.size());
  for (unsigned i = 0; i < n; ++i) {
    std::vector<double> p;
    for (const int m : most) p.push_back(r.integer(0, m) * unit + shift);
    s.add(p);
  }
  return s;
}

bool thinned(const PointSet& s) {
  const std::vector<std::uint64_t>* ids = nullptr;
  return ends_in_small_lattice(view_of(s), ids);
}

TEST(SmallLattice, EqualsTheGeneralFlow) {
  Random r(30);
  unsigned taken = 0;
  for (unsigned i = 0; i < 3000; ++i) {
    const unsigned d = i % 3 == 0 ? 2 : 3;
    const auto n = static_cast<unsigned>(i % 100 == 0 ? r.integer(2000, 9000) : r.integer(60, 700));
    std::vector<int> most(d);
    for (int& m : most) m = r.integer(0, i % 2 == 0 ? 8 : 70);
    const double shift = i % 5 == 0 ? -std::ldexp(1.0, r.integer(0, 48)) : 0;
    PointSet s = lattice_set(r, n, most, i % 7 == 0 ? 0.5 : 1, shift);
    if (i % 11 == 0)
      for (double& x : s.coordinates) x = x == 0 ? -0.0 : x;
    if (i % 13 == 0)  // one axis that is not whole
      for (std::size_t k = i % d; k < s.coordinates.size(); k += d) s.coordinates[k] += r.unit();
    if (i % 17 == 0)
      s.coordinates[s.coordinates.size() / 2] = i % 2 == 0
                                                    ? std::numeric_limits<double>::quiet_NaN()
                                                    : std::numeric_limits<double>::infinity();
    taken += d == 3 && thinned(s) ? 1 : 0;
    expect_general(view_of(s), "set " + std::to_string(i));
    if (HasFailure()) return;
  }
  EXPECT_GT(taken, 300U);
}

TEST(SmallLattice, BlocksKeepTheirCorners) {
  PointSet s;
  s.dimension = 3;
  for (const int again : {0, 1})
    for (int x = 0; x < 10; ++x)
      for (int y = 0; y < 7; ++y)
        for (int z = 0; z < 64; ++z) s.add({double(x), double(again == 0 ? y : 6 - y), double(z)});
  const std::vector<std::uint64_t>* ids = nullptr;
  ASSERT_TRUE(ends_in_small_lattice(view_of(s), ids));
  const auto id = [](int x, int y, int z) {
    return static_cast<std::uint64_t>((x * 7 + y) * 64 + z);
  };
  EXPECT_EQ(*ids,
            (std::vector<std::uint64_t>{id(0, 0, 0), id(0, 0, 63), id(0, 6, 0), id(0, 6, 63),
                                        id(9, 0, 0), id(9, 0, 63), id(9, 6, 0), id(9, 6, 63)}));
  EXPECT_EQ(extreme_points(view_of(s)).ids, *ids);
  expect_general(view_of(s), "block");
}

TEST(SmallLattice, EndsIncludeAllExtremePoints) {
  Random r(31);
  for (unsigned i = 0; i < 200; ++i) {
    const PointSet s = lattice_set(r, static_cast<unsigned>(r.integer(300, 3000)),
                                   {r.integer(1, 12), r.integer(1, 12), r.integer(1, 12)});
    const std::vector<std::uint64_t>* ids = nullptr;
    ASSERT_TRUE(ends_in_small_lattice(view_of(s), ids));
    EXPECT_TRUE(std::is_sorted(ids->begin(), ids->end()));
    const std::vector<std::uint64_t> kept = *ids;
    const Hull hull = convex_hull(view_of(s), options_of(0, CullMethod::none));
    EXPECT_TRUE(
        std::includes(kept.begin(), kept.end(), hull.vertices.begin(), hull.vertices.end()));
  }
}

TEST(SmallLattice, RefusesOtherSets) {
  Random r(32);
  EXPECT_TRUE(thinned(lattice_set(r, 128, {4, 4, 4})));
  EXPECT_FALSE(thinned(lattice_set(r, 127, {4, 4, 4})));
  EXPECT_TRUE(thinned(lattice_set(r, 300'000, {63, 63, 63})));
  EXPECT_FALSE(thinned(lattice_set(r, 1000, {4, 4})));
  EXPECT_FALSE(thinned(lattice_set(r, 1000, {4, 4, 4}, 0.5)));
  EXPECT_FALSE(thinned(lattice_set(r, 1000, {4, 4, 4}, 1, 0x1p51)));
  EXPECT_TRUE(thinned(lattice_set(r, 1000, {4, 4, 4}, 1, 0x1p49)));
  EXPECT_FALSE(thinned(lattice_set(r, 9000, {4, 4, 4}, 16)));
  EXPECT_FALSE(thinned(lattice_set(r, 130, {15, 15, 15})));
  PointSet late = lattice_set(r, 1000, {4, 4, 4});
  late.coordinates[2999] = 0.25;
  EXPECT_FALSE(thinned(late));
}

TEST(SmallLattice, AnyScalarAndLayout) {
  Random r(33);
  for (unsigned i = 0; i < 100; ++i) {
    const auto n = static_cast<std::size_t>(r.integer(100, 1500));
    std::vector<std::int16_t> rows(3 * n);
    for (std::int16_t& v : rows) v = static_cast<std::int16_t>(r.integer(-6, 6));
    expect_general(PointView::row_major(rows.data(), n, 3), "rows " + std::to_string(i));
    expect_general(PointView::column_major(rows.data(), n, 3), "columns " + std::to_string(i));
    const std::vector<float> floats(rows.begin(), rows.end());
    expect_general(PointView::row_major(floats.data(), n, 3), "floats " + std::to_string(i));
  }
}

TEST(WholeRange, EveryCountAndValue) {
  Random r(34);
  for (unsigned i = 0; i < 4000; ++i) {
    const unsigned d = 2 + i % 2;
    const auto count = static_cast<std::uint32_t>(r.integer(1, 40));
    std::vector<double> rows(d * count);
    for (double& v : rows) v = r.integer(-9, 9);
    const auto at = static_cast<std::size_t>(r.integer(0, static_cast<int>(rows.size()) - 1));
    const double odd[] = {0.5,        -1e-300,
                          1e300,      0x1p50,
                          0x1p52 + 1, std::nan(""),
                          -0.0,       std::numeric_limits<double>::infinity(),
                          -7.25,      std::numeric_limits<double>::denorm_min()};
    if (i % 3 != 0) rows[at] = odd[r.integer(0, 9)];
    const WholeRange range = whole_range(rows.data(), count, d);
    bool finite = true;
    for (const double v : rows) finite = finite && std::isfinite(v);
    ASSERT_EQ(range.finite, finite) << i;
    if (!finite) continue;
    for (unsigned a = 0; a < d; ++a) {
      double low = rows[a], high = rows[a];
      bool whole = true;
      for (std::size_t k = a; k < rows.size(); k += d) {
        low = std::min(low, rows[k]);
        high = std::max(high, rows[k]);
        whole = whole && std::abs(rows[k]) < 0x1p50 && std::trunc(rows[k]) == rows[k];
      }
      ASSERT_EQ(range.low[a], low) << i;
      ASSERT_EQ(range.high[a], high) << i;
      ASSERT_EQ(range.whole[a], whole) << i;
    }
  }
}

}  // namespace cullhull::small_lattice_test
