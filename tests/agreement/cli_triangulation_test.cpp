// cullhull delaunay and cullhull voronoi as users meet them.
#include <algorithm>
#include <sstream>

#include "agreement/expect_json.hpp"
#include "cullhull/io.hpp"

namespace cullhull::cli_triangulation_test {

using nlohmann::json;
using namespace testing;

const char* const square = "0 0\n2 0\n0 2\n2 2\n1 1\n";

TEST(CliTriangulation, SaysWhatThereIs) {
  const Folder f;
  write_file(f / "p.txt", square);
  const Ran ran = run_well({"delaunay", f / "p.txt", "--certify"});
  EXPECT_TRUE(has(ran.out, "cells      4, 4 facets on the hull\n"));
  EXPECT_TRUE(has(ran.out, "certified  yes\n"));
  const Ran dual = run_app({"voronoi", f / "p.txt"});
  EXPECT_TRUE(has(dual.out, "diagram    4 vertices, 8 ridges\n"));
}

TEST(CliTriangulation, PrintsAsQhullDoes) {
  const Folder f;
  write_file(f / "p.txt", square);
  EXPECT_EQ(run_app({"delaunay", f / "p.txt", "--format", "i Fx"}).out,
            "4\n0 1 4\n0 4 2\n1 3 4\n2 4 3\n4\n0\n1\n2\n3\n");
  EXPECT_EQ(run_app({"delaunay", f / "p.txt", "--format", "Fn"}).out,
            "4\n3 2 1 -1\n3 3 -1 0\n3 3 0 -1\n3 2 -1 1\n");
  EXPECT_EQ(run_app({"voronoi", f / "p.txt", "--format", "p"}).out, "2\n4\n1 0\n0 1\n2 1\n1 2\n");
  EXPECT_EQ(run_app({"voronoi", f / "p.txt", "--format", "Fv"}).out,
            "8\n4 0 1 1 0\n4 0 2 0 2\n4 0 4 2 1\n4 1 3 3 0\n4 1 4 1 3\n4 2 3 0 4\n4 2 4 4 2\n"
            "4 3 4 3 4\n");
  EXPECT_EQ(run_app({"voronoi", f / "p.txt", "--format", "o"}).out,
            "2\n5 5 1\n-10.101 -10.101\n1 0\n0 1\n2 1\n1 2\n3 0 1 2\n3 0 3 1\n3 0 2 4\n3 0 4 3\n"
            "4 1 3 4 2\n");
  expect_error({"delaunay", f / "p.txt", "--format", "Fv"}, 2, "expected i Fn Fx p");
}

TEST(CliTriangulation, WritesFiles) {
  const Folder f;
  write_file(f / "p.txt", square);
  run_well({"delaunay", f / "p.txt", "-q", "-o", f / "t.json", "-o", f / "t.off", "-o", f / "t.vtk",
            "-o", f / "t.wkt", "-o", f / "t.geojson", "-o", f / "t.ply"});
  const json t = json_in(f / "t.json");
  EXPECT_EQ(t["cells"], json::parse("[[0,1,4],[0,4,2],[1,3,4],[2,4,3]]"));
  EXPECT_EQ(t["neighbours"], json::parse("[[2,1,-1],[3,-1,0],[3,0,-1],[2,-1,1]]"));
  EXPECT_EQ(read_file(f / "t.off").substr(0, 10), "OFF\n5 4 8\n");
  EXPECT_TRUE(has(read_file(f / "t.vtk"), "CELLS 4 16\n3 0 1 4\n"));
  EXPECT_EQ(read_file(f / "t.wkt").substr(0, 59),
            "GEOMETRYCOLLECTION (POLYGON ((0 0, 2 0, 1 1, 0 0)), POLYGON");
  const json map = json_in(f / "t.geojson");
  EXPECT_EQ(map["features"].size(), 4U);
  EXPECT_EQ(map["features"][0]["geometry"]["coordinates"][0].size(), 4U);
}

// A surface of terrain: triangulated by place, its corners at their heights.
TEST(CliTriangulation, TerrainKeepsItsHeights) {
  const Folder f;
  write_file(f / "t.csv", "id,x,y,z\na,0,0,10\nb,2,0,20.5\nc,0,2,-30\nd,2,2,4e2\ne,1,1,0.1\n");
  std::vector<std::string> words{"delaunay", f / "t.csv", "--columns", "x,y",
                                 "--height", "z",         "-q"};
  const std::vector<std::vector<double>> rows{
      {0, 0, 10}, {2, 0, 20.5}, {0, 2, -30}, {2, 2, 400}, {1, 1, 0.1}};
  for (const char* ending : {"obj", "ply", "off", "stl", "vtk", "vtp", "glb", "json"}) {
    words.push_back("-o");
    words.push_back(f / ("tin." + std::string(ending)));
  }
  const Ran ran = run_well(words);
  for (const char* ending : {"obj", "ply", "off"}) {
    const PointFile file = open_points(f / ("tin." + std::string(ending)));
    ASSERT_EQ(file.points().count, 5U) << ending;
    for (std::uint64_t i = 0; i < 5; ++i)
      for (std::uint32_t j = 0; j < 3; ++j) EXPECT_EQ(file.points().at(i, j), rows[i][j]) << ending;
  }
  const PointFile stl = open_points(f / "tin.stl");
  ASSERT_EQ(stl.points().count, 12U);  // four triangles, 0 1 4 first
  EXPECT_EQ(stl.points().at(1, 2), 20.5);
  EXPECT_TRUE(has(read_file(f / "tin.obj"), "v 2 2 400\n"));
  EXPECT_TRUE(has(read_file(f / "tin.obj"), "f 1 2 5\n"));
  EXPECT_TRUE(has(read_file(f / "tin.vtk"), "\n0 2 -30\n"));
  const json t = json_in(f / "tin.json");
  EXPECT_EQ(t["heights"], json::parse("[10, 20.5, -30, 400, 0.1]"));
  // Of a file, and flat without.
  write_file(f / "h.txt", "1\n2\n3\n4\n5\n");
  const Ran other = run_well({"delaunay", f / "t.csv", "--columns", "x,y", "--height", f / "h.txt",
                              "-q", "-o", f / "h.obj", "-o", f / "h.json"});
  EXPECT_TRUE(has(read_file(f / "h.obj"), "v 1 1 5\n"));
  run_well({"delaunay", f / "t.csv", "--columns", "x,y", "-q", "-o", f / "h.obj"});
  EXPECT_TRUE(has(read_file(f / "h.obj"), "v 1 1 0\n"));
}

// A grid with steps of 1 and a point far off: without its long triangles the grid remains.
TEST(CliTriangulation, LongTrianglesAreDropped) {
  const Folder f;
  std::string table = "x,y,z\n";
  for (int x = 0; x < 4; ++x)
    for (int y = 0; y < 4; ++y)
      table +=
          std::to_string(x) + "," + std::to_string(y) + "," + std::to_string(10 * x + y) + "\n";
  write_file(f / "t.csv", table + "50,1,7\n");
  const auto said = [&](const std::string& length, const std::vector<std::string>& more = {}) {
    return run_well(joined({"delaunay", f / "t.csv", "--columns", "x,y", "--height", "z", "-o",
                            f / "t.off", "-o", f / "t.json", "--json=" + (f / "r.json"),
                            "--max-edge", length},
                           more))
        .out;
  };
  const std::string kept = said("1.5");
  EXPECT_TRUE(has(kept, "cells      18, 12 facets on the hull\n"));
  EXPECT_TRUE(has(kept, "cells with an edge longer than 1.5\n"));
  const json report = json_in(f / "r.json");
  const std::size_t dropped = report["dropped_cell_count"];
  EXPECT_GT(dropped, 2U);
  EXPECT_EQ(report["cell_count"], 18);
  const json t = json_in(f / "t.json");
  EXPECT_EQ(t["cells"].size(), 18U);
  EXPECT_EQ(t["hull_facets"].size(), 12U);
  EXPECT_EQ(t["hidden"], json::parse("[16]"));
  EXPECT_EQ(t["heights"].size(), 17U);
  for (std::size_t c = 0; c < 18; ++c)
    for (std::size_t j = 0; j < 3; ++j) {
      const int o = t["neighbours"][c][j];
      if (o < 0) continue;
      const json& back = t["neighbours"][static_cast<std::size_t>(o)];
      EXPECT_NE(std::find(back.begin(), back.end(), c), back.end());
    }
  EXPECT_TRUE(has(read_file(f / "t.off"), "\n2 3 23\n")) << "heights are kept";
  EXPECT_EQ(read_file(f / "t.off").substr(0, 10), "OFF\n17 18 ");
  // Exactly: the diagonal of a square of the grid is as long as sqrt(2), rounded down it is longer.
  (void)said("1.4142135623730951");
  EXPECT_EQ(json_in(f / "t.json")["cells"].size(), 18U);
  (void)said("1.414213562373095");
  EXPECT_EQ(json_in(f / "t.json")["cells"].size(), 0U);
  (void)said("0");
  EXPECT_EQ(json_in(f / "r.json")["cell_count"], 0);
  (void)said("1000", {"--certify"});
  EXPECT_EQ(json_in(f / "r.json")["dropped_cell_count"], 0);
  // With forced edges, in space, and on a line.
  write_file(f / "e.txt", "0 15\n");
  (void)said("1.5", {"--edges", f / "e.txt"});
  EXPECT_EQ(json_in(f / "r.json")["piece_count"], 3);
  write_file(f / "s.txt", "0 0 0\n1 0 0\n0 1 0\n0 0 1\n9 9 9\n");
  const Ran space = run_app({"delaunay", f / "s.txt", "--max-edge", "2"});
  EXPECT_TRUE(has(space.out, "cells      1, 4 facets on the hull\n"));
  write_file(f / "l.txt", "0 0\n1 0\n5 0\n6 0\n");
  const Ran line = run_app({"delaunay", f / "l.txt", "--max-edge", "2"});
  EXPECT_TRUE(has(line.out, "cells      2, 4 facets on the hull\n"));
  write_file(f / "one.txt", "0 0\n");
  run_well({"delaunay", f / "one.txt", "--max-edge", "2"});
  expect_error({"delaunay", f / "s.txt", "--max-edge", "-1"}, 2, "not a finite number from 0 on");
  expect_error({"voronoi", f / "t.csv", "--max-edge", "1"}, 2, "unknown option --max-edge");
}

TEST(CliTriangulation, HeightsThatCannotBeKept) {
  const Folder f;
  write_file(f / "t.csv", "x,y,z\n0,0,10\n2,0,20\n0,2,nan\n");
  const auto error = [&](std::vector<std::string> more, int status, const char* say) {
    expect_error(joined({"delaunay", f / "t.csv", "-q"}, more), status, say);
  };
  error({"--columns", "x,y", "--height", "z", "-o", f / "t.obj"}, 1, "height of point 2 is NaN");
  error({"--columns", "x,y", "--height", "z", "-o", f / "t.wkt"}, 2, ".wkt holds no heights");
  error({"--columns", "x,y", "--height", "w", "-o", f / "t.obj"}, 2, "no column 'w'");
  error({"--columns", "x,y", "--height", "x,z", "-o", f / "t.obj"}, 2,
        "columns 'x,z': 2 columns; expected one number per point");
  error({"--columns", "x,y,z", "--height", "z", "-o", f / "t.json"}, 2,
        "--height needs 2D points, but these are 3D");
  // A column of heights is no coordinate unless --columns says so.
  error({"--height", "z", "-o", f / "t.json"}, 1, "height of point 2 is NaN");
  error({"-o", f / "t.obj"}, 2,
        ".obj holds triangles of 2D points, and these are 3D; .vtk holds tetrahedra");
}

TEST(CliTriangulation, WritesCells) {
  const Folder f;
  write_file(f / "p.txt", square);
  const Ran ran =
      run_well({"voronoi", f / "p.txt", "-q", "--box", "0,0,2,2", "--measures", f / "m.txt", "-o",
                f / "c.geojson", "-o", f / "c.json", "-o", f / "c.off"});
  std::istringstream in(read_file(f / "m.txt"));
  std::vector<double> measures;
  for (double v; in >> v;) measures.push_back(v);
  EXPECT_EQ(measures, (std::vector<double>{0.5, 0.5, 0.5, 0.5, 2}));
  const json map = json_in(f / "c.geojson");
  ASSERT_EQ(map["features"].size(), 5U);
  EXPECT_EQ(map["features"][4]["geometry"]["coordinates"][0].size(), 5U);
  const json v = json_in(f / "c.json");
  EXPECT_EQ(v["vertices"], json::parse("[[1.0,0.0],[0.0,1.0],[2.0,1.0],[1.0,2.0]]"));
  EXPECT_EQ(v["regions"][0], json::parse("[-1,0,1]"));
  write_points(f / "ball.npy", "ball", 300, 3);
  run_well({"voronoi", f / "ball.npy", "-q", "-o", f / "b.obj", "--measures", f / "b.npy"});
  EXPECT_EQ(open_points(f / "b.npy").points().count, 300U);
}

/// A polygon with a dent and a hole, and a second one.
TEST(CliTriangulation, ClipsCellsToPolygons) {
  const Folder f;
  write_file(f / "p.csv", "x,y\n1,1\n3,1\n1,3\n6,2\n");
  write_file(f / "c.geojson",
             R"({"type": "FeatureCollection", "features": [
 {"type": "Feature", "properties": {}, "geometry": {"type": "MultiPolygon", "coordinates":
  [[[[0,0],[4,0],[4,4],[2,1],[0,4],[0,0]], [[0.5,0.5],[0.5,1],[1,1],[1,0.5],[0.5,0.5]]]]}},
 {"type": "Feature", "geometry": null},
 {"type": "Feature", "geometry": {"type": "GeometryCollection", "geometries": [
  {"type": "Point", "coordinates": [1, 1]},
  {"type": "Polygon", "coordinates": [[[6,0,9],[7,0,9],[7,1,9]]]}]}}]})");
  const std::vector<std::string> call{"voronoi",       f / "p.csv",     "-q",
                                      "--clip",        f / "c.geojson", "-o",
                                      f / "o.geojson", "--measures",    f / "m.txt"};
  const Ran ran = run_well(call);
  EXPECT_EQ(read_file(f / "m.txt"),
            "3.4166666666666665\n4.888888888888889\n1.3333333333333333\n0.6111111111111112\n");
  const json map = json_in(f / "o.geojson");
  EXPECT_EQ(map["features"][0]["geometry"]["coordinates"].size(), 2U);  // a hole
  EXPECT_EQ(map["features"][3]["geometry"]["type"], "MultiPolygon");
  EXPECT_EQ(map["features"][3]["geometry"]["coordinates"].size(), 2U);
  run_well({"voronoi", f / "p.csv", "-q", "--clip", f / "c.geojson", "-o", f / "o.wkt"});
  EXPECT_TRUE(
      has(read_file(f / "o.wkt"), "MULTIPOLYGON (((3.7777777777777777 3.6666666666666665, "));
  // The region from a pipe.
  const Ran pipe = run_well(
      {"voronoi", f / "p.csv", "-q", "--clip", "-", "--measures", f / "n.txt"}, f / "c.geojson");
  EXPECT_EQ(read_file(f / "n.txt"), read_file(f / "m.txt"));
}

