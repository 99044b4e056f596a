// The certificate's first look at a point, against the sum of squares written out.
#include "certify/hull/inner_ball.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>
#include <random>

namespace cullhull::internal::certify {
namespace inner_ball_test {

/// Points of `dimension` as T at any address, with `gap` bytes after each coordinate and point.
template <class T>
struct Layout {
  std::vector<std::byte> bytes;
  PointView view;

  Layout(const std::vector<double>& rows, unsigned dimension, ScalarType scalar, bool columns,
         std::size_t gap) {
    const std::size_t n = rows.size() / dimension, size = sizeof(T) + gap;
    bytes.resize(rows.size() * size + 1);
    view.data = bytes.data() + (gap % 2);  // an odd gap: no alignment either
    view.count = n;
    view.dimension = dimension;
    view.scalar = scalar;
    view.point_stride = static_cast<std::ptrdiff_t>(columns ? size : size * dimension);
    view.coordinate_stride = static_cast<std::ptrdiff_t>(columns ? size * n : size);
    for (std::size_t i = 0; i < n; ++i)
      for (unsigned j = 0; j < dimension; ++j) {
        const T v = static_cast<T>(rows[i * dimension + j]);
        std::memcpy(const_cast<std::byte*>(view.address(i, j)), &v, sizeof v);
      }
  }
};

void check(const PointView& view, const std::vector<double>& centre,
           const std::vector<double>& scale, double square) {
  const InnerBall ball(centre, scale, square);
  ASSERT_TRUE(ball.usable());
  std::vector<std::uint16_t> out(InnerBall::block);
  for (const std::uint32_t count : {0U, 1U, 7U, 8U, 9U, 100U, 333U})
    for (const std::uint64_t begin : {0U, 1U, 5U}) {
      const std::uint32_t kept = ball.outside(view, begin, count, out.data());
      std::vector<bool> left(count, false);
      for (std::uint32_t k = 0; k < kept; ++k) {
        ASSERT_LT(out[k], count);
        ASSERT_TRUE(k == 0 || out[k - 1] < out[k]);
        left[out[k]] = true;
      }
      unsigned inside = 0;
      for (std::uint32_t i = 0; i < count; ++i) {
        double sum = 0;
        for (unsigned j = 0; j < view.dimension; ++j) {
          const double y = (view.at(begin + i, j) - centre[j]) * scale[j];
          sum += y * y;
        }
        if (!(sum < square * (1 + 1e-14))) {
          EXPECT_TRUE(left[i]) << i;
        }
        inside += sum < square * (1 - 1e-14);
      }
      // Only what does not fill a vector may be left for no reason.
      EXPECT_LE(kept, count - inside + 8);
    }
}

TEST(InnerBall, KeepsWhatIsOutsideInEveryLayout) {
  for (unsigned d = 2; d <= InnerBall::max_dimension; ++d) {
    std::mt19937_64 random(d);
    std::uniform_real_distribution<double> uniform(-100, 100);
    std::vector<double> rows(400 * d), centre(d), scale(d);
    for (double& v : rows) v = std::floor(uniform(random));
    for (unsigned j = 0; j < d; ++j) {
      centre[j] = uniform(random) / 8;
      scale[j] = j % 2 != 0 ? 0x1p-6 : 0x1p-7;
    }
    for (const std::size_t gap : {0U, 1U, 8U})
      for (const bool columns : {false, true}) {
        check(Layout<double>(rows, d, ScalarType::f64, columns, gap).view, centre, scale, 1);
        check(Layout<float>(rows, d, ScalarType::f32, columns, gap).view, centre, scale, 1);
        check(Layout<std::int16_t>(rows, d, ScalarType::i16, columns, gap).view, centre, scale, 1);
        check(Layout<std::int8_t>(rows, d, ScalarType::i8, columns, gap).view, centre, scale, 1);
      }
  }
}

TEST(InnerBall, KeepsWhatIsNotFinite) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  constexpr double infinity = std::numeric_limits<double>::infinity();
  std::vector<double> rows(64 * 3, 0.25);
  rows[3 * 5 + 1] = nan;
  rows[3 * 20] = infinity;
  rows[3 * 33 + 2] = -infinity;
  const InnerBall ball({0, 0, 0}, {1, 1, 1}, 1);
  std::vector<std::uint16_t> out(InnerBall::block);
  const std::uint32_t kept =
      ball.outside(PointView::row_major(rows.data(), 64, 3), 0, 64, out.data());
  EXPECT_EQ(std::vector<std::uint16_t>(out.begin(), out.begin() + kept),
            (std::vector<std::uint16_t>{5, 20, 33}));
}

TEST(InnerBall, OfNothingIsNotUsable) {
  EXPECT_FALSE(InnerBall().usable());
  EXPECT_FALSE(InnerBall({0, 0}, {1, 1}, 0).usable());
  EXPECT_FALSE(InnerBall(std::vector<double>(7, 0), std::vector<double>(7, 1), 1).usable());
}

}  // namespace inner_ball_test
}  // namespace cullhull::internal::certify
