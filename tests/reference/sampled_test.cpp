// tests/sampled.txt names the tests that run a share of their sets, which `make test-all` has to
// run once more in full: those in whose text one of the functions of agreement/random_seeds.hpp is
// called.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>

namespace sampled_test {

namespace fs = std::filesystem;

std::string text_of(const fs::path& path) {
  std::ifstream in(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

std::set<std::string> named() {
  std::set<std::string> names;
  std::ifstream in(fs::path(CULLHULL_ROOT) / "tests/sampled.txt");
  for (std::string line; std::getline(in, line);)
    if (!line.empty() && line[0] != '#') names.insert(line);
  return names;
}

/// Suite.Test of each test in the text that calls one of the functions.
std::set<std::string> callers_in(const std::string& text) {
  static const std::regex head(R"(TEST(?:_F|_P)?\((\w+),\s*(\w+)\) \{)");
  static const std::regex call(R"(\b(?:for_random_seeds|share_of|sampled)\()");
  std::set<std::string> names;
  for (std::size_t at = text.find("\nTEST"); at != std::string::npos;
       at = text.find("\nTEST", at)) {
    const std::size_t begin = ++at;
    const std::string body = text.substr(begin, text.find("\n}", begin) - begin);
    std::smatch test;
    if (std::regex_search(body, test, head) && std::regex_search(body, call))
      names.insert(test.str(1) + "." + test.str(2));
  }
  return names;
}

TEST(Sampled, TheListIsThatOfTheSources) {
  std::set<std::string> calling;
  for (const char* folder :
       {"reference", "exactness", "agreement", "delaunay", "diagrams", "viewer"})
    for (const auto& entry : fs::directory_iterator(fs::path(CULLHULL_ROOT) / "tests" / folder))
      if (entry.path().extension() == ".cpp" && entry.path().stem() != "sampled_test")
        calling.merge(callers_in(text_of(entry.path())));
  EXPECT_EQ(calling, named());
}

TEST(Sampled, CallersAreFound) {
  const std::string text =
      "\nTEST(A, One) {\n  for_random_seeds(3, f);\n}\n\nTEST_F(A, Two) {\n  f();\n}\n"
      "\nTEST(B,\n     Three) {\n  for (auto s : sampled(sets())) f(s);\n}\n";
  EXPECT_EQ(callers_in(text), (std::set<std::string>{"A.One", "B.Three"}));
}

}  // namespace sampled_test
