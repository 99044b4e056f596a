// Points that are read from GeoJSON and WKT.
#include "cullhull/io.hpp"
#include "io/formats/geometry_positions.hpp"
#include "tests/io_fixtures.hpp"

namespace cullhull::testing::io_geometry_points_test {

Rows points_of(std::string_view text, const std::string& format, const std::string& columns = "") {
  ReadOptions options;
  options.columns = columns;
  return rows_of(parse(text, format, options).view);
}

std::string geometry(const std::string& type, const std::string& coordinates) {
  return "{\"type\": \"" + type + "\", \"coordinates\": " + coordinates + "}";
}

TEST(GeoJsonPoints, TheVerticesOfEveryGeometry) {
  const auto read = [](const std::string& type, const std::string& coordinates) {
    return points_of(geometry(type, coordinates), "geojson");
  };
  EXPECT_EQ(read("Point", "[1, 2]"), (Rows{{1, 2}}));
  EXPECT_EQ(read("Point", "[1, 2.5, -3e2]"), (Rows{{1, 2.5, -300}}));
  EXPECT_EQ(read("MultiPoint", "[[1, 2], [3, 4], [1, 2]]"), (Rows{{1, 2}, {3, 4}, {1, 2}}));
  EXPECT_EQ(read("LineString", "[[1, 2], [3, 4], [1, 2]]"), (Rows{{1, 2}, {3, 4}, {1, 2}}));
  EXPECT_EQ(read("MultiLineString", "[[[1, 2], [3, 4]], [[5, 6], [5, 6]]]"),
            (Rows{{1, 2}, {3, 4}, {5, 6}, {5, 6}}));
  // The last position of a ring is its first.
  const std::string ring = "[[0, 0], [1, 0], [0, 1], [0, 0]]";
  const Rows triangle{{0, 0}, {1, 0}, {0, 1}};
  EXPECT_EQ(read("Polygon", "[" + ring + "]"), triangle);
  EXPECT_EQ(read("Polygon", "[[[0, 0], [1, 0], [0, 1]]]"), triangle) << "a ring left open";
  Rows two = triangle;
  two.insert(two.end(), {{5, 5}, {6, 5}, {5, 6}});
  const std::string other = "[[5, 5], [6, 5], [5, 6], [5, 5]]";
  EXPECT_EQ(read("Polygon", "[" + ring + ", " + other + "]"), two);
  EXPECT_EQ(read("MultiPolygon", "[[" + ring + "], [" + other + "]]"), two);
  EXPECT_EQ(read("MultiPolygon", "[[" + ring + ", " + other + "]]"), two);
  // The type may come last.
  EXPECT_EQ(points_of("{\"coordinates\": [" + ring + "], \"type\": \"Polygon\"}", "geojson"),
            triangle);
}

TEST(GeoJsonPoints, FeaturesAndCollectionsInFileOrder) {
  const std::string text = R"({"type": "FeatureCollection", "crs": {"coordinates": [9]},
    "features": [
      {"type": "Feature", "id": 7, "bbox": [0, 0, 1, 1],
       "properties": {"coordinates": [[8, 8]], "geometry": {"type": "?"}, "features": null},
       "geometry": {"type": "Point", "coordinates": [1, 2]}},
      {"type": "Feature", "geometry": null, "properties": null},
      {"type": "Feature", "properties": {}, "geometry": {"type": "GeometryCollection",
       "geometries": [{"type": "MultiPoint", "coordinates": [[3, 4]]},
                      {"type": "Polygon", "coordinates": []},
                      {"type": "Point", "coordinates": [5, 6]}]}}]})";
  EXPECT_EQ(points_of(text, "geojson"), (Rows{{1, 2}, {3, 4}, {5, 6}}));
  EXPECT_EQ(points_of("\xEF\xBB\xBF" + text, ""), (Rows{{1, 2}, {3, 4}, {5, 6}})) << "by content";
  EXPECT_EQ(points_of(text, "geojson", "y,x"), (Rows{{2, 1}, {4, 3}, {6, 5}}));
  const auto none = parse(R"({"type": "FeatureCollection", "features": []})", "geojson");
  EXPECT_EQ(none.view.count, 0U);
  EXPECT_EQ(none.view.dimension, 2U);
  EXPECT_EQ(none.format, "geojson");
}

