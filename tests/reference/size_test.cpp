// The size of the tree: a budget of lines for each folder, and the numbers of types, of texts that
// write a result and of insertions. Whoever needs more takes it from elsewhere, or raises the
// budget in a decision that says what users get for it.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace size_test {

namespace fs = std::filesystem;

/// The most lines of text that a folder may hold, all that is below it included.
const std::map<std::string, std::size_t> budgets = {
    {"include", 3735},   {"src/batch", 670},     {"src/certify", 4170},  {"src/constrained", 600},
    {"src/cuda", 5700},  {"src/delaunay", 4320}, {"src/diagrams", 6900}, {"src/distributed", 250},
    {"src/exact", 4635}, {"src/extreme", 970},   {"src/few", 1855},      {"src/filter", 8910},
    {"src/flow", 1650},  {"src/generate", 660},  {"src/geometry", 1640}, {"src/hull", 6225},
    {"src/io", 18655},   {"src/parallel", 3010}, {"src/query", 3490},    {"src/result", 7620},
    {"src/shared", 55},  {"src/stream", 1296},   {"src/tracker", 870},   {"bindings", 32900},
    {"tests", 55530},    {"docs", 10920},        {"apps", 9545},         {"bench", 7560},
    {"viewer", 3445},    {"scripts", 4350},
};

bool is_text(const fs::path& file) {
  static const std::set<std::string> others{".png", ".gz",  ".xz", ".npy", ".las",  ".laz",
                                            ".ply", ".pyc", ".h5", ".svg", ".jsonl"};
  return others.count(file.extension().string()) == 0;
}

std::vector<fs::path> texts_below(const fs::path& folder) {
  std::vector<fs::path> files;
  if (!fs::exists(folder)) return files;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string path = entry.path().generic_string();
    if (entry.is_regular_file() && is_text(entry.path()) &&
        path.find("__pycache__") == std::string::npos &&
        path.find("bench/results") == std::string::npos)
      files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

std::size_t lines_of(const fs::path& file) {
  std::ifstream in(file);
  std::size_t lines = 0;
  for (std::string line; std::getline(in, line);) ++lines;
  return lines;
}

std::size_t lines_below(const fs::path& folder) {
  std::size_t lines = 0;
  for (const fs::path& file : texts_below(folder)) lines += lines_of(file);
  return lines;
}

/// What exceeds its budget, and folders without one.
std::vector<std::string> excesses(const fs::path& root,
                                  const std::map<std::string, std::size_t>& most) {
  std::vector<std::string> found;
  for (const auto& [folder, budget] : most)
    if (const std::size_t lines = lines_below(root / folder); lines > budget)
      found.push_back(folder + " has " + std::to_string(lines) + " lines of " +
                      std::to_string(budget));
  if (!fs::exists(root / "src")) return found;
  for (const auto& entry : fs::directory_iterator(root / "src")) {
    const std::string folder = "src/" + entry.path().filename().string();
    if (entry.is_directory() && most.count(folder) == 0) found.push_back(folder + " has no budget");
  }
  return found;
}

/// The files below `folder` that have a line like `pattern`, and how many such lines in all.
std::pair<std::set<std::string>, std::size_t> files_with(const fs::path& folder,
                                                         const std::regex& file_name,
                                                         const std::regex& pattern) {
  std::pair<std::set<std::string>, std::size_t> found{{}, 0};
  for (const fs::path& file : texts_below(folder)) {
    if (!std::regex_search(file.filename().string(), file_name)) continue;
    std::ifstream in(file);
    for (std::string line; std::getline(in, line);) {
      if (!std::regex_search(line, pattern)) continue;
      found.first.insert(file.lexically_relative(folder).generic_string());
      ++found.second;
    }
  }
  return found;
}

const std::regex header(R"(\.(hpp|cuh)$)");
const std::regex type(R"(^\s*(struct|class|enum|union)\s+[^;(]*\{)");

TEST(Size, FoldersKeepTheirBudgets) {
  EXPECT_EQ(excesses(CULLHULL_ROOT, budgets), std::vector<std::string>());
  // A budget that is far above what is there holds nothing.
  for (const auto& [folder, budget] : budgets)
    EXPECT_LE(budget, 41 * lines_below(fs::path(CULLHULL_ROOT) / folder) / 40 + 100) << folder;
}

TEST(Size, TypesAreFew) {
  const fs::path root = CULLHULL_ROOT;
  EXPECT_LE(files_with(root / "src", header, type).second, 571U);
  EXPECT_LE(files_with(root / "include", header, type).second, 86U);
}

// Four texts write the lists of a canonical result: of polygons, of triangles and of simplices, few
// or many, and of merged facets. hull_lists.hpp gives them room in a Hull or a HullBatch.
TEST(Size, FourTextsWriteResults) {
  const std::regex writes(
      R"(\b(NewLists<|keep_simplicial\()|\bfacet_neighbours\.(items|offsets)(\.resize| = ))");
  EXPECT_EQ(
      files_with(fs::path(CULLHULL_ROOT) / "src", std::regex(".*"), writes).first,
      (std::set<std::string>{"result/write/hull_lists.hpp", "result/write/write_facets.cpp",
                             "result/write/write_polygon.cpp", "result/write/write_simplices.cpp",
                             "result/write/write_triangles.cpp"}));
}

// The incremental insertions: each replaces what a new point sees or is in conflict with. That of
// few points in space counts twice, since it has two surfaces.
TEST(Size, InsertionsAreFew) {
  const std::regex inserts(
      R"(\b(void|bool) ([\w<>]+::)?(insert|replace|replace_cavity|make_cells)\()"
      R"((unsigned|Id|std::uint32_t|Lane&) [^;]*\{$)");
  EXPECT_EQ(files_with(fs::path(CULLHULL_ROOT) / "src", std::regex(".*"), inserts).first,
            (std::set<std::string>{"cuda/kernels/warp_hull.cuh", "delaunay/cell_insertion.hpp",
                                   "delaunay/plane_insertion.hpp", "few/small_3d.cpp",
                                   "few/small_nd.cpp", "hull/general/insertion_nd_cavity.hpp",
                                   "hull/space/insertion_3d.cpp"}));
}

TEST(Size, PlantedExcessesAreFound) {
  const fs::path root = fs::path(::testing::TempDir()) / "cullhull_size";
  fs::remove_all(root);
  fs::create_directories(root / "src/a/b");
  fs::create_directories(root / "src/c");
  std::ofstream(root / "src/a/b/x.hpp") << "struct A {\n};\nenum class B { c };\nstruct D;\n";
  std::ofstream(root / "src/c/y.png") << "one\ntwo\n";
  EXPECT_EQ(excesses(root, {{"src/a", 4}, {"src/c", 0}}), std::vector<std::string>());
  EXPECT_EQ(excesses(root, {{"src/a", 3}}),
            (std::vector<std::string>{"src/a has 4 lines of 3", "src/c has no budget"}));
  const auto [files, count] = files_with(root / "src", header, type);
  EXPECT_EQ(count, 2U);
  EXPECT_EQ(files, std::set<std::string>{"a/b/x.hpp"});
  fs::remove_all(root);
}

}  // namespace size_test
