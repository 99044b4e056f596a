// How many types a user of the library can meet: fewer are easier to learn.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <string>

namespace public_types_test {

namespace fs = std::filesystem;

/// A header without comments and without what is in cullhull::internal.
std::string public_text(const fs::path& path) {
  std::ifstream in(path);
  std::string text, line;
  bool internal = false;
  while (std::getline(in, line)) {
    if (line == "namespace cullhull::internal {") internal = true;
    if (!internal) text += line.substr(0, line.find("//")) + "\n";
    if (line.starts_with("}  // namespace cullhull::internal")) internal = false;
  }
  return text;
}

/// Classes, structs and enumerations that are defined there, nested ones too.
std::set<std::string> types_in(const std::string& text) {
  static const std::regex definition(
      R"((?:^|\n)\s*(?:struct|class|enum class)\s+(?:\[\[[^\]]*\]\]\s*)?(\w+)[^;{}()]*\{)");
  std::set<std::string> found;
  for (std::sregex_iterator i(text.begin(), text.end(), definition), end; i != end; ++i)
    found.insert((*i)[1]);
  return found;
}

TEST(PublicTypes, AreCounted) {
  EXPECT_EQ(types_in("struct A {\n  enum class B : int {};\n  class C;\n  friend class D;\n};\n"),
            (std::set<std::string>{"A", "B"}));
  // Whoever needs another type takes one from elsewhere, or says in a decision what users get.
  constexpr std::size_t most = 79;
  std::set<std::string> all;
  for (const auto& entry : fs::directory_iterator(CULLHULL_HEADERS))
    if (entry.path().filename() != "stop_token.hpp")  // stands in for std::stop_token
      all.merge(types_in(public_text(entry.path())));
  EXPECT_EQ(all.count("Hull"), 1U);
  EXPECT_EQ(all.count("ArrayAllocator"), 0U) << "internal";
  std::string list;
  for (const std::string& name : all) list += " " + name;
  EXPECT_LE(all.size(), most) << list;
}

}  // namespace public_types_test
