// The public headers: cullhull.hpp brings all that cullhull::cullhull has.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <sstream>

#include "cullhull/cullhull.hpp"
#include "thrown.hpp"

namespace cullhull::headers_test {

using testing_support::has;

static_assert(sizeof(HullQuery) > 0 && sizeof(GrowingHull) > 0 && sizeof(HullTracker) > 0 &&
              sizeof(HalfspaceIntersection) > 0 && sizeof(HullBatch) > 0);

TEST(Headers, OneBringsThemAll) {
  const std::filesystem::path folder = CULLHULL_HEADERS;
  std::ostringstream text;
  text << std::ifstream(folder / "cullhull.hpp").rdbuf();
  int headers = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    // Of libraries of their own.
    static const std::set<std::string> others{
        "cullhull.hpp",    "io.hpp",  "point_blocks.hpp", "triangulation_io.hpp",
        "group_hulls.hpp", "mpi.hpp", "placement.hpp"};
    if (others.contains(name)) continue;
    ++headers;
    EXPECT_TRUE(has(text.str(), "\"cullhull/" + name + "\"")) << name;
  }
  EXPECT_GT(headers, 15);
}

// The shared library hides what no public header shows.
TEST(Headers, WhatTheyDeclareIsVisible) {
  int headers = 0;
  for (const auto& entry : std::filesystem::directory_iterator(CULLHULL_HEADERS)) {
    std::ostringstream text;
    text << std::ifstream(entry.path()).rdbuf();
    const auto first = text.str().find("\nnamespace cullhull {");
    if (first == std::string::npos) continue;
    ++headers;
    if (entry.path().filename() == "stop_token.hpp") continue;  // declares aliases of std
    const auto push = text.str().find("\n#pragma GCC visibility push(default)\n");
    const auto pop = text.str().find("\n}  // namespace cullhull\n#pragma GCC visibility pop\n");
    EXPECT_TRUE(push != std::string::npos && pop != std::string::npos && push < first &&
                first < pop)
        << entry.path();
  }
  EXPECT_GT(headers, 25);
}

}  // namespace cullhull::headers_test
