// What converts to a PointView: ranges of points and matrices; and what does not.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <list>
#include <span>
#include <vector>

#include "cullhull/cullhull.hpp"
#include "cullhull/io.hpp"

namespace cullhull::point_ranges_test {

/// The members of Eigen's matrices that a view reads.
template <class T, int Rows, int Columns, bool RowMajor>
struct Matrix {
  using Scalar = T;
  static constexpr bool IsRowMajor = RowMajor;
  static constexpr int RowsAtCompileTime = Rows, ColsAtCompileTime = Columns;
  std::ptrdiff_t rows_, cols_, gap_ = 0;
  std::vector<T> items_;

  const T* data() const { return items_.data(); }
  std::ptrdiff_t rows() const { return rows_; }
  std::ptrdiff_t cols() const { return cols_; }
  std::ptrdiff_t innerStride() const { return 1; }
  std::ptrdiff_t outerStride() const { return (RowMajor ? cols_ : rows_) + gap_; }
  T& at(std::ptrdiff_t row, std::ptrdiff_t column) {
    return items_[static_cast<std::size_t>(RowMajor ? row * outerStride() + column
                                                    : column * outerStride() + row)];
  }
  void resize(int, int) {}

  /// Item (r, c) is 10 r + c; `gap` unused items between rows or columns.
  static Matrix counting(std::ptrdiff_t rows, std::ptrdiff_t cols, std::ptrdiff_t gap = 0) {
    Matrix m{rows, cols, gap, {}};
    m.items_.assign(static_cast<std::size_t>(m.outerStride() * (RowMajor ? rows : cols)), T(99));
    for (std::ptrdiff_t r = 0; r < rows; ++r)
      for (std::ptrdiff_t c = 0; c < cols; ++c) m.at(r, c) = static_cast<T>(10 * r + c);
    return m;
  }
};
constexpr int dynamic = -1;

void expect_rows(const PointView& view) {
  ASSERT_EQ(view.count, 5U);
  ASSERT_EQ(view.dimension, 3U);
  for (unsigned i = 0; i < 5; ++i)
    for (unsigned j = 0; j < 3; ++j) EXPECT_EQ(view.at(i, j), 10.0 * i + j);
}

TEST(PointRanges, ArraysOfPoints) {
  std::vector<std::array<float, 3>> points(5);
  double plain[5][3];
  for (unsigned i = 0; i < 5; ++i)
    for (unsigned j = 0; j < 3; ++j) points[i][j] = static_cast<float>(plain[i][j] = 10.0 * i + j);
  expect_rows(points);
  expect_rows(std::span<const std::array<float, 3>>(points));
  expect_rows(plain);
  EXPECT_EQ(PointView(points).scalar, ScalarType::f32);
  EXPECT_EQ(PointView(points).data, reinterpret_cast<const std::byte*>(points.data()));
  const std::array<std::array<std::uint8_t, 2>, 4> square{{{0, 0}, {9, 0}, {9, 9}, {0, 9}}};
  EXPECT_EQ(convex_hull(square).vertices.size(), 4U);
  EXPECT_EQ(PointView(std::span<const std::array<double, 2>>()).count, 0U);
}

/// The members of Eigen's Vector3f that a view reads.
struct Vector3f {
  using Scalar = float;
  static constexpr int IsVectorAtCompileTime = 1, SizeAtCompileTime = 3;
  float items[3];
};

TEST(PointRanges, VectorsOfFixedSize) {
  std::vector<Vector3f> points(5);
  for (unsigned i = 0; i < 5; ++i)
    for (unsigned j = 0; j < 3; ++j) points[i].items[j] = static_cast<float>(10 * i + j);
  expect_rows(points);
}

TEST(PointRanges, MembersOfObjects) {
  struct Vertex {
    int colour;
    float x, y, z;
    double weight;
  };
  std::vector<Vertex> vertices(5);
  for (unsigned i = 0; i < 5; ++i) {
    const auto x = static_cast<float>(10 * i);
    vertices[i] = {7, x, x + 1, x + 2, 99};
  }
  expect_rows(PointView::records(vertices, &Vertex::x, 3));
  EXPECT_EQ(PointView::records(vertices, &Vertex::weight, 1).at(4, 0), 99.0);
  const std::span<const Vertex> none;
  EXPECT_EQ(PointView::records(none, &Vertex::x, 3).count, 0U);
  EXPECT_THROW(PointView::records(vertices, &Vertex::weight, 9), Error);
}

TEST(PointRanges, ScalarsInARow) {
  const std::vector<double> xyz{0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  EXPECT_EQ(convex_hull(PointView::row_major(xyz, 3)).facets.size(), 4U);
  EXPECT_EQ(PointView::row_major(std::span<const double>(xyz), 2).count, 6U);
  EXPECT_THROW(PointView::row_major(xyz, 5), Error);
  EXPECT_THROW(PointView::row_major(xyz, 0), Error);
}

TEST(PointRanges, Matrices) {
  // The points are the rows, except where the number of rows alone is known.
  const auto plain = Matrix<double, dynamic, 3, true>::counting(5, 3);
  expect_rows(plain);
  const auto rows = Matrix<double, dynamic, dynamic, false>::counting(5, 3);
  expect_rows(rows);
  const auto padded = Matrix<float, dynamic, dynamic, true>::counting(5, 3, 2);
  expect_rows(padded);
  const auto fixed = Matrix<std::int32_t, dynamic, 3, false>::counting(5, 3, 4);
  expect_rows(fixed);
  auto columns = Matrix<double, 3, dynamic, false>::counting(3, 5);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 5; ++c) columns.at(r, c) = 10 * c + r;
  expect_rows(columns);
  auto column_rows = Matrix<double, 3, dynamic, true>::counting(3, 5, 1);
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 5; ++c) column_rows.at(r, c) = 10 * c + r;
  expect_rows(column_rows);
}

