// Ids that the user gives or that parts carry, lists of inputs: nothing is lost or overwritten
// without a word.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "agreement/expect_json.hpp"
#include "cullhull/error.hpp"
#include "cullhull/io.hpp"
#include "cullhull/stream.hpp"

namespace cullhull::cli_ids_test {

using namespace testing;

TEST(CliIds, OneIdForTwoPointsIsRefused) {
  const Folder f;
  write_file(f / "a.txt", "0 0\n4 0\n0 4\n");
  write_file(f / "b.txt", "9 9\n9 5\n5 9\n");
  for (const char* name : {"a", "b"})
    run_well({"hull", f / (std::string(name) + ".txt"), "-q", "--partial",
              f / (std::string(name) + ".hullstate")});
  expect_error({"hull", f / "a.hullstate", f / "b.hullstate", "--global-ids"}, 2,
               "two different points have the id 0");
  // Without --global-ids they are numbered on; ids of their own are kept.
  run_well({"hull", f / "a.hullstate", f / "b.hullstate", "-q", "--vertices", f / "on.csv"});
  EXPECT_EQ(read_file(f / "on.csv"), "id\n0\n1\n2\n3\n4\n5\n");
  // The same points twice are the same points.
  run_well({"hull", f / "a.hullstate", f / "a.hullstate", "--global-ids", "-q", "--vertices",
            f / "twice.csv"});
  EXPECT_EQ(read_file(f / "twice.csv"), "id\n0\n1\n2\n");
}

// States do not know which ids their points had: of an overlap only extreme points tell. What is
// found is the hull of all points even so.
TEST(CliIds, OverlapsOfInnerPointsLeaveTheHullWhole) {
  const Folder f;
  write_file(f / "a.txt", "0 0\n4 0\n0 4\n1 1\n1 2\n");  // 0 to 4; 3 and 4 are inside
  write_file(f / "b.txt", "9 9\n9 5\n5 9\n");            // 3 to 5
  write_file(f / "all.txt", read_file(f / "a.txt") + read_file(f / "b.txt"));
  const auto run = [&](std::vector<std::string> words) {
    words.insert(words.begin(), {"hull", "-q"});
    run_well(words);
  };
  run({f / "a.txt", "--partial", f / "a.hullstate"});
  run({f / "b.txt", "--first-id", "3", "--partial", f / "b.hullstate"});
  run({f / "all.txt", "--json=" + (f / "all.json")});
  for (const auto& [first, second] :
       {std::pair("a.hullstate", "b.hullstate"), std::pair("b.hullstate", "a.hullstate")}) {
    run({f / first, f / second, "--global-ids", "--json=" + (f / "both.json")});
    const auto both = json_in(f / "both.json");
    const auto all = json_in(f / "all.json");
    EXPECT_EQ(both["area"], all["area"]);
    EXPECT_EQ(both["points"]["count"], 8);
  }
}

TEST(CliIds, StatesThatDisagreeStayUnchanged) {
  const double near[] = {0, 0, 1, 0, 0, 1}, far[] = {7, 7, 8, 7, 7, 8};
  HullState state(PointView::row_major(near, 3, 2));
  const HullState before = state;
  error_of(ErrorCode::invalid_argument,
           [&] { state.merge(HullState(PointView::row_major(far, 3, 2))); });
  EXPECT_EQ(state, before);
}

TEST(CliIds, NumbersOfOptionsAreDecimal) {
  const Folder f;
  write_file(f / "p.txt", "0 0\n1 0\n0 1\n");
  for (const char* bad : {"-1", "18446744073709551616", "0x10", "1e3", "+1", "", "1 "})
    EXPECT_EQ(run_app({"hull", f / "p.txt", "--first-id", bad}).status, 2) << bad;
  run_well({"hull", f / "p.txt", "-q", "--first-id", "010", "--vertices", f / "v.csv"});
  EXPECT_EQ(read_file(f / "v.csv"), "id\n10\n11\n12\n");
  run_well({"hull", f / "p.txt", "-q", "--threads", "01"});
  EXPECT_EQ(run_app({"hull", f / "p.txt", "-q", "--threads", "-1"}).status, 2);
}

TEST(CliIds, GoUpToTheGreatestSignedNumber) {
  const Folder f;
  write_file(f / "p.txt", "0 0\n1 0\n0 1\n");
  run_well(
      {"hull", f / "p.txt", "-q", "--first-id", "9223372036854775805", "--vertices", f / "v.txt"});
  EXPECT_EQ(read_file(f / "v.txt"),
            "9223372036854775805\n9223372036854775806\n9223372036854775807\n");
  expect_error({"hull", f / "p.txt", "--first-id", "9223372036854775806"}, 2,
               "ids of the points exceed 9223372036854775807");
  expect_error({"hull", f / "p.txt", "--first-id", "9223372036854775808"}, 2,
               "ids go up to 9223372036854775807");
}

TEST(CliIds, AHullNumberedFromAnyIdIsCertified) {
  const Folder f;
  write_points(f / "p.npy", "sphere", 300, 3);
  run_well({"hull", f / "p.npy", "-q", "--first-id", "1000", "--certify", "-o", f / "h.json"});
  EXPECT_EQ(json_in(f / "h.json")["vertices"][0], 1000);
  for (const char* way : {"on", "off"})
    run_well({"certify", f / "p.npy", f / "h.json", "-q", "--first-id", "1000", "--stream", way});
  expect_error({"certify", f / "p.npy", f / "h.json"}, 1, "--first-id");
  expect_error({"certify", f / "p.npy", f / "h.json", "--first-id", "1001"}, 1, "--first-id");
}

TEST(CliIds, AListOfInputsIsNotOverwritten) {
  const Folder f;
  write_file(f / "p.txt", "0 0\n1 0\n0 1\n");
  const std::string list = f / "p.txt" + "\n";
  write_file(f / "list.json", list);
  for (const char* command : {"hull", "delaunay", "voronoi"})
    expect_error({command, "@" + (f / "list.json"), "-o", f / "list.json"}, 2,
                 "would overwrite the input");
  expect_error({"info", "@" + (f / "list.json"), "--json=" + (f / "list.json")}, 2,
               "would overwrite the input");
  EXPECT_EQ(read_file(f / "list.json"), list);
}

TEST(CliIds, OutputsThatCannotBeWrittenAreFoundBeforeTheWork) {
  const Folder f;
  // The points are not even read: there are none.
  write_file(f / "p.txt", "nothing of use\n");
  const std::string gone = f / "no/such/folder/";
  expect_error({"hull", f / "p.txt", "-o", gone + "h.json"}, 1, "cannot write");
  expect_error({"hull", f / "p.txt", "--checkpoint", gone + "c"}, 1, "cannot write");
  expect_error({"hull", f / "p.txt", "--partial", gone + "c.hullstate"}, 1, "cannot write");
  expect_error({"delaunay", f / "p.txt", "-o", gone + "t.json"}, 1, "cannot write");
  EXPECT_EQ(f.entries(), 1U);
}

TEST(CliIds, CommentsBeyondTheFirstMegabyte) {
  const Folder f;
  std::string text;
  while (text.size() < 5 << 20) text += "# a comment before the points\n";
  write_file(f / "p.txt", text + "0 0\n1 0\n0 1\n");
  run_well({"hull", f / "p.txt", "-q", "--stream", "off", "-o", f / "a.json"});
  const Ran blocks = run_well({"hull", f / "p.txt", "-q", "--stream", "on", "-o", f / "b.json"});
  EXPECT_EQ(read_file(f / "b.json"), read_file(f / "a.json"));
  write_file(f / "none.txt", text);
  expect_error({"hull", f / "none.txt", "--stream", "on"}, 1, "no points");
}

}  // namespace cullhull::cli_ids_test
