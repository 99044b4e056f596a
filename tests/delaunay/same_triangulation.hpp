// Two triangulations have the same items, bit for bit; their points may be of other scalar types.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "cullhull/triangulation.hpp"

namespace cullhull::testing_support {

inline void expect_same(const Triangulation& a, const Triangulation& b, const std::string& what) {
  EXPECT_EQ(a.dimension, b.dimension) << what;
  EXPECT_EQ(a.point_count, b.point_count) << what;
  EXPECT_EQ(a.affine_dimension, b.affine_dimension) << what;
  EXPECT_EQ(a.axes, b.axes) << what;
  EXPECT_EQ(a.cells, b.cells) << what;
  EXPECT_EQ(a.neighbours, b.neighbours) << what;
  EXPECT_EQ(a.cell_groups, b.cell_groups) << what;
  EXPECT_EQ(a.hull_facets, b.hull_facets) << what;
  EXPECT_EQ(a.hull_cells, b.hull_cells) << what;
  EXPECT_EQ(a.duplicates, b.duplicates) << what;
  EXPECT_EQ(a.hidden, b.hidden) << what;
}

}  // namespace cullhull::testing_support
