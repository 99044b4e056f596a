// .obj .off .stl
#include "tests/io_fixtures.hpp"

namespace cullhull::testing::io_mesh_readers_test {

TEST(Obj, VerticesInFileOrderExactly) {
  const auto points = parse(
      "# comment\nmtllib a.mtl\nv 0.1 1000000.01 -3\nvn 0 0 1\nv 1 2 3 1.0 # weight\n"
      "  v\t4 5 6 0.5 0.5 0.5\r\nf 1//1 2//1 \\\n 3//1\ng a b\n\nv 0.1 1000000.01 -3",
      "obj");
  EXPECT_EQ(rows_of(points.view),
            (Rows{{0.1, 1000000.01, -3}, {1, 2, 3}, {4, 5, 6}, {0.1, 1000000.01, -3}}));
}

TEST(Obj, Refusals) {
  EXPECT_EQ(refusal("v 1 2 3\nv 1 2\n", "obj"), "F:2: vertex has 2 coordinates, not 3");
  EXPECT_EQ(refusal("v 1 2 x\n", "obj"), "F:1: 'x' is not a number");
  EXPECT_EQ(refusal("v 1 2 3 4 5 6 7 8\n", "obj"), "F:1: vertex has more than 7 numbers");
  EXPECT_EQ(refusal("v 1 2 \\\n3\n", "obj"), "F:1: '\\' is not a number");
  for (const char* number : {"3.1+e2", "1e", "1e+", "--1", "1,5", "0x1p", "1.2.3"}) {
    const std::string said = std::string("F:2: '") + number + "' is not a number";
    EXPECT_EQ(refusal(std::string("v 1 2 3\nv 1 ") + number + " 3\n", "obj"), said);
    EXPECT_EQ(refusal(std::string("v 1 2 3\nv 1 2 3 ") + number + "\n", "obj"), said);
  }
  EXPECT_EQ(refusal("f 1 2 3\n", "obj"), "F: no vertices ('v' lines)");
}

TEST(Off, PlainColouredAndHighDimensional) {
  EXPECT_EQ(rows_of(parse("OFF\n# c\n3 1 0\n0.1 0 0\n1 0 0 # c\n\n0 1 0\n3 0 1 2\n", "off").view),
            (Rows{{0.1, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(rows_of(parse("OFF 1 0 0\n1 2 3\n", "off").view), (Rows{{1, 2, 3}}));
  EXPECT_EQ(rows_of(parse("COFF\n1 0\n1 2 3 255 0 0 255\n", "off").view), (Rows{{1, 2, 3}}));
  EXPECT_EQ(rows_of(parse("nOFF\n2\n2 0 0\n1 2\n3 4\n", "off").view), (Rows{{1, 2}, {3, 4}}));
  // As `qconvex o` prints it.
  EXPECT_EQ(rows_of(parse("2\n3 3 3\n0 0 \n1 0 \n0 1 \n2 0 1 \n2 1 2 \n2 2 0 \n", "off").view),
            (Rows{{0, 0}, {1, 0}, {0, 1}}));
}

// trimesh and Open3D read all these.
TEST(Off, MagicWithoutABlankAndWhatFollowsTheFaces) {
  const Rows one{{1, 2, 3}};
  for (const char* format : {"off", ""}) {
    EXPECT_EQ(remark_on("\t OFF1 0 0 # a\n1 2 3\n", format, one), "");
    EXPECT_EQ(remark_on("COFF1 0\n1 2 3 255 0 0\n", format, one), "");
  }
  EXPECT_EQ(remark_on("OFF\n1 0 0\n1 2 3\nmore\n", "off", one),
            "F: text after the last face is passed over");
  EXPECT_EQ(remark_on("OFF\n1 3 0\n1 2 3\n3 0 0 0\n3 0", "off", one),
            "F: ends within its faces: 2 of 3 are there; the points are complete");
  EXPECT_EQ(remark_on("OFF\n1 18446744073709551 0\n1 2 3\n", "off", one),
            "F: ends within its faces: 0 of 18446744073709551 are there; the points are complete");
}

TEST(Obj, LinesThatNoKeywordBegins) {
  EXPECT_EQ(remark_on("v 1 2 3\n$ a comment\nv1 4 5 6\nv 4 5 6\n", "obj", {{1, 2, 3}, {4, 5, 6}}),
            "F: lines that no keyword of .obj begins are passed over: 2, the first is line 2, '$'");
  std::string many = "v 1 2 3\n";
  Rows rows{{1, 2, 3}};
  for (int i = 0; i < 300000; ++i) many += "v 1 2 3\n", rows.push_back({1, 2, 3});
  EXPECT_EQ(remark_on(many + "solid\nline\n", "obj", rows),
            "F: lines that no keyword of .obj begins are passed over: 2, the first is line 300002, "
            "'solid'");
}

TEST(Off, Refusals) {
  EXPECT_EQ(refusal("OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n", "off"),
            "F:2: promises 4 vertices, but 3 lines follow");
  EXPECT_EQ(refusal("OFF\n18446744073709551615 1 0\n0 0 0\n", "off"),
            "F:2: '18446744073709551615' is not the number of vertices");
  EXPECT_EQ(refusal("OFF\n9000000000000000000 9000000000000000000 0\n0 0 0\n", "off")
                .find("F:2: promises"),
            0U);
  EXPECT_EQ(refusal("OFF\n-1 1 0\n", "off"), "F:2: '-1' is not the number of vertices");
  EXPECT_EQ(refusal("OFF\n1 0 0\n0 0\n", "off"), "F:3: vertex has 2 coordinates, not 3");
  EXPECT_EQ(refusal("OFF\n1 0 0\n0 0 0 0\n", "off"),
            "F:3: '0' after the 3 coordinates of a vertex");
  EXPECT_EQ(refusal("OFFline 1 0 0\n", "off"), "F:1: 'OFFline' does not begin an OFF file");
  EXPECT_EQ(refusal("OFF8\n", "off"), "F:1: ends within the OFF header");
  EXPECT_EQ(refusal("OFF BINARY\n", "off"), "F:1: binary OFF is not supported");
  EXPECT_EQ(refusal("4OFF\n", "off"), "F:1: homogeneous coordinates (4OFF) are not supported");
  EXPECT_EQ(refusal("FOO\n", "off"), "F:1: 'FOO' does not begin an OFF file");
  EXPECT_EQ(refusal("OFF\n", "off"), "F:1: ends within the OFF header");
  EXPECT_EQ(refusal("nOFF\n0\n1 0 0\n", "off"), "F:2: dimension 0");
  EXPECT_EQ(refusal("nOFF\n4000\n9 0 0\n1\n1\n1\n1\n1\n1\n1\n1\n1\n", "off").find("F:2: dimension"),
            0U);
}

const std::string triangle =
    " facet normal 0 0 1\n  outer loop\n   vertex 0.1 0 0\n   vertex 1 0 0\n   vertex 0 1 0\n"
    "  endloop\n endfacet\n";

TEST(Stl, AsciiAndBinary) {
  const auto ascii = parse("solid a name with vertex in it\n" + triangle + "endsolid a\n", "stl");
  EXPECT_EQ(ascii.format, "stl (ASCII)");
  EXPECT_EQ(rows_of(ascii.view), (Rows{{0.1, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  // A binary header may begin with "solid" as well.
  std::string header = "solid but binary";
  header.resize(80, ' ');
  const std::string record = bytes_of(0.0F, 0.0F, 1.0F, 0.1F, 0.0F, 0.0F, 1.0F, 0.0F, 0.0F, 0.0F,
                                      1.0F, 0.0F, std::uint16_t{0});
  const std::string bytes = header + bytes_of(2U) + record + record;
  for (const char* format : {"stl", ""}) {
    const auto binary = parse(bytes, format);
    EXPECT_EQ(binary.format, "stl (binary)");
    EXPECT_EQ(binary.view.scalar, ScalarType::f32);
    const std::vector<double> first = {0.1F, 0, 0};
    EXPECT_EQ(rows_of(binary.view),
              (Rows{first, {1, 0, 0}, {0, 1, 0}, first, {1, 0, 0}, {0, 1, 0}}));
  }
  std::string lie = bytes;
  lie[80] = 3;
  lie[0] = 'S';
  EXPECT_EQ(refusal(lie, "stl"), "F: byte 80: promises 3 triangles (234 bytes) in a file of 184");
  EXPECT_EQ(refusal(lie.substr(0, 70), "stl"),
            "F: byte 70: ends within the header of a binary STL");
}

TEST(Stl, AsciiInCapitals) {
  std::string text = "solid a\n" + triangle + "endsolid a\n";
  for (char& c : text) c = static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  for (const char* format : {"stl", ""}) {
    const auto points = parse(text, format);
    EXPECT_EQ(points.format, "stl (ASCII)");
    EXPECT_EQ(rows_of(points.view), (Rows{{0.1, 0, 0}, {1, 0, 0}, {0, 1, 0}}));
  }
  EXPECT_EQ(refusal("SOLID\nVERTEX 1 2 3\n", "stl"), "F:2: ends without 'endsolid'");
  EXPECT_EQ(refusal("SOLID\nWHATEVER\nENDSOLID\n", "stl"), "F:2: 'WHATEVER' is no keyword of .stl");
}

TEST(Stl, AsciiRefusals) {
  EXPECT_EQ(refusal("solid\n" + triangle, "stl"), "F:8: ends without 'endsolid'");
  EXPECT_EQ(refusal("solid\nvertex 1 2 3\nendsolid\n", "stl"),
            "F:3: 1 vertices are not a whole number of triangles");
  EXPECT_EQ(refusal("solid\nvertex 1 2\nendsolid\n", "stl"),
            "F:2: vertex has 2 coordinates, not 3");
  EXPECT_EQ(refusal("solid\nvertex 1 2 3 4\nendsolid\n", "stl"), "F:2: '4' after a vertex");
  EXPECT_EQ(refusal("solid\nwhatever\nendsolid\n", "stl"), "F:2: 'whatever' is no keyword of .stl");
}

}  // namespace cullhull::testing::io_mesh_readers_test
