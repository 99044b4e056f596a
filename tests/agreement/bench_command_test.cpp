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

TEST(BenchMachine, BadUsage) {
  for (const auto& words : std::vector<std::vector<std::string>>{
           {"bench"}, {"bench", "nothing"}, with(quick, {"--bytes", "many"})}) {
    const Ran ran = run_app(words);
    EXPECT_EQ(ran.status, 2) << words.back();
    EXPECT_TRUE(one_line(ran.err)) << ran.err;
    EXPECT_EQ(ran.out, "");
  }
}

}  // namespace
}  // namespace cullhull