TEST(GeoJsonPoints, NumbersAreRoundedOnce) {
  EXPECT_EQ(points_of(geometry("Point", "[0.1, 1000000.01]"), "geojson"),
            (Rows{{0.1, 1000000.01}}));
  EXPECT_EQ(points_of(geometry("Point", "[9007199254740993, -9007199254740993]"), "geojson"),
            (Rows{{9007199254740992.0, -9007199254740992.0}}));
  EXPECT_TRUE(std::signbit(points_of(geometry("Point", "[-0.0, 1]"), "geojson")[0][0]));
}

TEST(GeoJsonPoints, HeightsOfSomeAlone) {
  const std::string mixed = geometry("MultiPoint", "[[1, 2, 3], [4, 5, 6], [7, 8]]");
  EXPECT_EQ(refusal(mixed, "geojson"),
            "F:1: position 2 has 2 coordinates, others have 3; --columns x,y takes two of each");
  EXPECT_EQ(points_of(mixed, "geojson", "x,y"), (Rows{{1, 2}, {4, 5}, {7, 8}}));
  EXPECT_EQ(points_of(geometry("MultiPoint", "[[7, 8], [1, 2, 3]]"), "geojson", "y"),
            (Rows{{8}, {2}}));
  EXPECT_EQ(points_of(geometry("MultiPoint", "[[1, 2, 3]]"), "geojson", "z,x"), (Rows{{3, 1}}));
}

TEST(GeoJsonPoints, Refusals) {
  const auto says = [](const std::string& text) { return refusal(text, "geojson"); };
  const std::string no_points =
      "F: is JSON but not GeoJSON, and holds no points; a hull file is for certify and view";
  EXPECT_EQ(says("{\"kind\": \"hull\", \"points\": {\"count\": 3}}"), no_points);
  EXPECT_EQ(says("[1, 2]"),
            "F:1: row 0 of a list of points: a number where a list of numbers is expected, as in "
            "[[0, 0], [1, 0]]");
  EXPECT_EQ(says("[[1, 2],\n[3, null]]").find("F:2: row 1 of a list of points: null"), 0U);
  EXPECT_EQ(says("[[1, [2]]]").find("F:1: row 0 of a list of points: a list"), 0U);
  EXPECT_EQ(says("[[1, 2], []]"), "F:1: row 1 of a list of points is empty");
  EXPECT_EQ(says("[[1, 2],\n[3"), "F:2: not valid JSON");
  EXPECT_EQ(says("[[1, 1e999]]"), "F:1: a number exceeds the range of doubles");
  EXPECT_EQ(says("[]"), "F: no points");
  EXPECT_EQ(says("{\"points\": 3}"), no_points);
  EXPECT_EQ(says("null"), no_points);
  EXPECT_EQ(says("3"), no_points);
  EXPECT_EQ(says("{\"type\": \"FeatureCollection\", \"features\": [3]}"), no_points);
  EXPECT_EQ(says("{\"type\": \"FeatureCollection\",\n\"features\": [}"), "F:2: not valid JSON");
  EXPECT_EQ(says("{\"type\": \"Point\",\n\n\"coordinates\": [1, 1e999]}"),
            "F:3: a number exceeds the range of doubles");
  EXPECT_EQ(says("{\"type\": \"FeatureCollection\", \"features\": {}}"),
            "F:1: not GeoJSON: 'features' is not a list");
  EXPECT_EQ(says(geometry("Circle", "[1, 2]")), "F:1: not GeoJSON: its type is 'Circle'");
  EXPECT_EQ(says(geometry("Feature", "[1, 2]")), "F:1: a Feature with coordinates");
  EXPECT_EQ(says("{\"type\": \"Point\"}"), "F:1: a Point without coordinates");
  EXPECT_EQ(says(geometry("Point", "null")), "F:1: a Point without coordinates");
  EXPECT_EQ(says(geometry("Point", "[1]")), "F:1: position 0 has one coordinate");
  EXPECT_EQ(says(geometry("Point", "[1, 2, 3, 4]")),
            "F:1: position 0 has more than three coordinates");
  EXPECT_EQ(says(geometry("Point", "[1, \"2\"]")), "F:1: a string among coordinates");
  EXPECT_EQ(says(geometry("Point", "[1, null]")), "F:1: null among coordinates");
  EXPECT_EQ(says(geometry("Point", "[1, true]")), "F:1: true or false among coordinates");
  EXPECT_EQ(says(geometry("Point", "[1, {}]")), "F:1: an object among coordinates");
  EXPECT_EQ(says(geometry("Point", "[1, [2]]")),
            "F:1: position 0 has a list among its coordinates");
  EXPECT_EQ(says(geometry("MultiPoint", "[[1, 2], 3]")),
            "F:1: position 1: a number beside lists of coordinates");
  EXPECT_EQ(says(geometry("MultiPoint", "[[1, 2], [[3, 4]]]")),
            "F:1: position 1 is nested differently from those before it");
  EXPECT_EQ(says(geometry("Polygon", "[[1, 2]]")),
            "F:1: the coordinates of a Polygon are nested 2 deep, not 3");
  EXPECT_EQ(says(geometry("Point", "7")), "F:1: a number among coordinates");
  EXPECT_EQ(says("{\"type\": \"MultiPoint\", \"coordinates\": [[1, 2],\n[3,\n4], [5\n,6], [7\n]]}"),
            "F:4: position 3 has one coordinate");
  EXPECT_EQ(says("{\"type\": \"LineString\",\n\"coordinates\": [[1, 2],\n\n[3, NaN]]}"),
            "F:4: not valid JSON, which has no NaN and no infinity");
  EXPECT_EQ(says(geometry("Point", "[-Infinity, 1]")),
            "F:1: not valid JSON, which has no NaN and no infinity");
}