TEST(CliTriangulation, RefusesRegionsThatAreNone) {
  const Folder f;
  write_file(f / "p.csv", "x,y\n1,1\n3,1\n1,3\n6,2\n");
  const auto refused = [&](const std::string& region, int status, const std::string& message) {
    write_file(f / "c.geojson", region);
    expect_error({"voronoi", f / "p.csv", "--clip", f / "c.geojson", "-o", f / "o.wkt"}, status,
                 message);
  };
  const std::string polygon = R"({"type": "Polygon", "coordinates": )";
  refused("", 1, "empty");
  refused("x,y\n1,2\n", 1, ":1: not GeoJSON: not valid JSON");
  refused("[1, 2]", 1, "not GeoJSON: an object is expected");
  refused(R"({"type": "Topology"})", 1, "its type is \"Topology\"");
  refused(R"({"type": "Point", "coordinates": [1, 2]})", 1, "there is no polygon in it");
  refused(polygon + "[[[0,0],[1]]]}", 1, "ring 0 has a position without x and y");
  refused(polygon + "[[[0,0],[1,\"a\"]]]}", 1,
          "ring 0 has a coordinate that is not a finite number");
  refused(polygon + "[[[0,0],[1,1]]]}", 1, "ring 0 of the polygon has 2 corners");
  refused(polygon + "[[[0,0],[1,1],[0,1],[1,0]]]}", 1, "c.geojson: the boundary of the polygon");
  refused(polygon + "[[[0,0],[1,1],[2,2]]]}", 1, "spans dimension 1 only");
  write_file(f / "c.geojson",
             polygon + "[[[0,0],[4,0],[4,4],[0,4]],[[0.5,0.5],[1,0.5],[1,1],[0.5,1]]]}");
  expect_error({"voronoi", f / "p.csv", "--clip", f / "c.geojson", "-o", f / "o.obj", "--polygons"},
               2, "has a hole, which no polygon of a mesh has");
  expect_error({"voronoi", f / "p.csv", "--clip", f / "c.geojson", "-o", f / "c.geojson"}, 2,
               "would overwrite the input");
  expect_error({"voronoi", f / "p.csv", "--clip", f / "c.geojson", "--box", "0,0,1,1"}, 2,
               "exclude each other");
  write_points(f / "ball.npy", "ball", 30, 3);
  expect_error({"voronoi", f / "ball.npy", "--clip", f / "c.geojson"}, 2, "--clip needs 2D points");
  for (const char* option : {"--box", "--clip"})
    expect_error({"voronoi", f / "p.csv", option,
                  option[2] == 'b' ? "0,0,1,1" : (f / "c.geojson").c_str(), "-o", f / "o.json"},
                 2, ".json holds the unclipped diagram");
}

