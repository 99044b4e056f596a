// What programs for maps want: the coordinate reference system of every command's .geojson, and
// columns of points beside what belongs to one.

#include "agreement/expect_json.hpp"
#include "bench/suites/las_bytes.hpp"

namespace cullhull::cli_maps_test {

using nlohmann::json;
using namespace testing;

const std::string table =
    "x,y,region,n\n0,0,\"a, b\",1\n4,0,c,\n0,4,\"q \"\"z\"\"\",3\n4,4,,4\n1,2,c,5.5\n";
const std::string zone_32 = "PROJCS[\"ETRS_1989_UTM_Zone_32N\",GEOGCS[\"GCS_ETRS_1989\"]]";

/// The system that a file names.
std::string crs_in(const std::string& path) {
  const json document = json_in(path);
  return document.contains("crs") ? document["crs"]["properties"]["name"].get<std::string>() : "";
}

TEST(CliMaps, EveryCommandWritesTheSystemThatItsInputStates) {
  const Folder f;
  write_file(f / "p.csv", table);
  write_file(f / "utm.csv", table);
  write_file(f / "utm.prj", zone_32);
  const std::string out = f / "o.geojson";
  for (const std::vector<std::string>& words :
       command_lines({"hull", "hull --stream on", "hull --by region", "delaunay", "voronoi",
                      "alpha", "alpha --ratio 0.5", "cull", "cull --stream on"})) {
    const auto run = [&](const std::string& input, std::vector<std::string> more = {}) {
      more.insert(more.begin(), words.begin(), words.end());
      more.insert(more.end(), {input, "-o", out});
      return run_well(more).out;
    };
    const std::string silent = run(f / "p.csv");
    EXPECT_FALSE(has(silent, "crs"));
    EXPECT_EQ(crs_in(out), "") << words[0];
    EXPECT_TRUE(has(run(f / "utm.csv"), "\ncrs        EPSG:25832\n")) << words[0];
    EXPECT_EQ(crs_in(out), "urn:ogc:def:crs:EPSG::25832") << words[0];
    // What is asked for comes first; WGS 84 is what GeoJSON has without a name.
    run(f / "utm.csv", {"--crs", "epsg:31467"});
    EXPECT_EQ(crs_in(out), "urn:ogc:def:crs:EPSG::31467") << words[0];
    EXPECT_TRUE(has(run(f / "utm.csv", {"--crs", "OGC:CRS84"}), "crs        OGC:CRS84"));
    EXPECT_EQ(crs_in(out), "") << words[0];
    const Ran bad = run_app({words[0], f / "p.csv", "--crs", "UTM 32"});
    EXPECT_EQ(bad.status, 2);
    EXPECT_EQ(bad.err,
              "cullhull: --crs UTM 32: expected an authority and a code, such as "
              "EPSG:25832\n");
  }
  // What is written is read again.
  run_well({"hull", f / "utm.csv", "-o", f / "a.geojson"});
  run_well({"hull", f / "a.geojson", "-o", f / "b.geojson"});
  EXPECT_EQ(crs_in(f / "b.geojson"), "urn:ogc:def:crs:EPSG::25832");
}

TEST(CliMaps, ReportsNameIt) {
  const Folder f;
  write_file(f / "p.csv", table);
  EXPECT_FALSE(expect_json({"hull", f / "p.csv", "--json"}, "hull_report").contains("crs"));
  write_file(f / "p.prj", "EPSG:25832");
  const std::pair<std::vector<std::string>, std::string> reports[] = {
      {{"hull"}, "hull_report"},
      {{"hull", "--stream", "on"}, "hull_report"},
      {{"hull", "--only", "vertices"}, "extreme_report"},
      {{"cull"}, "cull_report"},
      {{"delaunay"}, "triangulation_report"},
      {{"voronoi"}, "voronoi_report"},
      {{"alpha"}, "alpha_report"},
      {{"info"}, "info_report"},
      {{"info", "--stream", "on"}, "info_report"}};
  for (const auto& [command, kind] : reports) {
    std::vector<std::string> words = command;
    words.insert(words.end(), {f / "p.csv", "--json"});
    EXPECT_EQ(expect_json(words, kind)["crs"], "EPSG:25832") << command[0];
  }
}

TEST(CliMaps, LasWithNothingButAProjectedSystem) {
  const Folder f;
  std::string las = bench::las_bytes({0, 0, 0, 900, 0, 1, 0, 900, 2, 500, 500, 3},
                                     {{0.01, 0.01, 0.01}, {500000, 5500000, 0}, {}});
  // A GeoTIFF directory of one key.
  std::string record(54, '\0');
  record.replace(2, 15, "LASF_Projection");
  record[18] = static_cast<char>(34735 & 255);
  record[19] = static_cast<char>(34735 >> 8);
  record[20] = 16;
  for (const unsigned v : {1U, 1U, 0U, 1U, 3072U, 0U, 1U, 25832U})
    (record += static_cast<char>(v & 255)) += static_cast<char>(v >> 8);
  las.insert(227, record);
  las[96] = static_cast<char>((227 + record.size()) & 255);
  las[97] = static_cast<char>((227 + record.size()) >> 8);
  las[100] = 1;
  write_file(f / "a.las", las);
  write_file(f / "b.las", las);
  EXPECT_TRUE(has(run_well({"info", f / "a.las"}).out, "crs        EPSG:25832\n"));
  for (const std::vector<std::string>& input :
       std::vector<std::vector<std::string>>{{f / "a.las"}, {f / "a.las", f / "b.las"}}) {
    run_well(joined({"hull", "--columns", "x,y", "-o", f / "o.geojson"}, input));
    EXPECT_EQ(crs_in(f / "o.geojson"), "urn:ogc:def:crs:EPSG::25832");
  }
  // A vertical plane is no map, nor are the file's whole numbers.
  run_well({"hull", f / "a.las", "--columns", "x,z", "-o", f / "o.geojson"});
  EXPECT_EQ(crs_in(f / "o.geojson"), "");
  run_well({"hull", f / "a.las", "--columns", "x,y", "--raw", "-o", f / "o.geojson"});
  EXPECT_EQ(crs_in(f / "o.geojson"), "");
  // A state carries none.
  run_well({"hull", f / "a.las", "--columns", "x,y", "--partial", f / "a.hullstate"});
  run_well({"hull", f / "a.hullstate", "-o", f / "o.geojson"});
  EXPECT_EQ(crs_in(f / "o.geojson"), "");
  run_well({"hull", f / "a.hullstate", "-o", f / "o.geojson", "--crs", "EPSG:25832"});
  EXPECT_EQ(crs_in(f / "o.geojson"), "urn:ogc:def:crs:EPSG::25832");
}

TEST(CliMaps, InputsOfTwoSystemsWriteNone) {
  const Folder f;
  write_file(f / "a.csv", table);
  write_file(f / "b.csv", table);
  write_file(f / "a.prj", "EPSG:25832");
  write_file(f / "b.prj", "EPSG:25833");
  const Ran ran = run_well({"hull", f / "a.csv", f / "b.csv", "-o", f / "o.geojson"});
  EXPECT_EQ(crs_in(f / "o.geojson"), "");
  EXPECT_TRUE(
      has(ran.err, (f / "b.csv") + ": states EPSG:25833, " + (f / "a.csv") +
                       " states EPSG:25832; no coordinate reference system is written without "
                       "--crs\n"));
  const Ran chosen =
      run_well({"hull", f / "a.csv", f / "b.csv", "-o", f / "o.geojson", "--crs", "EPSG:25832"});
  EXPECT_FALSE(has(chosen.err, "states"));
  EXPECT_EQ(crs_in(f / "o.geojson"), "urn:ogc:def:crs:EPSG::25832");
}

std::string polygon(const std::string& crs) {
  return "{\"type\": \"Polygon\", " +
         (crs.empty()
              ? ""
              : "\"crs\": {\"type\": \"name\", \"properties\": {\"name\": \"" + crs + "\"}}, ") +
         "\"coordinates\": [[[0, 0], [4, 0], [4, 4], [0, 4], [0, 0]]]}";
}

TEST(CliMaps, RegionsAndLinesOfAnotherSystemAreRefused) {
  const Folder f;
  write_file(f / "p.csv", table);
  write_file(f / "same.geojson", polygon("urn:ogc:def:crs:EPSG::25832"));
  write_file(f / "other.geojson", polygon("urn:ogc:def:crs:EPSG::25833"));
  write_file(f / "none.geojson", polygon(""));
  for (const char* option : {"--clip", "--edges"}) {
    const auto run = [&](const std::string& file) {
      const std::string command = option == std::string("--clip") ? "voronoi" : "delaunay";
      return run_app({command, f / "p.csv", option, f / file, "-o", f / "o.geojson", "-q"});
    };
    std::filesystem::remove(f / "p.prj");
    EXPECT_EQ(run("other.geojson").status, 0);
    write_file(f / "p.prj", "EPSG:25832");
    EXPECT_EQ(run("same.geojson").status, 0);
    EXPECT_EQ(run("none.geojson").status, 0);
    const Ran refused = run("other.geojson");
    EXPECT_EQ(refused.status, 1);
    EXPECT_TRUE(has(refused.err, option + (" " + (f / "other.geojson")) +
                                     ": states EPSG:25833, but the points are in EPSG:25832\n"));
  }
}

TEST(CliMaps, EdgesAreLinesOfGeoJson) {
  const Folder f;
  write_file(f / "p.csv", "0,0\n4,0\n4,4\n0,4\n1,2\n");
  write_file(f / "pairs.csv", "0,2\n2,3\n");
  write_file(f / "lines.geojson",
             R"({"type": "LineString", "coordinates": [[0, 0], [4, 4], [4, 4], [0, 4]]})");
  run_well({"delaunay", f / "p.csv", "--edges", f / "pairs.csv", "-o", f / "a.json"});
  run_well({"delaunay", f / "p.csv", "--edges", f / "lines.geojson", "-o", f / "b.json"});
  EXPECT_EQ(read_file(f / "a.json"), read_file(f / "b.json"));
  // The corners may be points of the same file.
  write_file(f / "ring.geojson", polygon(""));
  run_well({"delaunay", f / "ring.geojson", f / "p.csv", "--edges", f / "ring.geojson", "--inside",
            "-o", f / "c.json"});
  write_file(f / "off.geojson", R"({"type": "LineString", "coordinates": [[0, 0], [4, 3.5]]})");
  const Ran off = run_app({"delaunay", f / "p.csv", "--edges", f / "off.geojson"});
  EXPECT_EQ(off.status, 1);
  EXPECT_EQ(off.err, "cullhull: --edges " + (f / "off.geojson") +
                         ": line 0 has a corner at 4 3.5, where no point is; corners of lines must "
                         "be points (INPUT may be several files)\n");
  write_file(f / "dots.geojson", R"({"type": "Point", "coordinates": [0, 0]})");
  EXPECT_EQ(run_app({"delaunay", f / "p.csv", "--edges", f / "dots.geojson"}).status, 1);
  // On a grid corners are compared in the world.
  write_file(f / "g.las", bench::las_bytes({1, 1, 0, 31, 1, 0, 31, 31, 0, 1, 31, 0},
                                           {{0.1, 0.1, 0.1}, {484000, 0, 0}, {}}));
  write_file(f / "g.geojson",
             R"({"type": "LineString", "coordinates": [[484000.1, 0.1], [484003.1, 3.1]]})");
  EXPECT_TRUE(
      has(run_well({"delaunay", f / "g.las", "--columns", "x,y", "--edges", f / "g.geojson"}).out,
          "edges      1 forced"));
}

TEST(CliMaps, KeptColumnsGoToCellsAndSurvivors) {
  const Folder f;
  write_file(f / "p.csv", table);
  run_well({"voronoi", f / "p.csv", "--keep", "region,n", "-o", f / "o.geojson"});
  const json cells = json_in(f / "o.geojson")["features"];
  ASSERT_EQ(cells.size(), 5U);
  EXPECT_EQ(cells[0]["properties"], json({{"point", 0}, {"region", "a, b"}, {"n", 1}}));
  EXPECT_EQ(cells[1]["properties"], json({{"point", 1}, {"region", "c"}, {"n", nullptr}}));
  EXPECT_EQ(cells[2]["properties"]["region"], "q \"z\"");
  EXPECT_EQ(cells[3]["properties"], json({{"point", 3}, {"region", nullptr}, {"n", 4}}));
  EXPECT_EQ(cells[4]["properties"]["n"], 5.5);
  for (const char* stream : {"on", "off"}) {
    run_well({"cull", f / "p.csv", "--keep", "3", "-o", f / "s.geojson", "--points", f / "s.csv",
              "--stream", stream});
    const json points = json_in(f / "s.geojson")["features"];
    ASSERT_GE(points.size(), 4U);
    EXPECT_EQ(points[2]["properties"], json({{"id", 2}, {"column 3", 3}}));
    EXPECT_EQ(points[2]["geometry"]["coordinates"], json({0, 4}));
    EXPECT_EQ(read_file(f / "s.csv").substr(0, 25), "x,y,\"column 3\"\n0,0,1\n4,0,");
  }
  // In two files, in blocks: values are those of the same points.
  std::string many = "x,y,key\n";
  for (int i = 0; i < 200000; ++i)
    many +=
        std::to_string(i % 1000) + "," + std::to_string(i / 1000) + ",k" + std::to_string(i) + "\n";
  write_file(f / "m.csv", many);
  run_well(
      {"cull", f / "p.csv", f / "m.csv", "--columns", "x,y", "--keep", "2", "-o", f / "m.geojson"});
  const json written = json_in(f / "m.geojson");
  for (const json& point : written["features"]) {
    const auto id = point["properties"]["id"].get<int>();
    if (id >= 5) {
      EXPECT_EQ(point["properties"]["column 2"], "k" + std::to_string(id - 5));
    }
  }
}

/// The properties of all features.
std::vector<json> properties_in(const std::string& path) {
  std::vector<json> all;
  const json document = json_in(path);
  for (const json& feature : document.value("features", json::array({document})))
    all.push_back(feature["properties"]);
  return all;
}

TEST(CliMaps, ShapesKeepWhatTheirPointsHaveInCommon) {
  const Folder f;
  write_file(f / "p.csv",
             "x,y,region,land,name,n\n0,0,b,DE,u,1\n4,0,b,DE,v,1\n0,4,b,DE,w,1\n"
             "9,0,a,FR,r,2\n9,9,a,FR,s,\n12,3,a,,t,2\n9,1,c,FR,q,7\n");
  const std::string out = f / "o.geojson";
  for (const char* command : {"hull", "alpha"}) {
    run_well({command, f / "p.csv", "--by", "region", "--keep", "land,n,name", "-o", out});
    std::vector<json> groups = properties_in(out);
    ASSERT_EQ(groups.size(), 3U);
    const auto kept = [&](std::size_t i) {
      return json({groups[i]["region"], groups[i]["land"], groups[i]["n"], groups[i]["name"]});
    };
    EXPECT_EQ(kept(0), json({"a", nullptr, nullptr, nullptr})) << command;
    EXPECT_EQ(kept(1), json({"b", "DE", 1, nullptr})) << command;
    EXPECT_EQ(kept(2), json({"c", "FR", 7, "q"})) << command;
    // Of the whole set.
    write_file(f / "one.csv", "x,y,land,n\n0,0,DE,1\n4,0,DE,2\n0,4,DE,1\n");
    run_well({command, f / "one.csv", "--keep", "land,n", "-o", out, "-o", f / "o.ply"});
    EXPECT_EQ(properties_in(out)[0]["land"], "DE") << command;
    EXPECT_EQ(properties_in(out)[0]["n"], nullptr) << command;
  }
  run_well({"delaunay", f / "p.csv", "--keep", "region", "-o", out});
  const std::vector<json> triangles = properties_in(out);
  EXPECT_EQ(triangles[0]["region"], "b");
  EXPECT_EQ(std::count_if(triangles.begin(), triangles.end(),
                          [](const json& t) { return t["region"].is_null(); }),
            static_cast<std::ptrdiff_t>(triangles.size()) - 1);
}

TEST(CliMaps, VerticesAreWrittenAsPointsWithColumns) {
  const Folder f;
  write_file(f / "p.csv", "name,x,y\na,nan,1\nb,0,0\nc,1,1\nd,4,0\ne,0,4\nf,0,0\n");
  const std::string out = f / "v.geojson";
  for (const std::vector<std::string>& how :
       command_lines({"", "--stream on", "--only vertices", "--only vertices --stream on"})) {
    run_well(joined({"hull", f / "p.csv", "--columns", "x,y", "--skip-nan", "--keep", "name",
                     "--vertices", out, "--crs", "EPSG:25832"},
                    how));
    EXPECT_EQ(properties_in(out), (std::vector<json>{{{"id", 1}, {"name", "b"}},
                                                     {{"id", 3}, {"name", "d"}},
                                                     {{"id", 4}, {"name", "e"}}}));
    EXPECT_EQ(crs_in(out), "urn:ogc:def:crs:EPSG::25832");
  }
  // Of points on a grid, in the world.
  write_file(f / "g.las", bench::las_bytes({0, 0, 0, 10, 0, 0, 0, 10, 0, 0, 0, 10},
                                           {{0.1, 0.1, 0.1}, {500000, 0, 0}, {}}));
  for (const char* stream : {"on", "off"}) {
    run_well({"hull", f / "g.las", "--vertices", out, "--stream", stream});
    const json second = json_in(out)["features"][1];
    EXPECT_EQ(second["geometry"]["coordinates"], json({500001, 0, 0})) << stream;
  }
  expect_error({"hull", f / "p.csv", "--columns", "x,y", "--skip-nan", "--vertices", f / "v.las"},
               2, "");
}

/// Values are found by the points' ids in the file, whatever is left out.
TEST(CliMaps, KeptColumnsOfPointsBesideSkippedOnes) {
  const Folder f;
  std::string rows = "name,x,y,g\n";
  for (int i = 0; i < 60; ++i)
    rows += "n" + std::to_string(i) + (i % 3 == 0 ? ",nan,1," : ",") +
            (i % 3 == 0 ? "" : std::to_string(i % 7) + "," + std::to_string(i * i % 11) + ",") +
            "g" + std::to_string(i / 10) + "\n";
  write_file(f / "p.csv", rows);
  const std::string out = f / "o.geojson";
  for (const std::vector<std::string>& how :
       command_lines({"cull --stream on", "cull", "voronoi"})) {
    std::vector<std::string> words{how[0],   f / "p.csv", "--columns", "x,y", "--skip-nan",
                                   "--keep", "name",      "-o",        out};
    words.insert(words.end(), how.begin() + 1, how.end());
    run_well(words);
    for (const json& p : properties_in(out)) {
      const int id = p.contains("id") ? p["id"].get<int>() : p["point"].get<int>();
      EXPECT_EQ(p["name"], "n" + std::to_string(id)) << how[0];
    }
  }
  run_well({"hull", f / "p.csv", "--columns", "x,y", "--skip-nan", "--by", "g", "--keep", "g,name",
            "-o", out});
  for (const json& p : properties_in(out)) EXPECT_EQ(p["name"], nullptr);
}

TEST(CliMaps, KeptColumnsDoNotReplaceTheResultsOwn) {
  const Folder f;
  write_file(f / "p.csv", "id,x,y,region,point,area\n7,0,0,a,1,5\n8,4,0,a,1,5\n9,0,4,a,1,5\n");
  const std::string out = f / "o.geojson";
  const auto first = [&](std::vector<std::string> words, const std::string& keep) {
    words.insert(words.end(), {f / "p.csv", "--columns", "x,y", "--keep", keep, "-o", out});
    run_well(words);
    return properties_in(out)[0];
  };
  EXPECT_EQ(first({"cull"}, "id"), json({{"id", 0}, {"kept_id", 7}}));
  EXPECT_EQ(first({"voronoi"}, "point,id"), json({{"point", 0}, {"kept_point", 1}, {"id", 7}}));
  EXPECT_EQ(first({"hull"}, "area")["area"], 8);
  EXPECT_EQ(first({"hull"}, "area")["kept_area"], 5);
  EXPECT_EQ(first({"alpha"}, "region")["kept_region"], "a");
  EXPECT_EQ(first({"hull", "--by", "region"}, "region,id")["region"], "a");
}

TEST(CliMaps, TrackNamesItsColumns) {
  const Folder f;
  write_file(f / "a1.csv", "lat,lon\n50,8\n51,8\n50,9\n");
  write_file(f / "a2.csv", "lat,lon\n50,8\n51,8\n50,10\n");
  const Ran ran = run_well({"track", f / "a*.csv", "--json=" + (f / "r.json")});
  EXPECT_TRUE(has(ran.out, "columns    lon, lat\n"));
  EXPECT_EQ(json_in(f / "r.json")["columns"], json({"lon", "lat"}));
}

TEST(CliMaps, KeepSaysWhatItCannotDo) {
  const Folder f;
  write_file(f / "p.csv", table);
  const auto refused = [&](std::vector<std::string> words, int status, const std::string& why) {
    words.insert(words.begin() + 1, {f / "p.csv", "--columns", "x,y", "--keep", "n"});
    expect_error(words, status, why);
  };
  refused({"voronoi", "-o", f / "o.wkt"}, 2, "needs an output that ends in .geojson");
  refused({"voronoi"}, 2, "needs an output that ends in .geojson");
  refused({"cull", "-o", f / "ids.csv"}, 2, "needs an output that ends in .geojson or .csv");
  refused({"cull", "-o", f / "o.ply"}, 2, "holds no columns; .geojson and .csv do");
  refused({"hull", "-o", f / "o.ply"}, 2, "needs an output that ends in .geojson");
  refused({"hull", "-o", f / "o.geojson", "--vertices", f / "v.ply"}, 2, "holds no columns");
  refused({"hull", "-o", f / "o.geojson", "--stream", "on", "--first-id", "7"}, 2, "--first-id");
  refused({"cull", "-o", f / "o.geojson", "--memory", "40"}, 4, "memory");
  EXPECT_EQ(f.entries(), 1U);
  expect_error(
      {"voronoi", f / "p.csv", "--columns", "x,y", "--keep", "depth", "-o", f / "o.geojson", "-q"},
      2, "no column 'depth'");
  EXPECT_EQ(f.entries(), 1U);
}

}  // namespace cullhull::cli_maps_test
