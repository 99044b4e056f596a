// Fields beside x, y and z as columns, keys and weights: of .ply, .pcd, structured .npy and
// GeoJSON.
#include <string>
#include <vector>

#include "cullhull/point_blocks.hpp"
#include "tests/io_fixtures.hpp"
#include "thrown.hpp"

namespace cullhull::testing::io_fields_test {

struct Read {
  Rows rows;
  std::vector<std::string> keys;
  friend bool operator==(const Read&, const Read&) = default;
};

/// In blocks of a point.
Read read_blocks(const std::string& path, const ReadOptions& read) {
  Read all;
  const auto put = [&](const PointView& block, std::uint64_t first) {
    const Rows rows = rows_of(block);
    all.rows.resize(std::max<std::size_t>(all.rows.size(), first + rows.size()));
    std::copy(rows.begin(), rows.end(), all.rows.begin() + static_cast<std::ptrdiff_t>(first));
  };
  BlockVisitor visitor;
  visitor.points = put;
  visitor.keyed = [&](const PointView& block, std::uint64_t first, const PointKeys& keys) {
    put(block, first);
    for (std::size_t i = 0; i < keys.size(); ++i) all.keys.emplace_back(keys[i]);
  };
  BlockOptions options;
  options.read = read;
  options.readers = 1;
  options.block_bytes = 1;
  visit_blocks({path}, visitor, options);
  return all;
}

ReadOptions options_of(const std::string& columns, const std::string& key = "") {
  ReadOptions options;
  options.columns = columns;
  options.key = key;
  return options;
}

/// Columns, key and weights of a file whose points have x, y, z = 10i, 10i + 1, 10i + 2 and fields
/// `label` = i and `w` = i / 2.
void expect_fields(const std::string& path) {
  EXPECT_EQ(read_blocks(path, options_of("", "label")),
            (Read{{{0, 1, 2}, {10, 11, 12}, {20, 21, 22}}, {"0", "1", "2"}}))
      << path;
  EXPECT_EQ(read_blocks(path, options_of("w,y", "label")),
            (Read{{{0, 1}, {0.5, 11}, {1, 21}}, {"0", "1", "2"}}))
      << path;
  EXPECT_EQ(read_blocks(path, options_of("x", "x")), (Read{{{0}, {10}, {20}}, {"0", "10", "20"}}))
      << path;
  EXPECT_EQ(read_blocks(path, options_of("label")).rows, (Rows{{0}, {1}, {2}})) << path;
  EXPECT_EQ(read_blocks(path, options_of("1:3,W")).rows,
            (Rows{{1, 2, 0}, {11, 12, .5}, {21, 22, 1}}))
      << path;
  for (const char* columns : {"w", "x,w", "label,x", "z,y,x"})
    EXPECT_EQ(rows_of(open_points(path, options_of(columns)).points()),
              read_blocks(path, options_of(columns)).rows)
        << path << columns;
  ReadOptions weighted = options_of("x,y");
  weighted.weights = "w";
  const PointFile file = open_points(path, weighted);
  EXPECT_EQ(rows_of(file.points()), (Rows{{0, 1}, {10, 11}, {20, 21}}));
  EXPECT_EQ(file.weights(), (std::vector<double>{0, .5, 1}));
  EXPECT_TRUE(
      has(error_of(ErrorCode::invalid_argument, [&] { open_points(path, options_of("x,nope")); }),
          "'label'"));
}

TEST(IoFields, Ply) {
  const TemporaryFolder folder;
  const auto head = [](const std::string& kind, bool list) {
    return "ply\nformat " + kind +
           " 1.0\nelement vertex 3\nproperty uchar label\nproperty double x\nproperty double y\n" +
           (list ? "property list uchar int q\n" : "") +
           "property double z\nproperty float w\nend_header\n";
  };
  std::string ascii, listed, little, big;
  for (int i = 0; i < 3; ++i) {
    const double x = 10 * i;
    const std::string n = std::to_string(i), w = std::to_string(i / 2.0);
    const auto row = [&](const std::string& q) {
      return n + " " + std::to_string(10 * i) + " " + std::to_string(10 * i + 1) + q + " " +
             std::to_string(10 * i + 2) + " " + w + "\n";
    };
    ascii += row("");
    listed += row(" 2 7 7");
    little += bytes_of(static_cast<std::uint8_t>(i), x, x + 1, x + 2, static_cast<float>(i) / 2);
    big += bytes_of_big_endian(static_cast<std::uint8_t>(i)) + bytes_of_big_endian(x) +
           bytes_of_big_endian(x + 1) + bytes_of_big_endian(x + 2) +
           bytes_of_big_endian(static_cast<float>(i) / 2);
  }
  expect_fields(folder.write("a.ply", head("ascii", false) + ascii));
  expect_fields(folder.write("b.ply", head("ascii", true) + listed));
  expect_fields(folder.write("c.ply", head("binary_little_endian", false) + little));
  expect_fields(folder.write("d.ply", head("binary_big_endian", false) + big));
}

TEST(IoFields, Pcd) {
  const TemporaryFolder folder;
  const auto head = [](const std::string& kind) {
    return "VERSION 0.7\nFIELDS label x _ y z hist w\nSIZE 1 8 1 8 8 4 4\nTYPE U F U F F F F\n"
           "COUNT 1 1 3 1 1 2 1\nWIDTH 3\nHEIGHT 1\nPOINTS 3\nDATA " +
           kind + "\n";
  };
  std::string ascii, binary;
  for (int i = 0; i < 3; ++i) {
    const double x = 10 * i;
    ascii += std::to_string(i) + " " + std::to_string(10 * i) + " 0 0 0 " +
             std::to_string(10 * i + 1) + " " + std::to_string(10 * i + 2) + " 8 9 " +
             std::to_string(i / 2.0) + "\n";
    binary += bytes_of(static_cast<std::uint8_t>(i), x, std::uint8_t{0}, std::uint8_t{0},
                       std::uint8_t{0}, x + 1, x + 2, 8.F, 9.F, static_cast<float>(i) / 2);
  }
  expect_fields(folder.write("a.pcd", head("ascii") + ascii));
  expect_fields(folder.write("b.pcd", head("binary") + binary));
}

TEST(IoFields, StructuredNpy) {
  const TemporaryFolder folder;
  const auto head = [](const std::string& fields) {
    return "{'descr': [" + fields + "], 'fortran_order': False, 'shape': (3,), }";
  };
  std::string little, big, mixed;
  for (int i = 0; i < 3; ++i) {
    const double x = 10 * i;
    const float w = static_cast<float>(i) / 2;
    little += bytes_of(x, x + 1, x + 2, static_cast<std::uint8_t>(i), std::uint32_t{0}, w);
    big += bytes_of_big_endian(x) + bytes_of_big_endian(x + 1) + bytes_of_big_endian(x + 2) +
           bytes_of_big_endian(static_cast<std::int64_t>(i)) + bytes_of_big_endian(w);
    mixed +=
        bytes_of(static_cast<std::int64_t>(i), static_cast<float>(x), std::uint16_t{0},
                 std::uint16_t{0}, std::uint16_t{0}, x + 1, static_cast<std::int16_t>(x + 2), w);
  }
  // As PDAL and pyntcloud write them, with padding and with a field of several items.
  expect_fields(folder.write(
      "a.npy", npy(head("('X', '<f8'), ('Y', '<f8'), ('Z', '<f8'), ('label', '|u1'), ('', '|V4'), "
                        "('w', '<f4')"),
                   little)));
  expect_fields(folder.write("b.npy", npy(head("('x', '>f8'), ('y', '>f8'), ('z', '>f8'), "
                                               "('label', '>i8'), ('w', '>f4')"),
                                          big)));
  expect_fields(folder.write("c.npy", npy(head("('label', '<i8'), ('x', '<f4'), "
                                               "(('Red', 'rgb'), '<u2', (3,)), ('y', '<f8'), "
                                               "('z', '<i2'), ('w', '<f4')"),
                                          mixed)));
  const std::string plain = folder.write(
      "d.npy", npy("{'descr': [('X', '<f8'), ('Y', '<f8')], 'fortran_order': False, 'shape': (1,)}",
                   bytes_of(1.0, 2.0)));
  EXPECT_EQ(rows_of(open_points(plain).points()), (Rows{{1, 2}}));
  EXPECT_EQ(open_points(plain).format(), "npy (structured)");
}

std::string feature(const std::string& properties, const std::string& coordinates) {
  return R"({"type":"Feature","properties":)" + properties +
         R"(,"geometry":{"type":"Point","coordinates":)" + coordinates + "}}";
}

TEST(IoFields, PropertiesOfGeoJson) {
  const TemporaryFolder folder;
  std::string features;
  for (int i = 0; i < 3; ++i) {
    const std::string n = std::to_string(i);
    features += (i > 0 ? "," : "") +
                feature(R"({"label":)" + n + R"(,"deep":{"label":9,"w":[1]},"w":)" +
                            std::to_string(i / 2.0) + "}",
                        "[" + std::to_string(10 * i) + "," + std::to_string(10 * i + 1) + "," +
                            std::to_string(10 * i + 2) + "]");
  }
  expect_fields(
      folder.write("a.geojson", R"({"type":"FeatureCollection","features":[)" + features + "]}"));
  // A value is that of every vertex of its feature, before or behind its geometry.
  const std::string parts = folder.write(
      "b.geojson",
      R"({"type":"FeatureCollection","features":[{"type":"Feature","geometry":{"type":"Polygon",)"
      R"("coordinates":[[[0,0],[1,0],[1,1],[0,0]]]},"properties":{"Region":"north","on":true}},)" +
          feature("null", "[5,5]") + "," + feature(R"({"region":"south"})", "[6,6]") + "]}");
  EXPECT_EQ(read_blocks(parts, options_of("", "Region")).keys,
            (std::vector<std::string>{"north", "north", "north", "", ""}));
  EXPECT_EQ(read_blocks(parts, options_of("", "on")).keys,
            (std::vector<std::string>{"true", "true", "true", "", ""}));
  for (const auto& [columns, why] :
       {std::pair{"x,y,on", ":1: property 'on' of this feature is not a number: 'true'"},
        {"x,region", ":1: property 'region' of this feature has no value"},
        {"x,nope", "no column 'nope'; there are 'x', 'y', 'Region', 'on', 'region'"},
        {"x,REGION", "more than one column 'REGION'"}})
    EXPECT_TRUE(has(error_of([&, c = columns] { open_points(parts, options_of(c)); }), why));
}

// RFC 8142 and its relatives: a text after the other.
TEST(IoFields, SequencesOfGeoJsonTexts) {
  const TemporaryFolder folder;
  const std::string one = feature(R"({"k":"a"})", "[1,2]"), two = feature(R"({"k":"b"})", "[3,4]");
  const Rows both{{1, 2}, {3, 4}};
  for (const char* name : {"a.geojsonl", "a.geojsons", "a.geojsonseq", "a.geojson", "a.json", "a"})
    for (const std::string& text : {one + "\n" + two + "\n", "\x1E" + one + "\n\x1E" + two + "\n",
                                    "\n" + one + two, one + "\r\n\r\n" + two}) {
      const std::string path = folder.write(name, text);
      EXPECT_EQ(rows_of(open_points(path).points()), both) << name << text;
      EXPECT_EQ(read_blocks(path, options_of("", "k")).keys, (std::vector<std::string>{"a", "b"}));
    }
  for (const auto& [text, line] : {std::pair{one + "\n" + two + "\nx", 3},
                                   {one + "\n{\"type\":", 2},
                                   {one + "\n\n[1]", 3},
                                   {one + "\n" + feature("{}", "[1,null]"), 2}})
    EXPECT_TRUE(has(error_of([&, t = text] { open_points(folder.write("a.geojsonl", t)); }),
                    "a.geojsonl:" + std::to_string(line) + ":"));
}

}  // namespace cullhull::testing::io_fields_test