TEST(WktPoints, TheVerticesOfEveryGeometry) {
  const auto read = [](const std::string& text) { return points_of(text, "wkt"); };
  EXPECT_EQ(read("POINT (1 2)"), (Rows{{1, 2}}));
  EXPECT_EQ(read("point(1 -2.5e1)"), (Rows{{1, -25}}));
  for (const char* text :
       {"MULTIPOINT (1 2, 3 4)", "MULTIPOINT ((1 2), (3 4))", "LINESTRING(1 2,3 4)",
        "MultiLineString((1 2,3 4))", "POINT (1 2)\n# more\n\nPOINT (3 4)\n",
        "POINT (1 2);POINT (3 4);", "SRID=4326;POINT (1 2)\nSRID=4326; POINT(3\t4)\r\n",
        "GEOMETRYCOLLECTION (POINT (1 2), POINT EMPTY,\n"
        "GEOMETRYCOLLECTION (POINT (3 4), GEOMETRYCOLLECTION EMPTY))"})
    EXPECT_EQ(read(text), (Rows{{1, 2}, {3, 4}})) << text;
  const Rows triangle{{0, 0}, {1, 0}, {0, 1}};
  for (const char* text :
       {"POLYGON ((0 0, 1 0, 0 1, 0 0))", "TRIANGLE ((0 0, 1 0, 0 1, 0 0))",
        "MULTIPOLYGON (((0 0, 1 0, 0 1, 0 0)))", "MULTIPOLYGON (EMPTY, ((0 0, 1 0, 0 1, 0 0)))",
        "LINEARRING (0 0, 1 0, 0 1, 0 0)", "POLYGON ((0 0, 1 0, 0 1))"})
    EXPECT_EQ(read(text), triangle) << text;
  Rows two = triangle;
  two.insert(two.end(), {{5, 5}, {6, 5}, {5, 6}});
  for (const char* text : {"POLYGON ((0 0, 1 0, 0 1, 0 0), (5 5, 6 5, 5 6, 5 5))",
                           "TIN (((0 0, 1 0, 0 1, 0 0)), ((5 5, 6 5, 5 6, 5 5)))"})
    EXPECT_EQ(read(text), two) << text;
}

TEST(WktPoints, HeightsAndMeasures) {
  const auto read = [](const std::string& text) { return points_of(text, "wkt"); };
  for (const char* text : {"POINT Z (1 2 3)", "POINTZ(1 2 3)", "POINT (1 2 3)",
                           "POINT ZM (1 2 3 4)", "POINTZM (1 2 3 4)", "POINT (1 2 3 4)"})
    EXPECT_EQ(read(text), (Rows{{1, 2, 3}})) << text;
  for (const char* text : {"POINT M (1 2 9)", "POINTM (1 2 9)"})
    EXPECT_EQ(read(text), (Rows{{1, 2}})) << text;
  EXPECT_EQ(parse("MULTIPOINT Z EMPTY", "wkt").view.dimension, 3U);
  EXPECT_EQ(parse("MULTIPOINT EMPTY", "wkt").view.dimension, 2U);
  EXPECT_EQ(parse("MULTIPOINT EMPTY", "wkt").view.count, 0U);
  const std::string mixed = "POINT (1 2)\nPOINT (3 4 5)";
  EXPECT_EQ(refusal(mixed, "wkt"),
            "F:2: a position of 3 coordinates, where others have 2; --columns x,y takes two of "
            "each");
  EXPECT_EQ(points_of(mixed, "wkt", "x,y"), (Rows{{1, 2}, {3, 4}}));
}

