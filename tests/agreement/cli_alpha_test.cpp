// cullhull alpha as users meet it.
#include <cmath>

#include "agreement/expect_json.hpp"

namespace cullhull::cli_alpha_test {

using nlohmann::json;
using namespace testing;

/// A ring of 3 x 3 unit squares without the one in the middle, and a triangle far away.
std::string squares_and_triangle() {
  std::string text;
  for (int x = 0; x < 4; ++x)
    for (int y = 0; y < 4; ++y) text += std::to_string(x) + " " + std::to_string(y) + "\n";
  return text + "10 0\n11 0\n10 1\n";
}

TEST(CliAlpha, SaysWhatThereIs) {
  const Folder f;
  write_file(f / "p.txt", squares_and_triangle());
  const Ran ran = run_well({"alpha", f / "p.txt", "--alpha", "all-points"});
  EXPECT_TRUE(has(ran.out, "alpha      0.7071067811865476\n"));
  EXPECT_TRUE(has(ran.out, "cells      19 of 23, 15 facets around 2 regions\n"));
  const Ran one = run_app({"alpha", f / "p.txt"});
  EXPECT_TRUE(has(one.out, "around 1 region\n"));
  const Ran all = run_app({"alpha", f / "p.txt", "--alpha", "inf", "--json=" + (f / "r.json")});
  EXPECT_TRUE(has(all.out, "cells      23 of 23"));
  EXPECT_EQ(expect_document(read_file(f / "r.json"), "alpha_report")["alpha"], "inf");
}

// A point is missing in the middle of a grid: the shape has a hole of four half squares.
TEST(CliAlpha, SaysAreaAndPerimeter) {
  const Folder f;
  std::string ring, cube, line;
  for (int x = 0; x < 7; ++x)
    for (int y = 0; y < 7; ++y)
      if (x != 3 || y != 3) ring += std::to_string(x) + " " + std::to_string(y) + "\n";
  for (int x = 0; x < 3; ++x)
    for (int y = 0; y < 3; ++y)
      for (int z = 0; z < 3; ++z)
        cube += std::to_string(x) + " " + std::to_string(y) + " " + std::to_string(z) + "\n";
  const auto said = [&](const std::string& text, const std::vector<std::string>& more) {
    write_file(f / "p.txt", text);
    const Ran ran = run_well(joined({"alpha", f / "p.txt", "--json=" + (f / "r.json")}, more));
    return std::pair{ran.out, json_in(f / "r.json")};
  };
  const auto [plane, of_plane] = said(ring, {"--alpha", "0.71"});
  EXPECT_TRUE(has(plane, "\nperimeter  29.65685424949238"));
  EXPECT_TRUE(has(plane, "\narea       34\n"));
  EXPECT_DOUBLE_EQ(of_plane["perimeter"].get<double>(), 24 + 4 * std::sqrt(2.0));
  EXPECT_EQ(of_plane["area"], 34.0);
  const auto [whole, of_whole] = said(ring, {"--ratio", "1"});
  EXPECT_EQ(of_whole["perimeter"], 24.0);
  EXPECT_EQ(of_whole["area"], 36.0);
  const auto [space, of_space] = said(cube, {});
  EXPECT_TRUE(has(space, "\narea       24\nvolume     8\n"));
  EXPECT_EQ(of_space["volume"], 8.0);
  const auto [huge, of_huge] = said("0 0\n1e150 0\n0 1e150\n1e150 1e150\n", {});
  EXPECT_DOUBLE_EQ(of_huge["area"].get<double>(), 1e300) << huge;
  const auto [tiny, of_tiny] = said("0 0\n1e-150 0\n0 1e-150\n1e-150 1e-150\n", {});
  EXPECT_DOUBLE_EQ(of_tiny["area"].get<double>(), 1e-300) << tiny;
  const auto [flat, of_flat] = said("0 0 1\n2 0 1\n0 3 1\n2 3 1\n", {});
  EXPECT_EQ(of_flat["area"], 6.0) << flat;
  const auto [segment, of_line] = said("0 0\n3 4\n6 8\n", {"--alpha", "inf"});
  EXPECT_EQ(of_line["length"], 10.0) << segment;
  const auto [point, of_point] = said("0 0\n", {});
  EXPECT_FALSE(of_point.contains("area")) << point;
}

TEST(CliAlpha, AShapeForEachGroup) {
  const Folder f;
  std::string table = "x,y,town\n", ulm;
  for (int x = 0; x < 4; ++x)
    for (int y = 0; y < 4; ++y)
      if (x < 2 || y < 2) {
        table += std::to_string(x) + "," + std::to_string(y) + ",Ulm\n";
        ulm += std::to_string(x) + " " + std::to_string(y) + "\n";
      }
  table += "9,9,Bonn\n8,8,Bonn\n7,7,Bonn\n5,5,Kiel\n5,5,Kiel\n";
  write_file(f / "p.csv", table);
  write_file(f / "ulm.txt", ulm);
  for (const std::vector<std::string>& how : command_lines(
           {"", "--alpha 0.75", "--alpha all-points", "--edge-length 1.2", "--ratio 0.3"})) {
    const auto run = [&](std::vector<std::string> words) {
      words.insert(words.end(), how.begin(), how.end());
      return run_well(words).out;
    };
    for (const char* name : {"g.geojson", "g.csv", "g.json"}) {
      const std::string said = run({"alpha", f / "p.csv", "--by", "town", "-o", f / name});
      EXPECT_TRUE(has(said, "groups     3\n"));
    }
    (void)run({"alpha", f / "ulm.txt", "-q", "-o", f / "one.wkt", "--json=" + (f / "r.json")});
    const json one = json_in(f / "r.json");
    const json map = json_in(f / "g.geojson");
    ASSERT_EQ(map["features"].size(), 3U);
    const json& bonn = map["features"][0];
    const json& kiel = map["features"][1];
    const json& third = map["features"][2];
    EXPECT_EQ(bonn["properties"]["town"], "Bonn");
    EXPECT_EQ(kiel["geometry"], json::parse(R"({"type": "Point", "coordinates": [5, 5]})"));
    EXPECT_EQ(third["properties"]["town"], "Ulm");
    EXPECT_EQ(third["properties"]["points"], 12);
    EXPECT_EQ(third["properties"]["area"], one["area"]);
    EXPECT_EQ(third["properties"]["perimeter"], one["perimeter"]);
    const char* const limit = one["alpha"].is_null() ? "edge_length" : "alpha";
    EXPECT_EQ(third["properties"][limit], one[limit]);
    EXPECT_EQ(third["geometry"]["type"], "Polygon");
    EXPECT_EQ(third["geometry"]["coordinates"][0].size(),
              one["facet_count"].get<std::size_t>() + 1);
    const std::string csv = read_file(f / "g.csv");
    EXPECT_EQ(csv.substr(0, csv.find('\n')),
              std::string("town,points,") + limit + ",perimeter,area,wkt");
    const json records = json_in(f / "g.json");
    EXPECT_EQ(records["kind"], "group_shapes");
    const json& record = records["groups"][2];
    EXPECT_EQ(record["cells"].size(), one["cell_count"]);
    EXPECT_EQ(record["facets"].size(), one["facet_count"]);
    EXPECT_EQ(record["area"], one["area"]);
    EXPECT_EQ(record["coordinates"].size(), 12U);
  }
  run_well({"alpha", f / "p.csv", "-q", "--by", "town", "-o", f / "g.csv", "--alpha", "inf"});
  EXPECT_TRUE(has(read_file(f / "g.csv"), "\nBonn,3,inf,5.656854249492381,0,"));
  expect_error({"alpha", f / "p.csv", "--by", "town"}, 2,
               "--by writes the shapes of groups to one -o");
  expect_error({"alpha", f / "p.csv", "--by", "town", "-o", f / "g.ply"}, 2,
               "must end in .geojson, .csv or .json");
  expect_error({"alpha", f / "p.csv", "--by", "city", "-o", f / "g.csv"}, 2, "no column 'city'");
  expect_error(
      {"alpha", f / "p.csv", "--by", "town", "-o", f / "g.csv", "--alpha", "1", "--ratio", "1"}, 2,
      "exclude");
}

/// A comb: by the length of edges what is between its teeth is outside, and there are no holes.
TEST(CliAlpha, ByTheLengthOfEdges) {
  const Folder f;
  std::string text;
  for (int x = 0; x <= 9; ++x)
    for (int y = 0; y <= 5; ++y)
      if (y <= 1 || x % 4 <= 1) text += std::to_string(x) + " " + std::to_string(y) + "\n";
  write_file(f / "p.txt", text);
  const Ran ran =
      run_well({"alpha", f / "p.txt", "--edge-length", "1", "-o", f / "a.wkt", "-o", f / "a.json"});
  EXPECT_TRUE(has(ran.out, "edges      replaced where longer than 1\n"));
  EXPECT_TRUE(has(ran.out, "around 1 region\n"));
  const auto points_of_ring = [&] {
    const std::string wkt = read_file(f / "a.wkt");
    return std::count(wkt.begin(), wkt.end(), ',') + 1;
  };
  EXPECT_EQ(points_of_ring(), 45);  // every point, and the first again
  EXPECT_EQ(json_in(f / "a.json")["facets"].size(), 44U);
  run_well({"alpha", f / "p.txt", "--ratio", "1", "-q", "-o", f / "a.wkt"});
  EXPECT_EQ(points_of_ring(), 25);  // those on the convex hull
  const Ran half = run_app({"alpha", f / "p.txt", "--ratio", "0.5", "--json"});
  EXPECT_EQ(nlohmann::json::parse(half.out)["alpha"], nullptr);
  EXPECT_EQ(nlohmann::json::parse(half.out)["edge_length"], (1 + std::sqrt(10)) / 2);
  expect_error({"alpha", f / "p.txt", "--ratio", "1", "--edge-length", "2"}, 2,
               "exclude one another");
  expect_error({"alpha", f / "p.txt", "--ratio", "1", "--alpha", "2"}, 2, "exclude one another");
  expect_error({"alpha", f / "p.txt", "--ratio", "1.5"}, 2, "--ratio");
  expect_error({"alpha", f / "p.txt", "--edge-length", "-1"}, 2, "--edge-length");
  expect_error({"alpha", f / "p.txt", "--edge-length", "nan"}, 2, "--edge-length");
  write_file(f / "solid.txt", "0 0 0\n1 0 0\n0 1 0\n0 0 1\n");
  expect_error({"alpha", f / "solid.txt", "--ratio", "0.5"}, 2, "points in a plane");
}

TEST(CliAlpha, WritesPolygonsWithHoles) {
  const Folder f;
  // A square with a square hole, whose corners are farther apart than anything else.
  std::string text;
  for (int x = 0; x <= 8; ++x)
    for (int y = 0; y <= 8; ++y)
      if (x < 3 || x > 5 || y < 3 || y > 5)
        text += std::to_string(x) + " " + std::to_string(y) + "\n";
  write_file(f / "p.txt", text);
  run_well({"alpha", f / "p.txt", "-q", "--alpha", "0.75", "-o", f / "a.geojson", "-o", f / "a.wkt",
            "-o", f / "a.json", "-o", f / "a.vtk", "-o", f / "a.off"});
  const json map = json_in(f / "a.geojson");
  ASSERT_EQ(map["features"].size(), 1U);
  const json rings = map["features"][0]["geometry"]["coordinates"];
  ASSERT_EQ(rings.size(), 2U);
  EXPECT_EQ(rings[0].size(), 33U);  // closed
  EXPECT_EQ(rings[0].front(), rings[0].back());
  EXPECT_EQ(rings[1].size(), 13U);  // its corners are cut
  EXPECT_EQ(read_file(f / "a.wkt").substr(0, 35), "GEOMETRYCOLLECTION (POLYGON ((0 0, ");
  const json a = json_in(f / "a.json");
  EXPECT_EQ(a["alpha"], 0.75);
  EXPECT_EQ(a["cells"].size(), 2U * (64 - 16) + 4);
  EXPECT_EQ(a["facets"].size(), 44U);
  EXPECT_EQ(read_file(f / "a.off").substr(0, 15), "OFF\n72 100 172\n");
  EXPECT_TRUE(has(read_file(f / "a.vtk"), "CELLS 100 400\n"));
}

TEST(CliAlpha, FewPointsAndRefusals) {
  const Folder f;
  write_file(f / "line.txt", "0 0\n1 1\n2 2\n");
  const Ran ran = run_well({"alpha", f / "line.txt", "-o", f / "a.wkt", "-o", f / "a.ply"});
  EXPECT_EQ(read_file(f / "a.wkt"), "GEOMETRYCOLLECTION (LINESTRING (0 0, 2 2))\n");
  expect_error({"alpha", f / "line.txt", "--alpha", "-1"}, 2, "a number >= 0");
  expect_error({"alpha", f / "line.txt", "--alpha", "auto"}, 2, "expected one-region");
  expect_error({"alpha", f / "line.txt", "-o", f / "a.xyz"}, 2, "");
  expect_error({"alpha", f / "none.txt"}, 1, "none.txt");
}

}  // namespace cullhull::cli_alpha_test
