#include <cmath>

#include "tests/io_fixtures.hpp"
#include "thrown.hpp"

namespace cullhull::testing::io_ply_test {

std::string header(const std::string& format, const std::string& elements) {
  return "ply\nformat " + format + " 1.0\ncomment any words at all, as many as one likes\n" +
         elements + "end_header\n";
}
const std::string xyz_double = "property double x\nproperty double y\nproperty double z\n";

TEST(Ply, StridedRecordsAreReadInPlace) {
  const std::string head = header("binary_little_endian",
                                  "element vertex 2\nproperty uchar red\nproperty float x\n"
                                  "property float y\nproperty float z\nproperty short w\n");
  const std::string bytes = head + bytes_of(std::uint8_t{9}, 1.0F, 2.0F, 3.0F, std::int16_t{5}) +
                            bytes_of(std::uint8_t{9}, 4.0F, 5.0F, 6.0F, std::int16_t{5});
  const auto points = parse(bytes, "ply");
  EXPECT_EQ(points.in_place, lies_ready);
  EXPECT_EQ(points.format, "ply (binary little-endian)");
  EXPECT_EQ(points.view.point_stride, lies_ready ? 15 : 12);
  EXPECT_EQ(points.view.coordinate_stride, 4);
  EXPECT_EQ(reinterpret_cast<const char*>(points.view.data) == bytes.data() + head.size() + 1,
            lies_ready);
  EXPECT_EQ(rows_of(points.view), (Rows{{1, 2, 3}, {4, 5, 6}}));
}

TEST(Ply, BackwardsAndEvenlyApartIsInPlaceToo) {
  const std::string bytes =
      header("binary_little_endian",
             "element vertex 1\nproperty double z\nproperty double y\nproperty double x\n") +
      bytes_of(3.0, 2.0, 1.0);
  const auto points = parse(bytes, "ply");
  EXPECT_EQ(points.in_place, lies_ready);
  EXPECT_EQ(points.view.coordinate_stride, lies_ready ? -8 : 8);
  EXPECT_EQ(rows_of(points.view), (Rows{{1, 2, 3}}));
}

TEST(Ply, MixedTypesAndUnevenOffsetsAreConverted) {
  const std::string mixed =
      header("binary_little_endian",
             "element vertex 1\nproperty double x\nproperty float y\nproperty uint z\n") +
      bytes_of(0.1, 2.0F, 4000000000U);
  EXPECT_FALSE(parse(mixed, "ply").in_place);
  EXPECT_EQ(rows_of(parse(mixed, "ply").view), (Rows{{0.1, 2, 4e9}}));
  const std::string uneven = header("binary_little_endian",
                                    "element vertex 1\nproperty char x\nproperty char y\n"
                                    "property char i\nproperty char z\n") +
                             std::string("\x01\x02\x07\xFF");
  EXPECT_EQ(rows_of(parse(uneven, "ply").view), (Rows{{1, 2, -1}}));
}

TEST(Ply, ColoursAreThreeBytes) {
  const std::string names = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
  const std::string binary =
      header("binary_big_endian", "element vertex 2\n" + xyz_double + names) +
      bytes_of_big_endian(1.0) + bytes_of_big_endian(2.0) + bytes_of_big_endian(3.0) +
      "\x07\x08\xFF" + bytes_of_big_endian(4.0) + bytes_of_big_endian(5.0) +
      bytes_of_big_endian(6.0) + "\x01\x02\x03";
  EXPECT_EQ(rows_of(parse(binary, "ply").colours), (Rows{{7, 8, 255}, {1, 2, 3}}));
  const std::string ascii = header("ascii", "element vertex 2\n" + names + xyz_double) +
                            "7 8 255 1 2 3\n300 -1 nan 4 5 6\n";
  const auto points = parse(ascii, "ply");
  EXPECT_EQ(rows_of(points.view), (Rows{{1, 2, 3}, {4, 5, 6}}));
  EXPECT_EQ(rows_of(points.colours), (Rows{{7, 8, 255}, {255, 0, 0}}));
  // No blue, floats, a list: no colours, and no error.
  for (const std::string part :
       {"property uchar red\nproperty uchar green\n",
        "property float red\nproperty float green\nproperty float blue\n"}) {
    const std::string text = header("ascii", "element vertex 1\n" + xyz_double + part) +
                             "1 2 3 4 5" + (part.find("blue") == std::string::npos ? "\n" : " 6\n");
    EXPECT_EQ(parse(text, "ply").colours.count, 0U);
    EXPECT_EQ(rows_of(parse(text, "ply").view), (Rows{{1, 2, 3}}));
  }
}

TEST(Ply, BigEndianAndPlanar) {
  const std::string bytes =
      header("binary_big_endian", "element vertex 1\nproperty short x\nproperty double y\n") +
      bytes_of_big_endian(std::int16_t{-2}) + bytes_of_big_endian(0.1);
  const auto points = parse(bytes, "ply");
  EXPECT_EQ(points.view.dimension, 2U);
  EXPECT_EQ(points.format, "ply (binary big-endian)");
  EXPECT_EQ(rows_of(points.view), (Rows{{-2, 0.1}}));
}

TEST(Ply, ElementsAndListsBeforeTheVertices) {
  const std::string elements =
      "element camera 1\nproperty float f\nelement face 2\n"
      "property list uchar int vertex_indices\nelement vertex 2\n" +
      xyz_double + "element tail 1\nproperty list uchar char c\n";
  const std::string bytes = header("binary_little_endian", elements) + bytes_of(1.0F) +
                            bytes_of(std::uint8_t{1}, 5) + bytes_of(std::uint8_t{0}) +
                            bytes_of(1.0, 2.0, 3.0, 4.0, 5.0, 6.0) + bytes_of(std::uint8_t{0});
  const auto points = parse(bytes, "ply");
  EXPECT_EQ(points.in_place, lies_ready);
  EXPECT_EQ(rows_of(points.view), (Rows{{1, 2, 3}, {4, 5, 6}}));
  const std::string within = header("binary_little_endian",
                                    "element vertex 2\nproperty list uchar short n\n"
                                    "property float x\nproperty float y\n") +
                             bytes_of(std::uint8_t{1}, std::int16_t{3}, 1.0F, 2.0F) +
                             bytes_of(std::uint8_t{0}, 3.0F, 4.0F);
  EXPECT_FALSE(parse(within, "ply").in_place);
  EXPECT_EQ(rows_of(parse(within, "ply").view), (Rows{{1, 2}, {3, 4}}));
}

TEST(Ply, AsciiKeepsDoubles) {
  const std::string bytes =
      header("ascii",
             "element group 1\nproperty int id\nelement vertex 2\nproperty list uchar int l\n"
             "property float x\nproperty float z\nproperty float y\nelement face 1\n"
             "property list uchar int vertex_indices\n") +
      "7\r\n2 5 6 0.1 3 2e-3\r\n\r\n0 1e300 nan -inf\n3 0 1 2\n";
  const auto points = parse(bytes, "ply");
  EXPECT_FALSE(points.in_place);
  EXPECT_EQ(points.format, "ply (ASCII)");
  ASSERT_EQ(points.view.count, 2U);
  EXPECT_EQ(rows_of(points.view)[0], (std::vector<double>{0.1, 2e-3, 3}));
  EXPECT_EQ(points.view.at(1, 0), 1e300);
  EXPECT_EQ(points.view.at(1, 1), -INFINITY);
  EXPECT_NE(points.view.at(1, 2), points.view.at(1, 2));
}

TEST(Ply, BlanksBehindTheFirstLine) {
  const std::string rest =
      "format ascii 1.0 \nelement vertex 1\t\nproperty float x \n"
      "property float y\nend_header \n1 2\n";
  for (const char* first : {"ply \n", "ply\t \n", "ply \r\n", "ply\r\n"})
    for (const char* format : {"ply", ""})
      EXPECT_EQ(rows_of(parse(first + rest, format).view), (Rows{{1, 2}})) << first;
  EXPECT_EQ(refusal("ply x\n" + rest, "ply"), "F:1: does not begin with 'ply'");
}

TEST(Ply, HeadersThatLie) {
  const std::string data = bytes_of(1.0, 2.0, 3.0);
  const auto binary = [&](const std::string& count, const std::string& more = "") {
    return header("binary_little_endian", "element vertex " + count + "\n" + xyz_double + more) +
           data;
  };
  const std::string offset = std::to_string(binary("1").size() - 24);
  EXPECT_EQ(refusal(binary("2"), "ply").find("F: byte " + offset + ": 2 records"), 0U);
  EXPECT_EQ(refusal(binary("768614336404564651"), "ply").find("F: byte "), 0U);  // * 24 overflows
  EXPECT_EQ(refusal(binary("-1"), "ply"), "F:4: element needs a name and a count");
  const std::string list = header("binary_little_endian",
                                  "element face 1\nproperty list int double i\n"
                                  "element vertex 1\n" +
                                      xyz_double) +
                           bytes_of(-1) + data;
  EXPECT_TRUE(has(refusal(list, "ply"), "list 'i' of -1 items"));
  const std::string ascii =
      header("ascii", "element vertex 2\nproperty float x\nproperty float y\n");
  EXPECT_EQ(refusal(ascii + "1 2\n", "ply").find("F:8: ends early"), 0U);
  EXPECT_EQ(refusal(ascii + "1 2\n3\n", "ply"), "F:9: property 'y' needs a number");
  EXPECT_EQ(refusal(ascii + "1 2\n3 4 5\n", "ply"), "F:9: '5' after the last property");
  EXPECT_EQ(refusal(ascii + "1 2\n3 four\n", "ply"), "F:9: 'four' is not a number");
  EXPECT_EQ(refusal(ascii + "1 2\n3 1e999\n", "ply"), "F:9: '1e999' exceeds the range of doubles");
}

// Nothing but the points is read, so nothing but them must be complete.
TEST(Ply, WhatFollowsTheVerticesMayBeCutOrTooLong) {
  const Rows rows{{1, 2}, {3, 4}};
  const auto remark = [&](const std::string& bytes) { return remark_on(bytes, "ply", rows); };
  const std::string vertices = "element vertex 2\nproperty float x\nproperty float y\n";
  const std::string list = "property list uchar int vertex_indices\n";
  const std::string faces = "element face 2\n" + list;
  const std::string records = bytes_of(1.F, 2.F, 3.F, 4.F);
  const std::string binary = header("binary_little_endian", vertices + faces) + records;
  EXPECT_EQ(remark(binary + std::string("\0\0", 2)), "");
  EXPECT_EQ(remark(binary + "\3"), "F: ends within its records of 'face'; the points are complete");
  EXPECT_EQ(remark(header("binary_little_endian", vertices) + records + "xy"),
            "F: 2 bytes after the last element are passed over");
  const std::string ascii = header("ascii", vertices + faces) + "1 2\n3 4\n";
  EXPECT_EQ(remark(ascii + "3 0 1 2\n3 0 1 2\n"), "");
  EXPECT_EQ(remark(ascii + "3 0 1 2\n"),
            "F: ends early, after 3 of 4 lines of elements; the points are complete");
  EXPECT_EQ(remark(ascii + "3 0 1 2\n3 0 1 2\nmore\n"),
            "F: text after the last element is passed over");
  // The line "element face" is lost, so that its list became one of the vertices.
  EXPECT_EQ(remark(header("ascii", vertices + list) + "1 2\n3 4 \n3 0 1 2\n"),
            "F: vertices without the list that the header gives them");
}

TEST(Ply, HeadersThatAreNone) {
  const std::string v = "element vertex 0\n" + xyz_double;
  EXPECT_EQ(refusal("plx\n", "ply"), "F:1: does not begin with 'ply'");
  EXPECT_EQ(refusal("ply\nformat ascii 1.0\n" + v, "ply"), "F:6: ends within the header");
  EXPECT_EQ(refusal("ply\n" + v + "end_header\n", "ply"), "F:6: header without a 'format' line");
  EXPECT_EQ(refusal(header("ebcdic", v), "ply"), "F:2: unknown format 'ebcdic'");
  EXPECT_EQ(refusal(header("ascii", "element face 0\nproperty int i\n"), "ply"),
            "F:6: no element 'vertex'");
  EXPECT_EQ(refusal(header("ascii", "element vertex 1\nproperty int x\n"), "ply"),
            "F:4: vertex has no property 'y'");
  EXPECT_EQ(refusal(header("ascii", v + "property int x\n"), "ply"),
            "F:4: property 'x' must be one number");
  EXPECT_EQ(refusal(header("ascii", v + v), "ply"), "F:8: second element 'vertex'");
  EXPECT_EQ(refusal(header("ascii", v + "property half h\n"), "ply"), "F:8: unknown type 'half'");
  EXPECT_EQ(refusal(header("ascii", v + "property list float int l\n"), "ply"),
            "F:8: 'float' cannot count a list");
  EXPECT_EQ(refusal(header("ascii", "property int x\n"), "ply"),
            "F:4: property before the first element");
  EXPECT_EQ(refusal(header("ascii", v + "surprise\n"), "ply"),
            "F:8: 'surprise' is no keyword of a PLY header");
  EXPECT_EQ(parse(header("ascii", v), "ply").view.count, 0U);
}

}  // namespace cullhull::testing::io_ply_test