/// A region far from the points is noticed, and sizes have the name of what they are.
TEST(CliTriangulation, CountsClippedCells) {
  const Folder f;
  write_file(f / "p.csv", "x,y\n1,1\n3,1\n1,3\n6,2\n");
  const Ran ran =
      run_well({"voronoi", f / "p.csv", "--box", "100,100,102,103", "--measures", f / "sizes.csv"});
  EXPECT_TRUE(has(ran.out, "clipped    4 cells, 3 of them empty; total area 6\n"));
  EXPECT_EQ(read_file(f / "sizes.csv").substr(0, 5), "area\n");
}

TEST(CliTriangulation, WeightsFromFilesAndColumns) {
  const Folder f;
  write_file(f / "p.csv", "x,y,w\n0,0,0\n2,0,0\n0,2,0\n1,0,-1.5\n");
  write_file(f / "w.txt", "0\n0\n0\n-1.5\n");
  const Ran column = run_well({"delaunay", f / "p.csv", "--columns", "x,y", "--weights", "w",
                               "--certify", "--format", "i"});
  EXPECT_EQ(column.out, "1\n0 1 2\n");
  const Ran file = run_app(
      {"delaunay", f / "p.csv", "--columns", "x,y", "--weights", f / "w.txt", "--format", "i"});
  EXPECT_EQ(file.out, column.out) << file.err;
  EXPECT_EQ(run_app({"delaunay", f / "p.csv", "--columns", "x,y", "--format", "i"}).out,
            "2\n0 3 2\n1 2 3\n");
  // The input is read once, so that it may be a pipe; the weights are no coordinate.
  const Ran pipe = run_app(
      {"delaunay", "-", "--input-format", "csv", "--weights", "w", "--format", "i"}, f / "p.csv");
  EXPECT_EQ(pipe.out, column.out) << pipe.err;
  write_file(f / "q.csv", "a,b,w\n0,0,0\n2,0,0\n0,2,0\n1,0,-1.5\n");
  EXPECT_EQ(run_app({"delaunay", f / "q.csv", "--weights", "w", "--format", "i"}).out, column.out);
  write_file(f / "word.csv", "x,y,w\n0,0,0\n2,0,heavy\n0,2,0\n");
  expect_error({"delaunay", f / "word.csv", "--weights", "w"}, 1,
               "column 'w' of point 1 is not a number: 'heavy'");
  write_file(f / "few.txt", "0\n0\n");
  expect_error({"delaunay", f / "p.csv", "--columns", "x,y", "--weights", f / "few.txt"}, 2,
               "2 numbers for 4 points");
}