TEST(PointRanges, WhatDoesNotConvert) {
  using Rows = std::vector<std::array<double, 3>>;
  static_assert(std::is_convertible_v<Rows&, PointView>);
  static_assert(std::is_convertible_v<const Rows&, PointView>);
  static_assert(std::is_convertible_v<Rows, PointView>);  // a temporary, until the call returns
  static_assert(!std::is_convertible_v<std::vector<double>&, PointView>);  // of which dimension?
  static_assert(!std::is_convertible_v<std::list<std::array<double, 3>>&, PointView>);
  using Owning = Matrix<double, dynamic, 3, false>;
  static_assert(std::is_convertible_v<Owning&, PointView>);
  static_assert(std::is_convertible_v<const Owning&, PointView>);
  static_assert(std::is_convertible_v<Owning, PointView>);
  static_assert(std::is_trivially_copyable_v<PointView>);
  static_assert(std::is_convertible_v<const PointView&, PointView>);
}

std::vector<std::array<double, 2>> made_square() {
  return {{0, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 1}};
}

TEST(PointRanges, TemporariesAreReadByTheCall) {
  EXPECT_EQ(convex_hull(made_square()).vertices.size(), 4U);
  EXPECT_EQ(convex_hull(Matrix<double, dynamic, 3, true>::counting(5, 3)).affine_dimension, 1);
  const HullQuery query(made_square(), convex_hull(made_square()));
  EXPECT_EQ(query.side(std::array{1.0, 1.0}), Side::inside);
}

/// The members of Eigen's VectorXf that a query reads.
struct VectorXf {
  std::vector<float> items;
  std::ptrdiff_t size() const { return static_cast<std::ptrdiff_t>(items.size()); }
  float operator[](std::ptrdiff_t i) const { return items[static_cast<std::size_t>(i)]; }
};

