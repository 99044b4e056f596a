// PCD: ascii, binary and compressed, in place and in blocks; headers and packings that lie.
#include <gtest/gtest.h>

#include <cmath>

#include "cullhull/point_blocks.hpp"
#include "io/packed/lzf.hpp"
#include "io_fixtures.hpp"

namespace cullhull::testing::io_pcd_test {

std::string header(const std::string& fields, const std::string& size, const std::string& type,
                   const std::string& count, std::size_t points, const std::string& data) {
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " +
         size + "\nTYPE " + type + "\nCOUNT " + count + "\nWIDTH " + std::to_string(points) +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(points) + "\nDATA " +
         data + "\n";
}

/// As literal runs and copies, so that every branch of the decoder is taken.
std::string packed_by_lzf(const std::string& bytes) {
  std::string out;
  for (std::size_t at = 0; at < bytes.size();) {
    std::size_t best = 0, back = 0;
    for (std::size_t b = 1; b <= std::min<std::size_t>(at, 8192); ++b) {
      std::size_t n = 0;
      while (n < 264 && at + n < bytes.size() && bytes[at + n] == bytes[at + n - b]) ++n;
      if (n > best) best = n, back = b;
    }
    if (best >= 3) {
      const std::size_t length = best - 2, far = back - 1;
      out += static_cast<char>(std::min<std::size_t>(length, 7) << 5 | far >> 8);
      if (length >= 7) out += static_cast<char>(length - 7);
      out += static_cast<char>(far & 255);
      at += best;
    } else {
      out += '\0';
      out += bytes[at++];
    }
  }
  return out;
}

/// As it stands in a file: with its sizes.
std::string compressed(const std::string& bytes) {
  const std::string small = packed_by_lzf(bytes);
  return bytes_of(static_cast<std::uint32_t>(small.size()),
                  static_cast<std::uint32_t>(bytes.size())) +
         small;
}

/// The rows read whole, which must be those read in blocks of a point.
Rows read_both_ways(const std::string& path) {
  const Rows rows = rows_of(open_points(path).points());
  EXPECT_EQ(rows_in_blocks(path, {}, 1), rows);
  return rows;
}

TEST(IoPcd, AsciiWithFieldsAnywhere) {
  const TemporaryFolder folder;
  const std::string text =
      header("rgb y _ x z", "4 4 1 8 4", "F F U F F", "1 1 2 1 1", 2, "ascii") +
      "4.2e6 2 0 0 1 3\n1 -5 7 7 0.1 nan\n";
  const PointFile file = open_points(folder.write("a.pcd", text));
  EXPECT_EQ(file.format(), "pcd (ascii)");
  ASSERT_EQ(file.points().count, 2U);
  EXPECT_EQ(rows_of(file.points())[0], (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(file.points().at(1, 0), 0.1);
  EXPECT_TRUE(std::isnan(file.points().at(1, 2)));
}

TEST(IoPcd, BinaryInPlace) {
  const TemporaryFolder folder;
  const Rows rows{{1.5, -2, 3}, {4, 5, 6e30}};
  std::string body;
  for (const auto& r : rows)
    body += bytes_of(std::uint32_t{7}, static_cast<float>(r[0]), static_cast<float>(r[1]),
                     static_cast<float>(r[2]));
  const std::string path =
      folder.write("a", header("rgba x y z", "4 4 4 4", "U F F F", "1 1 1 1", 2, "binary") + body);
  const PointFile file = open_points(path);
  EXPECT_EQ(file.format(), "pcd (binary)");
  EXPECT_EQ(file.mapped(), lies_ready);
  EXPECT_EQ(file.points().scalar, ScalarType::f32);
  EXPECT_EQ(read_both_ways(path), (Rows{{1.5, -2, 3}, {4, 5, static_cast<float>(6e30)}}));
}

// As ROS drivers write fields that are aligned already.
TEST(IoPcd, PaddingOfNoBytes) {
  const TemporaryFolder folder;
  const Rows rows{{1, 2, 3}, {4, 5, 6}};
  std::string body;
  for (const auto& r : rows)
    body += bytes_of(static_cast<float>(r[0]), static_cast<float>(r[1]), static_cast<float>(r[2]),
                     std::uint8_t{9}, std::uint8_t{0});
  const auto named = [](const char* kind) {
    return header("x y z _ ring _ _", "4 4 4 1 1 1 1", "F F F U U U U", "1 1 1 0 1 0 1", 2, kind);
  };
  EXPECT_EQ(read_both_ways(folder.write("a.pcd", named("binary") + body)), rows);
  EXPECT_EQ(read_both_ways(folder.write("b.pcd", named("ascii") + "1 2 3 9 0\n4 5 6 9 0\n")), rows);
}

// Early versions of PCL fill the last page behind the points.
TEST(IoPcd, BytesAfterThePointsArePassedOver) {
  const TemporaryFolder folder;
  const std::string points = bytes_of(1.F, 2.F, 3.F, 4.F, 5.F, 6.F);
  const std::string path =
      folder.write("a.pcd", header("x y z", "4 4 4", "F F F", "1 1 1", 2, "binary") + points +
                                std::string(4096, 0));
  EXPECT_EQ(read_both_ways(path), (Rows{{1, 2, 3}, {4, 5, 6}}));
  std::vector<std::string> said;
  open_points(path, remarks_to(said));
  EXPECT_EQ(said, std::vector{path + ": 4096 bytes after the last point are passed over"});
}

// As PDAL writes them.
TEST(IoPcd, FieldsInCapitals) {
  const TemporaryFolder folder;
  const Rows want{{1, 2, 3}};
  EXPECT_EQ(read_both_ways(folder.write(
                "a.pcd", header("Z Y Intensity X", "8 8 2 8", "F F U F", "1 1 1 1", 1, "ascii") +
                             "3 2 7 1\n")),
            want);
  EXPECT_EQ(read_both_ways(folder.write(
                "a.pcd", header("X x y Y z", "8 8 8 8 8", "F F F F F", "1 1 1 1 1", 1, "binary") +
                             bytes_of(9.0, 1.0, 2.0, 9.0, 3.0))),
            want);
}

TEST(IoPcd, EveryTypeOfNumber) {
  const TemporaryFolder folder;
  struct Kind {
    const char *size, *type;
    std::string bytes;
    double least;
  };
  const Kind kinds[] = {{"1", "I", bytes_of(std::int8_t{-3}), -3},
                        {"1", "U", bytes_of(std::uint8_t{253}), 253},
                        {"2", "I", bytes_of(std::int16_t{-300}), -300},
                        {"2", "U", bytes_of(std::uint16_t{65000}), 65000},
                        {"4", "I", bytes_of(std::int32_t{-70000}), -70000},
                        {"4", "U", bytes_of(std::uint32_t{4000000000U}), 4e9},
                        {"8", "I", bytes_of(std::int64_t{-(1LL << 53)}), -9007199254740992.0},
                        {"8", "U", bytes_of(std::uint64_t{1} << 63), 9223372036854775808.0},
                        {"4", "F", bytes_of(0.5F), 0.5},
                        {"8", "F", bytes_of(1e300), 1e300}};
  for (const Kind& x : kinds)
    for (const Kind& z : kinds)
      for (const bool packed : {false, true}) {
        SCOPED_TRACE(std::string(x.type) + x.size + " " + z.type + z.size);
        const std::string size = std::string(z.size) + " 2 " + x.size + " 1";
        const std::string type = std::string(z.type) + " I " + x.type + " U";
        const std::string y = bytes_of(std::int16_t{-9}), pad = "p";
        const std::string text = header("z y x other", size, type, "1 1 1 1", 2,
                                        packed ? "binary_compressed" : "binary");
        std::string body;
        if (packed) {
          for (const std::string& field : {z.bytes, y, x.bytes, pad}) body += field + field;
          body = compressed(body);
        } else {
          for (int i = 0; i < 2; ++i) body += z.bytes + y + x.bytes + pad;
        }
        EXPECT_EQ(read_both_ways(folder.write("a.pcd", text + body)),
                  (Rows{{x.least, -9, z.least}, {x.least, -9, z.least}}));
      }
}

TEST(IoPcd, CompressedPointsOfOneTypeAreNotConverted) {
  const TemporaryFolder folder;
  std::string body;
  Rows rows(1000);
  for (int j = 0; j < 3; ++j)
    for (int i = 0; i < 1000; ++i) {
      rows[static_cast<std::size_t>(i)].push_back(i % 7 + 10 * j);
      body += bytes_of(static_cast<float>(i % 7 + 10 * j));
    }
  EXPECT_LT(packed_by_lzf(body).size(), body.size() / 4);
  const std::string path =
      folder.write("a.pcd", header("x y z", "4 4 4", "F F F", "1 1 1", 1000, "binary_compressed") +
                                compressed(body) + std::string(100, '\0'));
  EXPECT_EQ(open_points(path).points().scalar, ScalarType::f32);
  EXPECT_EQ(open_points(path).format(), "pcd (compressed)");
  EXPECT_EQ(read_both_ways(path), rows);
  ReadOptions little;
  little.memory_budget = 5000;
  error_of(ErrorCode::out_of_budget, [&] { open_points(path, little); });
}

TEST(IoPcd, PointsOfThePlaneAndNone) {
  const TemporaryFolder folder;
  EXPECT_EQ(read_both_ways(folder.write(
                "a.pcd", header("x y", "4 4", "F F", "1 1", 1, "binary") + bytes_of(1.0F, 2.0F))),
            (Rows{{1, 2}}));
  for (const char* data : {"ascii", "binary"})
    EXPECT_EQ(read_both_ways(folder.write("b.pcd", header("x y", "4 4", "F F", "1 1", 0, data))),
              Rows{});
}

std::string said(const TemporaryFolder& folder, const std::string& bytes) {
  return error_whole_and_in_blocks(folder.write("a.pcd", bytes));
}

TEST(IoPcd, HeadersThatLie) {
  const TemporaryFolder folder;
  const auto expect_error = [&](const std::string& bytes, const char* say) {
    EXPECT_TRUE(has(said(folder, bytes), say));
  };
  const std::string xyz = header("x y z", "4 4 4", "F F F", "1 1 1", 1, "binary");
  expect_error(xyz + "12345678901", "1 points of 12 bytes exceed the 11 bytes that follow");
  expect_error(header("x z", "4 4", "F F", "1 1", 1, "ascii") + "1 2\n", "no field 'y'");
  expect_error(header("x y x", "4 4 4", "F F F", "1 1 1", 1, "ascii"), "'x' must be one number");
  expect_error(header("x y z", "4 4 4", "F F F", "1 2 1", 1, "ascii"), "'y' must be one number");
  expect_error(header("x y", "4 3", "F F", "1 1", 1, "ascii"), "a.pcd:4: '3' is no SIZE");
  expect_error(header("x y", "4 2", "F F", "1 1", 1, "ascii"), "a float of 2 bytes");
  expect_error(header("x y", "4 4", "F C", "1 1", 1, "ascii"), "'C' is no TYPE");
  expect_error(header("x y", "4 4", "F F", "1 0", 1, "ascii"), "'0' is no COUNT");
  expect_error(header("_ y x", "4 4 4", "F F F", "1 0 1", 1, "binary"), "'0' is no COUNT");
  expect_error(header("x y", "4", "F F", "1 1", 1, "ascii"), "SIZE has 1 values for the 2 fields");
  expect_error(header("x y p", "4 4 8", "F F F", "1 1 9999999999999999999", 1, "binary"), "COUNT");
  expect_error(header("x y", "4 4", "F F", "1 1", 1, "zip"), "DATA is ascii, binary or");
  expect_error(header("x y", "4 4", "F F", "1 1", 2, "ascii") + "1 2\n",
               "promises 2 points, but 1");
  expect_error(header("x y", "4 4", "F F", "1 1", 1, "ascii") + "1 2 3\n", "a.pcd:12: '3' after");
  expect_error(header("x y", "4 4", "F F", "1 1", 1, "ascii") + "1\n", "a.pcd:12:");
  expect_error("VERSION 0.8\n", "PCD versions 0.5 to 0.7");
  expect_error("# .PCD\nFIELDS x y\nWIDTH 2\nHEIGHT 3\nPOINTS 5\nDATA ascii\n", "POINTS is 5");
  expect_error("# .PCD\nFIELDS x y\nDATA ascii\n", "neither POINTS nor WIDTH");
  expect_error("# .PCD\nFIELDS x y\nWIDTH 9999999999999999999\nHEIGHT 2\nDATA ascii\n", "64 bits");
  expect_error("# .PCD\nDATA ascii\n", "no line 'FIELDS'");
  expect_error("# .PCD\nPOINTS 1\nPOINTS 1\n", "second line");
  expect_error("# .PCD\nFRUITS 1\n", "no keyword of a PCD header");
  expect_error("# .PCD\n", "ends within the PCD header");
  expect_error(
      header("x y", "8 4", "I F", "1 1", 1, "binary") + bytes_of((std::int64_t{1} << 53) + 1, 1.0F),
      "field 'x' of point 0 is a 64-bit integer that no double equals");
}

TEST(IoPcd, PackingsThatLie) {
  const TemporaryFolder folder;
  const std::string head = header("x y", "4 4", "F F", "1 1", 1, "binary_compressed");
  const auto expect_error =
      [&](std::uint32_t packed, std::uint32_t size, const std::string& bytes, const char* say) {
    EXPECT_TRUE(has(said(folder, head + bytes_of(packed, size) + bytes), say));
  };
  const std::string good =
      "\x07"
      "12345678";
  expect_error(9, 9, good, "1 points of 8 bytes are not the 9");
  expect_error(10, 8, good, "do not fit the 9 that follow");
  expect_error(0, 8, good, "do not fit");
  expect_error(8, 8, good, "corrupt");  // cut short
  expect_error(9, 8,
               "\x06"
               "1234567"
               "\x20",
               "corrupt");  // a copy without its distance
  expect_error(9, 8,
               std::string("\x04"
                           "12345"
                           "\x20\x05",
                           8) +
                   "x",
               "corrupt");  // too far back
  expect_error(8, 8,
               std::string("\x03"
                           "1234"
                           "\xE0\xFF\x00",
                           8),
               "corrupt");  // too long
  EXPECT_TRUE(has(said(folder, head + "1234567"), "ends before its points"));
}

TEST(Lzf, CopiesMayOverlapThemselves) {
  char out[300];
  const char packed[] = {0, 'a', static_cast<char>(0xE0), static_cast<char>(255), 0};
  ASSERT_TRUE(internal::unpack_lzf(packed, sizeof packed, out, 265));
  EXPECT_EQ(std::string(out, 265), std::string(265, 'a'));
  EXPECT_FALSE(internal::unpack_lzf(packed, sizeof packed, out, 264));
  EXPECT_FALSE(internal::unpack_lzf(packed, sizeof packed, out, 266));
  EXPECT_TRUE(internal::unpack_lzf(nullptr, 0, out, 0));
}

}  // namespace cullhull::testing::io_pcd_test
