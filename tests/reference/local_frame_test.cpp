// What the frame of many points is, and that it does not depend on the number of threads.
#include "geometry/local_frame.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "cullhull/generate.hpp"
#include "cullhull/options.hpp"
#include "parallel/threads/run.hpp"

namespace cullhull::internal::local_frame_test {

constexpr std::uint32_t many = 100'000;  // several chunks of every sweep

LocalFrame frame_of(const std::vector<double>& rows, unsigned d, unsigned threads) {
  static const Options options;
  static const internal::Run run(options);
  return LocalFrame(Array<double>(rows.begin(), rows.end()),
                    static_cast<std::uint32_t>(rows.size() / d), d, run.with_threads(threads));
}

/// The frame on one thread, after a look that it is the same on three.
LocalFrame same_frame(const std::vector<double>& rows, unsigned d) {
  LocalFrame one = frame_of(rows, d, 1);
  const LocalFrame three = frame_of(rows, d, 3);
  EXPECT_EQ(one.simplex(), three.simplex());
  EXPECT_EQ(one.axes(), three.axes());
  EXPECT_EQ(one.points().small_lattice, three.points().small_lattice);
  const std::size_t values = std::size_t{one.points().count} * one.points().dimension;
  EXPECT_TRUE(std::equal(one.points().coordinates, one.points().coordinates + values,
                         three.points().coordinates));
  return one;
}

TEST(LocalFrame, OnePointOffAPlaneIsFoundWhereverItIs) {
  // A plane that no axis is at right angles to, on a grid so that it is one exactly.
  const std::vector<double> plane = generate("cube", many, 2, 1);
  std::vector<double> rows;
  for (std::uint32_t i = 0; i < many; ++i) {
    const double x = std::round(plane[2 * i] * 1024), y = std::round(plane[2 * i + 1] * 1024);
    rows.insert(rows.end(), {x, y, x + 2 * y});
  }
  const LocalFrame flat = same_frame(rows, 3);
  EXPECT_EQ(flat.affine_dimension(), 2);
  EXPECT_EQ(flat.axes().size(), 2U);
  EXPECT_TRUE(flat.points().small_lattice);
  for (const std::uint32_t at : {0U, 40'000U, many - 1}) {
    std::vector<double> off = rows;
    off[3 * std::size_t{at} + 2] = std::nextafter(off[3 * std::size_t{at} + 2], 1e9);
    const LocalFrame frame = same_frame(off, 3);
    EXPECT_EQ(frame.affine_dimension(), 3) << at;
    EXPECT_NE(std::find(frame.simplex().begin(), frame.simplex().end(), at), frame.simplex().end());
    EXPECT_FALSE(frame.points().small_lattice);
  }
}

TEST(LocalFrame, APointThatScalingWouldChangeIsKeptAsItIs) {
  std::vector<double> rows = generate("ball", many, 3, 2);
  for (double& v : rows) v *= 0x1p1000;
  const LocalFrame plain = same_frame(rows, 3);
  EXPECT_EQ(plain.points().exact, plain.points().coordinates);
  const std::size_t at = 3 * std::size_t{90'000} + 1;
  rows[at] = 0x1.8p-1073;
  const LocalFrame frame = same_frame(rows, 3);
  ASSERT_NE(frame.points().exact, frame.points().coordinates);
  EXPECT_EQ(frame.points().exact[at], rows[at]);
  for (std::uint32_t i = 0; i < many; ++i)
    for (unsigned j = 0; j < 3; ++j) ASSERT_LE(std::fabs(frame.points().row(i)[j]), 1);
}

/// Every 97th point of this grid lies in one plane: steps through the points would see no other.
TEST(LocalFrame, PeriodsOfTheInputDoNotHideItsShape) {
  std::vector<double> rows;
  for (std::uint32_t i = 0; i < many; ++i)
    rows.insert(rows.end(), {static_cast<double>(i % 31), static_cast<double>(i % 53),
                             i % 97 == 0 ? 0.0 : static_cast<double>(i % 7)});
  const LocalFrame frame = same_frame(rows, 3);
  EXPECT_EQ(frame.affine_dimension(), 3);
  double most = 0;
  for (const std::uint32_t v : frame.simplex()) most = std::max(most, rows[3 * std::size_t{v} + 2]);
  EXPECT_GE(most, 3);
}

}  // namespace cullhull::internal::local_frame_test
