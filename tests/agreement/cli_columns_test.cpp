// The program over columns by name: one file, many, a pipe, in blocks and not.
#include "agreement/run_app.hpp"

namespace cullhull::cli_columns_test {

using namespace testing;

/// Rows of a CSV with words beside the coordinates, and the same points plainly.
struct Tables {
  std::string named, plain;
};

Tables tables(std::uint64_t from, std::uint64_t to) {
  const std::vector<double> p = generate("ball", 400, 3, 1);
  Tables t{"name,x,y,z,intensity\n", "x,y,z\n"};
  for (std::uint64_t i = from; i < to; ++i) {
    char row[120];
    std::snprintf(row, sizeof row, "%.17g,%.17g,%.17g", p[3 * i], p[3 * i + 1], p[3 * i + 2]);
    t.named +=
        (i % 3 == 0 ? "\"a, b\"," : "word,") + std::string(row) + "," + std::to_string(i) + "\n";
    t.plain += std::string(row) + "\n";
  }
  return t;
}

class CliColumns : public ::testing::Test {
 protected:
  CliColumns() {
    write_file(f_ / "named.csv", tables(0, 400).named);
    write_file(f_ / "plain.csv", tables(0, 400).plain);
    write_file(f_ / "a.csv", tables(0, 150).named);
    write_file(f_ / "b.csv", tables(150, 400).named);
    expected_ = hull({"plain.csv"}, {});
  }
  std::string hull(const std::vector<std::string>& files, std::vector<std::string> more,
                   const std::string& input = "/dev/null") {
    std::vector<std::string> words{"hull"};
    for (const std::string& file : files) words.push_back(file == "-" ? file : f_ / file);
    words.insert(words.end(), more.begin(), more.end());
    words.insert(words.end(), {"-o", f_ / "out.json"});
    last_ = run_app(words, input);
    EXPECT_EQ(last_.status, 0) << last_.err;
    return read_file(f_ / "out.json");
  }
  Folder f_;
  Ran last_;
  std::string expected_;
};

TEST_F(CliColumns, OneFileManyAPipeBlocks) {
  for (const char* columns : {"x,y,z", "1:4"}) {
    for (const char* stream : {"on", "off"}) {
      const std::vector<std::string> more{"--columns", columns, "--stream", stream};
      EXPECT_EQ(hull({"named.csv"}, more), expected_) << columns << " " << stream;
      EXPECT_EQ(last_.err, "");
      EXPECT_EQ(hull({"a.csv", "b.csv"}, more), expected_) << columns << " " << stream;
      EXPECT_EQ(hull({"-"}, more, f_ / "named.csv"), expected_) << columns << " " << stream;
    }
  }
}

TEST_F(CliColumns, TheRemarkIsOneLineHoweverManyFiles) {
  const std::string said =
      "x, y and z of 5 columns are taken as coordinates; --columns takes others\n";
  for (const char* stream : {"on", "off"}) {
    EXPECT_EQ(hull({"a.csv", "b.csv"}, {"--stream", stream}), expected_);
    EXPECT_TRUE(last_.err == "cullhull: " + f_ / "a.csv" + ": " + said ||
                last_.err == "cullhull: " + f_ / "b.csv" + ": " + said)
        << last_.err;
  }
  EXPECT_EQ(hull({"named.csv"}, {"--certify", "--stream", "on"}), expected_);
  EXPECT_EQ(last_.err, "cullhull: " + f_ / "named.csv" + ": " + said);
}

TEST_F(CliColumns, TheHintGoesByTheKindOfARemarkNotByItsWords) {
  const std::string name = f_ / "x: taken as coordinates.off";
  write_file(name, "OFF\n4 1 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2\nmore\n");
  const Ran ran = run_well({"hull", name, "-q"});
  EXPECT_EQ(ran.err, "cullhull: " + name + ": text after the last face is passed over\n");
}

TEST_F(CliColumns, ThatAreNotThereOrNoNumbers) {
  const std::string named = f_ / "named.csv";
  expect_error({"hull", named, "--columns", "x,q"}, 2, "no column 'q'; there are 'name', 'x', 'y'");
  expect_error({"hull", named, "--columns", "name,x"}, 1, "named.csv:2: column 'name': 'a, b'");
  expect_error({"hull", named, "--columns", "x,q", "--stream", "on"}, 2, "no column 'q'");
}

}  // namespace cullhull::cli_columns_test
