// The command line: exit statuses, one-line errors, the same bytes by every path, and no half
// files.
#include <algorithm>
#include <filesystem>
#include <limits>

#include "agreement/expect_json.hpp"
#include "cullhull/device_points.hpp"
#include "cullhull/generate.hpp"
#include "cullhull/io.hpp"
#include "cullhull/version.hpp"
#include "io/write/npy_writers.hpp"

namespace cullhull::cli_test {

using namespace testing;

TEST(Cli, LicensesArePrinted) {
  const Ran ran = run_well({"--licenses"});
  for (const std::string words :
       {"MIT License", "==== Apache-2.0 (Highway) ====", "GCC RUNTIME LIBRARY EXCEPTION",
        "GNU LESSER GENERAL PUBLIC LICENSE", "Stephen L. Moshier"})
    EXPECT_TRUE(has(ran.out, words)) << words;
}

TEST(Cli, BadUsageIsStatusTwo) {
  const Folder f;
  write_points(f / "p.npy", "ball", 100, 3);
  const std::string p = f / "p.npy";
  EXPECT_EQ(run_app({"-q"}).status, 2);
  expect_error({"fly", p}, 2, "fly");
  expect_error({"hull"}, 2, "INPUT is required (see cullhull hull --help)");
  expect_error({"hull", p, "--bogus"}, 2, "--bogus");
  expect_error({"hull", p, "--cull", "magic"}, 2, "magic");
  expect_error({"hull", p, "--threads", "-1"}, 2, "threads");
  expect_error({"hull", p, "--repeat", "0"}, 2, "repeat");
  expect_error({"hull", p, "--format", "Qx"}, 2, "Qx");
  expect_error({"hull", p, "--memory", "lots"}, 2, "lots");
  expect_error({"hull", p, "--json", "--format", "i"}, 2, "standard output");
  expect_error({"hull", p, "-o", f / "hull.docx"}, 2, "hull.docx");
  expect_error({"hull", p, "--columns", "0:4"}, 2, "0 to 2");
  expect_error({"hull", p, "--columns", "2:1"}, 2, "empty");
  expect_error({"hull", p, "--columns", "0,0"}, 2, "twice");
  expect_error({"hull", p, "--columns", "0,"}, 2, "0:3");
  expect_error({"hull", p, "--columns", "x"}, 2, "0:3");
  expect_error({"hull", p, "--dim", "3"}, 2, "raw");
  expect_error({"generate", "potato", "-n", "10", "-o", f / "g.npy"}, 2, "potato");
  expect_error({"generate", "ball", "-n", "ten", "-o", f / "g.npy"}, 2, "ten");
  expect_error({"generate", "ball", "-n", "10", "-o", f / "g.docx"}, 2, ".npy");
  EXPECT_EQ(f.entries(), 1U);
}

TEST(Cli, BadInputIsStatusOne) {
  const Folder f;
  expect_error({"hull", f / "absent.npy"}, 1, "absent.npy");
  expect_error({"hull", f / ""}, 1, "");
  write_file(f / "empty.npy", "");
  expect_error({"hull", f / "empty.npy"}, 1, "empty.npy");
  write_file(f / "empty.txt", "");
  expect_error({"hull", f / "empty.txt"}, 1, "empty.txt");
  write_points(f / "whole.npy", "ball", 100, 3);
  const std::string whole = read_file(f / "whole.npy");
  write_file(f / "short.npy", whole.substr(0, whole.size() - 5));
  expect_error({"hull", f / "short.npy"}, 1, "short.npy");
  std::string strings = whole;
  strings.replace(strings.find("<f8"), 3, "<U8");
  write_file(f / "strings.npy", strings);
  expect_error({"hull", f / "strings.npy"}, 1, "strings.npy");
  write_file(f / "word.txt", "0 0 0\n1 0 0\n0 potato 0\n");
  expect_error({"hull", f / "word.txt"}, 1, "3");
  write_file(f / "mixed.txt", "0 0 0\n1 0 0\n0 1\n");
  expect_error({"hull", f / "mixed.txt"}, 1, "3");
  expect_error({"info", f / "short.npy"}, 1, "short.npy");
  expect_error({"cull", f / "short.npy", "-o", f / "ids.npy"}, 1, "short.npy");
  expect_error({"certify", f / "whole.npy", f / "absent.json"}, 1, "absent.json");
  write_file(f / "junk.json", "{\"version\": ");
  expect_error({"certify", f / "whole.npy", f / "junk.json"}, 1, "junk.json");
}

TEST(Cli, CudaIsNotThere) {
  const Folder f;
  write_points(f / "p.npy", "ball", 100, 3);
  if (cuda_status().available) GTEST_SKIP() << "there is a CUDA device";
  expect_error({"hull", f / "p.npy", "--backend", "cuda"}, 5, cuda_status().reason);
}

TEST(Cli, ReportHasTheKeysChecksRelyOn) {
  const Folder f;
  write_points(f / "p.npy", "ball", 20000, 3, ScalarType::f32);
  const Ran ran = run_well({"hull", f / "p.npy", "--json", "--certify", "--repeat", "3"});
  EXPECT_EQ(ran.err, "");  // no progress where there is no terminal
  const auto json = nlohmann::json::parse(ran.out);
  for (const char* key :
       {"version", "points", "threads", "backend", "cull", "hull", "affine_dimension",
        "vertex_count", "facet_count", "simplex_count", "area", "volume", "read_seconds",
        "compute_seconds", "compute_seconds_all", "peak_bytes", "certified"})
    EXPECT_TRUE(json.contains(key)) << key;
  EXPECT_EQ(json["points"]["count"], 20000);
  EXPECT_EQ(json["points"]["dimension"], 3);
  EXPECT_EQ(json["points"]["scalar"], "f32");
  EXPECT_EQ(json["compute_seconds_all"].size(), 3U);
  auto times = json["compute_seconds_all"].get<std::vector<double>>();
  std::sort(times.begin(), times.end());
  EXPECT_EQ(json["compute_seconds"].get<double>(), times[1]);
  EXPECT_EQ(json["certified"], true);
  EXPECT_EQ(json["simplex_count"].get<int>(), 2 * json["vertex_count"].get<int>() - 4);
  run_well({"hull", f / "p.npy", "--json=" + (f / "r.json"), "-q"});
  EXPECT_EQ(json_in(f / "r.json")["volume"], json["volume"]);
}

TEST(Cli, OnlyVerticesWritesTheHullsIds) {
  const Folder f;
  write_points(f / "p.npy", "gauss", 2000, 5);
  const std::string p = f / "p.npy";
  run_well({"hull", p, "--vertices", f / "hull.npy"});
  const Ran ran =
      run_well({"hull", p, "--only", "vertices", "--vertices", f / "only.npy", "--json"});
  EXPECT_EQ(read_file(f / "only.npy"), read_file(f / "hull.npy"));
  const auto json = nlohmann::json::parse(ran.out);
  EXPECT_EQ(json["affine_dimension"], 5);
  EXPECT_EQ(json["vertices"].size(), json["vertex_count"]);
  expect_error({"hull", p, "--only", "vertices", "--certify"}, 2, "finds no facets");
  expect_error({"hull", p, "--only", "facets"}, 2, "--only");
}

TEST(Cli, CullByThePapersFilter) {
  const Folder f;
  write_points(f / "p.npy", "ball", 50000, 3);
  const auto json =
      nlohmann::json::parse(run_app({"cull", f / "p.npy", "--cull", "pseudo-hull", "--json"}).out);
  EXPECT_EQ(json["cull"]["method"], "pseudo-hull");
  EXPECT_LT(json["cull"]["survivors"], 50000 / 10);
}

TEST(Cli, ColumnsAreTakenFromLongerRecords) {
  const Folder f;
  const auto points = generate("ball", 2000, 3, 3);
  std::vector<double> wide(2000 * 5, 7.0), spread(2000 * 5, 7.0), swapped(2000 * 4, 7.0);
  for (std::size_t i = 0; i < 2000; ++i)
    for (std::size_t j = 0; j < 3; ++j) {
      wide[i * 5 + 1 + j] = points[i * 3 + j];
      spread[i * 5 + 2 * j] = points[i * 3 + j];
      swapped[i * 4 + (j == 2 ? 3 : j)] = points[i * 3 + j];
    }
  write_npy_points(f / "p.npy", points.data(), 2000, 3, ScalarType::f64);
  write_npy_points(f / "wide.npy", wide.data(), 2000, 5, ScalarType::f64);
  write_npy_points(f / "spread.npy", spread.data(), 2000, 5, ScalarType::f64);
  write_npy_points(f / "swapped.npy", swapped.data(), 2000, 4, ScalarType::f64);
  const std::string expected = run_app({"hull", f / "p.npy", "--format", "i"}).out;
  EXPECT_FALSE(expected.empty());
  EXPECT_EQ(run_app({"hull", f / "wide.npy", "--columns", "1:4", "--format", "i"}).out, expected);
  EXPECT_EQ(run_app({"hull", f / "spread.npy", "--columns", "0,2,4", "--format", "i"}).out,
            expected);
  EXPECT_EQ(run_app({"hull", f / "swapped.npy", "--columns", ":2,3", "--format", "i"}).out,
            expected);
}

TEST(Cli, GenerateIsReproducible) {
  const Folder f;
  run_well({"generate", "grid:9", "-n", "2k", "-d", "4", "--seed", "5", "-o", f / "a.npy"});
  run_well({"generate", "grid:9", "-n", "2000", "-d", "4", "--seed", "5", "-o", f / "b.npy"});
  EXPECT_EQ(read_file(f / "a.npy"), read_file(f / "b.npy"));
  const PointFile file = open_points(f / "a.npy");
  EXPECT_EQ(file.points().count, 2000U);
  EXPECT_EQ(file.points().dimension, 4U);
  run_well({"generate", "disk", "-n", "7", "--type", "f32", "-o", f / "c.npy"});
  const PointFile disk = open_points(f / "c.npy");
  EXPECT_EQ(disk.points().dimension, 2U);
  EXPECT_EQ(disk.points().scalar, ScalarType::f32);
  run_well({"generate", "cyclic", "-n", "40", "-d", "4", "-o", f / "d.npy"});
  const auto json = nlohmann::json::parse(run_app({"hull", f / "d.npy", "--json"}).out);
  EXPECT_EQ(json["vertex_count"], 40);
  EXPECT_EQ(json["facet_count"], 40 * 37 / 2);  // n (n - 3) / 2
}

TEST(Cli, OutputThatCannotBeWrittenIsOneLine) {
  const Folder f;
  write_points(f / "p.npy", "ball", 50000, 3);
  for (const std::vector<std::string>& arguments :
       command_lines(f, {"hull @p.npy", "hull @p.npy --json", "hull @p.npy --format o",
                         "hull @p.npy -o -", "info @p.npy", "--help"})) {
    const Ran full = run_app(arguments, "/dev/null", "/dev/full");
    EXPECT_EQ(full.status, 1) << arguments[0];
    EXPECT_TRUE(one_line(full.err));
    EXPECT_TRUE(has(full.err, "No space left"));
    // A pipe nobody reads, and no standard output at all.
    int pipe_ends[2] = {};
    ASSERT_EQ(::pipe2(pipe_ends, O_CLOEXEC), 0);
    ::close(pipe_ends[0]);
    for (const int out : {pipe_ends[1], -1}) {
      const int err = ::open((f / "err").c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
      const int status = wait_for(start_app(arguments, 0, out, err));
      ::close(err);
      // The reader of a pipe has ended, which is no error of the program.
      EXPECT_EQ(status, out < 0 ? 1 : 1000 + SIGPIPE) << arguments[0];
      if (out < 0)
        EXPECT_TRUE(one_line(read_file(f / "err")));
      else
        EXPECT_EQ(read_file(f / "err"), "") << arguments[0];
    }
    ::close(pipe_ends[1]);
  }
  expect_error({"hull", f / "p.npy", "-q", "-o", f / "absent/hull.ply"}, 1, "absent/hull.ply");
  expect_error({"hull", f / "p.npy", "-q", "--vertices", f / "absent/v.npy"}, 1, "absent/v.npy");
  expect_error({"hull", f / "p.npy", "-q", "--json=" + (f / "absent/r.json")}, 1, "absent/r.json");
}

// The frames' hulls are those of the frames by themselves, byte for byte.
TEST(Cli, TrackWritesWhatHullWrites) {
  const Folder f;
  run_well({"generate", "bumpy", "-n", "9000", "--frames", "4", "--motion", "fracture", "-o",
            f / "s.npy"});
  const MovingPoints moving("bumpy", "fracture", 9000, 3, 4, 1);
  std::vector<double> frame(27000);
  std::vector<std::string> hulls;
  for (std::uint64_t k = 0; k < 4; ++k) {
    moving.frame(k, frame.data());
    write_npy_points(f / "one.npy", frame.data(), 9000, 3, ScalarType::f64);
    run_well({"hull", f / "one.npy", "-o", f / "one.json"});
    hulls.push_back(read_file(f / "one.json"));
  }
  for (const std::string cull : {"auto", "gauge", "pseudo-hull", "none"}) {
    const Ran ran = run_well({"track", f / "s.npy", "--cull", cull, "--certify", "-o",
                              f / ("h" + cull + "-%03d.json"), "--json"});
    const auto report = nlohmann::json::parse(ran.out);
    ASSERT_EQ(report.at("frames").size(), 4U);
    EXPECT_EQ(report.at("certified"), true);
    EXPECT_EQ(report.at("totals").at("frames"), 4);
    EXPECT_EQ(report.at("backend"), "cpu");  // 9000 points are not worth a device
    for (std::size_t k = 0; k < 4; ++k) {
      EXPECT_EQ(read_file(f / ("h" + cull + "-00" + std::to_string(k) + ".json")), hulls[k])
          << cull << ", frame " << k;
      const auto& r = report.at("frames")[k];
      const auto h = nlohmann::json::parse(hulls[k]);
      for (const char* key : {"vertex_count", "facet_count", "volume", "area"})
        EXPECT_EQ(r.at(key), h.at(key)) << key;
      EXPECT_EQ(r.at("index"), k);
      EXPECT_EQ(r.at("backend"), "cpu");
      EXPECT_LE(r.at("survivors"), r.at("scan_survivors"));
      EXPECT_LE(r.at("vertex_count"), r.at("survivors"));
      for (const char* key : {"scan_seconds", "cull_seconds", "hull_seconds"})
        EXPECT_LE(r.at(key), r.at("compute_seconds")) << key;
      // A fracture in four frames is too fast for the simplices, not for the leaders.
      EXPECT_TRUE(cull != "gauge" || r.at("method") == (k > 0 ? "gauge" : "static")) << k;
      EXPECT_TRUE(cull != "none" || r.at("survivors") == 9000);
    }
  }
}

TEST(Cli, TrackOnADeviceOrNot) {
  const Folder f;
  run_well(
      {"generate", "ball", "-n", "20k", "--frames", "3", "--motion", "twist", "-o", f / "s.npy"});
  const std::vector<std::string> arguments{"track",     f / "s.npy", "--cull", "gauge",
                                           "--backend", "cuda",      "--json"};
  const CudaStatus status = cuda_status();
  if (!status.available) {
    expect_error(arguments, 5, "frame 0: " + status.reason);
    return;
  }
  const Ran ran = run_well(arguments);
  const auto report = nlohmann::json::parse(ran.out);
  EXPECT_EQ(report.at("backend"), "cuda");
  EXPECT_EQ(report.at("totals").at("led_frames"), 2);
}

TEST(Cli, TrackReadsFoldersAndRefusesWhatItMust) {
  const Folder f;
  std::filesystem::create_directories(f / "in");
  for (const int k : {2, 10, 1})
    write_points(f / ("in/f" + std::to_string(k) + ".npy"), "ball", 200 + static_cast<unsigned>(k),
                 3);
  const Ran ran = run_well({"track", f / "in", "-o", f / "out/", "--json=" + (f / "r.json")});
  EXPECT_TRUE(has(ran.out, "frames     3"));
  EXPECT_EQ(json_in(f / "r.json").at("points").at("count"), 210);
  run_well({"hull", f / "in/f2.npy", "-o", f / "two.ply"});
  EXPECT_EQ(read_file(f / "out/frame-000001.ply"), read_file(f / "two.ply"));
  run_well({"track", f / "in/f*.npy", "-q"});

  expect_error({"track", f / "in", "-o", f / "x.ply"}, 2, "%04d");
  expect_error({"track", f / "in", "-o", f / "%s.ply"}, 2, "%d");
  expect_error({"track", f / "in", "-o", f / "%d.doc"}, 2, "must end in");
  expect_error({"track", f / "none"}, 1, "none");
  expect_error({"generate", "ball", "-n", "5", "--frames", "3", "-o", f / "y.npy"}, 2, "--motion");
}

TEST(Cli, TrackNamesTheFrameWithANan) {
  const Folder f;
  const MovingPoints moving("ball", "spin", 8000, 3, 10, 1);
  std::vector<double> frame(24000);
  {
    internal::NpySequenceWriter writer(f / "s.npy", 10, 8000, 3, ScalarType::f64);
    for (std::uint64_t k = 0; k < 10; ++k) {
      moving.frame(k, frame.data());
      if (k == 7) frame[3 * 77 + 2] = std::numeric_limits<double>::quiet_NaN();
      writer.write(frame.data());
    }
  }
  expect_error({"hull", f / "s.npy"}, 1, "track");
  for (const std::string cull : {"auto", "gauge", "pseudo-hull", "none"}) {
    expect_error({"track", f / "s.npy", "--cull", cull}, 1, "frame 7: point 77, coordinate 2");
    const Ran ran = run_app({"track", f / "s.npy", "--cull", cull, "--keep-going", "--json"});
    EXPECT_EQ(ran.status, 1);
    EXPECT_TRUE(one_line(ran.err));
    const auto report = nlohmann::json::parse(ran.out);
    ASSERT_EQ(report.at("frames").size(), 10U);
    EXPECT_TRUE(report.at("frames")[7].contains("error"));
    EXPECT_TRUE(report.at("frames")[8].contains("volume"));
    EXPECT_EQ(report.at("totals").at("failed_frames"), 1);
  }
}

}  // namespace cullhull::cli_test
