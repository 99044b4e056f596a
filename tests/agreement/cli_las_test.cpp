// The program on LAS files: computed on the grid of their decimals, told and written in the world.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <random>

#include "agreement/expect_json.hpp"
#include "bench/suites/las_bytes.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/point_blocks.hpp"

namespace cullhull::cli_las_test {

using namespace testing;

using Numbers = std::vector<std::int32_t>;

Numbers ball(std::uint64_t count) {
  Numbers numbers;
  for (const double v : generate("ball", count, 3, 4))
    numbers.push_back(static_cast<std::int32_t>(v * 1e6));
  return numbers;
}

/// Of 1000ths: the whole numbers that `metres` makes of these.
std::vector<double> on_grid(const Numbers& numbers) {
  const double step[] = {1, 1, 10}, origin[] = {5e8, 4e9, -12500};
  std::vector<double> rows;
  for (std::size_t i = 0; i < numbers.size(); ++i)
    rows.push_back(numbers[i] * step[i % 3] + origin[i % 3]);
  return rows;
}

const Placement metres{{0.001, 0.001, 0.01}, {500000, 4000000, -12.5}};

/// Rows of whole numbers on the grid of 1000ths as .npy.
void write_rows(const std::string& path, const std::vector<double>& rows, std::uint32_t d = 3) {
  write_npy_points(path, rows.data(), rows.size() / d, d, ScalarType::f64);
}

Numbers rows_from(const Numbers& numbers, std::size_t first, std::size_t last) {
  return {numbers.begin() + static_cast<std::ptrdiff_t>(3 * first),
          numbers.begin() + static_cast<std::ptrdiff_t>(3 * last)};
}

std::vector<double> vertices_of_obj(const std::string& text) {
  std::vector<double> rows;
  std::istringstream lines(text);
  for (std::string word; lines >> word;)
    if (word == "v")
      for (int j = 0; j < 3; ++j) {
        rows.push_back(0);
        lines >> rows.back();
      }
    else
      std::getline(lines, word);
  return rows;
}

TEST(CliLas, MeshesLieWhereScaleAndOffsetPutThem) {
  const Folder f;
  const Numbers numbers = ball(3000);
  write_file(f / "a.las", bench::las_bytes(numbers, metres));
  const std::vector<double> grid = on_grid(numbers);
  const Hull hull = convex_hull(PointView::row_major(grid.data(), 3000, 3));
  std::vector<double> expected;
  for (const std::uint64_t v : hull.vertices)
    for (std::size_t j = 0; j < 3; ++j) {
      expected.push_back(grid[3 * v + j] / 1000);
      // What laspy computes differs in the last place at most.
      const double laspy = metres.at(j, numbers[3 * v + j]);
      EXPECT_NEAR(expected.back(), laspy, std::abs(laspy) * 0x1p-52);
    }
  for (const char* stream : {"off", "on"}) {
    const Ran ran = run_well({"hull", f / "a.las", "--stream", stream, "-o", f / "a.obj", "-o",
                              f / "a.json", "--certify"});
    EXPECT_EQ(vertices_of_obj(read_file(f / "a.obj")), expected) << stream;
    const auto json = json_in(f / "a.json");
    EXPECT_DOUBLE_EQ(json["volume"].get<double>(), hull.volume / 1e9);
    EXPECT_DOUBLE_EQ(json["area"].get<double>(), hull.area / 1e6);
    EXPECT_EQ(json["centroid"][1].get<double>(), hull.centroid[1] / 1000);
    for (const char* again : {"off", "on"})
      run_well({"certify", f / "a.las", f / "a.json", "--stream", again});
  }
  std::string text = read_file(f / "a.json");
  const std::string x = nlohmann::json(expected[0]).dump();
  text.replace(text.find(x), x.size(), nlohmann::json(std::nextafter(expected[0], 0)).dump());
  write_file(f / "b.json", text);
  for (const char* stream : {"off", "on"})
    expect_error({"certify", f / "a.las", f / "b.json", "--stream", stream}, 3, "not certified");
  // A number that is wrong is named in the integers that were compared.
  auto wrong = json_in(f / "a.json");
  wrong["volume"] = 1;
  write_file(f / "c.json", wrong.dump());
  for (const char* stream : {"off", "on"})
    expect_error({"certify", f / "a.las", f / "c.json", "--stream", stream}, 3,
                 "(in units of the points' grid)");
}

TEST(CliLas, PlansHaveMeasuresInTheirUnits) {
  const Folder f;
  write_file(
      f / "a.las",
      bench::las_bytes({0, 0, 7, 3000, 0, 7, 3000, 4000, 9, 0, 4000, 9, 1000, 1000, 8}, metres));
  run_well({"hull", f / "a.las", "--columns", "y,x", "-o", f / "a.geojson"});
  const auto feature = json_in(f / "a.geojson");
  EXPECT_EQ(feature["properties"]["area"].get<double>(), 12);
  EXPECT_EQ(feature["properties"]["perimeter"].get<double>(), 14);
  EXPECT_EQ(feature["geometry"]["coordinates"][0].size(), 5U);
  for (const auto& corner : feature["geometry"]["coordinates"][0])
    EXPECT_TRUE(corner[0] >= 4000000 && corner[1] >= 500000 && corner[1] < 500004) << corner;
}

// 484683.1 as the nearest double, not 4846831 * 0.1 with its two roundings.
TEST(CliLas, GeometriesHaveTheDecimalsOfTheGrid) {
  const Folder f;
  Numbers numbers;
  for (int i = 0; i < 400; ++i)
    for (const int x : {7 * i * i % 5003, 11 * i * i % 4999, 0}) numbers.push_back(x);
  write_file(f / "a.las", bench::las_bytes(numbers, {{0.1, 0.1, 1}, {484683.1, 6000000.7, 0}}));
  const std::vector<std::string> plan{f / "a.las", "--columns", "x,y", "-o"};
  const auto with = [&](std::vector<std::string> words, const std::string& out) {
    words.insert(words.begin() + 1, plan.begin(), plan.end());
    words.push_back(out);
    return words;
  };
  run_well(with({"hull"}, f / "hull.geojson"));
  run_well(with({"hull"}, f / "hull.wkt"));
  run_well(with({"alpha"}, f / "alpha.geojson"));
  run_well(with({"delaunay"}, f / "delaunay.wkt"));
  for (const char* name : {"hull.geojson", "hull.wkt", "alpha.geojson", "delaunay.wkt"}) {
    const std::string text = read_file(f / name);
    std::size_t found = 0;
    for (std::size_t at = text.find("48"); at != std::string::npos; at = text.find("48", at + 1)) {
      const std::size_t end = text.find_first_not_of("0123456789.", at);
      if (text.compare(at, 3, "484") != 0 && text.compare(at, 3, "485") != 0) continue;
      if (text.find('.', at) > end) continue;
      EXPECT_LE(end - at, 8U) << name << ' ' << text.substr(at, end - at);
      ++found;
    }
    EXPECT_GT(found, 3U) << name;
  }
}

TEST(CliLas, TilesOfACommonGridAreOneFile) {
  const Folder f;
  const Numbers numbers = ball(2000);
  write_file(f / "all.las", bench::las_bytes(numbers, metres));
  write_file(f / "t1.las", bench::las_bytes(rows_from(numbers, 0, 700), metres));
  // The same points of another origin, and a tile of coarser steps in between.
  Placement other = metres;
  other.offset = {500001, 3999999.5, -12};
  Numbers moved = rows_from(numbers, 700, 2000);
  for (std::size_t i = 0; i < moved.size(); ++i)
    moved[i] -= i % 3 == 0 ? 1000 : i % 3 == 1 ? -500 : 50;
  write_file(f / "t2.las", bench::las_bytes(moved, other));
  for (const char* stream : {"off", "on"})
    for (const char* name : {"ply", "json", "obj"}) {
      const auto out = [&](const char* stem) { return f / (std::string(stem) + "." + name); };
      run_well({"hull", f / "all.las", "-o", out("all")});
      run_well({"hull", f / "t1.las", f / "t2.las", "--stream", stream, "-o", out("tiles")});
      EXPECT_EQ(read_file(out("tiles")), read_file(out("all"))) << stream << name;
    }
  for (const char* command : {"delaunay", "voronoi"}) {
    run_well({command, f / "all.las", "-o", f / "all.json"});
    run_well({command, f / "t1.las", f / "t2.las", "-o", f / "tiles.json"});
    EXPECT_EQ(read_file(f / "tiles.json"), read_file(f / "all.json")) << command;
  }
  run_well({"alpha", f / "all.las", "--columns", "x,y", "-o", f / "all.wkt"});
  run_well({"alpha", f / "t1.las", f / "t2.las", "--columns", "x,y", "-o", f / "tiles.wkt"});
  EXPECT_EQ(read_file(f / "tiles.wkt"), read_file(f / "all.wkt"));
}

// Of tiles without a common grid, and of files without any: in the world, whatever comes first.
TEST(CliLas, OtherMixturesAreInTheWorldInAnyOrder) {
  const Folder f;
  const Numbers numbers = ball(600);
  const std::string a = f / "a.las", b = f / "b.las", p = f / "p.npy";
  write_file(a, bench::las_bytes(rows_from(numbers, 0, 200), metres));
  const Placement odd{{0.001, 0.0013371234567890123, 0.01}, {500000, 4000000, -12.5}};
  write_file(b, bench::las_bytes(rows_from(numbers, 200, 400), odd));
  std::vector<double> rows = on_grid(rows_from(numbers, 400, 600));
  for (double& x : rows) x /= 1000;
  write_rows(p, rows);
  std::vector<double> all = on_grid(rows_from(numbers, 0, 200));
  for (double& x : all) x /= 1000;
  const Numbers second = rows_from(numbers, 200, 400);
  for (std::size_t i = 0; i < second.size(); ++i) all.push_back(odd.at(i % 3, second[i]));
  all.insert(all.end(), rows.begin(), rows.end());
  write_rows(f / "all.npy", all);
  run_well({"hull", f / "all.npy", "--json=" + (f / "all.json")});
  const auto expected = json_in(f / "all.json");
  const std::vector<std::vector<std::string>> orders{{a, b, p}, {b, p, a}, {p, a, b}, {b, a, p}};
  for (const auto& order : orders)
    for (const char* stream : {"off", "on"}) {
      run_well({"hull", order[0], order[1], order[2], "--stream", stream,
                "--json=" + (f / "mixed.json")});
      const auto json = json_in(f / "mixed.json");
      EXPECT_EQ(json["placement"]["numbers"], "rounded");
      EXPECT_EQ(json["vertex_count"], expected["vertex_count"]);
      EXPECT_NEAR(json["volume"].get<double>(), expected["volume"].get<double>(),
                  expected["volume"].get<double>() * 1e-9);
    }
  run_well({"delaunay", a, b, p, "-o", f / "mixed.obj.json"});
  run_well({"delaunay", f / "all.npy", "-o", f / "all.obj.json"});
  EXPECT_EQ(read_file(f / "mixed.obj.json"), read_file(f / "all.obj.json"));
}

// What is not affine: cells of the true points, not of the file's numbers.
TEST(CliLas, TriangulationsAreThoseOfTheGrid) {
  const Folder f;
  const Numbers numbers = ball(500);
  write_file(f / "a.las", bench::las_bytes(numbers, metres));
  write_rows(f / "grid.npy", on_grid(numbers));
  run_well({"delaunay", f / "a.las", "-o", f / "a.json", "-o", f / "a.vtk", "--certify"});
  run_well({"delaunay", f / "grid.npy", "-o", f / "grid.json"});
  EXPECT_EQ(read_file(f / "a.json"), read_file(f / "grid.json"));
  run_well({"delaunay", f / "a.las", "--raw", "-o", f / "raw.json"});
  EXPECT_NE(read_file(f / "raw.json"), read_file(f / "grid.json"));
  run_well({"voronoi", f / "a.las", "-o", f / "a.json", "--measures", f / "a.csv"});
  run_well({"voronoi", f / "grid.npy", "-o", f / "grid.json", "--measures", f / "grid.csv"});
  const auto placed = json_in(f / "a.json"), grid = json_in(f / "grid.json");
  EXPECT_EQ(placed["ridge_points"], grid["ridge_points"]);
  for (std::size_t i = 0; i < grid["vertices"].size(); ++i)
    for (std::size_t j = 0; j < 3; ++j)
      ASSERT_EQ(placed["vertices"][i][j].get<double>(),
                grid["vertices"][i][j].get<double>() / 1000);
  std::istringstream a(read_file(f / "a.csv")), g(read_file(f / "grid.csv"));
  std::string line;
  std::getline(a, line);
  std::getline(g, line);
  std::size_t cells = 0;
  for (double x = 0, y = 0; a >> x && g >> y; ++cells) EXPECT_DOUBLE_EQ(x, y / 1e9);
  EXPECT_EQ(cells, 500U);
}

TEST(CliLas, BoxesLengthsAndWeightsAreInTheWorld) {
  const Folder f;
  const Numbers numbers = ball(500);
  write_file(f / "a.las", bench::las_bytes(numbers, metres));
  const auto plan = [&](std::vector<std::string> words) {
    words.insert(words.end(), {"--columns", "x,y"});
    run_well(words);
  };
  plan({"voronoi", f / "a.las", "--box", "499999,3999999,500001,4000001", "-o", f / "v.wkt",
        "--json=" + (f / "v")});
  EXPECT_DOUBLE_EQ(json_in(f / "v")["measure"].get<double>(), 4);
  plan({"alpha", f / "a.las", "--alpha", "0.5", "--json=" + (f / "a")});
  EXPECT_EQ(json_in(f / "a")["alpha"].get<double>(), 0.5);
  plan({"alpha", f / "a.las", "--edge-length", "25.5", "--json=" + (f / "e")});
  EXPECT_EQ(json_in(f / "e")["edge_length"].get<double>(), 25.5);
  write_rows(f / "grid.npy", on_grid(numbers));
  run_well({"alpha", f / "grid.npy", "--columns", "0,1", "--alpha", "500", "--json=" + (f / "g")});
  EXPECT_EQ(json_in(f / "a")["cell_count"], json_in(f / "g")["cell_count"]);
  std::vector<double> weights, scaled;
  for (int i = 0; i < 500; ++i) {
    weights.push_back(i % 7 * 1000.0);
    scaled.push_back(weights.back() * 1e6);
  }
  write_rows(f / "w.npy", weights, 1);
  write_rows(f / "s.npy", scaled, 1);
  run_well({"delaunay", f / "a.las", "--weights", f / "w.npy", "-o", f / "w.json"});
  run_well({"delaunay", f / "grid.npy", "--weights", f / "s.npy", "-o", f / "s.json"});
  EXPECT_EQ(read_file(f / "w.json"), read_file(f / "s.json"));
}

TEST(CliLas, FieldsOfTheRecordAreColumnsAndKeys) {
  const Folder f;
  const Numbers numbers = ball(900);
  write_file(f / "a.las", bench::las_bytes(numbers, metres, 3));
  run_well({"hull", f / "a.las", "--by", "classification", "--columns", "x,y", "-o",
            f / "groups.geojson"});
  const auto groups = json_in(f / "groups.geojson")["features"];
  ASSERT_EQ(groups.size(), 3U);
  for (std::size_t c = 0; c < 3; ++c) {
    Numbers of_class;
    for (std::size_t i = c; i < 900; i += 3)
      for (std::size_t j = 0; j < 3; ++j) of_class.push_back(numbers[3 * i + j]);
    write_file(f / "c.las", bench::las_bytes(of_class, metres));
    run_well({"hull", f / "c.las", "--columns", "x,y", "-o", f / "c.geojson"});
    EXPECT_EQ(groups[c]["geometry"], json_in(f / "c.geojson")["geometry"]);
    EXPECT_EQ(groups[c]["properties"]["classification"], c);
    EXPECT_EQ(groups[c]["properties"]["area"], json_in(f / "c.geojson")["properties"]["area"]);
  }
  // From a pipe the same.
  const Ran piped = run_well(
      {"hull", "-", "--by", "classification", "--columns", "x,y", "-o", f / "piped.geojson"},
      f / "a.las");
  EXPECT_EQ(read_file(f / "piped.geojson"), read_file(f / "groups.geojson"));
  run_well({"info", f / "a.las", "--columns", "x,classification,key_point", "--json=" + (f / "i")});
  const auto axes = json_in(f / "i")["axes"];
  EXPECT_EQ(axes[1]["greatest"].get<double>(), 2);
  EXPECT_EQ(axes[2]["least"].get<double>(), 1);
  expect_error({"info", f / "a.las", "--columns", "x,nir"}, 2, "no column 'nir'; there are 'x'");
}

/// `bytes` of las_bytes in point format 1: point i has the GPS time 1000 + i * i % 97.
std::string timed(const std::string& bytes) {
  constexpr std::size_t header = 227, record = 20;
  std::string out = bytes.substr(0, header);
  out[104] = 1;
  out[105] = record + 8;
  for (std::size_t at = header, i = 0; at < bytes.size(); at += record, ++i) {
    const double time = internal::little_endian(1000 + static_cast<double>(i * i % 97));
    out.append(bytes, at, record).append(reinterpret_cast<const char*>(&time), sizeof time);
  }
  return out;
}

TEST(CliLas, CoordinatesBesideGpsTimeAreInTheWorld) {
  const Folder f;
  const Numbers numbers = ball(500);
  write_file(f / "a.las", timed(bench::las_bytes(numbers, metres)));
  std::vector<double> world, stored;
  for (std::size_t i = 0; i < 500; ++i) {
    for (std::uint32_t j = 0; j < 2; ++j) {
      stored.push_back(numbers[3 * i + j]);
      world.push_back(metres.at(j, stored.back()));
    }
    stored.push_back(1000 + static_cast<double>(i * i % 97));
    world.push_back(stored.back());
  }
  write_rows(f / "world.npy", world);
  write_rows(f / "stored.npy", stored);
  for (const std::string kind : {"world", "stored"}) {
    run_well({"hull", f / (kind + ".npy"), "-o", f / "npy.json"});
    std::vector<std::string> words{"--columns", "x,y,gps_time", "-o", f / "las.json"};
    if (kind == "stored") words.emplace_back("--raw");
    for (const char* stream : {"off", "on"}) {
      run_well(joined({"hull", f / "a.las", "--stream", stream}, words));
      EXPECT_EQ(read_file(f / "las.json"), read_file(f / "npy.json")) << kind << " " << stream;
    }
    run_well(joined({"hull", "-"}, words), f / "a.las");
    EXPECT_EQ(read_file(f / "las.json"), read_file(f / "npy.json")) << kind << " from a pipe";
  }
}

TEST(CliLas, RawGivesTheNumbersOfTheFile) {
  const Folder f;
  const Numbers numbers = ball(500);
  write_file(f / "a.las", bench::las_bytes(numbers, metres));
  const std::vector<double> wide(numbers.begin(), numbers.end());
  write_npy_points(f / "a.npy", wide.data(), 500, 3, ScalarType::i32);
  for (const char* stream : {"off", "on"}) {
    run_well({"hull", f / "a.las", "--raw", "--stream", stream, "-o", f / "raw.json"});
    run_well({"hull", f / "a.npy", "-o", f / "npy.json"});
    EXPECT_EQ(read_file(f / "raw.json"), read_file(f / "npy.json"));
    run_well({"certify", f / "a.las", f / "raw.json", "--raw", "--stream", stream});
  }
  expect_error({"certify", f / "a.las", f / "raw.json"}, 3, "not certified");
}

TEST(CliLas, StatesAndPipesKeepTheGrid) {
  const Folder f;
  const Numbers numbers = ball(2000);
  write_file(f / "all.las", bench::las_bytes(numbers, metres));
  write_file(f / "t1.las", bench::las_bytes(rows_from(numbers, 0, 900), metres));
  write_file(f / "t2.las", bench::las_bytes(rows_from(numbers, 900, 2000), metres));
  run_well({"hull", f / "all.las", "-o", f / "all.json"});
  run_well({"hull", f / "t1.las", "--partial", f / "t1.hullstate"});
  run_well({"hull", f / "t2.las", "--partial", f / "t2.hullstate"});
  for (const auto& inputs :
       {std::pair{"t1.hullstate", "t2.hullstate"}, {"t1.las", "t2.hullstate"}}) {
    run_well({"hull", f / inputs.first, f / inputs.second, "-o", f / "parts.json"});
    EXPECT_EQ(read_file(f / "parts.json"), read_file(f / "all.json")) << inputs.first;
  }
  for (const char* command : {"hull", "cull"})  // raw beside placed coordinates
    expect_error({command, f / "t2.las", f / "t1.hullstate", "--raw"}, 2,
                 "t1.hullstate: holds coordinates, not the integers of a .las");
  // The coordinates that a state holds are those in the world.
  const HullState state = read_state(f / "t1.hullstate");
  EXPECT_EQ(state.decimals(), 3);
  EXPECT_EQ(state.points().at(0, 1), on_grid(numbers)[3 * state.ids()[0] + 1] / 1000);
  HullState merged = state, other = read_state(f / "t2.hullstate");
  other.shift_ids(900);
  merged.merge(other);
  EXPECT_EQ(merged.decimals(), 3);
  EXPECT_EQ(merged.ids(),
            convex_hull(PointView::row_major(on_grid(numbers).data(), 2000, 3)).vertices);
}

/// Hull states of tiles give the hull of the tiles, byte for byte, or a sentence.
TEST(CliLas, StatesOfTilesOnDifferentGrids) {
  const Folder f;
  std::mt19937_64 random(3);
  constexpr double scales[] = {0.001, 0.01, 0.1, 0.25, 0.5, 1, 0.125, 0.05, 10, 1e-7, 1.0 / 3};
  constexpr double offsets[] = {0, 0.25, 1000, 10'000.1, 484'683.001};
  unsigned refused = 0;
  for (unsigned set = 0; set < 40; ++set) {
    std::vector<std::string> tiles, states;
    for (const char* name : {"a", "b"}) {
      const double scale = scales[random() % std::size(scales)];
      const double offset = offsets[random() % std::size(offsets)];
      Numbers numbers;
      for (unsigned i = 0; i < 90; ++i)
        numbers.push_back(static_cast<std::int32_t>(
            std::lround(static_cast<double>(random() % 5) / std::min(scale, 1.0))));
      tiles.push_back(f / (std::string(name) + ".las"));
      states.push_back(f / (std::string(name) + ".hullstate"));
      write_file(tiles.back(),
                 bench::las_bytes(numbers, {{scale, scale, scale}, {offset, offset, offset}}));
      run_well({"hull", tiles.back(), "--partial", states.back()});
    }
    run_well({"hull", tiles[0], tiles[1], "-o", f / "tiles.obj"});
    const Ran ran = run_app({"hull", states[0], states[1], "-o", f / "states.obj"});
    if (ran.status == 0) {
      EXPECT_EQ(read_file(f / "states.obj"), read_file(f / "tiles.obj")) << "set " << set;
      continue;
    }
    EXPECT_EQ(ran.status, 1);
    EXPECT_TRUE(has(ran.err, "decimals"));
    ++refused;
  }
  EXPECT_LT(refused, 20U);
}

TEST(CliLas, TracksAreInTheWorld) {
  const Folder f;
  const Numbers numbers = ball(300);
  for (const char* name : {"f1.las", "f2.las"})
    write_file(f / name, bench::las_bytes(numbers, metres));
  run_well({"track", f / "f1.las", f / "f2.las", "-o", f / "t%d.obj", "--json=" + (f / "t"),
            "--certify"});
  run_well({"hull", f / "f1.las", "-o", f / "h.obj", "--json=" + (f / "h")});
  EXPECT_EQ(read_file(f / "t1.obj"), read_file(f / "h.obj"));
  EXPECT_EQ(json_in(f / "t")["frames"][1]["volume"], json_in(f / "h")["volume"]);
}

TEST(CliLas, ReportsNameTheUnits) {
  const Folder f;
  write_file(f / "a.las", bench::las_bytes({0, 0, 0, 3000, 0, 0, 0, 4000, 0, 0, 0, 100}, metres));
  for (const char* stream : {"off", "on"})
    for (const char* command : {"hull", "cull", "info"}) {
      const Ran ran = run_app({command, f / "a.las", "--stream", stream});
      EXPECT_TRUE(
          has(ran.out, "exact on the grid of 0.001; scale 0.001 0.001 0.01, offset 500000"));
      const std::string x = command == std::string("info") ? "axis 0     500000 to 500003"
                                                           : "extent     500000 to 500003, 4000000";
      EXPECT_TRUE(has(ran.out, x));
    }
}

TEST(CliLas, EveryReportHasThePlacement) {
  const Folder f;
  const Numbers numbers = {0, 0, 0, 3000, 0, 0, 0, 4000, 0, 0, 0, 100, 7, 7, 1};
  for (const char* name : {"a.las", "b.las"})
    write_file(f / name, bench::las_bytes(numbers, metres));
  write_npy_points(f / "w.npy", std::vector<double>(5).data(), 5, 1, ScalarType::f64);
  run_well({"hull", f / "a.las", "-o", f / "h.json"});
  const std::vector<std::vector<std::string>> commands = command_lines(
      f, {"hull @a.las", "hull @a.las --stream on", "hull @a.las --only vertices",
          "hull @a.las --only vertices --stream on",
          "hull @a.las --partial @s.hullstate --stream on", "hull @s.hullstate --only vertices",
          "certify @a.las @h.json", "certify @a.las @h.json --stream on", "track @a.las @b.las",
          "cull @a.las", "cull @a.las --stream on", "info @a.las", "info @a.las --stream on",
          "delaunay @a.las", "delaunay @a.las --weights @w.npy", "voronoi @a.las", "alpha @a.las",
          "view @a.las -o @v.html"});
  for (std::vector<std::string> words : commands)
    for (const bool raw : {false, true}) {
      const bool state = words[1].ends_with(".hullstate");
      const bool partial = words.size() > 2 && words[2] == "--partial";
      if (raw && (state || partial || words[0] == "certify")) continue;  // kept in the world
      if (raw) words.push_back("--raw");
      words.push_back("--json=" + (f / "j"));
      run_well(words);
      words.pop_back();
      const nlohmann::json report = json_in(f / "j");
      const std::string what = words[0] + " " + words[2 % words.size()] + (raw ? " raw" : "");
      ASSERT_TRUE(report.contains("placement")) << what;
      const nlohmann::json placement = report["placement"];
      EXPECT_EQ(placement["numbers"], raw ? "file" : "grid") << what;
      EXPECT_EQ(placement["grid"], raw ? nlohmann::json() : nlohmann::json(0.001)) << what;
      if (!state) {
        EXPECT_EQ(placement["scale"], nlohmann::json(metres.scale)) << what;
        EXPECT_EQ(placement["offset"], nlohmann::json(metres.offset)) << what;
      }
      const nlohmann::json extent = {{500000, 500003}, {4000000, 4000004}, {-12.5, -11.5}};
      if (words[0] != "info") {  // which says the range of each axis
        EXPECT_EQ(placement["extent"],
                  raw ? nlohmann::json({{0, 3000}, {0, 4000}, {0, 100}}) : extent)
            << what;
      }
      EXPECT_TRUE(placement.contains("unit")) << what;
    }
}

TEST(CliLas, PointsAsTextAreInTheWorld) {
  const Folder f;
  const Numbers numbers = ball(3000);
  write_file(f / "a.las", bench::las_bytes(numbers, metres));
  const std::vector<double> grid = on_grid(numbers);
  for (const char* stream : {"off", "on"}) {
    run_well(
        {"cull", f / "a.las", "--stream", stream, "-o", f / "ids.txt", "--points", f / "kept.csv"});
    std::istringstream ids(read_file(f / "ids.txt")), kept(read_file(f / "kept.csv"));
    std::string line;
    std::getline(kept, line);
    EXPECT_EQ(line, "x,y,z");
    for (std::size_t id = 0; ids >> id;)
      for (std::size_t j = 0; j < 3; ++j) {
        double x = 0;
        ASSERT_TRUE(kept >> x);
        kept.get();
        EXPECT_EQ(x, grid[3 * id + j] / 1000);
      }
  }
}

// Headers that were not filled in.
TEST(CliLas, WithoutAScaleRawAloneReads) {
  const Folder f;
  const Numbers numbers = ball(500);
  write_file(f / "a.las", bench::las_bytes(numbers, {{0, 0, 0}, {0, 0, 0}}));
  write_file(f / "good.las", bench::las_bytes(numbers, metres));
  const std::vector<double> wide(numbers.begin(), numbers.end());
  write_npy_points(f / "a.npy", wide.data(), 500, 3, ScalarType::i32);
  run_well({"hull", f / "a.npy", "-o", f / "npy.obj"});
  run_well({"hull", "--raw", f / "a.las", "-o", f / "las.obj"});
  EXPECT_EQ(read_file(f / "las.obj"), read_file(f / "npy.obj"));
  const std::string say = "a.las: byte 131: the scale of x is 0, which gives no coordinates";
  const std::vector<std::vector<std::string>> commands = command_lines(
      f, {"hull @a.las", "hull @a.las --stream on", "hull @a.las --columns x,y",
          "hull @a.las --by classification -o @h.csv", "hull @good.las @a.las",
          "hull @a.las @good.las --stream on", "cull @a.las -o @ids.npy", "info @a.las",
          "delaunay @a.las", "track @good.las @a.las", "view @a.las -o @page.html"});
  for (const std::vector<std::string>& command : commands) expect_error(command, 1, say);
}

// What --raw takes is said, also where the header gives no place; and no header written has NaN.
TEST(CliLas, RawIsSaidAndWritten) {
  const Folder f;
  const Numbers numbers = ball(500);
  const double nan = std::numeric_limits<double>::quiet_NaN(),
               inf = std::numeric_limits<double>::infinity();
  write_file(f / "p.csv", "1,2,3\n4,5,6\n");
  const std::string say = "units      stored numbers, a .las without its scale and offset";
  for (const Placement& bad :
       {Placement{{0, 0, 0}, {0, 0, 0}, ""}, Placement{{nan, 1, 1}, {0, 0, 0}, ""},
        Placement{{1, 1, 1}, {0, nan, 0}, ""}, Placement{{1, 1, 1}, {inf, 0, 0}, ""}, metres}) {
    write_file(f / "a.las", bench::las_bytes(numbers, bad));
    for (const char* stream : {"off", "on"}) {
      for (const std::vector<std::string>& inputs :
           {std::vector<std::string>{f / "a.las"}, {f / "a.las", f / "p.csv"}}) {
        const Ran ran = run_well(joined({"hull", "--raw", "--stream", stream}, inputs));
        EXPECT_TRUE(has(ran.out, say));
      }
      const auto report =
          expect_json({"hull", "--raw", f / "a.las", "--stream", stream, "--json"}, "hull_report");
      EXPECT_EQ(report["placement"]["numbers"], "file");
    }
    run_well({"cull", f / "a.las", "--raw", "-o", f / "b.las"});
    const std::string written = read_file(f / "b.las");
    for (std::size_t at = 179; at < 227; at += 8) {
      double end = 0;
      std::memcpy(&end, written.data() + at, sizeof end);
      EXPECT_TRUE(std::isfinite(end)) << at;
    }
  }
}

}  // namespace cullhull::cli_las_test
