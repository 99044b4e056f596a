#include "cullhull/point_view.hpp"

#include <gtest/gtest.h>

#include <cstring>

namespace cullhull::point_view_test {

TEST(PointView, ReadsRowsAndColumnsAlike) {
  const double rows[] = {1, 2, 3, 4, 5, 6};
  const double columns[] = {1, 4, 2, 5, 3, 6};
  const auto r = PointView::row_major(rows, 2, 3);
  const auto c = PointView::column_major(columns, 2, 3);
  for (unsigned i = 0; i < 2; ++i)
    for (unsigned j = 0; j < 3; ++j) EXPECT_EQ(r.at(i, j), c.at(i, j));
  EXPECT_TRUE(r.packed_rows());
  EXPECT_FALSE(c.packed_rows());
}

TEST(PointView, ReadsUnalignedRecords) {
  std::byte buffer[2 * 13 + 1] = {};
  const float value = 2.5F;
  std::memcpy(buffer + 1 + 13 + 4, &value, 4);
  PointView v{buffer + 1, ScalarType::f32, 3, 2, 13, 4};
  EXPECT_EQ(v.at(1, 1), 2.5);
  EXPECT_EQ(v.at(0, 1), 0.0);
}

TEST(PointView, EveryScalarTypeIsExact) {
  const std::int8_t a[] = {-128};
  const std::uint32_t b[] = {4294967295U};
  const std::int32_t c[] = {-2147483647 - 1};
  EXPECT_EQ(PointView::row_major(a, 1, 1).at(0, 0), -128.0);
  EXPECT_EQ(PointView::row_major(b, 1, 1).at(0, 0), 4294967295.0);
  EXPECT_EQ(PointView::row_major(c, 1, 1).at(0, 0), -2147483648.0);
}

}  // namespace cullhull::point_view_test
