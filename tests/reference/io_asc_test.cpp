// .asc, CloudCompare's text: its first line names the columns, the next perhaps how many points
// there are. Each may be wrong.
#include <gtest/gtest.h>

#include "cullhull/point_blocks.hpp"
#include "io_fixtures.hpp"

namespace cullhull {
namespace io_asc_test {

using namespace testing;

const Rows cloud = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};

/// The points of such a file, read whole and in blocks.
Rows read_asc(const std::string& text, const std::string& name = "cloud.asc") {
  const TemporaryFolder folder;
  const std::string path = folder.write(name, text);
  const Rows whole = rows_of(open_points(path).points());
  EXPECT_EQ(rows_in_blocks(path), whole) << text;
  return whole;
}

/// What is said of it without the path.
std::string fault_of(const std::string& text) {
  const TemporaryFolder folder;
  const std::string said = error_whole_and_in_blocks(folder.write("cloud.asc", text));
  return said.substr(said.find("cloud.asc"));
}

TEST(Asc, HeaderCountAndRows) {
  const std::string rows = "1 2 3 255 0 0\n4 5 6 0 255 0\n7 8 9 0 0 255\n";
  EXPECT_EQ(read_asc("//X Y Z R G B\n3\n" + rows), cloud);
  EXPECT_EQ(read_asc("//X Y Z R G B\n" + rows), cloud);
  EXPECT_EQ(read_asc("// X Y Z R G B\r\n3\r\n1 2 3 0 0 0\r\n4 5 6 0 0 0\r\n7 8 9 0 0 0\r\n"),
            cloud);
  EXPECT_EQ(read_asc("\xEF\xBB\xBF//X Y Z R G B\n" + rows), cloud);
  EXPECT_EQ(read_asc("//X,Y,Z,Intensity\n1,2,3,nan\n4,5,6,word\n7,8,9,\n"), cloud);
  EXPECT_EQ(read_asc("//X;Y;Z\n3\n1;2;3\n4;5;6\n7;8;9\n"), cloud);
  EXPECT_EQ(read_asc("//R G B Z Y X\n1 1 1 3 2 1\n1 1 1 6 5 4\n1 1 1 9 8 7\n"), cloud);
  // Without a header x, y and z come first.
  EXPECT_EQ(read_asc(rows), cloud);
  EXPECT_EQ(read_asc("3\n" + rows), cloud);
  EXPECT_EQ(read_asc(rows, "cloud.xyzrgb"), cloud);
  EXPECT_EQ(read_asc("1 2 3\n4 5 6\n7 8 9\n"), cloud);
  EXPECT_EQ(read_asc("//\n1 2 3\n4 5 6\n7 8 9\n"), cloud);
  const TemporaryFolder folder;
  const PointFile file = open_points(folder.write("a.asc", "//X Y Z R\n1 2 3 4\n"));
  EXPECT_EQ(file.format(), "asc");
  EXPECT_EQ(file.columns(), (std::vector<std::string>{"X", "Y", "Z"}));
}

TEST(Asc, TheHeaderLiesInEveryWay) {
  const std::string rows = "1 2 3 255 0 0\n4 5 6 0 255 0\n";
  const struct {
    std::string text, say;
  } cases[] = {
      {"//X Y Z R G\n" + rows, "cloud.asc:2: 6 columns where line 1 names 5"},
      {"//X Y Z R G B A\n" + rows, "cloud.asc:2: 6 columns where line 1 names 7"},
      {"//X\n" + rows, "cloud.asc:2: 6 columns where line 1 names 1"},
      {"//X Y Z R G\n2\n" + rows, "cloud.asc:3: 6 columns where line 1 names 5"},
      {"//A R G B C D\n" + rows, "cloud.asc:1: the names of the columns are not known"},
      {"//X X Y Z G B\n" + rows, "cloud.asc:1: the names of the columns are not known"},
      {"//X Y \"Z R G B\n" + rows, "cloud.asc:1: "},
      {"//X Y Z R G B\n3\n" + rows, "cloud.asc:2: promises 3 points, but 2 lines follow"},
      {"//X Y Z R G B\n1\n" + rows, "cloud.asc:2: promises 1 points, but 2 lines follow"},
      {"//X Y Z R G B\n0\n" + rows, "cloud.asc:2: promises 0 points, but 2 lines follow"},
      {"//X Y Z R G B\n9999999999999999999\n" + rows, "cloud.asc:2: promises 9999999999999999999"},
      {"//X Y Z R G B\n-2\n" + rows, "cloud.asc:2: 1 column where line 1 names 6"},
      {"//X Y Z R G B\n2.5\n" + rows, "cloud.asc:2: 1 column where line 1 names 6"},
      {"//X Y Z R G B\n99999999999999999999\n" + rows, "cloud.asc:2: 1 column where line 1"},
      {"//X Y Z R G B\n2 3\n" + rows, "cloud.asc:2: 2 columns where line 1 names 6"},
      {"//X Y Z R G B\n2\n2\n" + rows, "cloud.asc:"},
      {"//X Y Z R G B\n2\n1 2 3 255 0 0\n4 5 6 0 255\n",
       "cloud.asc:4: 5 columns where there are 6"},
      {"//X Y Z R G B\n2\n1 2 three 255 0 0\n4 5 6 0 255 0\n", "cloud.asc:3: column 'Z': "},
      {"//X Y Z R G B\n", "cloud.asc: no points"},
      {"//X Y Z R G B", "cloud.asc: no points"},
      {"ncols 4\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2 3 4\n5 6 7 8\n",
       "cloud.asc:1: holds a raster (an ESRI grid), not points"},
  };
  for (const auto& c : cases) {
    const std::string said = fault_of(c.text);
    EXPECT_EQ(said.substr(0, c.say.size()), c.say) << c.text << said;
  }
}

}  // namespace io_asc_test
}  // namespace cullhull
