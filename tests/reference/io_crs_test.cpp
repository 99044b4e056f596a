// Coordinate reference systems: what files state, and how GeoJSON names it.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "cullhull/cullhull.hpp"
#include "cullhull/group_hulls.hpp"
#include "cullhull/triangulation_io.hpp"
#include "io_fixtures.hpp"

namespace cullhull::io_crs_test {

using testing_support::has;

using testing::slurp;
using testing::TemporaryFolder;

const std::string zone_32 =
    R"(PROJCS["ETRS89 / UTM zone 32N",GEOGCS["ETRS89",AUTHORITY["EPSG","4258"]],)"
    R"(UNIT["metre",1,AUTHORITY["EPSG","9001"]],AUTHORITY["EPSG","25832"]])";
const std::string zone_32_of_2 =
    R"(PROJCRS["ETRS89 / UTM zone 32N",BASEGEOGCRS["ETRS89",ID["EPSG",4258]],)"
    R"(CONVERSION["UTM zone 32N",ID["EPSG",16032]], ID["EPSG", 25832]])";

TEST(IoCrs, CodesOfTextsAndUrns) {
  EXPECT_EQ(crs_code("EPSG:25832"), "EPSG:25832");
  EXPECT_EQ(crs_code("epsg:25832"), "EPSG:25832");
  EXPECT_EQ(crs_code("urn:ogc:def:crs:EPSG::25832"), "EPSG:25832");
  EXPECT_EQ(crs_code("urn:ogc:def:crs:EPSG:9.8.6:25832"), "EPSG:25832");
  EXPECT_EQ(crs_code("urn:ogc:def:crs:OGC:1.3:CRS84"), "OGC:CRS84");
  EXPECT_EQ(crs_code("http://www.opengis.net/def/crs/EPSG/0/25832"), "EPSG:25832");
  EXPECT_EQ(crs_code("ESRI:102025"), "ESRI:102025");
  for (const char* bad : {"", "25832", "EPSG:", ":25832", "EPSG:abc", "EPSG:25832:1", "a b:c",
                          "urn:ogc:def:crs:EPSG", "PROJCS[\"a:b\"]", "EPSG:25 832"})
    EXPECT_EQ(crs_code(bad), "") << bad;
}

TEST(IoCrs, CodesOfWkt) {
  EXPECT_EQ(crs_of_wkt(zone_32), "EPSG:25832");
  EXPECT_EQ(crs_of_wkt(zone_32_of_2), "EPSG:25832");
  // The horizontal part of a compound system, and what a bound one is bound from.
  EXPECT_EQ(crs_of_wkt("COMPD_CS[\"x\"," + zone_32 +
                       R"(,VERT_CS["h",AUTHORITY["EPSG","7837"]],AUTHORITY["EPSG","5555"]])"),
            "EPSG:25832");
  EXPECT_EQ(crs_of_wkt("BOUNDCRS[SOURCECRS[" + zone_32_of_2 + "],TARGETCRS[GEOGCRS[\"w\"]]]"),
            "EPSG:25832");
  EXPECT_EQ(crs_of_wkt(R"(GEOGCS["NAD27",DATUM["d",AUTHORITY["EPSG","6267"]],)"
                       R"(AUTHORITY["EPSG","4267"]])"),
            "EPSG:4267");
  // By name, as Esri's programs write them.
  const auto named = [](const std::string& name) {
    return crs_of_wkt("PROJCS[\"" + name + "\",GEOGCS[\"g\",DATUM[\"d\"]],UNIT[\"Meter\",1]]");
  };
  EXPECT_EQ(named("ETRS_1989_UTM_Zone_32N"), "EPSG:25832");
  EXPECT_EQ(named("WGS_1984_UTM_Zone_5N"), "EPSG:32605");
  EXPECT_EQ(named("WGS_1984_UTM_Zone_33S"), "EPSG:32733");
  EXPECT_EQ(named("WGS 84 / UTM zone 33S"), "EPSG:32733");
  EXPECT_EQ(named("NAD_1983_UTM_Zone_12N"), "EPSG:26912");
  EXPECT_EQ(named("WGS_1984_Web_Mercator_Auxiliary_Sphere"), "EPSG:3857");
  EXPECT_EQ(crs_of_wkt(R"(GEOGCS["GCS_WGS_1984",DATUM["D_WGS_1984"]])"), "EPSG:4326");
  for (const char* other : {"ETRS_1989_UTM_Zone_32S", "ETRS_1989_UTM_Zone_7N",
                            "WGS_1984_UTM_Zone_61N", "WGS_1984_UTM_Zone_0N", "WGS_1984_UTM_Zone_N",
                            "NAD_1983_UTM_Zone_12N_Feet", "NAD_1983_StatePlane_California_V", ""})
    EXPECT_EQ(named(other), "") << other;
  for (const std::string& broken :
       {std::string(), std::string("PROJCS["), std::string("PROJCS[\"a"), zone_32.substr(0, 20),
        std::string("LOCAL_CS[\"x\",AUTHORITY[\"EPSG\",\"1\"]]")})
    EXPECT_EQ(crs_of_wkt(broken), "") << broken;
}

std::string collection(const std::string& before, const std::string& after,
                       const std::string& properties = "{}") {
  return "{\"type\": \"FeatureCollection\", " + before +
         "\"features\": [{\"type\": \"Feature\", \"properties\": " + properties +
         ", \"geometry\": {\"type\": \"Point\", \"coordinates\": [1, 2]}}]" + after + "}\n";
}

const std::string member =
    R"("crs": {"type": "name", "properties": {"name": "urn:ogc:def:crs:EPSG::25832"}})";

TEST(IoCrs, OfGeoJson) {
  const TemporaryFolder f;
  const auto of = [&](const std::string& text) { return file_crs(f.write("a.geojson", text)); };
  EXPECT_EQ(of(collection("", "")), "");
  EXPECT_EQ(of(collection(member + ", ", "")), "EPSG:25832");
  EXPECT_EQ(of("\xEF\xBB\xBF" + collection(member + ", ", "")), "EPSG:25832");
  EXPECT_EQ(of(collection("", ", " + member)), "EPSG:25832");
  EXPECT_EQ(of(collection("", std::string(1 << 18, ' ') + ", " + member)), "EPSG:25832");
  EXPECT_EQ(of(collection(R"("crs" : {"type": "EPSG", "properties": {"code": 25832}}, )", "")),
            "EPSG:25832");
  EXPECT_EQ(of(collection(R"("crs": null, )", "")), "");
  EXPECT_EQ(of(collection(R"("crs": {"type": "link", "properties": {"href": "x"}}, )", "")), "");
  // What is only called so.
  EXPECT_EQ(of(collection("", "", R"({"crs": "EPSG:25833", "a": {"crs": {"b": 1}}})")), "");
  EXPECT_EQ(of(collection("", ", " + member, R"({"crs": "EPSG:25833"})")), "EPSG:25832");
  EXPECT_EQ(of("{\"crs\": {\"type\": \"name"), "");
  EXPECT_EQ(of("{"), "");
}

TEST(IoCrs, BesideAFile) {
  const TemporaryFolder f;
  const std::string table = f.write("a.csv", "x,y\n1,2\n");
  EXPECT_EQ(file_crs(table), "");
  f.write("a.prj", zone_32 + "\r\n");
  EXPECT_EQ(file_crs(table), "EPSG:25832");
  EXPECT_EQ(file_crs(f.write("a.csv.gz", "not even packed")), "EPSG:25832");
  f.write("a.prj", "EPSG:31467\n");
  EXPECT_EQ(file_crs(table), "EPSG:31467");
  f.write("a.prj", "Projection UTM\n");
  EXPECT_EQ(file_crs(table), "");
  f.write("a.prj", "");
  EXPECT_EQ(file_crs(table), "");
  // What a file says itself comes first.
  f.write("b.prj", "EPSG:4258");
  EXPECT_EQ(file_crs(f.write("b.geojson", collection(member + ", ", ""))), "EPSG:25832");
  EXPECT_EQ(file_crs("-"), "");
  EXPECT_EQ(file_crs(f.file("none.las")), "");
  EXPECT_EQ(file_crs(f.file("")), "");
}

TEST(IoCrs, OfSeveralFiles) {
  const TemporaryFolder f;
  const std::string a = f.write("a.csv", "1,2\n"), b = f.write("b.csv", "1,2\n"),
                    c = f.write("c.csv", "1,2\n");
  EXPECT_EQ(common_crs({}), "");
  EXPECT_EQ(common_crs({a, b}), "");
  f.write("b.prj", "EPSG:25832");
  EXPECT_EQ(common_crs({a, b, c}), "EPSG:25832");
  f.write("c.prj", "EPSG:25833");
  std::pair<std::string, std::string> differing;
  EXPECT_EQ(common_crs({a, b, c}, &differing), "");
  EXPECT_EQ(differing, std::pair(b, c));
  f.write("b.prj", "EPSG:4326");
  f.write("c.prj", "OGC:CRS84");
  EXPECT_EQ(common_crs({b, c}), "EPSG:4326");
}

constexpr double square[] = {0, 0, 4, 0, 4, 4, 0, 4, 1, 2};
const PointView points = PointView::row_major(square, 5, 2);

/// A column of 5 values.
PointColumn column(const std::string& name, const std::vector<std::string>& values, bool numeric) {
  PointColumn made;
  made.name = name;
  made.numeric = numeric;
  for (const std::string& value : values) made.values.add(value);
  return made;
}

TEST(IoCrs, EveryWriterOfGeoJsonNamesIt) {
  const TemporaryFolder f;
  const std::string path = f.file("a.geojson");
  const Triangulation t = delaunay(points);
  const auto write_all = [&](const std::string& crs) {
    std::vector<std::string> texts;
    const MapExtras extras{crs, {}};
    const auto keep = [&] { texts.push_back(slurp(path)); };
    const Hull hull = convex_hull(points);
    write_hull(path, points, hull, "", Faces::polygons, extras);
    keep();
    write_triangulation(path, points, t, "", {}, extras);
    keep();
    const double low[] = {-1, -1}, high[] = {5, 5};
    write_cells(path, clip_voronoi(points, t, low, high), "", Faces::by_format, extras);
    keep();
    write_alpha_shape(path, points, t, alpha_shape(points, t, INFINITY), INFINITY, "", extras);
    keep();
    write_points(path, points, {0, 4}, "", extras);
    keep();
    BlockOptions reading;
    reading.read.key = "k";
    (void)write_group_hulls({f.write("p.csv", "x,y,k\n0,0,a\n1,0,a\n0,1,a\n")}, path, reading, {},
                            extras);
    keep();
    return texts;
  };
  const std::vector<std::string> none = write_all(""), utm = write_all("EPSG:25832");
  for (std::size_t i = 0; i < none.size(); ++i) {
    EXPECT_FALSE(has(none[i], "crs"));
    // Nothing else differs.
    std::string without = utm[i];
    const std::size_t at = without.find(member + ", ");
    ASSERT_NE(at, std::string::npos) << utm[i];
    EXPECT_LT(at, 40U);
    without.erase(at, member.size() + 2);
    EXPECT_EQ(without, none[i]);
  }
  // GeoJSON's own system has no name in it.
  EXPECT_EQ(write_all("OGC:CRS84"), none);
  EXPECT_EQ(write_all("EPSG:4326"), none);
  EXPECT_EQ(file_crs(path), "");
  (void)write_all("ESRI:102025");
  EXPECT_EQ(file_crs(path), "ESRI:102025");
}

TEST(IoCrs, ColumnsBesidePoints) {
  const TemporaryFolder f;
  const MapExtras extras{"",
                         {column("name", {"a", "b \"c\"", "", "d, e", "\xC3\xA9"}, false),
                          column("depth", {"1", "2.5", "", "4", "5e3"}, true)}};
  const std::string path = f.file("a.geojson");
  write_points(path, points, {1, 2, 4}, "", extras);
  EXPECT_EQ(slurp(path),
            "{\"type\": \"FeatureCollection\", \"features\": [\n"
            "{\"type\": \"Feature\", \"properties\": {\"id\": 1, \"name\": \"b \\\"c\\\"\", "
            "\"depth\": 2.5}, \"geometry\": {\"type\": \"Point\", \"coordinates\": [4, 0]}},\n"
            "{\"type\": \"Feature\", \"properties\": {\"id\": 2, \"name\": null, \"depth\": null}, "
            "\"geometry\": {\"type\": \"Point\", \"coordinates\": [4, 4]}},\n"
            "{\"type\": \"Feature\", \"properties\": {\"id\": 4, \"name\": \"\xC3\xA9\", "
            "\"depth\": 5e3}, \"geometry\": {\"type\": \"Point\", \"coordinates\": [1, 2]}}\n]}\n");
  write_points(f.file("a.csv"), points, {1, 3}, "", extras);
  EXPECT_EQ(slurp(f.file("a.csv")), "x,y,name,depth\n4,0,\"b \"\"c\"\"\",2.5\n0,4,\"d, e\",4\n");
  for (const char* other : {"a.npy", "a.ply", "a.xyz", "a.txt"})
    EXPECT_THROW(write_points(f.file(other), points, {1}, "", extras), Error) << other;
  EXPECT_EQ(f.entries(), 2U);
  const Triangulation t = delaunay(points);
  const double low[] = {-1, -1}, high[] = {5, 5};
  write_cells(path, clip_voronoi(points, t, low, high), "", Faces::by_format, extras);
  EXPECT_TRUE(has(slurp(path), "{\"point\": 3, \"name\": \"d, e\", \"depth\": 4}"));
  const std::vector<double> line(5);
  EXPECT_THROW(write_points(path, PointView::row_major(line.data(), 5, 1), {0}), Error);
}

TEST(IoCrs, LinesOfGeoJson) {
  const TemporaryFolder f;
  const auto lines = [&](const std::string& geometry) {
    return read_lines(f.write("a.geojson", geometry));
  };
  const Polygons one = lines(R"({"type": "LineString", "coordinates": [[0, 0, 9], [1, 2]]})");
  EXPECT_EQ(one.corners, (std::vector<double>{0, 0, 1, 2}));
  EXPECT_EQ(one.ring_offsets, (std::vector<std::uint64_t>{0, 2}));
  const Polygons many = lines(
      R"({"type": "GeometryCollection", "geometries": [{"type": "Point", "coordinates": [9, 9]},)"
      R"({"type": "MultiLineString", "coordinates": [[[0, 0], [1, 1]], [[2, 2], [3, 3], [4, 4]]]},)"
      R"({"type": "Polygon", "coordinates": [[[0, 0], [1, 0], [0, 1], [0, 0]]]}]})");
  EXPECT_EQ(many.ring_offsets, (std::vector<std::uint64_t>{0, 2, 5, 9}));
  EXPECT_THROW(lines(R"({"type": "Point", "coordinates": [1, 2]})"), Error);
  EXPECT_THROW(lines(R"({"type": "LineString", "coordinates": [[1], [2, 3]]})"), Error);
  EXPECT_THROW(lines(R"({"type": "LineString", "coordinates": [[1, "a"], [2, 3]]})"), Error);
  // Lines bound nothing.
  EXPECT_THROW(read_polygons(f.write("b.geojson", R"({"type": "LineString", "coordinates": []})")),
               Error);
}

}  // namespace cullhull::io_crs_test
