// Files and headings that comments and pages name are there.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace mentions_test {

namespace fs = std::filesystem;

std::string text_of(const fs::path& file) {
  std::ifstream in(file);
  return {std::istreambuf_iterator<char>(in), {}};
}

/// Comments alone, as one line: a sentence may run over several.
std::string comments_of(const std::string& code) {
  static const std::regex comment(R"(//[/!]?<? *([^\n]*))");
  std::string all;
  for (auto i = std::sregex_iterator(code.begin(), code.end(), comment);
       i != std::sregex_iterator(); ++i)
    all += (*i)[1].str() + ' ';
  return all;
}

std::string joined(std::string page) {
  std::replace(page.begin(), page.end(), '\n', ' ');
  return page;
}

/// The files of the tree that people read: its folders but for builds and data.
struct Tree {
  explicit Tree(const fs::path& r) : root(r) {
    for (const char* folder : {"apps", "bench", "bindings", "cmake", "docs", "examples", "fuzz",
                               "include", "scripts", "src", "tests", "viewer"}) {
      if (!fs::exists(root / folder)) continue;
      for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
        if (entry.path().string().find("/results/") != std::string::npos) continue;
        names.insert(entry.path().filename().string());
        if (entry.is_regular_file()) files.push_back(entry.path());
      }
    }
    for (const auto& entry : fs::directory_iterator(root)) {
      names.insert(entry.path().filename().string());
      if (entry.path().extension() == ".md") files.push_back(entry.path());
    }
    std::sort(files.begin(), files.end());
  }

  fs::path root;
  std::set<std::string> names;  ///< of files and folders, without what leads there
  std::vector<fs::path> files;
};

/// Whether something in the tree has this path, in which * stands for anything within a name. A
/// program may be named in the place of its source.
bool is_there(const Tree& tree, const std::string& path) {
  if (path.find('*') == std::string::npos)
    return fs::exists(tree.root / path) || fs::exists(tree.root / (path + ".cpp"));
  std::string form;
  for (const char c : path)
    if (c == '*')
      form += "[^/]*";
    else if (std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '/' || c == '_')
      form += c;
    else
      form += std::string("\\") + c;
  const std::regex whole(form + "(/.*|[.]cpp)?");
  return std::any_of(tree.files.begin(), tree.files.end(), [&](const fs::path& file) {
    return std::regex_match(file.lexically_relative(tree.root).generic_string(), whole);
  });
}

bool has_heading(const Tree& tree, const std::string& page, const std::string& heading) {
  std::ifstream in(tree.root / page);
  for (std::string line; std::getline(in, line);)
    if ((line.rfind('#', 0) == 0 && line.find(heading) != std::string::npos) ||
        line.rfind("**" + heading, 0) == 0)  // of a paragraph
      return true;
  return false;
}

std::vector<std::string> faults(const Tree& tree) {
  static const std::regex path(
      R"(\b((?:apps|bench|bindings|cmake|docs|examples|fuzz|include|scripts|src|tests|viewer)/[\w./*-]*[\w*]))");
  static const std::regex file(R"((^|[\s(`"])(\w[\w-]*\.(?:hpp|cpp|cuh|cu|md|py|sh)))"
                               R"((?=[\s)`",;:]|\.\s|\.$|$))");
  static const std::regex section(R"re((docs/\w+\.md), "([^"]+)")re");
  std::vector<std::string> found;
  for (const fs::path& source : tree.files) {
    const std::string extension = source.extension().string();
    const bool page = extension == ".md";
    const bool code =
        extension == ".hpp" || extension == ".cpp" || extension == ".cu" || extension == ".cuh";
    const std::string name = source.lexically_relative(tree.root).generic_string();
    if ((!page && !code) || name == "tests/reference/mentions_test.cpp" ||
        name == "tests/reference/layers_test.cpp" || name == "CHANGELOG.md")
      continue;
    const std::string text = page ? joined(text_of(source)) : comments_of(text_of(source));
    const auto each = [&](const std::regex& form, const auto& body) {
      for (auto i = std::sregex_iterator(text.begin(), text.end(), form);
           i != std::sregex_iterator(); ++i)
        body(*i);
    };
    each(path, [&](const std::smatch& m) {
      if (m.prefix().str().size() >= 6 &&
          m.prefix().str().substr(m.prefix().length() - 6) == "build/")
        return;  // made by a build
      if (!is_there(tree, m[1]) && m[1].str().find("NAME") == std::string::npos)
        found.push_back(name + " names " + m[1].str());
    });
    if (code)
      each(file, [&](const std::smatch& m) {
        if (tree.names.count(m[2]) == 0) found.push_back(name + " names " + m[2].str());
      });
    each(section, [&](const std::smatch& m) {
      if (!has_heading(tree, m[1], m[2]))
        found.push_back(name + " names " + m[1].str() + ", \"" + m[2].str() + "\"");
    });
  }
  return found;
}

TEST(Mentions, FilesAndHeadingsThatTextNamesAreThere) {
  const Tree tree(CULLHULL_ROOT);
  ASSERT_GT(tree.files.size(), 300U);
  EXPECT_EQ(faults(tree), std::vector<std::string>());
}

TEST(Mentions, PlantedFaultsAreFound) {
  const fs::path root = fs::path(::testing::TempDir()) / "cullhull_mentions";
  fs::remove_all(root);
  fs::create_directories(root / "src");
  fs::create_directories(root / "docs");
  std::ofstream(root / "docs/a.md") << "# A page\n## Cached planes\nsrc/a.cpp and `src/b*`, src.\n";
  std::ofstream(root / "src/a.cpp") << "// see a.md and docs/a.md, \"Cached\n// planes\"\nint a;\n";
  EXPECT_EQ(faults(Tree(root)), (std::vector<std::string>{"docs/a.md names src/b*"}));
  std::ofstream(root / "src/b.cpp") << "// twin.cpp; docs/b.md (docs/a.md, \"Sizes\")\nint b;\n";
  EXPECT_EQ(faults(Tree(root)),
            (std::vector<std::string>{"src/b.cpp names docs/b.md", "src/b.cpp names twin.cpp",
                                      "src/b.cpp names docs/a.md, \"Sizes\""}));
  fs::remove_all(root);
}

}  // namespace mentions_test
