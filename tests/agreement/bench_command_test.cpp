// cullhull-bench: what a suite prints and keeps. Rates are looked at for sense, never for speed.
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <map>

#include "agreement/expect_json.hpp"
#include "cgal.hpp"

namespace cullhull::bench_command_test {

using namespace testing;

TEST(BenchCommand, HelpAndUsage) {
  for (const char* suite : {"rivals", "calls"}) expect_same_help({"cullhull-bench"}, suite);
  expect_help_alone({"cullhull-bench"});
  expect_error({"cullhull-bench", "rivals", "--workloads", "x"}, 2,
               "did you mean --workload? (see cullhull-bench rivals --help)");
  expect_error({"cullhull-bench", "nothing"}, 2, "unknown command 'nothing'");
  expect_error({"cullhull-bench", "rival"}, 2,
               "unknown command 'rival'; did you mean rivals? (see cullhull-bench --help)");
  const Ran json = run_app({"cullhull-bench", "--json"});
  EXPECT_EQ(json.status, 2) << json.err;
  EXPECT_FALSE(has(json.err, "--json=-"));
  const Ran cut = run_app({"cullhull-bench", "rivals", "--workload", std::string(5000, 'x')});
  EXPECT_TRUE(cut.status == 1 || cut.status == 2) << cut.status;
  EXPECT_TRUE(one_line(cut.err)) << cut.err.substr(0, 100);
  EXPECT_LT(cut.err.size(), 700U) << cut.err.substr(0, 100);
  EXPECT_TRUE(has(cut.err, "xxx")) << cut.err.substr(0, 300);
  const Folder f;
  expect_error({"cullhull-bench", "calls", "--seconds", "0", "--json=" + (f / "m.csv")}, 2,
               ".json");
  EXPECT_EQ(f.entries(), 0U);
}

TEST(BenchCommand, SaysThatItWasCancelled) {
  EXPECT_EQ(cancelled_at_work({"cullhull-bench", "rivals", "--scale", "1", "--workload",
                               "sphere-3d-1M", "--repeat", "100"}),
            "cullhull: cancelled\n");
}

TEST(CliJson, BenchSuites) {
  expect_json({"cullhull-bench", "rivals", "--scale", "1", "--repeat", "1", "--workload",
               "cube-3d-100", "--json"},
              "bench_report");
  expect_json({"cullhull-bench", "calls", "--seconds", "0", "--workload", "cube-3d-100", "--json"},
              "bench_report");
  expect_json({"cullhull-bench", "lifting", "--scale", "1", "--repeat", "1", "--workload",
               "uniform-3d-50", "--json"},
              "bench_report");
  const auto paths =
      expect_json({"cullhull-bench", "paths", "--way", "few in space", "--seconds", "0", "--json"},
                  "bench_report");
  EXPECT_EQ(paths["figures"][0]["rows"][0]["name"], "few in space, ball-3d-100");
  expect_json(
      {"cullhull-bench", "stream", "--scale", "1e-5", "--repeat", "1", "--format", "las", "--json"},
      "bench_report");
}

/// Every row has values that are times or shares, and says how it was checked.
void expect_sound(const nlohmann::json& report) {
  ASSERT_FALSE(report["figures"].empty());
  for (const auto& figure : report["figures"]) {
    ASSERT_FALSE(figure["rows"].empty()) << figure["id"];
    for (const auto& row : figure["rows"]) {
      EXPECT_FALSE(row["values"].empty()) << row["name"];
      for (const auto& [name, value] : row["values"].items())
        EXPECT_TRUE(value.is_null() || value.get<double>() >= 0) << row["name"] << ' ' << name;
      EXPECT_TRUE(row["agrees"].get<bool>()) << row["name"] << ' ' << row["check"];
      EXPECT_NE(row["check"], "");
      EXPECT_TRUE(row["bandwidth_share"].is_null() || row["bandwidth_share"].get<double>() > 0);
      EXPECT_EQ(row["reads"].is_null(), report["suite"] != "rivals");
    }
  }
  EXPECT_EQ(report["read_bytes_per_second"].empty(),
            report["suite"] == "calls" || report["suite"] == "lifting");
  for (const auto& [threads, rate] : report["read_bytes_per_second"].items())
    EXPECT_GT(rate.get<double>(), 0) << threads;
  for (const char* key : {"processor", "cores", "memory"}) EXPECT_NE(report["machine"][key], "");
}

TEST(BenchPaper, EveryFigureAtASmallScale) {
  const Folder f;
  const std::string file = f / "report.json";
  const Ran ran =
      run_well({"cullhull-bench", "paper", "--scale", "0.0005", "--repeat", "1", "--json=" + file});
  EXPECT_TRUE(has(ran.out, "figure-12"));
  const auto report = json_in(file);
  EXPECT_EQ(report["suite"], "paper");
  EXPECT_EQ(report["scale"], 0.0005);
  expect_sound(report);
  EXPECT_EQ(report["figures"].size(), 8U);

  const Ran one = run_well({"cullhull-bench", "paper", "--scale", "0.0005", "--repeat", "1",
                            "--figure", "threads", "--json"});
  EXPECT_EQ(nlohmann::json::parse(one.out)["figures"].size(), 1U);
  EXPECT_EQ(run_app({"cullhull-bench", "paper", "--figure", "figure-99"}).status, 2);
  EXPECT_EQ(run_app({"cullhull-bench", "paper", "--scale", "0"}).status, 2);
}

/// Rows of the figure of all workloads, by name.
std::map<std::string, nlohmann::json> rows_of(const nlohmann::json& report) {
  std::map<std::string, nlohmann::json> rows;
  for (const auto& row : report["figures"].back()["rows"])
    rows[row["name"].get<std::string>()] = row;
  return rows;
}

/// A shell script that can be run, in the place of a rival's program.
std::string script_at(const std::string& path, const std::string& body) {
  write_file(path, "#!/bin/sh\n" + body);
  std::filesystem::permissions(path, std::filesystem::perms::owner_all);
  return path;
}

const std::vector<std::string> rivals = {"cullhull-bench", "rivals", "--repeat", "1"};

TEST(BenchRivals, MarksWhereARivalIsFaster) {
  const Ran ran =
      run_well(joined(rivals, {"--scale", "0.001", "--workload", "ball-3d-8M", "--workload",
                               "sphere-4d-100k", "--threads", "1,2", "--json"}));
  const auto report = nlohmann::json::parse(ran.out);
  expect_sound(report);
  const auto& all = report["figures"].back();
  ASSERT_EQ(all["rows"].size(), 2U);
  EXPECT_EQ(all["rows"][0]["name"], "ball-3d-8k");
  std::size_t lost = 0;
  for (const auto& row : all["rows"]) {
    double best = 1e300, worst = 0;
    for (const auto& [name, value] : row["values"].items()) {
      if (value.is_null()) continue;
      if (name.starts_with("cullhull")) worst = std::max(worst, value.get<double>());
      if (!name.starts_with("cullhull")) best = std::min(best, value.get<double>());
    }
    EXPECT_TRUE(row["values"].contains("cullhull, 1 thread"));
    EXPECT_TRUE(row["values"].contains("cullhull, 2 threads"));
    EXPECT_EQ(row["slower"].is_null(), !(best < worst)) << row;
    lost += best < worst ? 1 : 0;
  }
  EXPECT_EQ(report["figures"].size(), lost > 0 ? 2U : 1U);
  EXPECT_EQ(report["figures"][0]["id"], lost > 0 ? "lost" : "rivals");
  EXPECT_EQ(report["figures"][0]["rows"].size(), lost > 0 ? lost : 2);
}

TEST(BenchRivals, EveryCombinationAndHardPoints) {
  const Folder f;
  const Ran ran = run_well(joined(
      rivals,
      {"--scale",  "1",           "--shape",   "ball",     "--shape", "sphere",     "--dimension",
       "2",        "--dimension", "3",         "--points", "500",     "--scalar",   "f32",
       "--scalar", "i32",         "--threads", "1",        "--json",  "--markdown", f / "t.md"}));
  const auto report = nlohmann::json::parse(ran.out);
  expect_sound(report);
  const auto rows = rows_of(report);
  ASSERT_EQ(rows.size(), 8U);
  for (const char* name : {"ball-2d-500-f32", "ball-3d-500-i32", "sphere-3d-500-f32"})
    EXPECT_EQ(rows.count(name), 1U) << name;
  const std::string table = read_file(f / "t.md");
  EXPECT_TRUE(has(table, "| 2D disk 500, f32"));

  const Ran hard = run_well(
      joined(rivals, {"--scale", "1", "--workload", "turned-lattice-surface-3d-600", "--workload",
                      "two-circles-3d-300", "--workload", "turned-squashed-3d-300", "--workload",
                      "cone-3d-300", "--workload", "grid-3d-2k-i32", "--json"}));
  const auto found = nlohmann::json::parse(hard.out);
  expect_sound(found);
  EXPECT_EQ(rows_of(found).at("two-circles-3d-300")["vertices"], 300);
  EXPECT_EQ(rows_of(found).at("cone-3d-300")["vertices"], 300);
}

TEST(BenchRivals, ARivalThatTakesTooLongIsStopped) {
  const Ran ran = run_well(joined(rivals, {"--scale", "1", "--workload", "sphere-3d-200k",
                                           "--limit", "0.1", "--without", "cgal", "--json"}));
  const auto row = rows_of(nlohmann::json::parse(ran.out)).begin()->second;
  EXPECT_FALSE(row["values"].contains("CGAL"));
  if (row["values"]["Qhull"].is_null()) return;  // built without
  EXPECT_EQ(row["unfinished"], nlohmann::json::array({"Qhull"}));
  EXPECT_EQ(row["values"]["Qhull"], 0.1);
  EXPECT_TRUE(row["ratio_is_bound"].get<bool>());
}

/// Stands in for CGAL's program and has lost a point.
TEST(BenchRivals, OtherExtremePointsAreAnError) {
  const std::vector<double> square{0, 0, 1, 0, 0, 1, 1, 1};
  const bench::Difference same = bench::difference(square, {1, 1, 0, 0, 1, 0, -0.0, 1}, 2);
  EXPECT_EQ(same.first + same.second, 0U);
  const bench::Difference found = bench::difference(square, {0, 0, 1, 0, 5, 5, 1, 1, 7, 7}, 2);
  EXPECT_EQ(found.first, 1U);
  EXPECT_EQ(found.second, 2U);

  const Folder f;
  const std::string ours = f / "cullhull-bench";
  std::filesystem::copy_file(CULLHULL_APP "-bench", ours);
  const std::string program = f / "cullhull-rival-cgal";
  script_at(program, "printf '\\0\\0\\0\\0\\0\\0\\360?'\nhead -c 48 /dev/zero\n");
  const std::string out = f / "report.json";
  std::string command = ours;
  command += " rivals --scale 1 --repeat 1 --workload cube-3d-100 -q --json=";
  command += out + " 2>/dev/null";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 3);
  const auto report = json_in(out);
  EXPECT_EQ(report["figures"][0]["id"], "differ");
  const auto& row = report["figures"][0]["rows"][0];
  EXPECT_FALSE(row["agrees"].get<bool>());
  EXPECT_EQ(row["values"]["CGAL"], 1.0);
  EXPECT_TRUE(has(row["check"].get<std::string>(), "2 only CGAL's")) << row;
}

