// LAS: every version and point format, in place and in blocks; headers that lie.
#include <gtest/gtest.h>

#include "cullhull/point_blocks.hpp"
#include "io_fixtures.hpp"

namespace cullhull {
namespace {

constexpr unsigned least_record[] = {20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

struct Las {
  unsigned minor = 2, format = 0, record = 0, header = 0, offset = 0;
  std::uint64_t promised = ~std::uint64_t{0};
  std::vector<std::array<std::int32_t, 3>> points = {
      {1, 2, 3}, {-4, 5, 6}, {2147483647, -2147483648, 0}};

  std::string bytes() const {
    const unsigned size = header != 0 ? header : minor == 4 ? 375 : minor == 3 ? 235 : 227;
    const unsigned begin = offset != 0 ? offset : size + 54;
    const unsigned length = record != 0 ? record : least_record[format & 15] + 3;
    std::string b(std::max(begin, 375U), '\0');
    const auto put = [&](std::size_t at, auto v) { b.replace(at, sizeof v, testing::bytes_of(v)); };
    b.replace(0, 4, "LASF");
    put(24, static_cast<std::uint8_t>(1));
    put(25, static_cast<std::uint8_t>(minor));
    put(94, static_cast<std::uint16_t>(size));
    put(96, static_cast<std::uint32_t>(begin));
    put(104, static_cast<std::uint8_t>(format));
    put(105, static_cast<std::uint16_t>(length));
    const std::uint64_t n = promised != ~std::uint64_t{0} ? promised : points.size();
    if (format <= 5 || minor < 4) put(107, static_cast<std::uint32_t>(n));
    if (minor == 4) put(247, n);
    b.resize(begin);
    for (const auto& p : points) {
      std::string r(length, '\x55');
      r.replace(0, 12, testing::bytes_of(p[0], p[1], p[2]));
      b += r;
    }
    return b;
  }
};

void expect_points(const Las& las, const PointView& view) {
  ASSERT_EQ(view.count, las.points.size());
  EXPECT_EQ(view.dimension, 3U);
  EXPECT_EQ(view.scalar, ScalarType::i32);
  for (std::size_t i = 0; i < las.points.size(); ++i)
    for (std::uint32_t j = 0; j < 3; ++j) EXPECT_EQ(view.at(i, j), las.points[i][j]);
}

TEST(IoLas, EveryVersionAndPointFormat) {
  const testing::TemporaryFolder folder;
  for (unsigned minor = 0; minor <= 4; ++minor)
    for (unsigned format = 0; format <= 10; ++format) {
      SCOPED_TRACE(std::to_string(minor) + " " + std::to_string(format));
      Las las;
      las.minor = minor;
      las.format = format;
      const std::string path = folder.write("a.las", las.bytes());
      const PointFile file = open_points(path);
      EXPECT_EQ(file.mapped(), testing::lies_ready);
      EXPECT_EQ(file.format(),
                "las 1." + std::to_string(minor) + ", point format " + std::to_string(format));
      expect_points(las, file.points());
      std::size_t seen = 0;
      BlockVisitor visitor;
      visitor.points = [&](const PointView& block, std::uint64_t first) {
        seen += block.count;
        for (std::uint64_t i = 0; i < block.count; ++i)
          for (std::uint32_t j = 0; j < 3; ++j) EXPECT_EQ(block.at(i, j), las.points[first + i][j]);
      };
      BlockOptions options;
      options.block_bytes = 1;
      options.readers = 1;
      visit_blocks({path}, visitor, options);
      EXPECT_EQ(seen, 3U);
      // By content, and with extra bytes behind the points, as waveforms and extended records are.
      const PointFile other = open_points(folder.write("b", las.bytes() + "more"));
      expect_points(las, other.points());
    }
}

std::string error_of(const testing::TemporaryFolder& folder, const std::string& bytes) {
  return testing::error_whole_and_in_blocks(folder.write("a.las", bytes));
}

TEST(IoLas, HeadersThatLie) {
  const testing::TemporaryFolder folder;
  const auto expect_error = [&](const Las& las, const char* say) {
    const std::string error = error_of(folder, las.bytes());
    EXPECT_NE(error.find(say), std::string::npos) << error << " / " << say;
  };
  expect_error({.minor = 5}, "byte 24: LAS version 1.5");
  expect_error({.format = 11, .record = 80}, "byte 104: LAS point format 11");
  expect_error({.format = 0x80}, "LAZ");
  expect_error({.format = 1, .record = 27}, "byte 105: records of 27 bytes");
  expect_error({.header = 100, .offset = 400}, "byte 94: LAS header of 100 bytes");
  expect_error({.minor = 4, .header = 300}, "byte 94: LAS header of 300 bytes");
  expect_error({.offset = 200}, "byte 96: points at byte 200");
  expect_error({.promised = 4}, "4 points of 23 bytes need more than the 69 bytes");
  expect_error({.minor = 4, .promised = ~std::uint64_t{0} / 23}, "need more than");
  const std::string whole = Las().bytes();
  for (const std::size_t size : {4UL, 100UL, 226UL, 250UL, whole.size() - 1})
    EXPECT_NE(error_of(folder, whole.substr(0, size)), "") << size;
}

}  // namespace
}  // namespace cullhull
