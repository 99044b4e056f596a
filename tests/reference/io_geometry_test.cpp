// What viewers and maps read: .geojson, .wkt, .glb, .vtp, byte by byte and number by number.
#include <cstring>
#include <nlohmann/json.hpp>

#include "cullhull/cullhull.hpp"
#include "tests/hull_fixtures.hpp"
#include "tests/io_fixtures.hpp"
#include "thrown.hpp"

namespace cullhull::testing::io_geometry_test {

std::string written(const PointView& points, const std::string& name,
                    Faces faces = Faces::polygons) {
  const TemporaryFolder folder;
  write_hull(folder.file(name), points, convex_hull(points), "", faces);
  return slurp(folder.file(name));
}

std::string written(const std::vector<double>& rows, std::uint32_t d, const std::string& name) {
  return written(PointView::row_major(rows.data(), rows.size() / d, d), name);
}

const std::vector<double> square_rows{0, 0, 0.5, 0.5, 0, 1, 1, 1, 1, 0, 0.5, 1};

TEST(Geometry, PolygonsAreClosedAndCounterClockwise) {
  EXPECT_EQ(written(square_rows, 2, "a.wkt"), "POLYGON ((0 0, 1 0, 1 1, 0 1, 0 0))\n");
  const auto json = nlohmann::json::parse(written(square_rows, 2, "a.geojson"));
  EXPECT_EQ(json["type"], "Feature");
  EXPECT_EQ(json["geometry"]["type"], "Polygon");
  EXPECT_EQ(json["geometry"]["coordinates"],
            nlohmann::json::parse("[[[0.0,0.0],[1.0,0.0],[1.0,1.0],[0.0,1.0],[0.0,0.0]]]"));
  EXPECT_EQ(json["properties"]["points"], 6);
  EXPECT_EQ(json["properties"]["perimeter"], 4.0);
  EXPECT_EQ(json["properties"]["area"], 1.0);
}

TEST(Geometry, CoordinatesReadBackAsTheSameDoubles) {
  const std::vector<double> rows{0.1, 1.0 / 3, 1.7976931348623157e308, 5e-324, -0.0, -1e-300};
  const auto json = nlohmann::json::parse(written(rows, 2, "a.geojson"));
  const auto& ring = json["geometry"]["coordinates"][0];
  ASSERT_EQ(ring.size(), 4U);
  for (const auto& corner : ring) {
    bool found = false;
    for (std::size_t i = 0; i < 6; i += 2)
      found =
          found || (corner[0].get<double>() == rows[i] && corner[1].get<double>() == rows[i + 1]);
    EXPECT_TRUE(found) << corner;
  }
}

TEST(Geometry, FlatHullsAreLinesAndPoints) {
  EXPECT_EQ(written({0, 0, 2, 2, 1, 1}, 2, "a.wkt"), "LINESTRING (0 0, 2 2)\n");
  EXPECT_EQ(written({3, 4, 3, 4}, 2, "a.wkt"), "POINT (3 4)\n");
  const auto line = nlohmann::json::parse(written({0, 0, 0, 2, 0, 1}, 2, "a.geojson"));
  EXPECT_EQ(line["geometry"],
            nlohmann::json::parse(R"({"type":"LineString","coordinates":[[0.0,0.0],[0.0,2.0]]})"));
  EXPECT_EQ(line["properties"]["perimeter"], 4.0);
  EXPECT_EQ(line["properties"]["area"], 0.0);
  const auto point = nlohmann::json::parse(written({3, 4}, 2, "a.geojson"));
  EXPECT_EQ(point["geometry"],
            nlohmann::json::parse(R"({"type":"Point","coordinates":[3.0,4.0]})"));
  const std::vector<double> none{0, 0};
  const PointView empty = PointView::row_major(none.data(), 0, 2);
  EXPECT_EQ(written(empty, "a.wkt"), "POLYGON EMPTY\n");
  EXPECT_TRUE(nlohmann::json::parse(written(empty, "a.geojson"))["geometry"].is_null());
}

TEST(Geometry, OtherDimensionsAreRefused) {
  const Example e = cube();
  for (const char* name : {"a.geojson", "a.wkt"})
    EXPECT_TRUE(has(error_of(ErrorCode::invalid_argument, [&] { (void)written(e.view(), name); }),
                    "holds hulls of 2D points, not 3D"));
}

template <class T>
T at(const std::string& bytes, std::size_t offset) {
  T value;
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

TEST(Glb, IsWellFormedAndClosed) {
  std::vector<double> rows = cube().coordinates;
  for (std::size_t i = 0; i < rows.size(); ++i) rows[i] += 1e9 + static_cast<double>(i % 3);
  const std::string glb = written(rows, 3, "a.glb");
  EXPECT_EQ(glb.substr(0, 4), "glTF");
  EXPECT_EQ(at<std::uint32_t>(glb, 4), 2U);
  EXPECT_EQ(at<std::uint32_t>(glb, 8), glb.size());
  const std::size_t json_size = at<std::uint32_t>(glb, 12);
  EXPECT_EQ(glb.substr(16, 4), "JSON");
  EXPECT_EQ(json_size % 4, 0U);
  const auto json = nlohmann::json::parse(glb.substr(20, json_size));
  const std::size_t binary = 28 + json_size;
  EXPECT_EQ(glb.substr(binary - 4, 4), std::string("BIN\0", 4));
  EXPECT_EQ(at<std::uint32_t>(glb, binary - 8), glb.size() - binary);
  EXPECT_EQ(json["buffers"][0]["byteLength"], glb.size() - binary);
  const auto& accessors = json["accessors"];
  ASSERT_EQ(accessors[0]["count"], 8);
  ASSERT_EQ(accessors[1]["count"], 36);
  EXPECT_EQ(accessors[0]["min"], nlohmann::json::parse("[-0.5,-0.5,-0.5]"));
  EXPECT_EQ(accessors[0]["max"], nlohmann::json::parse("[0.5,0.5,0.5]"));
  EXPECT_EQ(json["nodes"][0]["translation"],
            nlohmann::json::parse("[1000000000.5,1000000001.5,1000000002.5]"));
  const std::size_t indices = binary + json["bufferViews"][1]["byteOffset"].get<std::size_t>();
  double volume = 0;
  for (std::size_t t = 0; t < 12; ++t) {
    double v[3][3];
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t j = 0; j < 3; ++j)
        v[k][j] =
            at<float>(glb, binary + 12 * at<std::uint32_t>(glb, indices + 4 * (3 * t + k)) + 4 * j);
    volume += v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) -
              v[0][1] * (v[1][0] * v[2][2] - v[1][2] * v[2][0]) +
              v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
  }
  EXPECT_DOUBLE_EQ(volume / 6, 1);  // outward, and all of it
}

