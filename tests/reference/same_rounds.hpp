// What the tests of the filters in rounds share: CPU, emulated executor and device.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "cullhull/point_view.hpp"
#include "filter/pseudo_hull/pseudo_hull.hpp"
#include "made_sets.hpp"

namespace cullhull::testing_support {

inline void expect_same_rounds(const std::vector<internal::PseudoHullRound>& found,
                               const std::vector<internal::PseudoHullRound>& expected,
                               const std::string& name) {
  ASSERT_EQ(found.size(), expected.size()) << name;
  for (std::size_t r = 0; r < found.size(); ++r) {
    EXPECT_EQ(found[r].facets, expected[r].facets) << name << ", round " << r;
    EXPECT_EQ(found[r].exterior, expected[r].exterior) << name << ", round " << r;
    EXPECT_EQ(found[r].culled, expected[r].culled) << name << ", round " << r;
    EXPECT_EQ(found[r].kept, expected[r].kept) << name << ", round " << r;
  }
}

/// expect(points, view, name) for n normally distributed points and for such on a grid, where ties
/// and duplicates are the rule: as rows, as columns, and every second one backwards.
template <class T, class Expect>
void each_normal_layout(std::size_t n, unsigned d, std::uint64_t seed, const Expect& expect) {
  for (const double step : {0.0, 0.5}) {
    const std::vector<T> p = normal_points<T>(n, d, seed, step);
    expect(p, PointView::row_major(p.data(), n, d), "rows");
    expect(p, PointView::column_major(p.data(), n, d), "columns");
    PointView backwards = PointView::row_major(p.data() + (n - 1) * d, n / 3, d);
    backwards.point_stride = -2 * backwards.point_stride;
    expect(p, backwards, "every second point, backwards");
  }
}

}  // namespace cullhull::testing_support
