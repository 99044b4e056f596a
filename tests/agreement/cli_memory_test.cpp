// The program's memory limit with pipes: what is read in blocks, what is refused, and what the
// refusal advises; and messages that name only options of the command.
#include <nlohmann/json.hpp>

#include "agreement/run_app.hpp"
#include "cullhull/generate.hpp"

namespace cullhull::cli_memory_test {

using namespace testing;

/// Made points in a format of points; 4.8 MB as .npy, more than one block.
std::string points_in(const Folder& f, const std::string& ending, const std::string& count) {
  const std::string path = f / (count + ending);
  const Ran made = run_well({"generate", "ball", "-n", count, "-d", "3", "-q", "-o", path});
  return path;
}

std::string method_of(const std::vector<std::string>& arguments, const std::string& input) {
  const Ran ran = run_well(arguments, input);
  return nlohmann::json::parse(ran.out)["cull"]["method"];
}

TEST(CliMemory, AutoReadsAPipeInBlocksBeyondTheFirst) {
  const Folder f;
  const std::string many = points_in(f, ".npy", "200k"), few = points_in(f, ".npy", "1k");
  EXPECT_EQ(method_of({"hull", "-", "--json"}, many), "stream");
  EXPECT_EQ(method_of({"cull", "-", "--json"}, many), "stream");
  EXPECT_NE(method_of({"hull", "-", "--json"}, few), "stream");
  EXPECT_NE(method_of({"hull", "-", "--json", "--stream", "off"}, many), "stream");
  EXPECT_NE(method_of({"hull", "-", "--json", "--certify"}, many), "stream");
  EXPECT_EQ(method_of({"hull", "-", "--json", "--stream", "on"}, few), "stream");
}

TEST(CliMemory, APipeGivesTheBytesOfItsFile) {
  const Folder f;
  for (const std::string ending : {".npy", ".ply", ".csv", ".xyz", ".raw", ".obj", ".wkt"})
    for (const std::string count : {"1", "7", "1k", "200k"}) {
      if (ending == ".wkt" && count == "1") continue;  // a point in three dimensions is no mesh
      std::vector<std::string> options;
      if (ending == ".raw") options = {"--dim", "3", "--type", "f64"};
      if (ending == ".wkt" || ending == ".csv") options = {"--input-format", ending.substr(1)};
      const std::string path = points_in(f, ending, count);
      std::vector<std::string> words = joined({"hull", path, "-q", "-o", f / "file.json"}, options);
      const Ran of_file = run_app(words);
      words[1] = "-";
      words[4] = f / "pipe.json";
      const Ran of_pipe = run_app(words, path);
      ASSERT_EQ(of_file.status, 0) << path << ": " << of_file.err;
      ASSERT_EQ(of_pipe.status, 0) << path << ": " << of_pipe.err;
      EXPECT_EQ(read_file(f / "pipe.json"), read_file(f / "file.json")) << path;
    }
}

TEST(CliMemory, ACompressedPipeIsReadInBlocks) {
  const Folder f;
  const std::string few = points_in(f, ".npy", "1k"), packed = f / "packed";
  ASSERT_EQ(std::system(("gzip -c " + few + " > " + packed).c_str()), 0);
  EXPECT_EQ(method_of({"hull", "-", "--json"}, packed), "stream");
  run_well({"delaunay", "-", "-q"}, packed);
}

TEST(CliMemory, APipeThatEndsWithinAPoint) {
  const Folder f;
  for (const std::string count : {"7", "200k"}) {
    std::string bytes = read_file(points_in(f, ".npy", count));
    bytes.resize(bytes.size() - 5);
    write_file(f / "cut", bytes);
    for (const char* command : {"hull", "cull", "info", "delaunay"}) {
      const Ran ran = run_app({command, "-"}, f / "cut");
      EXPECT_EQ(ran.status, 1) << command << ran.err;
      EXPECT_TRUE(ran.err.starts_with("cullhull: standard input: ")) << ran.err;
      EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 1) << ran.err;
    }
  }
}

TEST(CliMemory, RefusalsNameStreamOnWhereItHelps) {
  const Folder f;
  const std::string csv = points_in(f, ".csv", "200k"), obj = points_in(f, ".obj", "200k"),
                    npy = points_in(f, ".npy", "200k");
  const auto refused = [](const std::vector<std::string>& words, const std::string& input) {
    const Ran ran = run_app(words, input);
    EXPECT_EQ(ran.status, 4) << words[0] << ran.err;
    EXPECT_TRUE(one_line(ran.err));
    return ran.err;
  };
  for (const char* command : {"hull", "cull"}) {
    EXPECT_TRUE(has(refused({command, "-", "--stream", "off", "--memory", "2M"}, npy),
                    "--stream on reads it in blocks"));
    EXPECT_TRUE(has(refused({command, csv, "--stream", "off", "--memory", "2M"}, csv),
                    "--stream on reads it in blocks"));
    EXPECT_TRUE(has(refused({command, "-", "--cull", "gauge", "--memory", "2M"}, npy),
                    "without --cull gauge it is read in blocks"));
    EXPECT_FALSE(
        has(refused({command, obj, "--stream", "off", "--memory", "2M"}, obj), "--stream"));
  }
  EXPECT_TRUE(has(refused({"hull", "-", "--certify", "--memory", "2M"}, npy),
                  "without --certify of standard input it is read in blocks"));
  for (const char* command : {"delaunay", "voronoi", "alpha"})
    for (const std::string& input : {npy, csv, obj})
      EXPECT_FALSE(has(refused({command, "-", "--memory", "2M"}, input), "blocks")) << input;
  EXPECT_FALSE(has(refused({"qconvex", "s", "--memory", "2M"}, npy), "blocks"));
  EXPECT_FALSE(has(refused({"view", "-", "-o", f / "v.html", "--memory", "2M"}, npy), "blocks"));
}