TEST(BenchRivals, BadUsage) {
  for (const auto& words :
       command_lines({"--workload nothing", "--workload nothing-3d-1k", "--workload squashed-4d-1k",
                      "--threads 0", "--json --markdown=-", "--threads 1,many", "--points many"}))
    expect_error(joined(rivals, words), 2, "");
}

TEST(BenchStream, EveryFormatHasTheHullThatItHasInMemory) {
  const Ran ran =
      run_well({"cullhull-bench", "stream", "--scale", "0.0005", "--repeat", "1", "--json"});
  const auto report = nlohmann::json::parse(ran.out);
  ASSERT_EQ(report["figures"].size(), 2U);
  const auto& rates = report["figures"][0]["rows"];
  ASSERT_EQ(rates.size(), 5U);
  for (const auto& row : rates) {
    EXPECT_TRUE(row["agrees"]) << row;
    EXPECT_GT(row["vertices"], 100);
    EXPECT_GT(row["values"]["plain read"], 0);
    EXPECT_GT(row["values"]["streamed"], 0);
  }
  for (const auto& row : report["figures"][1]["rows"]) EXPECT_GT(row["values"]["streamed"], 1);
  EXPECT_EQ(run_app({"cullhull-bench", "stream", "--format", "doc"}).status, 2);
  EXPECT_EQ(run_app({"cullhull-bench", "stream", "--memory", "much"}).status, 2);
  EXPECT_EQ(run_app({"cullhull-bench", "stream", "--scale", "1e-5", "--folder", "/nowhere/at/all"})
                .status,
            1);
}