TEST(Glb, WhatItCannotHold) {
  const auto said = [](const std::vector<double>& rows) {
    return error_of(ErrorCode::invalid_argument, [&] { (void)written(rows, 3, "a.glb"); });
  };
  EXPECT_TRUE(has(said({0, 0, 0, 1, 1, 1}), "holds triangles"));
  EXPECT_TRUE(has(said({0, 0, 0, 1e300, 0, 0, 0, 1, 0}), "32-bit floats"));
}

TEST(Vtp, HoldsDoublesPolygonsLinesAndPoints) {
  const std::string plane = written({0.1, 0, 0, 1, 1, 1, 1, 0}, 2, "a.vtp");
  EXPECT_TRUE(has(plane,
                  "<DataArray type=\"Float64\" Name=\"Points\" NumberOfComponents=\"3\" "
                  "format=\"ascii\">\n0.1 0 0\n1 0 0\n1 1 0\n0 1 0\n</DataArray>"));
  EXPECT_TRUE(has(plane, "NumberOfPolys=\"1\""));
  EXPECT_TRUE(has(plane, "Name=\"offsets\" format=\"ascii\">\n4\n"));
  const Example e = cube();
  const std::string solid = written(e.view(), "a.vtp");
  EXPECT_TRUE(has(solid,
                  "NumberOfPoints=\"8\" NumberOfVerts=\"0\" NumberOfLines=\"0\" "
                  "NumberOfStrips=\"0\" NumberOfPolys=\"6\""));
  EXPECT_TRUE(has(solid, "Name=\"offsets\" format=\"ascii\">\n4 8 12 16 20 24\n"));
  EXPECT_TRUE(has(written(e.view(), "a.vtp", Faces::triangles), "NumberOfPolys=\"12\""));
  EXPECT_TRUE(has(written({0, 0, 0, 1, 2, 3}, 3, "a.vtp"), "<Lines>"));
  EXPECT_TRUE(has(written({0, 0, 0}, 3, "a.vtp"), "<Verts>"));
}

}  // namespace cullhull::testing::io_geometry_test
