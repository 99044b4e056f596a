// Columns by name and number: of texts whose other columns hold anything, and of every format.
#include <algorithm>
#include <set>

#include "cullhull/point_blocks.hpp"
#include "io/system.hpp"
#include "tests/io_fixtures.hpp"
#include "thrown.hpp"

namespace cullhull::testing::io_columns_test {

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
  EXPECT_EQ(rows_of(parse(text, "csv", remarks_to(said)).view), want) << text;
  EXPECT_EQ(said, remark.empty() ? std::vector<std::string>{} : std::vector{remark}) << text;
}

TEST(Columns, WithoutBeingAskedForXYZOfAHeader) {
  for (const auto& [text, want, remark] : std::vector<std::tuple<const char*, Rows, std::string>>{
           {"x,y,z,intensity\n1,2,3,4\n",
            {{1, 2, 3}},
            "F: x, y and z of 4 columns are taken as coordinates"},
           {"id,Y,X\nB-1,1,2\n", {{2, 1}}, "F: X and Y of 3 columns are taken as coordinates"},
           {"x,y,z\n1,2,3\n", {{1, 2, 3}}, ""},
           {"\"x\",\"y\"\n\"1\",\"2\"\n", {{1, 2}}, ""},
           {"y,x\n1,2\n", {{2, 1}}, "F: x and y are taken as coordinates, in this order"},
           {"lon,lat,height\n1,2,3\n", {{1, 2, 3}}, ""},
           {"x0,x1,x2,x3\n1,2,3,4\n", {{1, 2, 3, 4}}, ""}}) {
    expect_rows_and_remark(text, want, remark);
  }
}

TEST(Columns, OfMapsAreKnown) {
  for (const auto& [text, want, remark] : std::vector<std::tuple<const char*, Rows, std::string>>{
           {"fid,LAT,Lon\n1,2,3\n",
            {{3, 2}},
            "F: Lon and LAT of 3 columns are taken as coordinates"},
           {"longitude;latitude\n1;2\n", {{1, 2}}, ""},
           {"latitude,longitude\n1,2\n",
            {{2, 1}},
            "F: longitude and latitude are taken as coordinates, in this order"},
           {"Easting,Northing,Elevation,class\n1,2,3,4\n",
            {{1, 2, 3}},
            "F: Easting, Northing and Elevation of 4 columns are taken as coordinates"},
           {"name,northing,easting\nUlm,2,3\n",
            {{3, 2}},
            "F: easting and northing of 3 columns are taken as coordinates"},
           {"X,Y,lon,lat\n1,2,3,4\n",
            {{1, 2}},
            "F: X and Y of 4 columns are taken as coordinates"}})
    expect_rows_and_remark(text, want, remark);
}