TEST(PointRanges, OnePointOfAQuery) {
  const HullQuery query(made_square(), convex_hull(made_square()));
  const std::vector<double> inside{1, 1.5}, beyond{3, 1};
  const float plain[2] = {1, 1.5F};
  const double row[2] = {1, 1.5};
  EXPECT_TRUE(query.contains(inside));
  EXPECT_TRUE(query.contains(inside.data()));
  EXPECT_TRUE(query.contains(row));
  EXPECT_TRUE(query.contains(plain));
  EXPECT_TRUE(query.contains({1, 1.5}));
  EXPECT_TRUE(query.contains(std::array{1, 1}));
  EXPECT_TRUE(query.contains(std::array<std::uint8_t, 2>{1, 2}));
  EXPECT_TRUE(query.contains(std::span<const double>(inside)));
  EXPECT_TRUE(query.contains(std::span<const float, 2>(plain)));
  EXPECT_TRUE(query.contains(VectorXf{{1, 1.5F}}));
  EXPECT_FALSE(query.contains(beyond));
  EXPECT_EQ(query.side({2, 2}), Side::boundary);
  EXPECT_EQ(query.visible_facets(beyond).size(), 1U);
  EXPECT_EQ(query.support({1, 1}), 2U);
  EXPECT_EQ(query.signed_distance({3, 1}), 1.0);
  EXPECT_EQ(query.nearest_facet(std::array{3.0F, 1.0F}).distance, 1.0);
  EXPECT_EQ(query.ray({-1, 1}, std::array{1.0F, 0.0F}).enter, 1.0);
  EXPECT_EQ(query.ray(beyond.data(), std::array{-1, 0}).exit, 3.0);
  for (const auto& wrong : {std::vector<double>{}, {1}, {1, 1, 1}, {1, 1, 1, 1, 1}})
    EXPECT_THROW(query.contains(wrong), Error);
  EXPECT_THROW(query.contains({1}), Error);
  EXPECT_THROW(query.ray(inside, {1, 0, 0}), Error);
  EXPECT_THROW(query.contains({1, std::numeric_limits<double>::infinity()}), Error);

  // More dimensions than are converted without memory of their own.
  const std::array<std::array<float, 6>, 7> simplex{
      {{}, {1}, {0, 1}, {0, 0, 1}, {0, 0, 0, 1}, {0, 0, 0, 0, 1}, {0, 0, 0, 0, 0, 1}}};
  const HullQuery wide(simplex, convex_hull(simplex));
  EXPECT_TRUE(wide.contains(std::array<float, 6>{0, 0.1F, 0.1F, 0.1F, 0.1F, 0.1F}));
  EXPECT_FALSE(wide.contains(std::array<int, 6>{0, 0, 0, 0, 1, 1}));

  const std::vector<std::array<double, 2>> points = made_square();
  const Triangulation cells = delaunay(points);
  const TriangulationQuery located(points, cells);
  EXPECT_EQ(located.find({0.5, 1}), located.find(std::array{0.5F, 1.0F}));
  EXPECT_EQ(located.nearest({1.1, 1}), 4U);
  double shares[3];
  located.barycentric({1, 1}, located.find({1, 1}), shares);
  EXPECT_EQ(shares[0] + shares[1] + shares[2], 1.0);
  EXPECT_THROW(located.find({1}), Error);
  EXPECT_EQ(NearestPoint(points).nearest(VectorXf{{1.9F, 0}}), 1U);
  const Interpolator values(points, cells, std::array{1.0, 1.0, 1.0, 1.0, 1.0}.data());
  EXPECT_EQ(values.natural_neighbours({1, 1}).ids, std::vector<std::uint32_t>{4});
  const std::vector<std::array<double, 2>> sides{{1, -3}, {-1, 1}};  // x from 1 to 3
  EXPECT_EQ(intersect_halfspaces(sides, {2}).vertices.size(), 2U);
}

#ifndef _WIN32
// Names of files are texts, as "-" and FILE.npz:NAME are names, too; paths convert to them.
TEST(PointRanges, PathsAreNamesOfFiles) {
  EXPECT_THROW(open_points(std::filesystem::path("there is no such file.npy")), Error);
}
#endif

}  // namespace cullhull::point_ranges_test
