// The program on LAS files: hulls of their whole numbers, written where scale and offset put them.
#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "agreement/run_app.hpp"
#include "parallel/byte_order.hpp"

namespace cullhull {
namespace {

using testing::expect_error;
using testing::Folder;
using testing::Ran;
using testing::read_file;
using testing::run_app;
using testing::write_file;

using Numbers = std::vector<std::int32_t>;

/// LAS 1.2 of point format 0.
std::string las(const Numbers& numbers, const Placement& placement) {
  constexpr std::size_t header = 227, record = 20;
  std::string bytes(header + numbers.size() / 3 * record, '\0');
  const auto put = [&](std::size_t at, auto value) {
    value = internal::little_endian(value);
    std::memcpy(bytes.data() + at, &value, sizeof value);
  };
  bytes.replace(0, 4, "LASF");
  put(24, std::uint8_t{1});
  put(25, std::uint8_t{2});
  put(94, static_cast<std::uint16_t>(header));
  put(96, static_cast<std::uint32_t>(header));
  put(105, static_cast<std::uint16_t>(record));
  put(107, static_cast<std::uint32_t>(numbers.size() / 3));
  for (std::size_t j = 0; j < 3; ++j) {
    put(131 + 8 * j, placement.scale[j]);
    put(155 + 8 * j, placement.offset[j]);
  }
  for (std::size_t i = 0; i < numbers.size(); ++i)
    put(header + i / 3 * record + i % 3 * 4, numbers[i]);
  return bytes;
}

Numbers ball(std::uint64_t count) {
  Numbers numbers;
  for (const double v : generate("ball", count, 3, 4))
    numbers.push_back(static_cast<std::int32_t>(v * 1e6));
  return numbers;
}

const Placement metres{{0.001, 0.001, 0.01}, {500000, 4000000, -12.5}};

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
  write_file(f / "a.las", las(numbers, metres));
  const std::vector<double> wide(numbers.begin(), numbers.end());
  const Hull hull = convex_hull(PointView::row_major(wide.data(), 3000, 3));
  std::vector<double> expected;
  for (const std::uint64_t v : hull.vertices)
    for (std::size_t j = 0; j < 3; ++j)
      expected.push_back(wide[3 * v + j] * metres.scale[j] + metres.offset[j]);
  for (const char* stream : {"off", "on"}) {
    const Ran ran = run_app({"hull", f / "a.las", "--stream", stream, "-o", f / "a.obj", "-o",
                             f / "a.json", "--certify"});
    ASSERT_EQ(ran.status, 0) << ran.err;
    EXPECT_EQ(vertices_of_obj(read_file(f / "a.obj")), expected) << stream;
    // The result itself, which certify checks, has the file's numbers.
    EXPECT_EQ(run_app({"certify", f / "a.las", f / "a.json"}).status, 0);
  }
}

TEST(CliLas, PlansHaveMeasuresInTheirUnits) {
  const Folder f;
  write_file(f / "a.las",
             las({0, 0, 7, 3000, 0, 7, 3000, 4000, 9, 0, 4000, 9, 1000, 1000, 8}, metres));
  ASSERT_EQ(run_app({"hull", f / "a.las", "--columns", "y,x", "-o", f / "a.geojson"}).status, 0);
  const auto feature = nlohmann::json::parse(read_file(f / "a.geojson"));
  EXPECT_DOUBLE_EQ(feature["properties"]["area"].get<double>(), 12);
  EXPECT_DOUBLE_EQ(feature["properties"]["perimeter"].get<double>(), 14);
  EXPECT_EQ(feature["geometry"]["coordinates"][0].size(), 5U);
  for (const auto& corner : feature["geometry"]["coordinates"][0])
    EXPECT_TRUE(corner[0] >= 4000000 && corner[1] >= 500000 && corner[1] < 500004) << corner;
}

TEST(CliLas, TilesOfOneGridAreOneSetAndOthersAreRefused) {
  const Folder f;
  const Numbers numbers = ball(2000);
  const auto part = [&](std::size_t first, std::size_t last) {
    return Numbers(numbers.begin() + static_cast<std::ptrdiff_t>(3 * first),
                   numbers.begin() + static_cast<std::ptrdiff_t>(3 * last));
  };
  write_file(f / "all.las", las(numbers, metres));
  write_file(f / "t1.las", las(part(0, 700), metres));
  write_file(f / "t2.las", las(part(700, 2000), metres));
  ASSERT_EQ(run_app({"hull", f / "all.las", "-o", f / "all.ply"}).status, 0);
  for (const char* stream : {"off", "on"}) {
    const Ran ran =
        run_app({"hull", f / "t1.las", f / "t2.las", "--stream", stream, "-o", f / "tiles.ply"});
    ASSERT_EQ(ran.status, 0) << ran.err;
    EXPECT_EQ(read_file(f / "tiles.ply"), read_file(f / "all.ply")) << stream;
  }
  Placement other = metres;
  other.offset[0] += 1000;
  write_file(f / "t2.las", las(part(700, 2000), other));
  for (const char* stream : {"off", "on"})
    expect_error({"hull", f / "t1.las", f / "t2.las", "--stream", stream}, 1,
                 "t2.las: scale or offset are not those of the numbers in");
}

// So that they are the same points, whole: what scale and offset make of them is rounded.
TEST(CliLas, PointsAsTextAreTheNumbersOfTheFile) {
  const Folder f;
  const Numbers numbers = ball(3000);
  write_file(f / "a.las", las(numbers, metres));
  for (const char* stream : {"off", "on"}) {
    ASSERT_EQ(run_app({"cull", f / "a.las", "--stream", stream, "-o", f / "ids.txt", "--points",
                       f / "kept.csv"})
                  .status,
              0);
    std::istringstream ids(read_file(f / "ids.txt"));
    std::string expected = "x,y,z\n";
    for (std::size_t id = 0; ids >> id;)
      for (std::size_t j = 0; j < 3; ++j)
        expected += std::to_string(numbers[3 * id + j]) + (j < 2 ? ',' : '\n');
    EXPECT_EQ(read_file(f / "kept.csv"), expected);
    // Beside a mesh of the same file, whose vertices lie elsewhere.
    ASSERT_EQ(run_app({"hull", f / "kept.csv", "-o", f / "kept.obj"}).status, 0);
    ASSERT_EQ(run_app({"hull", f / "a.las", "-o", f / "las.obj"}).status, 0);
    std::vector<double> placed = vertices_of_obj(read_file(f / "kept.obj"));
    for (std::size_t i = 0; i < placed.size(); ++i) placed[i] = metres.at(i % 3, placed[i]);
    std::vector<double> lie = vertices_of_obj(read_file(f / "las.obj"));
    std::sort(placed.begin(), placed.end());
    std::sort(lie.begin(), lie.end());
    EXPECT_EQ(placed, lie);
  }
}

// Headers that were not filled in, and numbers of another format among them: as they are.
TEST(CliLas, WithoutAScaleNumbersAreAsTheyAre) {
  const Folder f;
  const Numbers numbers = ball(500);
  write_file(f / "a.las", las(numbers, {{0, 0, 0}, {0, 0, 0}}));
  const std::vector<double> wide(numbers.begin(), numbers.end());
  write_npy_points(f / "a.npy", wide.data(), 500, 3, ScalarType::i32);
  ASSERT_EQ(run_app({"hull", f / "a.npy", "-o", f / "npy.obj"}).status, 0);
  ASSERT_EQ(run_app({"hull", f / "a.las", "-o", f / "las.obj"}).status, 0);
  EXPECT_EQ(read_file(f / "las.obj"), read_file(f / "npy.obj"));
  write_file(f / "b.las", las(numbers, metres));
  ASSERT_EQ(run_app({"hull", f / "b.las", f / "a.npy", "-o", f / "both.obj"}).status, 0);
  EXPECT_EQ(read_file(f / "both.obj"), read_file(f / "npy.obj"));
}

}  // namespace
}  // namespace cullhull
