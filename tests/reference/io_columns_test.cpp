// Columns by name and number: of texts whose other columns hold anything, and of every format.
#include <filesystem>
#include <fstream>
#include <functional>
#include <map>
#include <mutex>

#include "cullhull/point_blocks.hpp"
#include "tests/io_fixtures.hpp"

namespace cullhull::testing {
namespace {

ReadOptions columns(const std::string& text) {
  ReadOptions options;
  options.columns = text;
  return options;
}

Rows rows(std::string_view text, const std::string& chosen, const std::string& format = "csv") {
  return rows_of(parse(text, format, columns(chosen)).view);
}

/// The message where the columns asked for are not to be had.
std::string not_there(std::string_view text, const std::string& chosen,
                      const std::string& format = "csv") {
  return error_of(ErrorCode::invalid_argument, [&] { parse(text, format, columns(chosen)); });
}

constexpr std::string_view towns =
    "id,name,x,y,z\n"
    "7,Ulm,1,2,3\n"
    "8,\"Weil, am Rhein\",4,5,6\n"
    "9,\"the \"\"old\"\" town\",\"7\", 8 ,9e0\n"
    "# a comment\n"
    "\n"
    "10,,-1,.5,0\r\n";

TEST(Columns, ByNameAndNumberWithWordsBeside) {
  const Rows want{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}, {-1, 0.5, 0}};
  for (const char* chosen : {"x,y,z", "X,Y,Z", "2:5", "2:", "2,3,4", "\"x\",y,4"})
    for (const char* format : {"csv", "txt", ""})
      EXPECT_EQ(rows(towns, chosen, format), want) << chosen << " " << format;
  EXPECT_EQ(rows(towns, "z,x"), (Rows{{3, 1}, {6, 4}, {9, 7}, {0, -1}}));
  EXPECT_EQ(rows(towns, "id"), (Rows{{7}, {8}, {9}, {10}}));
}

TEST(Columns, SeparatorsOtherThanCommas) {
  EXPECT_EQ(rows("name;x;y\na, b;1;2\n", "x,y"), (Rows{{1, 2}}));
  EXPECT_EQ(rows("name\tx\ty\na b\t1\t2\n\t3\t4\n", "x,y", "txt"), (Rows{{1, 2}, {3, 4}}));
  EXPECT_EQ(rows("name x  y\na   1 2\n b 3\t4 \n", "x,y", "txt"), (Rows{{1, 2}, {3, 4}}));
  EXPECT_EQ(rows("//X Y Z Red\n1 2 3 red\n", "z,x", "xyz"), (Rows{{3, 1}}));
  EXPECT_EQ(rows("# t x y\n# written by hand\n0 1 2\n", "x,y", "xyz"), (Rows{{1, 2}}));
  EXPECT_EQ(rows("a 1 2\nb 3 4\n", "1:", "xyz"), (Rows{{1, 2}, {3, 4}}));
  EXPECT_EQ(rows("x,1st,2nd\n1,2,3\n", "2nd,x"), (Rows{{3, 1}}));
  EXPECT_EQ(rows("\"a,b\",\"c \"\"d\"\"\"\n1,2\n", "\"c \"\"d\"\"\",\"a,b\""), (Rows{{2, 1}}));
}

void expect_rows_and_remark(const char* text, const Rows& want, const std::string& remark) {
  std::vector<std::string> said;
  ReadOptions options;
  options.remark = [&](const std::string& line) { said.push_back(line); };
  EXPECT_EQ(rows_of(parse(text, "csv", options).view), want) << text;
  EXPECT_EQ(said, remark.empty() ? std::vector<std::string>{} : std::vector{remark}) << text;
}

TEST(Columns, WithoutBeingAskedForXYZOfAHeader) {
  for (const auto& [text, want, remark] : std::vector<std::tuple<const char*, Rows, std::string>>{
           {"x,y,z,intensity\n1,2,3,4\n",
            {{1, 2, 3}},
            "F: x, y and z of 4 columns are taken as coordinates"},
           {"id,Y,X\nB-1,1,2\n", {{2, 1}}, "F: x and y of 3 columns are taken as coordinates"},
           {"x,y,z\n1,2,3\n", {{1, 2, 3}}, ""},
           {"\"x\",\"y\"\n\"1\",\"2\"\n", {{1, 2}}, ""},
           {"y,x\n1,2\n", {{2, 1}}, "F: x and y are taken as coordinates, in this order"},
           {"lon,lat,height\n1,2,3\n", {{1, 2, 3}}, ""},
           {"x0,x1,x2,x3\n1,2,3,4\n", {{1, 2, 3, 4}}, ""},
           {"x,x,y\n1,2,3\n", {{1, 2, 3}}, ""}}) {
    expect_rows_and_remark(text, want, remark);
  }
}

TEST(Columns, OfMapsAreKnown) {
  for (const auto& [text, want, remark] : std::vector<std::tuple<const char*, Rows, std::string>>{
           {"fid,LAT,Lon\n1,2,3\n",
            {{3, 2}},
            "F: lon and lat of 3 columns are taken as coordinates"},
           {"longitude;latitude\n1;2\n", {{1, 2}}, ""},
           {"latitude,longitude\n1,2\n",
            {{2, 1}},
            "F: longitude and latitude are taken as coordinates, in this order"},
           {"Easting,Northing,Elevation,class\n1,2,3,4\n",
            {{1, 2, 3}},
            "F: easting, northing and elevation of 4 columns are taken as coordinates"},
           {"name,northing,easting\nUlm,2,3\n",
            {{3, 2}},
            "F: easting and northing of 3 columns are taken as coordinates"},
           {"X,Y,lon,lat\n1,2,3,4\n", {{1, 2}}, "F: x and y of 4 columns are taken as coordinates"},
           {"lon,lat,lat\n1,2,3\n", {{1, 2, 3}}, ""}})
    expect_rows_and_remark(text, want, remark);
}

TEST(Columns, OfTextsWithBlanksAreKnown) {
  for (const char* format : {"txt", "xyz", ""}) {
    const auto read = [&](const char* text) { return rows_of(parse(text, format).view); };
    EXPECT_EQ(read("X Y Z\n1 2 3\n4 5 6\n"), (Rows{{1, 2, 3}, {4, 5, 6}})) << format;
    EXPECT_EQ(read("# a scan\nEasting\tNORTHING\tClass\n1\t2\t3\n"), (Rows{{1, 2}})) << format;
    EXPECT_EQ(read("lat lon\n1 2\n"), (Rows{{2, 1}})) << format;
    EXPECT_EQ(refusal("a b\n1 2\n", format), "F:1: 'a' is not a number");
    EXPECT_EQ(refusal("x 1\n1 2\n", format), "F:1: 'x' is not a number");
  }
}

// pandas writes the index of a frame in a first column without a name.
TEST(Columns, ThatNumberThePointsAreNoCoordinates) {
  for (const auto& [text, want, remark] : std::vector<std::tuple<const char*, Rows, std::string>>{
           {"id,a,b\n1,2,3\n", {{2, 3}}, "F: 'a', 'b' are taken as coordinates, not 'id'"},
           {"a,b,INDEX\n1,2,3\n", {{1, 2}}, "F: 'a', 'b' are taken as coordinates, not 'INDEX'"},
           {"\"\",a,b,FID\n1,2,3,4\n",
            {{2, 3}},
            "F: 'a', 'b' are taken as coordinates, not '', 'FID'"},
           {",a,b\n0,2,3\n", {{2, 3}}, "F: 'a', 'b' are taken as coordinates, not ''"},
           {"1,2\n3,4\n", {{1, 2}, {3, 4}}, ""}})
    expect_rows_and_remark(text, want, remark);
  EXPECT_EQ(rows("id,a,b\n1,2,3\n", "id,a"), (Rows{{1, 2}}));
  EXPECT_NE(refusal("id\n1\n", "csv").find("number the points"), std::string::npos);
  EXPECT_EQ(rows("id\n1\n", "id"), (Rows{{1}}));
}

TEST(Columns, RowsThatAreNone) {
  const auto refused = [](std::string_view text, const std::string& chosen) {
    return refusal(text, "csv", columns(chosen));
  };
  EXPECT_EQ(refused("id,x,y\n1,2,3\n1,two,3\n", "x,y"), "F:3: column 'x': 'two' is not a number");
  EXPECT_EQ(refused("id,x,y\n1,2,3\n1,,3\n", "x,y"), "F:3: column 'x' is empty");
  EXPECT_EQ(refused("id,x,y\n1,\" \",3\n", "x,y"), "F:2: column 'x' is empty");
  EXPECT_EQ(refused("a,1e999\n", "1"), "F:1: column 2: '1e999' exceeds the range of doubles");
  EXPECT_EQ(refused("id,x,y\na,1 2,3\n", "x,y"), "F:2: column 'x': '1 2' is not a number");
  EXPECT_EQ(refused("id,x,y\nWeil, am Rhein,2,3\n", "x,y"),
            "F:2: column 'x': 'am Rhein' is not a number");
  EXPECT_EQ(refused("x,y,id\n1,2,a\n1,2,b,c\n", "x,y"), "F:3: 4 columns where there are 3");
  EXPECT_EQ(refused("x,y,id\n1,2\n", "x,y"), "F:2: 2 columns where there are 3");
  EXPECT_EQ(refused("x,y\n\"1\n\",2\n", "x,y"), "F:2: a column in quotes does not end on its line");
  EXPECT_EQ(refused("x,y\n\"1\"0,2\n", "x,y"), "F:2: characters behind a column in quotes");
  EXPECT_EQ(refused("\"x,y\n1,2\n", "x,y"), "F:1: a column in quotes does not end on its line");
  EXPECT_EQ(refused("id;x;y\na;1,5;2\n", "x,y"),
            "F:2: column 'x': '1,5' is not a number; decimal commas are not read");
  EXPECT_EQ(refused("x,y\n", "x"), "F: no points after the line of column names");
}

TEST(Columns, ThatAreNotThere) {
  EXPECT_EQ(not_there(towns, "x,w"),
            "F: columns 'x,w': no column 'w'; there are 'id', 'name', 'x', 'y', 'z'");
  EXPECT_EQ(not_there("x,X,y\n1,2,3\n", "Y,Z"),
            "F: columns 'Y,Z': no column 'Z'; there are 'x', 'X', 'y'");
  EXPECT_EQ(rows("x,X,y\n1,2,3\n", "X,y"), (Rows{{2, 3}}));
  EXPECT_EQ(not_there("aa,AA,y\n1,2,3\n", "Aa"), "F: columns 'Aa': more than one column 'Aa'");
  EXPECT_EQ(not_there("x,x,y\n1,2,3\n", "x"), "F: columns 'x': more than one column 'x'");
  EXPECT_EQ(not_there(towns, "x,2"), "F: columns 'x,2': coordinate 2 is named twice");
  EXPECT_EQ(not_there(towns, "1:9"), "F: columns '1:9': the points have coordinates 0 to 4");
  EXPECT_EQ(not_there(towns, "2:2"), "F: columns '2:2': the range '2:2' is empty");
  EXPECT_EQ(not_there(towns, "99999999999"),
            "F: columns '99999999999': write a range such as 0:3 or a list such as 0,2,5");
  for (const char* chosen : {"x,", ",x", ",", "1,,2", "::"})
    EXPECT_NE(not_there(towns, chosen).find("0:3"), std::string::npos) << chosen;
  EXPECT_NE(not_there("1 2 3\n", "x,y", "txt").find("no names of columns here"), std::string::npos);
  std::string all = "0:";
  for (int i = 0; i < 1000; ++i) all += ",0:";
  EXPECT_NE(not_there(towns, all).find("twice"), std::string::npos);
}

TEST(Columns, OfOtherFormats) {
  const std::string obj = "v 1 2 3\nv 4 5 6\n";
  EXPECT_EQ(rows(obj, "z,x", "obj"), (Rows{{3, 1}, {6, 4}}));
  EXPECT_EQ(rows(obj, "z,y,x", "obj"), (Rows{{3, 2, 1}, {6, 5, 4}}));
  EXPECT_EQ(rows(obj, "1:", "obj"), (Rows{{2, 3}, {5, 6}}));
  EXPECT_EQ(rows(obj, "y,z,x", "obj"), (Rows{{2, 3, 1}, {5, 6, 4}}));
  EXPECT_NE(not_there(obj, "w", "obj").find("'x', 'y', 'z'"), std::string::npos);
  EXPECT_EQ(rows("3 rbox 2 D3\n2\n1 2 3\n4 5 6\n", "2,0", "txt"), (Rows{{3, 1}, {6, 4}}));
  const std::string npy =
      testing::npy("{'descr': '<f8', 'fortran_order': False, 'shape': (1, 3), }\n",
                   bytes_of(1.0) + bytes_of(2.0) + bytes_of(3.0));
  EXPECT_EQ(rows(npy, "2,0,1", "npy"), (Rows{{3, 1, 2}}));
  EXPECT_NE(not_there(npy, "x", "npy").find("0:3"), std::string::npos);
}

TEST(Columns, ColoursStayWhereColumnsAreCopied) {
  const std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
      "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar "
      "blue\nend_header\n" +
      bytes_of(1.f) + bytes_of(2.f) + bytes_of(3.f) + "abc" + bytes_of(4.f) + bytes_of(5.f) +
      bytes_of(6.f) + "def";
  const std::string path = std::filesystem::temp_directory_path() / "cullhull-colours.ply";
  std::ofstream(path, std::ios::binary) << ply;
  const PointFile file = open_points(path, columns("y,z,x"));
  std::filesystem::remove(path);
  EXPECT_EQ(rows_of(file.points()), (Rows{{2, 3, 1}, {5, 6, 4}}));
  EXPECT_EQ(rows_of(file.colours()), (Rows{{'a', 'b', 'c'}, {'d', 'e', 'f'}}));
  EXPECT_FALSE(file.mapped());
}

TEST(Columns, InBlocksAsInMemory) {
  std::string text = "name,y,\"the x\",note\n";
  for (int i = 0; i < 3000; ++i)
    text += (i % 7 == 0 ? "\"a, \"\"b\"\"\"," : "c d,") + std::to_string(i * 7 % 1000) + "," +
            std::to_string(i) + ".5,//x\n";
  const std::string path = std::filesystem::temp_directory_path() / "cullhull-blocks.csv";
  std::ofstream(path, std::ios::binary) << text;
  const Rows want = rows(text, "\"the x\",y");
  ASSERT_EQ(want.size(), 3000U);
  EXPECT_EQ(want[7], (std::vector<double>{7.5, 49}));
  for (const std::uint64_t bytes : {64, 1000, 1 << 20})
    EXPECT_EQ(rows_in_blocks(path, columns("the x,y"), bytes), want) << bytes;
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace cullhull::testing
