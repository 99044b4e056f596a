// What `cullhull view` reads as one set and as frames, and where it writes without -o.
#include <cstdlib>
#include <filesystem>
#include <string>

#include "agreement/expect_json.hpp"

namespace cullhull::cli_view_test {

using nlohmann::json;
using namespace testing;

class CliView : public ::testing::Test {
 protected:
  void SetUp() override {
    write_file(f / "p.txt", "0 0\n1 0\n0 1\n");
    if (run_app({"view", f / "p.txt", "-q", "-o", f / "v.html"}).status == 5)
      GTEST_SKIP() << "built without three.js";
    ::unsetenv("DISPLAY");
    ::unsetenv("WAYLAND_DISPLAY");
    std::filesystem::create_directory(f / "tiles");
    write_file(f / "tiles/a-1.txt", "0 0\n1 0\n0 1\n");
    write_file(f / "tiles/a-2.txt", "5 5\n6 5\n");
  }
  Folder f;
};

TEST_F(CliView, SeveralFilesAreOneSet) {
  for (const std::vector<std::string>& inputs : {std::vector<std::string>{f / "tiles"},
                                                 {f / "tiles/"},
                                                 {f / "tiles/a-*.txt"},
                                                 {f / "tiles/a-1.txt", f / "tiles/a-2.txt"}}) {
    std::vector<std::string> words{"view", "-o", f / "v.html", "--json"};
    words.insert(words.begin() + 1, inputs.begin(), inputs.end());
    const json report = expect_json(words, "hull_report");
    EXPECT_EQ(report["points"]["count"], 5) << inputs[0];
    EXPECT_EQ(report["vertex_count"], 5) << inputs[0];
    words.emplace_back("--frames");
    EXPECT_EQ(expect_json(words, "view_report")["frames"].size(), 2U) << inputs[0];
  }
  run_well({"track", f / "tiles", "-q", "-o", f / "h-%d.json"});
  const json hulls =
      expect_json({"view", f / "h-*.json", "-o", f / "v.html", "--json"}, "view_report");
  EXPECT_EQ(hulls["frames"].size(), 2U);
  EXPECT_EQ(hulls["frames"][0]["kind"], "hull_figures");
}

TEST_F(CliView, WithoutAnOutputThePageIsBesideTheInput) {
  const Ran ran = run_well({"view", f / "p.txt", "--no-open"});
  EXPECT_TRUE(has(ran.out, "p.html"));
  run_well({"view", f / "p.txt", "-q"});  // its own page is replaced
  run_well({"view", f / "tiles/", "-q"});
  EXPECT_TRUE(std::filesystem::exists(f / "tiles.html"));
  write_file(f / "q.txt", "0 0\n1 0\n0 1\n");
  write_file(f / "q.html", "<html>mine</html>");
  expect_error({"view", f / "q.txt"}, 2, "q.html: is there and is no page of cullhull's");
  EXPECT_EQ(read_file(f / "q.html"), "<html>mine</html>");
  for (const std::vector<std::string>& inputs :
       {std::vector<std::string>{"-"}, {f / "p.txt", f / "q.txt"}, {f / "tiles/*.txt"}}) {
    EXPECT_EQ(run_app(joined({"view"}, inputs)).status, 2) << inputs[0];
  }
}

// As a desktop does it: by the program xdg-open.
TEST_F(CliView, ABrowserOpensThePage) {
  std::filesystem::create_directory(f / "bin");
  write_file(f / "bin/xdg-open", "#!/bin/sh\nprintf '%s' \"$1\" > " + (f / "opened") + "\n");
  std::filesystem::permissions(f / "bin/xdg-open", std::filesystem::perms::owner_all);
  const std::string path = std::getenv("PATH");
  ::setenv("PATH", ((f / "bin") + ":" + path).c_str(), 1);
  ::setenv("DISPLAY", ":99", 1);
  run_well({"view", f / "p.txt", "--no-open", "-q"});
  run_well({"view", f / "p.txt", "-q", "-o", f / "v.html"});
  EXPECT_FALSE(std::filesystem::exists(f / "opened"));
  run_well({"view", f / "p.txt", "-q"});
  for (int i = 0; i < 200 && read_file(f / "opened").empty(); ++i) ::usleep(50'000);
  EXPECT_EQ(read_file(f / "opened"), f / "p.html");
  ::setenv("PATH", path.c_str(), 1);
  ::unsetenv("DISPLAY");
}

}  // namespace cullhull::cli_view_test