TEST(CliTriangulation, ForcesEdges) {
  const Folder f;
  write_file(f / "p.csv", "x,y\n0,0\n4,0\n4,1\n0,1\n2,0.9\n2,0.1\n9,9\n");
  write_file(f / "e.txt", "0 1\n1 2\n2 3\n3 0\n0 2\n");
  const Ran ran = run_well({"delaunay", f / "p.csv", "--edges", f / "e.txt", "--certify"});
  EXPECT_TRUE(has(ran.out, "edges      5 forced\n"));
  EXPECT_TRUE(has(ran.out, "certified  yes\n"));
  const Ran inside = run_app(
      {"delaunay", f / "p.csv", "--edges", f / "e.txt", "--inside", "--certify", "--format", "i"});
  EXPECT_EQ(inside.out, "6\n0 1 5\n0 2 4\n0 4 3\n0 5 2\n1 2 5\n2 3 4\n") << inside.err;
  write_file(f / "x.txt", "0 2\n1 3\n");
  expect_error({"delaunay", f / "p.csv", "--edges", f / "x.txt"}, 1,
               f / "x.txt" + ":1: edges 0 (0, 2) and 1 (1, 3) cross");
  write_file(f / "y.txt", "0 7\n");
  expect_error({"delaunay", f / "p.csv", "--edges", f / "y.txt"}, 1,
               "is not the id of one of 7 points");
  // A fault of the file names its line, whatever is wrong.
  for (const auto& [text, why] :
       {std::pair{"0 1\n\n1 9\n", ":3: edge 1 has 9, which is not the id of one of "},
        {"# edges\n0 0.5\n", ":2: edge 0 has 0.5, which is not the id of one of "},
        {"0 nan\n", ":1: edge 0 has nan, which is not the id of one of "},
        {"-1 0\n", ":1: edge 0 has -1, which is not the id of one of "},
        {"0 1 2\n", ": 3 columns; --edges expects two point ids per line"},
        {"0 1\n0 x\n", ":2: 'x' is not a number"}}) {
    write_file(f / "z.txt", text);
    expect_error({"delaunay", f / "p.csv", "--edges", f / "z.txt"}, 1, f / "z.txt" + why);
  }
  expect_error({"delaunay", f / "p.csv", "--inside"}, 2, "--inside needs --edges");
  expect_error({"delaunay", f / "p.csv", "--edges", f / "x.txt", "--furthest"}, 2, "furthest");
}