TEST(WktPoints, KnownByContentAndNaNByItsLine) {
  EXPECT_EQ(parse("\n# a map\nMULTIPOINT ((1 2), (3 4))", "").format, "wkt");
  EXPECT_EQ(parse("SRID=25832;POINT Z EMPTY", "").format, "wkt");
  EXPECT_EQ(parse("point,x,y\n1,2,3\n", "").format, "text");
  EXPECT_EQ(points_of("POINT (nan 1)", "wkt").size(), 1U);
  const std::string text =
      "POLYGON ((0 0, 1 0, 0 1, 0 0))\nPOINT (4 4)\nMULTIPOINT ((5 5),\n(nan 6))\n";
  const internal::Source source{"F", text.data(), text.size()};
  EXPECT_EQ(internal::line_of_wkt_point(source, 2), 1U);
  EXPECT_EQ(internal::line_of_wkt_point(source, 3), 2U);
  EXPECT_EQ(internal::line_of_wkt_point(source, 5), 4U);
  const TemporaryFolder folder;
  EXPECT_EQ(line_of_point(folder.write("a.wkt", text), 5), 4U);
}

TEST(WktPoints, Refusals) {
  const auto says = [](const std::string& text) { return refusal(text, "wkt"); };
  EXPECT_EQ(says("\n\n"), "F:3: no geometry");
  EXPECT_EQ(says("POINT (1 2)\nCIRCLE (1 2)"),
            "F:2: a geometry such as POINT (1 2) is expected, not 'CIRCLE (1 2)'");
  EXPECT_EQ(says("POINT 1 2"), "F:1: '(' or EMPTY is expected, not '1 2'");
  EXPECT_EQ(says("POINT (1)"), "F:1: a second coordinate is expected, not ')'");
  EXPECT_EQ(says("POINT ()"), "F:1: a position is expected, not ')'");
  EXPECT_EQ(says("POINT (1 x)"), "F:1: a number is expected, not 'x)'");
  EXPECT_EQ(says("POINT (1 2x)"), "F:1: a number is expected, not 'x)'");
  EXPECT_EQ(says("POINT (1 2 3 4 5)"), "F:1: a position of more than four numbers");
  EXPECT_EQ(says("POINT (1 1e999)"), "F:1: a number exceeds the range of doubles");
  EXPECT_EQ(says("POINT Z (1 2)"), "F:1: a position of 2 numbers in a POINT Z");
  EXPECT_EQ(says("POINT M (1 2)"), "F:1: a position of 2 numbers in a POINT M");
  EXPECT_EQ(says("POINT ((1 2))"), "F:1: more parentheses than a POINT has");
  EXPECT_EQ(says("POLYGON (1 2)"), "F:1: fewer parentheses than a POLYGON has");
  EXPECT_EQ(says("POINT (1 2"), "F:1: ends where ',' or ')' is expected");
  EXPECT_EQ(says("GEOMETRYCOLLECTION (POINT (1 2)"), "F:1: ends where ',' or ')' is expected");
  EXPECT_EQ(says("SRID=x;POINT (1 2)"), "F:1: ';' is expected, not 'x;POINT (1 2)'");
}

TEST(GeometryPoints, FilesCompressedOnesAndBlocks) {
  const TemporaryFolder folder;
  const Rows want{{1, 2}, {3, 4}};
  const std::string files[] = {
      folder.write("a.geojson", geometry("MultiPoint", "[[1, 2], [3, 4]]")),
      folder.write("a.json", geometry("MultiPoint", "[[1, 2], [3, 4]]")),
      folder.write("a.wkt", "MULTIPOINT (1 2, 3 4)"),
      folder.write("a.unknown", "MULTIPOINT (1 2, 3 4)")};
  for (const std::string& file : files) {
    const PointFile read = open_points(file);
    EXPECT_EQ(rows_of(read.points()), want) << file;
    EXPECT_FALSE(read.mapped());
    EXPECT_EQ(rows_in_blocks(file), want) << file;
  }
  const std::string bad = folder.write("bad.geojson", "{\"type\": 1}");
  EXPECT_NE(error_whole_and_in_blocks(bad), "");
}

}  // namespace cullhull::testing::io_geometry_points_test
