// cullhull alpha as users meet it.
#include <nlohmann/json.hpp>

#include "agreement/run_app.hpp"
#include "cullhull/io.hpp"
#include "cullhull/triangulation_io.hpp"

namespace cullhull {
namespace cli_alpha_test {

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
  const Ran ran = run_app({"alpha", f / "p.txt", "--alpha", "all-points"});
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_NE(ran.out.find("alpha      0.7071067811865476\n"), std::string::npos) << ran.out;
  EXPECT_NE(ran.out.find("cells      19 of 23, 15 facets around 2 regions\n"), std::string::npos)
      << ran.out;
  const Ran one = run_app({"alpha", f / "p.txt"});
  EXPECT_NE(one.out.find("around 1 region\n"), std::string::npos) << one.out;
  const Ran all = run_app({"alpha", f / "p.txt", "--alpha", "inf"});
  EXPECT_NE(all.out.find("cells      23 of 23"), std::string::npos) << all.out;
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
      run_app({"alpha", f / "p.txt", "--edge-length", "1", "-o", f / "a.wkt", "-o", f / "a.json"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_NE(ran.out.find("edges      replaced where longer than 1\n"), std::string::npos)
      << ran.out;
  EXPECT_NE(ran.out.find("around 1 region\n"), std::string::npos) << ran.out;
  const auto points_of_ring = [&] {
    const std::string wkt = read_file(f / "a.wkt");
    return std::count(wkt.begin(), wkt.end(), ',') + 1;
  };
  EXPECT_EQ(points_of_ring(), 45);  // every point, and the first again
  EXPECT_EQ(nlohmann::json::parse(read_file(f / "a.json"))["facets"].size(), 44U);
  ASSERT_EQ(run_app({"alpha", f / "p.txt", "--ratio", "1", "-q", "-o", f / "a.wkt"}).status, 0);
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
  ASSERT_EQ(run_app({"alpha", f / "p.txt", "-q", "--alpha", "0.75", "-o", f / "a.geojson", "-o",
                     f / "a.wkt", "-o", f / "a.json", "-o", f / "a.vtk", "-o", f / "a.off"})
                .status,
            0);
  const json map = json::parse(read_file(f / "a.geojson"));
  ASSERT_EQ(map["features"].size(), 1U);
  const json rings = map["features"][0]["geometry"]["coordinates"];
  ASSERT_EQ(rings.size(), 2U);
  EXPECT_EQ(rings[0].size(), 33U);  // closed
  EXPECT_EQ(rings[0].front(), rings[0].back());
  EXPECT_EQ(rings[1].size(), 13U);  // its corners are cut
  EXPECT_EQ(read_file(f / "a.wkt").substr(0, 35), "GEOMETRYCOLLECTION (POLYGON ((0 0, ");
  const json a = json::parse(read_file(f / "a.json"));
  EXPECT_EQ(a["alpha"], 0.75);
  EXPECT_EQ(a["cells"].size(), 2U * (64 - 16) + 4);
  EXPECT_EQ(a["facets"].size(), 44U);
  EXPECT_EQ(read_file(f / "a.off").substr(0, 15), "OFF\n72 100 172\n");
  EXPECT_NE(read_file(f / "a.vtk").find("CELLS 100 400\n"), std::string::npos);
}

TEST(CliAlpha, WritesSurfacesInSpace) {
  const Folder f;
  write_points(f / "ball.npy", "ball", 500, 3);
  for (const char* ending : {"ply", "obj", "off", "stl", "glb", "vtp", "vtk", "json"})
    EXPECT_EQ(
        run_app({"alpha", f / "ball.npy", "-q", "-o", f / (std::string("s.") + ending)}).status, 0)
        << ending;
  const std::string off = read_file(f / "s.off");
  std::uint64_t vertices = 0, faces = 0, edges = 0;
  ASSERT_EQ(std::sscanf(off.c_str(), "OFF\n%lu %lu %lu", &vertices, &faces, &edges), 3);
  EXPECT_LE(vertices, 500U);
  EXPECT_GT(faces, 0U);
  expect_error({"alpha", f / "ball.npy", "-o", f / "s.wkt"}, 2, "polygons of 2D points");
}

TEST(CliAlpha, FewPointsAndRefusals) {
  const Folder f;
  write_file(f / "line.txt", "0 0\n1 1\n2 2\n");
  const Ran ran = run_app({"alpha", f / "line.txt", "-o", f / "a.wkt", "-o", f / "a.ply"});
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(read_file(f / "a.wkt"), "GEOMETRYCOLLECTION EMPTY\n");
  expect_error({"alpha", f / "line.txt", "--alpha", "-1"}, 2, "numbers that are not negative");
  expect_error({"alpha", f / "line.txt", "--alpha", "auto"}, 2, "known are one-region");
  expect_error({"alpha", f / "line.txt", "-o", f / "a.xyz"}, 2, "");
  expect_error({"alpha", f / "none.txt"}, 1, "none.txt");
}

}  // namespace cli_alpha_test
}  // namespace cullhull