const std::vector<std::string> lifting = {"cullhull-bench", "lifting", "--scale", "1",
                                          "--repeat",       "1"};

TEST(BenchLifting, EveryFamilyAndDimensionAgreesWithARivalOrIsCertified) {
  const Folder f;
  const std::string file = f / "scan.csv";
  write_file(file, "0,0,9\n1,0,9\n0,1,9\n1,1.5,9\n7,7,9\n");
  const Ran ran = run_well(joined(lifting, {"--shape",     "uniform",
                                            "--shape",     "clustered",
                                            "--shape",     "lattice",
                                            "--shape",     "sphere",
                                            "--shape",     "lines",
                                            "--dimension", "2",
                                            "--dimension", "3",
                                            "--dimension", "4",
                                            "--points",    "300",
                                            "--workload",  "scan-2d-1M",
                                            "--workload",  "uniform-5d-60-f32",
                                            "--scan",      file,
                                            "--threads",   "1,2",
                                            "--json"}));
  const auto report = nlohmann::json::parse(ran.out);
  expect_sound(report);
  const auto rows = rows_of(report);
  ASSERT_EQ(rows.size(), 17U);
  // All of a lattice is ties: beyond the plane its cells are not counted but certified.
  EXPECT_TRUE(has(rows.at("lattice-3d-300")["check"].get<std::string>(), ", certified"));
  EXPECT_EQ(rows.at("scan-2d-5")["check"].get<std::string>().substr(0, 7), "4 cells");
  for (const auto& [name, row] : rows) {
    EXPECT_GT(row["values"]["cullhull, 1 thread"], 0) << name;
    EXPECT_GT(row["values"]["cullhull, 2 threads"], 0) << name;
    const std::string check = row["check"];
    EXPECT_TRUE(check.find("as many as CGAL") != std::string::npos ||
                check.find(", certified") != std::string::npos)
        << name << ' ' << check;
  }
}