TEST(CliTriangulation, RefusesWhatCannotBe) {
  const Folder f;
  write_points(f / "ball.npy", "ball", 300, 3);
  write_points(f / "disk.npy", "disk", 30, 2);
  expect_error({"delaunay", f / "ball.npy", "-o", f / "t.off"}, 2, "triangles of 2D points");
  expect_error({"voronoi", f / "ball.npy", "-o", f / "t.wkt"}, 2, "polygons of 2D points");
  expect_error({"voronoi", f / "disk.npy", "--box", "0,0,1,1,2,2"}, 2, "expected 4 numbers");
  // The words behind the first are files.
  expect_error({"voronoi", f / "disk.npy", "--box", "0", "0", "1", "1"}, 2,
               "--box 0: expected numbers joined by commas");
  expect_error({"voronoi", f / "disk.npy", "--box", "0,0,1,0", "-o", f / "c.wkt"}, 2,
               "the box is empty");
  expect_error({"delaunay", f / "disk.npy", "-o", f / "t.xyz"}, 2, "");
  expect_error({"delaunay", f / "none.npy"}, 1, "none.npy");
  write_points(f / "many.npy", "disk", 100000, 2);
  expect_error({"delaunay", f / "many.npy", "--memory", "1M"}, 4, "memory");
}

}  // namespace cullhull::cli_triangulation_test