TEST(Columns, OfTextsWithBlanksAreKnown) {
  for (const char* format : {"txt", "xyz", ""}) {
    const auto read = [&](const char* text) { return rows_of(parse(text, format).view); };
    EXPECT_EQ(read("X Y Z\n1 2 3\n4 5 6\n"), (Rows{{1, 2, 3}, {4, 5, 6}})) << format;
    EXPECT_EQ(read("# a scan\nEasting\tNORTHING\tClass\n1\t2\t3\n"), (Rows{{1, 2}})) << format;
    EXPECT_EQ(read("lat lon\n1 2\n"), (Rows{{2, 1}})) << format;
    EXPECT_EQ(read("a b\n1 2\n"), (Rows{{1, 2}})) << format;
    EXPECT_EQ(refusal("x 1\n1 2\n", format),
              "F:1: 'x' is not a number; --columns 1 takes the columns of numbers (in Python "
              "columns=)");
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
  EXPECT_TRUE(has(refusal("id\n1\n", "csv"), "number the points"));
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
  EXPECT_EQ(
      refused("id,x,y\nWeil, am Rhein,2,3\n", "x,y"),
      "F:2: 4 columns where line 1 names 3; if the first column has no name, as R writes names "
      "of rows, --columns 1:4 leaves it out; --columns 0:4 takes all (in Python columns=)");
  EXPECT_EQ(refused("id,x,y\n1,2,3\nWeil, am Rhein,2,3\n", "x,y"),
            "F:3: column 'x': 'am Rhein' is not a number");
  EXPECT_EQ(refused("x,y,id\n1,2,a\n1,2,b,c\n", "x,y"), "F:3: 4 columns where there are 3");
  EXPECT_EQ(refused("x,y,id\n1,2\n", "x,y").find("F:2: 2 columns where line 1 names 3; "), 0U);
  EXPECT_EQ(refused("x,y\n\"1\n\",2\n", "x,y"), "F:2: a column in quotes does not end on its line");
  EXPECT_EQ(refused("x,y\n\"1\"0,2\n", "x,y"), "F:2: characters behind a column in quotes");
  EXPECT_EQ(refused("\"x,y\n1,2\n", "x,y"), "F:1: a column in quotes does not end on its line");
  ReadOptions points = columns("x,y");
  points.decimal = '.';
  EXPECT_EQ(refusal("id;x;y\na;1,5;2\n", "csv", points),
            "F:2: column 'x': '1,5' is not a number; --decimal , reads decimal commas (in Python "
            "decimal=\",\")");
  for (const char* twice : {"x,x,y\n1,2,3\n", "lon,lat,lat\n1,2,3\n"})
    EXPECT_TRUE(has(refusal(twice, "csv"), "not known as coordinates"));
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
    EXPECT_TRUE(has(not_there(towns, chosen), "0:3")) << chosen;
  EXPECT_TRUE(has(not_there("1 2 3\n", "x,y", "txt"), "no names of columns here"));
  std::string all = "0:";
  for (int i = 0; i < 1000; ++i) all += ",0:";
  EXPECT_TRUE(has(not_there(towns, all), "twice"));
}

TEST(Columns, OfOtherFormats) {
  const std::string obj = "v 1 2 3\nv 4 5 6\n";
  EXPECT_EQ(rows(obj, "z,x", "obj"), (Rows{{3, 1}, {6, 4}}));
  EXPECT_EQ(rows(obj, "z,y,x", "obj"), (Rows{{3, 2, 1}, {6, 5, 4}}));
  EXPECT_EQ(rows(obj, "1:", "obj"), (Rows{{2, 3}, {5, 6}}));
  EXPECT_EQ(rows(obj, "y,z,x", "obj"), (Rows{{2, 3, 1}, {5, 6, 4}}));
  EXPECT_TRUE(has(not_there(obj, "w", "obj"), "'x', 'y', 'z'"));
  EXPECT_EQ(rows("3 rbox 2 D3\n2\n1 2 3\n4 5 6\n", "2,0", "txt"), (Rows{{3, 1}, {6, 4}}));
  const std::string npy =
      testing::npy("{'descr': '<f8', 'fortran_order': False, 'shape': (1, 3), }\n",
                   bytes_of(1.0) + bytes_of(2.0) + bytes_of(3.0));
  EXPECT_EQ(rows(npy, "2,0,1", "npy"), (Rows{{3, 1, 2}}));
  EXPECT_TRUE(has(not_there(npy, "x", "npy"), "0:3"));
}

/// Two points of each format whose coordinates have the names x, y and z whatever its dimension.
struct NamedByFormat {
  std::string format, plane, space;
};

std::string ply(const std::string& kind, const std::string& axes, const std::string& body) {
  std::string text = "ply\nformat " + kind + " 1.0\nelement vertex 2\n";
  for (const char axis : axes) text += std::string("property double ") + axis + "\n";
  return text + "end_header\n" + body;
}

std::string pcd(const std::string& kind, const std::string& axes, const std::string& body) {
  const auto each = [&](const std::string& value) {
    std::string all;
    for (std::size_t i = 0; i < axes.size(); ++i) all += " " + value;
    return all;
  };
  std::string names;
  for (const char axis : axes) names += std::string(" ") + axis;
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS" + names + "\nSIZE" + each("8") + "\nTYPE" + each("F") +
         "\nCOUNT" + each("1") + "\nWIDTH 2\nHEIGHT 1\nPOINTS 2\nDATA " + kind + "\n" + body;
}

std::vector<NamedByFormat> named_by_format() {
  const std::string two = bytes_of(1.0, 2.0, 4.0, 5.0), three = bytes_of(1., 2., 3., 4., 5., 6.);
  return {
      {"geojson", R"({"type":"MultiPoint","coordinates":[[1,2],[4,5]]})",
       R"({"type":"MultiPoint","coordinates":[[1,2,3],[4,5,6]]})"},
      {"wkt", "MULTIPOINT (1 2, 4 5)\n", "MULTIPOINT Z (1 2 3, 4 5 6)\n"},
      {"ply", ply("ascii", "xy", "1 2\n4 5\n"), ply("ascii", "xyz", "1 2 3\n4 5 6\n")},
      {"ply", ply("binary_little_endian", "xy", two), ply("binary_little_endian", "xyz", three)},
      {"pcd", pcd("ascii", "xy", "1 2\n4 5\n"), pcd("ascii", "xyz", "1 2 3\n4 5 6\n")},
      {"pcd", pcd("binary", "xy", two), pcd("binary", "xyz", three)},
      {"obj", "", "v 1 2 3\nv 4 5 6\n"},
      {"off", "", "OFF\n2 0 0\n1 2 3\n4 5 6\n"}};
}

/// The rows that a file in memory and in blocks gives, or the message, which must be the same.
Rows rows_or_error(const std::string& path, const ReadOptions& read, std::string& error) {
  Rows whole, blocks;
  std::string of_blocks;
  const auto note = [](std::string& text, const auto& call) {
    try {
      call();
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::invalid_argument) << e.what();
      text = e.what();
    }
  };
  note(error, [&] { whole = rows_of(open_points(path, read).points()); });
  note(of_blocks, [&] { blocks = rows_in_blocks(path, read, 16); });
  EXPECT_EQ(error, of_blocks);
  EXPECT_EQ(whole, blocks);
  return whole;
}