/// Seconds and simplices as doubles: one of each, of which the square has two.
TEST(BenchLifting, ProgramsOfOthersAndWhoCountsOtherCells) {
  const Folder f;
  const std::string one_and_one = "printf '\\0\\0\\0\\0\\0\\0\\360?\\0\\0\\0\\0\\0\\0\\360?'\n";
  const std::vector<std::string> square = {"--workload", "lattice-2d-4", "--without", "qhull"};
  const auto other = run_app(joined(
      joined(lifting, square),
      {"--rival", "other=" + script_at(f / "other", "test \"$2\" = delaunay && " + one_and_one),
       "--without", "cgal", "--json"}));
  ASSERT_EQ(other.status, 0) << other.err;
  const auto row = rows_of(nlohmann::json::parse(other.out)).begin()->second;
  EXPECT_EQ(row["values"]["other"], 1.0);
  EXPECT_EQ(row["check"], "2 cells, other 1, certified");

  expect_error(joined(joined(lifting, square),
                      {"--rival", "silent=" + script_at(f / "silent", "printf 12"), "-q"}),
               1, "");

  const std::string ours = f / "cullhull-bench", out = f / "report.json";
  std::filesystem::copy_file(CULLHULL_APP "-bench", ours);
  script_at(f / "cullhull-rival-cgal", one_and_one);
  std::string command = ours + " lifting --scale 1 --repeat 1 --without qhull -q";
  command += " --workload lattice-2d-4 --json=" + out + " 2>/dev/null";
  EXPECT_EQ(WEXITSTATUS(std::system(command.c_str())), 3);
  const auto report = json_in(out);
  EXPECT_EQ(report["figures"][0]["id"], "differ");
  EXPECT_EQ(report["figures"][0]["rows"][0]["check"], "2 cells, CGAL 1");
}

