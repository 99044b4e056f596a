// cullhull bench: what a suite prints and keeps. Rates are looked at for sense, never for speed.
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "agreement/run_app.hpp"

namespace cullhull {
namespace {

using testing::Folder;
using testing::one_line;
using testing::Ran;
using testing::read_file;
using testing::run_app;
using testing::write_file;

const std::vector<std::string> quick = {"bench", "machine", "--bytes", "4MiB", "--passes", "1"};

std::vector<std::string> with(std::vector<std::string> words,
                              const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

TEST(BenchMachine, TableAndJson) {
  const Ran table = run_app(quick);
  EXPECT_EQ(table.status, 0) << table.err;
  EXPECT_EQ(table.err, "");
  EXPECT_NE(table.out.find("host memory, copy, all cores"), std::string::npos) << table.out;

  const Ran ran = run_app(with(quick, {"--json"}));
  ASSERT_EQ(ran.status, 0) << ran.err;
  const auto json = nlohmann::json::parse(ran.out);
  EXPECT_EQ(json["suite"], "machine");
  EXPECT_EQ(json["bytes"], 4 << 20);
  EXPECT_GE(json["cores"].get<int>(), 1);
  for (const char* key : {"read_one_core_bytes_per_second", "read_bytes_per_second",
                          "copy_one_core_bytes_per_second", "copy_bytes_per_second"})
    EXPECT_GT(json["host"][key].get<double>(), 0) << key;
  if (json["device"].is_null())
    EXPECT_NE(json["no_device"], "");
  else
    EXPECT_GT(json["device"]["link_bytes_per_second"].get<double>(), 0);
}

TEST(BenchMachine, SavesWhereThePlannerLooks) {
  const Folder f;
  ::setenv("CULLHULL_MACHINE", (f / "deep/er/machine.json").c_str(), 1);
  const Ran ran = run_app(with(quick, {"--save", "--quiet"}));
  EXPECT_EQ(ran.status, 0) << ran.err;
  EXPECT_EQ(ran.out, "");
  const auto json = nlohmann::json::parse(read_file(f / "deep/er/machine.json"));
  EXPECT_GT(json["host_read_bytes_per_second"].get<double>(), 0);
  EXPECT_GT(json["host_copy_bytes_per_second"].get<double>(), 0);
  EXPECT_GE(json["cores"].get<int>(), 1);
  EXPECT_EQ(json["date"].get<std::string>().size(), 20U);

  write_file(f / "file", "");
  ::setenv("CULLHULL_MACHINE", (f / "file/machine.json").c_str(), 1);
  const Ran refused = run_app(with(quick, {"--save"}));
  EXPECT_EQ(refused.status, 1);
  EXPECT_TRUE(one_line(refused.err));
  ::unsetenv("CULLHULL_MACHINE");
}

TEST(BenchMachine, WhatIsSavedIsRead) {
  const Folder f;
  const std::string points = f / "p.npy";
  ASSERT_EQ(run_app({"generate", "ball", "-n", "100k", "-o", points}).status, 0);
  ::setenv("XDG_CONFIG_HOME", (f / "").c_str(), 1);
  EXPECT_EQ(run_app(with(quick, {"--save", "--quiet"})).status, 0);
  EXPECT_EQ(run_app({"hull", points, "-q"}).status, 0);
  // A file that is no JSON is noticed: so it is this one that is read.
  write_file(f / "cullhull/machine.json", "no");
  const Ran ran = run_app({"hull", points, "-q"});
  EXPECT_EQ(ran.status, 1);
  EXPECT_NE(ran.err.find("machine.json"), std::string::npos) << ran.err;
  ::unsetenv("XDG_CONFIG_HOME");
}

TEST(BenchMachine, BadUsage) {
  for (const auto& words : std::vector<std::vector<std::string>>{
           {"bench"}, {"bench", "nothing"}, with(quick, {"--bytes", "many"})}) {
    const Ran ran = run_app(words);
    EXPECT_EQ(ran.status, 2) << words.back();
    EXPECT_TRUE(one_line(ran.err)) << ran.err;
    EXPECT_EQ(ran.out, "");
  }
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
    }
  }
  for (const char* key : {"processor", "cores", "memory"}) EXPECT_NE(report["machine"][key], "");
}

TEST(BenchPaper, EveryFigureAtASmallScale) {
  const Folder f;
  const std::string file = f / "report.json";
  const Ran ran =
      run_app({"bench", "paper", "--scale", "0.0005", "--repeat", "1", "--json=" + file});
  ASSERT_EQ(ran.status, 0) << ran.err;
  EXPECT_NE(ran.out.find("figure-12"), std::string::npos);
  const auto report = nlohmann::json::parse(read_file(file));
  EXPECT_EQ(report["suite"], "paper");
  EXPECT_EQ(report["scale"], 0.0005);
  expect_sound(report);
  EXPECT_EQ(report["figures"].size(), 8U);

  const Ran one = run_app(
      {"bench", "paper", "--scale", "0.0005", "--repeat", "1", "--figure", "threads", "--json"});
  ASSERT_EQ(one.status, 0) << one.err;
  EXPECT_EQ(nlohmann::json::parse(one.out)["figures"].size(), 1U);
  EXPECT_EQ(run_app({"bench", "paper", "--figure", "figure-99"}).status, 2);
  EXPECT_EQ(run_app({"bench", "paper", "--scale", "0"}).status, 2);
}

TEST(BenchRivals, MarksWhereARivalIsFaster) {
  const Ran ran = run_app({"bench", "rivals", "--scale", "0.001", "--repeat", "1", "--workload",
                           "ball-3d-8M", "--workload", "sphere-4d-100k", "--json"});
  ASSERT_EQ(ran.status, 0) << ran.err;
  const auto report = nlohmann::json::parse(ran.out);
  expect_sound(report);
  const auto& all = report["figures"].back();
  ASSERT_EQ(all["rows"].size(), 2U);
  EXPECT_EQ(all["rows"][0]["name"], "ball-3d-8k");
  std::size_t lost = 0;
  for (const auto& row : all["rows"])
    lost += !row["ratio"].is_null() && row["ratio"].get<double>() < 1;
  EXPECT_EQ(report["figures"].size(), lost > 0 ? 2U : 1U);
  EXPECT_EQ(report["figures"][0]["rows"].size(), lost > 0 ? lost : 2);
  EXPECT_EQ(run_app({"bench", "rivals", "--workload", "nothing"}).status, 2);
}

}  // namespace
}  // namespace cullhull