TEST(CliMemory, SeveralInputsWithAPipe) {
  const Folder f;
  const std::string npy = points_in(f, ".npy", "200k"), few = points_in(f, ".npy", "1k");
  expect_error({"delaunay", few, "-", "--memory", "2M"}, 4, "", npy);
  EXPECT_EQ(method_of({"hull", few, "-", "--json", "--memory", "8M"}, npy), "stream");
  expect_error({"hull", "-", "-"}, 2, "", npy);
}

TEST(CliMemory, DiagramsAreRefusedBeforeTheWork) {
  const Folder f;
  const std::string plane = f / "plane.npy";
  run_well({"generate", "disk", "-n", "100k", "-d", "2", "-q", "-o", plane});
  for (const std::vector<std::string>& words :
       command_lines(f, {"delaunay @plane.npy --memory 10M", "voronoi @plane.npy --memory 25M",
                         "voronoi @plane.npy --box=-1,-1,1,1 --memory 50M",
                         "alpha @plane.npy --memory 10M"})) {
    const Ran ran = run_app(words);
    EXPECT_EQ(ran.status, 4) << words[0] << ran.err;
    EXPECT_TRUE(has(ran.err, "cells of the triangulation need about "));
    EXPECT_TRUE(has(ran.err, "--memory "));
  }
}

// ------------------------------------------------------------------- closed pipes, full disks

TEST(CliPipe, AClosedStandardErrorIsNoReasonToEnd) {
  const Folder f;
  int ends[2];
  ASSERT_EQ(::pipe2(ends, O_CLOEXEC), 0);
  ::close(ends[0]);
  const int null = ::open("/dev/null", O_RDWR | O_CLOEXEC);
  EXPECT_EQ(wait_for(start_app({"hull", f / "absent.npy"}, null, null, ends[1])), 1);
  for (const int fd : {ends[1], null}) ::close(fd);
}

// ----------------------------------------------------------------- options that mean nothing

TEST(CliStates, OptionsOfPointsAreRefusedForStatesAlone) {
  const Folder f;
  const std::string points = points_in(f, ".npy", "1k"), state = f / "a.hullstate";
  run_well({"hull", points, "-q", "--partial", state});
  for (const char* command : {"hull", "cull"})
    for (const std::vector<std::string>& option :
         command_lines({"--columns q", "--dim 7", "--type f32", "--input-format csv"}))
      expect_error({command, state, option[0], option[1]}, 2, option[0]);
  run_well({"hull", state});
  run_well({"hull", state, points, "--columns", "0:3"});
}

TEST(CliStates, DimAndTypeAreOfRawInputInBlocksToo) {
  const Folder f;
  const std::string csv = points_in(f, ".csv", "1k");
  for (const char* stream : {"on", "off"})
    expect_error({"hull", csv, "--dim", "3", "--stream", stream}, 2,
                 "--dim and --type describe raw input");
}

// ----------------------------------------------------------- advice that the command can follow

TEST(CliAdvice, MessagesNameOnlyOptionsOfTheCommand) {
  const Folder f;
  write_file(f / "mixed.geojson",
             R"({"type":"MultiPoint","coordinates":[[0,0,1],[1,0],[0,1,2],[1,1]]})");
  std::string las(227 + 20, '\0');
  las.replace(0, 4, "LASF");
  las[24] = 1;
  las[25] = 2;
  las[94] = static_cast<char>(227);
  las[96] = static_cast<char>(227);
  las[105] = 20;
  las[107] = 1;
  write_file(f / "unusable.las", las);  // its scales are 0
  EXPECT_TRUE(has(run_app({"hull", f / "unusable.las"}).err, "--raw"));
  EXPECT_TRUE(has(run_app({"hull", f / "mixed.geojson"}).err, "--columns"));
  for (const std::vector<std::string>& words : command_lines(
           f, {"qconvex TI @unusable.las", "qconvex TI @mixed.geojson", "track @mixed.geojson"})) {
    const Ran ran = run_app(words);
    EXPECT_EQ(ran.status, 1) << ran.err;
    EXPECT_FALSE(has(ran.err, "--"));
    EXPECT_TRUE(has(ran.err, words.back()));
  }
}

}  // namespace cullhull::cli_memory_test