TEST(BenchLifting, BadUsage) {
  for (const auto& words :
       command_lines({"--workload scan-2d-10", "--workload nothing-2d-10",
                      "--workload squashed-2d-10", "--rival program", "--threads 0"}))
    expect_error(joined(lifting, words), 2, "");
  EXPECT_EQ(run_app(joined(lifting, {"--workload", "scan-2d-10", "--scan", "/no/file.ply"})).status,
            1);
}

const std::vector<std::string> calls = {"cullhull-bench", "calls", "--seconds", "0", "--json"};

TEST(BenchCalls, AFigureForEachLoadAndTheFirstCall) {
  const Ran ran = run_well(
      joined(calls, {"--shape", "ball", "--dimension", "2", "--dimension", "4", "--points", "30",
                     "--scalar", "f32", "--threads", "0,2", "--callers", "1,3", "--busy", "0,2"}));
  const auto report = nlohmann::json::parse(ran.out);
  expect_sound(report);
  std::vector<std::string> ids;
  for (const auto& figure : report["figures"]) {
    ids.push_back(figure["id"]);
    ASSERT_EQ(figure["rows"].size(), 2U);
    EXPECT_EQ(figure["rows"][0]["name"], "ball-2d-30-f32");
  }
  EXPECT_EQ(ids, (std::vector<std::string>{"calls", "calls-2-busy", "first-calls"}));
  for (const char* name : {"cullhull", "cullhull, 99 %", "cullhull, 2 threads",
                           "cullhull, 2 threads, 3 callers, 99 %"})
    EXPECT_GT(report["figures"][1]["rows"][1]["values"][name], 0) << name;
  for (const char* name : {"first", "later"})
    EXPECT_GT(report["figures"][2]["rows"][0]["values"][name], 0) << name;
}

/// A rival that needs a second for each of the 2000 sets, one that answers too little, none.
TEST(BenchCalls, ProgramsOfOthers) {
  const Folder f;
  const std::string program = f / "rival";
  const auto measured_with = [&](const char* script) {
    script_at(program, script);
    return run_app(joined(calls, {"--points", "8", "--busy", "0", "--rival", "slow=" + program}));
  };
  const Ran ran = measured_with(
      "test -s \"$1\" && for i in $(seq $2); do printf '\\0\\0\\0\\0\\0\\0\\360?'; "
      "done");
  ASSERT_EQ(ran.status, 0) << ran.err;
  const auto row = nlohmann::json::parse(ran.out)["figures"][0]["rows"][0];
  EXPECT_EQ(row["values"]["slow"], 1.0);
  EXPECT_EQ(row["values"]["slow, 99 %"], 1.0);
  const Ran less = measured_with("printf 1234");
  EXPECT_EQ(less.status, 1);
  EXPECT_TRUE(one_line(less.err)) << less.err;
  EXPECT_TRUE(has(less.err, program));
}

TEST(BenchCalls, BadUsage) {
  for (const auto& words :
       command_lines({"--seconds many", "--callers 0", "--callers all", "--busy some",
                      "--rival program", "--rival =program", "--shape squashed", "--seconds -1"}))
    expect_error(joined(calls, words), 2, "");
}

}  // namespace cullhull::bench_command_test