// At 2b236ba5 a 2D file had a column z: the next point's x, and for the last memory of others.
TEST(Columns, EveryCombinationOfUpToFourNames) {
  const TemporaryFolder folder;
  const std::string names = "xyzw";
  for (const NamedByFormat& f : named_by_format())
    for (const std::string& bytes : {f.plane, f.space}) {
      if (bytes.empty()) continue;
      const std::string path = folder.write("a." + f.format, bytes);
      const Rows all = rows_of(open_points(path).points());
      const std::size_t width = all[0].size();
      for (std::size_t code = 1; code < 625; ++code) {  // of each of four places: which, or none
        std::string text;
        std::vector<std::size_t> chosen;
        for (std::size_t rest = code; rest > 0; rest /= 5) {
          if (rest % 5 == 0) continue;
          chosen.push_back(rest % 5 - 1);
          text += (text.empty() ? "" : ",") + names.substr(chosen.back(), 1);
        }
        std::string error;
        const Rows got = rows_or_error(path, columns(text), error);
        const bool there =
            std::all_of(chosen.begin(), chosen.end(), [&](std::size_t c) { return c < width; });
        const bool once = std::set(chosen.begin(), chosen.end()).size() == chosen.size();
        SCOPED_TRACE(f.format + " " + std::to_string(width) + "D " + text + ": " + error);
        EXPECT_EQ(error.empty(), there && once);
        if (!there) {
          EXPECT_TRUE(has(error, width == 2 ? "there are 'x', 'y'" : "there are 'x', 'y', 'z'"));
        }
        if (!error.empty()) continue;
        Rows want(all.size());
        for (std::size_t i = 0; i < all.size(); ++i)
          for (const std::size_t c : chosen) want[i].push_back(all[i][c]);
        EXPECT_EQ(got, want);
      }
      for (const char* name : {"z", "Z", "w"}) {  // as keys and as weights
        ReadOptions weighed, keyed;
        weighed.weights = keyed.key = name;
        const bool there = width == 3 && *name != 'w';
        const auto read_keys = [&] {
          BlockVisitor visitor;
          visitor.keyed = [](const PointView&, std::uint64_t, const PointKeys&) {};
          BlockOptions options;
          options.read = keyed;
          visit_blocks({path}, visitor, options);
        };
        if (there) {
          EXPECT_EQ(open_points(path, weighed).weights(), (std::vector<double>{3, 6}));
          EXPECT_NO_THROW(read_keys());
        } else {
          EXPECT_TRUE(
              has(error_of(ErrorCode::invalid_argument, [&] { open_points(path, weighed); }),
                  "there are 'x', 'y'"));
          error_of(ErrorCode::invalid_argument, read_keys);
        }
      }
    }
}

// The mapping ends with the last coordinate: a read behind it ends the process.
TEST(Columns, OfAPlaneAtTheEndOfAPageHaveNoZ) {
  const TemporaryFolder folder;
  const std::size_t page = internal::system::map_granularity();
  const std::string points(4096, '\0');
  std::string text = ply("binary_little_endian", "xy", "");
  text.replace(text.find(" 2\n"), 3, " " + std::to_string(points.size() / 16) + "\n");
  const std::size_t used = text.size() + points.size() + std::string("comment \n").size();
  text.insert(4, "comment " + std::string(page - used % page, 'p') + "\n");
  std::string error;
  rows_or_error(folder.write("page.ply", text + points), columns("x,y,z"), error);
  EXPECT_TRUE(has(error, "no column 'z'; there are 'x', 'y'"));
}

TEST(Columns, ColoursStayWhereColumnsAreCopied) {
  const std::string ply =
      "ply\nformat binary_little_endian 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
      "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar "
      "blue\nend_header\n" +
      bytes_of(1.f) + bytes_of(2.f) + bytes_of(3.f) + "abc" + bytes_of(4.f) + bytes_of(5.f) +
      bytes_of(6.f) + "def";
  const TemporaryFolder folder;
  const PointFile file = open_points(folder.write("a.ply", ply), columns("y,z,x"));
  EXPECT_EQ(rows_of(file.points()), (Rows{{2, 3, 1}, {5, 6, 4}}));
  EXPECT_EQ(rows_of(file.colours()), (Rows{{'a', 'b', 'c'}, {'d', 'e', 'f'}}));
  EXPECT_FALSE(file.mapped());
}

TEST(Columns, InBlocksAsInMemory) {
  std::string text = "name,y,\"the x\",note\n";
  for (int i = 0; i < 3000; ++i)
    text += (i % 7 == 0 ? "\"a, \"\"b\"\"\"," : "c d,") + std::to_string(i * 7 % 1000) + "," +
            std::to_string(i) + ".5,//x\n";
  const TemporaryFolder folder;
  const std::string path = folder.write("a.csv", text);
  const Rows want = rows(text, "\"the x\",y");
  ASSERT_EQ(want.size(), 3000U);
  EXPECT_EQ(want[7], (std::vector<double>{7.5, 49}));
  for (const std::uint64_t bytes : {64, 1000, 1 << 20})
    EXPECT_EQ(rows_in_blocks(path, columns("the x,y"), bytes), want) << bytes;
}

}  // namespace cullhull::testing::io_columns_test
