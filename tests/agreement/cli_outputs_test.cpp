// What the program writes, under which names, and what it refuses to write over.
#include <array>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <sstream>

#include "agreement/run_app.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/io.hpp"

namespace cullhull::cli_outputs_test {

using namespace testing;

/// Exit 2 with one line that holds `part`, and no file that was not there before.
void expect_refused(const Folder& f, const std::vector<std::string>& arguments,
                    const std::string& part, const std::string& input = "/dev/null") {
  const std::size_t before = f.entries();
  expect_error(arguments, 2, part, input);
  EXPECT_EQ(f.entries(), before) << part;
}

std::vector<std::uint64_t> lines_of(const std::string& text) {
  std::istringstream in(text);
  std::vector<std::uint64_t> numbers;
  for (std::uint64_t n; in >> n;) numbers.push_back(n);
  return numbers;
}

std::vector<std::uint64_t> npy_ids(const std::string& path) {
  const std::string bytes = read_file(path);
  EXPECT_EQ(bytes.substr(1, 5), "NUMPY") << path;
  EXPECT_TRUE(has(bytes, "'<i8'")) << path;
  const std::size_t begin = bytes.find('\n') + 1;
  std::vector<std::uint64_t> ids((bytes.size() - begin) / 8);
  std::memcpy(ids.data(), bytes.data() + begin, ids.size() * 8);
  return ids;
}

TEST(CliOutputs, IdsAsTheNameSays) {
  const Folder f;
  write_points(f / "p.npy", "ball", 3000, 3);
  for (const std::vector<std::string>& command :
       command_lines(f, {"hull @p.npy -q --vertices", "hull @p.npy -q --only vertices --vertices",
                         "cull @p.npy -q -o"})) {
    const auto write = [&](const std::string& name) {
      auto arguments = command;
      arguments.push_back(f / name);
      run_well(arguments);
      return read_file(f / name);
    };
    write("ids.npy");
    const auto ids = npy_ids(f / "ids.npy");
    ASSERT_GT(ids.size(), 100U);
    EXPECT_EQ(lines_of(write("ids.txt")), ids) << command[0];
    const std::string csv = write("IDS.CSV");
    EXPECT_EQ(csv.substr(0, 3), "id\n") << command[0];
    EXPECT_EQ(lines_of(csv.substr(3)), ids) << command[0];
  }
  for (const char* name : {"v.obj", "v.json", "v.las", "v", "v."})
    expect_refused(f, {"hull", f / "p.npy", "--vertices", f / name},
                   "must end in .npy, .ply, .geojson, .csv, .xyz or .txt");
}

TEST(CliOutputs, CullWritesPoints) {
  const Folder f;
  for (const ScalarType type : {ScalarType::f64, ScalarType::f32}) {
    write_points(f / "p.npy", "ball", 5000, 3, type);
    run_well({"cull", f / "p.npy", "-q", "-o", f / "ids.npy"});
    const auto ids = npy_ids(f / "ids.npy");
    const PointFile all = open_points(f / "p.npy");
    for (const char* name : {"s.ply", "s.xyz"})
      run_well({"cull", f / "p.npy", "-q", "-o", f / name});
    for (const char* name : {"t.npy", "t.ply", "t.csv", "t.xyz", "t.txt"})
      run_well({"cull", f / "p.npy", "-q", "-o", f / "ids.csv", "--points", f / name});
    for (const char* name : {"s.ply", "s.xyz", "t.npy", "t.ply", "t.csv", "t.xyz", "t.txt"}) {
      const PointFile some = open_points(f / name);
      ASSERT_EQ(some.points().count, ids.size()) << name;
      ASSERT_EQ(some.points().dimension, 3U) << name;
      const bool binary = std::string(name).ends_with("npy") || std::string(name).ends_with("ply");
      EXPECT_EQ(some.points().scalar, binary ? type : ScalarType::f64) << name;
      for (std::size_t i = 0; i < ids.size(); ++i)
        for (std::uint32_t j = 0; j < 3; ++j)
          ASSERT_EQ(some.points().at(i, j), all.points().at(ids[i], j)) << name;
    }
    EXPECT_EQ(read_file(f / "t.csv").substr(0, 6), "x,y,z\n");
  }
  write_points(f / "four.npy", "ball", 5000, 4);
  expect_refused(f, {"cull", f / "four.npy", "-o", f / "a.ply"}, "dimension 2 or 3");
  run_well({"cull", f / "four.npy", "-q", "--points", f / "a.csv"});
  EXPECT_EQ(open_points(f / "a.csv").points().dimension, 4U);
}

TEST(CliOutputs, UnknownNamesAreRefusedBeforeTheWork) {
  const Folder f;
  const std::string absent = f / "absent.npy";  // the name is judged before the input is opened
  expect_refused(f, {"cull", absent, "-o", f / "s.obj"},
                 "must end in .npy, .ply, .las, .geojson, .csv, .xyz or .txt");
  expect_refused(f, {"cull", absent, "-o", f / "s"}, "must end in");
  expect_refused(f, {"cull", absent, "--points", f / "s.off"}, "must end in");
  expect_refused(f, {"hull", absent, "-o", f / "h.npy"},
                 "must end in .ply, .obj, .off, .stl, .glb, .vtp, .geojson, .wkt, .json, .txt, "
                 ".hullstate or .npz");
  for (const char* other : {"h.ply", "h.vtk", "h.las", "h.html"})
    expect_refused(f, {"hull", absent, "--json=" + (f / other)}, "end it in .json");
  expect_refused(f, {"generate", "ball", "-n", "5", "-o", f / "h.stl"},
                 "must end in .npy, .ply, .obj, .off, .geojson, .wkt, .csv, .xyz, .txt or .raw");
  expect_refused(f, {"view", absent, "-o", f / "h.png"}, "must end in .html or .htm");
  expect_refused(f, {"track", absent, "-o", f / "%d.docx"}, "must end in .ply");
  expect_refused(f, {"hull", absent, "--vertices", ""}, "empty");
  expect_refused(f, {"hull", absent, "-o", ""}, "empty");
}

TEST(CliOutputs, NothingOverwritesAnInput) {
  const Folder f;
  const std::string ply = f / "p.ply", npy = f / "p.npy", json = f / "h.json";
  write_points(npy, "ball", 300, 3);
  run_well({"cull", npy, "-q", "--cull", "none", "-o", ply});
  run_well({"hull", npy, "-q", "-o", json});
  std::filesystem::create_symlink(ply, f / "link.ply");
  std::filesystem::create_hard_link(ply, f / "hard.ply");
  std::filesystem::create_directory(f / "sub");
  std::filesystem::create_directory_symlink(f / "", f / "sub/loop");
  const std::string before = read_file(ply);
  for (const std::string& name : {ply, f / "link.ply", f / "hard.ply", f / "./p.ply",
                                  f / "sub/../p.ply", f / "sub/loop/p.ply"}) {
    expect_refused(f, {"hull", ply, "-o", name}, "would overwrite the input");
    expect_refused(f, {"hull", name, "-o", ply}, "would overwrite the input");
    expect_refused(f, {"cull", ply, "-o", name}, "would overwrite the input");
    expect_refused(f, {"cull", ply, "--points", name}, "would overwrite the input");
  }
  expect_refused(f, {"hull", "-", "-o", ply}, "would overwrite the input standard input", ply);
  expect_refused(f, {"hull", npy, "--vertices", npy}, "would overwrite the input");
  expect_refused(f, {"certify", npy, json, "--json=" + json}, "would overwrite the input");
  expect_refused(f, {"info", json, "--json=" + json}, "would overwrite the input");
  expect_refused(f, {"qconvex", "TI", npy, "TO", npy}, "would overwrite the input");
  expect_refused(f, {"view", json, "-o", f / "v.html", "--json=" + json},
                 "would overwrite the input");
  expect_refused(f, {"track", f / "p*.ply", "-o", f / "p.ply"}, "frame's number");
  std::filesystem::copy_file(ply, f / "t0.ply");
  std::filesystem::copy_file(ply, f / "t1.ply");
  expect_refused(f, {"track", f / "t*.ply", "-o", f / "t%d.ply"}, "would overwrite the input");
  EXPECT_EQ(read_file(ply), before);
  // A name that merely looks alike is another file.
  run_well({"hull", ply, "-q", "-o", f / "P.ply"});
}

TEST(CliOutputs, NoTwoOutputsOfOneName) {
  const Folder f;
  const std::string p = f / "p.npy";
  write_points(p, "ball", 300, 3);
  std::filesystem::create_directory(f / "sub");
  expect_refused(f, {"hull", p, "-o", f / "a.json", "--json=" + (f / "a.json")}, "-o");
  expect_refused(f, {"hull", p, "-o", f / "a.txt", "--vertices", f / "./a.txt"}, "--vertices");
  expect_refused(f, {"hull", p, "-o", f / "a.ply", "-o", f / "sub/../a.ply"}, "a.ply");
  expect_refused(f, {"cull", p, "-o", f / "a.ply", "--points", f / "a.ply"}, "--points");
  write_file(f / "old.txt", "");
  std::filesystem::create_symlink(f / "old.txt", f / "new.txt");
  expect_refused(f, {"hull", p, "-o", f / "old.txt", "--vertices", f / "new.txt"}, "--vertices");
  for (const std::vector<std::string>& two : command_lines(
           {"--json --format i", "--json --vertices -", "--vertices - -o -", "-o - -o -"})) {
    expect_refused(f, joined({"hull", p}, two), "standard output");
  }
  // Devices have no name to share.
  run_well({"hull", p, "-q", "-o", "/dev/null", "--vertices", "/dev/null"});
}

TEST(CliOutputs, StandardOutputTakesResults) {
  const Folder f;
  const std::string p = f / "p.npy";
  write_points(p, "ball", 300, 3);
  run_well({"hull", p, "-q", "-o", f / "h.json"});
  const Ran ran = run_well({"hull", p, "-o", "-"});
  EXPECT_EQ(ran.out, read_file(f / "h.json"));
  run_well({"cull", p, "-q", "-o", f / "ids.npy"});
  EXPECT_EQ(run_app({"cull", p, "-o", "-"}).out, read_file(f / "ids.npy"));
  run_well({"generate", "ball", "-n", "300", "-q", "-o", f / "g.npy"});
  EXPECT_EQ(run_app({"generate", "ball", "-n", "300", "-o", "-"}).out, read_file(f / "g.npy"));
}

TEST(CliOutputs, WhatWasWrittenIsSaid) {
  const Folder f;
  const std::string p = f / "p.npy";
  const Ran made = run_well({"generate", "ball", "-n", "1000", "-o", p});
  EXPECT_TRUE(has(made.out, "points     1,000 x 3 f64, ball, seed 1\n"));
  EXPECT_TRUE(has(made.out, "wrote      " + p + ", 24,128 bytes\n"));
  EXPECT_EQ(run_app({"generate", "ball", "-n", "1000", "-q", "-o", p}).out, "");
  const Ran page = run_app({"view", p, "-o", f / "page.html"});
  if (page.status != 5) {  // built without three.js
    EXPECT_EQ(page.status, 0) << page.err;
    EXPECT_EQ(page.out.find("wrote      " + (f / "page.html") + ", "), 0U) << page.out;
  }
  EXPECT_TRUE(
      has(run_app({"hull", p, "-o", f / "h.ply"}).out, "wrote      " + (f / "h.ply") + ", "));
  EXPECT_TRUE(
      has(run_app({"cull", p, "-o", f / "s.npy"}).out, "wrote      " + (f / "s.npy") + ", "));
}

// Polygons are more than some programs read: trimesh and PyVista of .ply, Open3D of .obj.
TEST(CliOutputs, TrianglesByDefaultPolygonsOnRequest) {
  const Folder f;
  const std::string p = f / "p.txt";
  write_file(p, "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n");
  for (const std::string name : {"h.ply", "h.off", "h.obj"})
    run_well({"hull", p, "-q", "-o", f / name});
  const std::string ply = read_file(f / "h.ply");
  EXPECT_TRUE(has(ply, "element face 12\n"));
  const std::size_t faces = ply.find("end_header\n") + 11 + std::size_t{8} * 24;
  ASSERT_EQ(ply.size(), faces + std::size_t{12} * 13);
  for (std::size_t t = 0; t < 12; ++t) EXPECT_EQ(ply[faces + 13 * t], 3);
  const std::string off = read_file(f / "h.off");
  EXPECT_EQ(off.substr(0, 11), "OFF\n8 12 18");
  std::size_t lines = 0;
  const std::string obj = read_file(f / "h.obj");
  for (std::size_t at = obj.find("\nf "); at != std::string::npos; at = obj.find("\nf ", at + 1))
    ++lines;
  EXPECT_EQ(lines, 12U);
  const auto faces_of = [&](const std::string& option, const std::string& name) {
    std::vector<std::string> words{"hull", p, "-q", "-o", f / name};
    if (!option.empty()) words.push_back(option);
    run_well(words);
    return read_file(f / name);
  };
  EXPECT_TRUE(has(faces_of("--polygons", "h.ply"), "element face 6\n"));
  EXPECT_EQ(faces_of("--polygons", "h.off").substr(0, 11), "OFF\n8 6 12\n");
  EXPECT_EQ(faces_of("--triangles", "h.off").substr(0, 11), "OFF\n8 12 18");
  EXPECT_TRUE(has(faces_of("", "h.vtp"), "NumberOfPolys=\"6\""));
  EXPECT_TRUE(has(faces_of("--polygons", "h.vtp"), "NumberOfPolys=\"6\""));
  EXPECT_TRUE(has(faces_of("--triangles", "h.vtp"), "NumberOfPolys=\"12\""));
  const std::string pattern = f / "t%d.off";
  run_well({"track", p, "-q", "-o", pattern, "--polygons"});
  EXPECT_EQ(read_file(f / "t0.off").substr(0, 11), "OFF\n8 6 12\n");
  run_well({"track", p, "-q", "-o", pattern});
  EXPECT_EQ(read_file(f / "t0.off").substr(0, 11), "OFF\n8 12 18");
  for (const char* option : {"--polygons", "--triangles"}) {
    expect_refused(f, {"hull", p, option, "-o", f / "n.stl"}, "is of meshes");
    expect_refused(f, {"hull", p, option}, "is of meshes");
    expect_refused(f, {"track", p, option, "-o", f / "n%d.json"}, "is of meshes");
  }
  expect_refused(f, {"hull", p, "--polygons", "--triangles", "-o", f / "n.ply"}, "exclude");
  // The hull of points in the plane is one polygon, or a fan.
  write_file(p, "0 0\n1 0\n0 1\n1 1\n2 0.5\n");
  run_well({"hull", p, "-q", "-o", f / "h.off"});
  EXPECT_EQ(read_file(f / "h.off").substr(0, 9), "OFF\n5 3 7");
  EXPECT_EQ(faces_of("--polygons", "h.off").substr(0, 9), "OFF\n5 1 5");
}

// Cells of a region with a dent and a hole: their triangles have its area, where fans overlap.
TEST(CliOutputs, ClippedCellsAsTriangles) {
  const Folder f;
  const std::string p = f / "p.txt", region = f / "region.geojson", out = f / "cells.off";
  write_file(p, "0.5 0.5\n3 3\n9 9\n");
  write_file(region,
             R"({"type": "Polygon", "coordinates": [
                 [[0, 0], [4, 0], [4, 1], [1, 1], [1, 4], [0, 4], [0, 0]],
                 [[0.25, 0.25], [0.25, 0.5], [0.5, 0.5], [0.5, 0.25], [0.25, 0.25]]]})");
  run_well({"voronoi", p, "-q", "--clip", region, "-o", out});
  std::istringstream in(read_file(out));
  std::string word;
  std::size_t vertices = 0, faces = 0, edges = 0;
  in >> word >> vertices >> faces >> edges;
  std::vector<std::array<double, 3>> at(vertices);
  for (auto& v : at) in >> v[0] >> v[1] >> v[2];
  double area = 0;
  for (std::size_t i = 0; i < faces; ++i) {
    std::size_t n = 0, a = 0, b = 0, c = 0;
    in >> n >> a >> b >> c;
    ASSERT_EQ(n, 3U);
    const double twice = (at[b][0] - at[a][0]) * (at[c][1] - at[a][1]) -
                         (at[b][1] - at[a][1]) * (at[c][0] - at[a][0]);
    EXPECT_GT(twice, 0);
    area += twice / 2;
  }
  EXPECT_DOUBLE_EQ(area, 7 - 0.0625);
  expect_error({"voronoi", p, "-q", "--clip", region, "-o", out, "--polygons"}, 2, "has a hole");
  run_well({"voronoi", p, "-q", "--clip", region, "-o", f / "c.vtp", "--triangles"});
  expect_error({"voronoi", p, "--clip", region, "-o", f / "c.geojson", "--polygons"}, 2,
               "is of meshes");
}

}  // namespace cullhull::cli_outputs_test
