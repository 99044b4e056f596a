// Files byte for byte, as every machine must write and read them, whatever its own byte order is.
#include "parallel/byte_order.hpp"

#include <cstdint>
#include <vector>

#include "cullhull/hull.hpp"
#include "cullhull/point_blocks.hpp"
#include "cullhull/stream.hpp"
#include "tests/io_fixtures.hpp"
#include "thrown.hpp"

namespace cullhull::testing::byte_order_test {

using namespace std::string_literals;

TEST(ByteOrder, NumbersAndItems) {
  const unsigned char bytes[] = {1, 2, 3, 4, 5, 6, 7, 8};
  EXPECT_EQ(internal::load_little_endian<std::uint64_t>(bytes), 0x0807060504030201U);
  EXPECT_EQ(internal::load_little_endian<std::int16_t>(bytes + 1), 0x0302);
  EXPECT_EQ(internal::reverse_bytes(std::uint32_t{0x01020304}), 0x04030201U);
  std::uint16_t items[] = {0x0102, 0x0304};
  internal::little_endian_items(items, sizeof items, sizeof items[0]);
  const auto* const p = reinterpret_cast<const unsigned char*>(items);
  EXPECT_EQ((std::vector<int>(p, p + 4)), (std::vector<int>{2, 1, 4, 3}));
}

TEST(ByteOrder, ReversedCopiesKeepRowsAndTypes) {
  const std::uint16_t rows[] = {0x0102, 0xFFFF, 0x0304, 0xFFFF, 0x0506, 0xFFFF};
  internal::PointData data;
  data.view = PointView::row_major(rows, 3, 2);
  data.view.dimension = 1;  // every other number
  data.in_place = true;
  const auto turned = internal::with_reversed_bytes(std::move(data));
  EXPECT_FALSE(turned.in_place);
  EXPECT_EQ(turned.view.scalar, ScalarType::u16);
  EXPECT_EQ(rows_of(turned.view), (Rows{{0x0201}, {0x0403}, {0x0605}}));
}

TEST(ByteOrder, PointFiles) {
  const TemporaryFolder folder;
  const double v[] = {1, -2, 0.5, 3};
  write_npy_points(folder.file("a.npy"), v, 2, 2, ScalarType::f64);
  std::string bytes = slurp(folder.file("a.npy"));
  EXPECT_TRUE(has(bytes, "'descr': '<f8'"));
  EXPECT_EQ(bytes.substr(bytes.size() - 32),
            "\0\0\0\0\0\0\xf0\x3f\0\0\0\0\0\0\0\xc0\0\0\0\0\0\0\xe0\x3f\0\0\0\0\0\0\x08\x40"s);
  write_npy_ids(folder.file("b.npy"), {258, 3});
  bytes = slurp(folder.file("b.npy"));
  EXPECT_EQ(bytes.substr(bytes.size() - 16), "\2\1\0\0\0\0\0\0\3\0\0\0\0\0\0\0"s);
  const std::int16_t few[] = {1, 2, 515, 4};
  write_points(folder.file("c.ply"), PointView::row_major(few, 2, 2), {1});
  bytes = slurp(folder.file("c.ply"));
  EXPECT_EQ(bytes.substr(bytes.find("end_header\n")), "end_header\n\3\2\4\0"s);
}

TEST(ByteOrder, MeshFiles) {
  const TemporaryFolder folder;
  const double v[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
  const PointView points = PointView::row_major(v, 4, 3);
  const Hull hull = convex_hull(points);
  write_hull(folder.file("a.ply"), points, hull);
  std::string bytes = slurp(folder.file("a.ply"));
  bytes = bytes.substr(bytes.find("end_header\n") + 11);
  ASSERT_EQ(bytes.size(), 4U * 24 + 4 * 13);
  EXPECT_EQ(bytes.substr(24, 8), "\0\0\0\0\0\0\xf0\x3f"s);
  EXPECT_EQ(bytes.substr(96, 13).substr(0, 5), "\3\0\0\0\0"s);
  write_hull(folder.file("a.stl"), points, hull);
  bytes = slurp(folder.file("a.stl"));
  EXPECT_EQ(bytes.substr(80, 4), "\4\0\0\0"s);
}

/// A state of two points of dimension 1, version 1.
const std::string state_bytes =
    "\x93"
    "CULLHS\n"
    "\1\0\0\0\1\0\0\0"                  // version, dimension
    "\1\0\0\0\0\0\0\0"                  // 64-bit floats
    "\2\0\0\0\0\0\0\0\2\0\0\0\0\0\0\0"  // points seen, points kept
    "\0\1\0\0\0\0\0\0\1\1\0\0\0\0\0\0"  // ids 256 and 257
    "\0\0\0\0\0\0\xf0\x3f\0\0\0\0\0\0\0\xc0"s;

TEST(ByteOrder, HullStates) {
  const double v[] = {1, -2};
  const HullState state(PointView::row_major(v, 2, 1), 256);
  const std::vector<std::byte> made = state.to_bytes();
  const std::string_view text(reinterpret_cast<const char*>(made.data()), made.size());
  ASSERT_EQ(text.size(), state_bytes.size() + 8);
  EXPECT_EQ(text.substr(0, state_bytes.size()), state_bytes);
  EXPECT_EQ(HullState::from_bytes(made), state);
  const TemporaryFolder folder;
  write_state(folder.file("a.npz"), state);
  const std::string npz = slurp(folder.file("a.npz"));
  EXPECT_TRUE(has(npz, "\0\1\0\0\0\0\0\0\1\1\0\0\0\0\0\0"s));
  EXPECT_TRUE(has(npz, "\0\0\0\0\0\0\xf0\x3f\0\0\0\0\0\0\0\xc0"s));
}

}  // namespace cullhull::testing::byte_order_test
