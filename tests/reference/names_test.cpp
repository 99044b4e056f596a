// One name, one entity: no two files define a type, inline function or inline variable of the same
// name in the same namespace. The linker keeps one copy of what both define, whichever it was.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

namespace names_test {

namespace fs = std::filesystem;

bool in_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// The end of the literal that starts at `i`: of text, raw text or a character.
std::size_t end_of_literal(const std::string& code, std::size_t i) {
  if (code[i] == '"' && i > 0 && code[i - 1] == 'R') {
    const std::size_t open = code.find('(', i);
    const std::string close = ")" + code.substr(i + 1, open - i - 1) + "\"";
    const std::size_t end = code.find(close, open);
    return end == std::string::npos ? code.size() : end + close.size();
  }
  const char quote = code[i];
  for (++i; i < code.size() && code[i] != quote; ++i)
    if (code[i] == '\\') ++i;
  return std::min(i + 1, code.size());
}

/// The end of the preprocessor's line that starts at `i`, with the lines that continue it.
std::size_t end_of_directive(const std::string& code, std::size_t i) {
  while (i < code.size() && code[i] != '\n') i += code[i] == '\\' ? 2 : 1;
  return std::min(i, code.size());
}

/// The code without comments, literals and what is for the preprocessor.
std::string bare(const std::string& code) {
  std::string out;
  bool line_starts = true;
  for (std::size_t i = 0; i < code.size();) {
    const char c = code[i];
    if (c == '/' && code.compare(i, 2, "//") == 0) {
      i = std::min(code.find('\n', i), code.size());
    } else if (c == '/' && code.compare(i, 2, "/*") == 0) {
      i = std::min(code.find("*/", i), code.size() - 2) + 2;
    } else if (c == '#' && line_starts) {
      i = end_of_directive(code, i);
    } else if (c == '"' || (c == '\'' && (i == 0 || !in_word(code[i - 1])))) {
      i = end_of_literal(code, i);
      out += "\"\"";
    } else {
      out += c;
      ++i;
      line_starts = c == '\n' || (line_starts && std::isspace(static_cast<unsigned char>(c)) != 0);
    }
  }
  return out;
}

/// One space where there was any between words, none elsewhere.
std::string squeezed(const std::string& text) {
  std::string out;
  bool gap = false;
  for (const char c : text) {
    if (std::isspace(static_cast<unsigned char>(c)) != 0) {
      gap = true;
      continue;
    }
    if (gap && in_word(c) && !out.empty() && in_word(out.back())) out += ' ';
    gap = false;
    out += c;
  }
  return out;
}

/// What lies between the bracket at `i` and its match, and the place behind that.
std::pair<std::string, std::size_t> bracketed(const std::string& text, std::size_t i) {
  const std::size_t first = i + 1;
  int depth = 0;
  for (; i < text.size(); ++i) {
    const bool arrow = text[i] == '>' && i > 0 && text[i - 1] == '-';
    if (std::string("(<[{").find(text[i]) != std::string::npos) ++depth;
    if (!arrow && std::string(")>]}").find(text[i]) != std::string::npos && --depth == 0)
      return {text.substr(first, i - first), i + 1};
  }
  return {text.substr(first), text.size()};
}

std::vector<std::string> at_commas(const std::string& list) {
  std::vector<std::string> parts(1);
  int depth = 0;
  for (const char c : list) {
    if (std::string("(<[{").find(c) != std::string::npos) ++depth;
    if (std::string(")>]}").find(c) != std::string::npos) --depth;
    if (c == ',' && depth == 0)
      parts.emplace_back();
    else
      parts.back() += c;
  }
  return parts;
}

/// A parameter without its default and its name.
std::string type_of(const std::string& parameter) {
  static const std::regex named(
      R"((.*[^:])\b(?!(?:const|unsigned|int|char|long|bool|double)\b)\w+((?:\[.*\])?))");
  static const std::set<std::string> incomplete{"const", "typename", "class", "struct", ""};
  const std::string text = squeezed(parameter.substr(0, parameter.find('=')));
  std::smatch match;
  if (!std::regex_match(text, match, named)) return text;
  const std::string type = squeezed(match[1]);
  return incomplete.count(type) > 0 ? text : type + match[2].str();
}

/// Takes `template <...>` off the front; parameters are numbered in `names`, their kinds returned.
std::string take_template(std::string& head, std::vector<std::string>& names) {
  std::string kinds;
  while (head.rfind("template<", 0) == 0) {
    const auto [list, end] = bracketed(head, 8);
    kinds += "template<";
    for (const std::string& parameter : at_commas(list)) {
      const std::string text = squeezed(parameter.substr(0, parameter.find('=')));
      const std::string kind = text.find_first_of(" .") == std::string::npos ? text : type_of(text);
      kinds += (kind == text ? kind : text.substr(0, kind.size())) + ",";
      names.push_back(text.substr(text.find_last_of(" .>") + 1));
    }
    kinds += ">";
    head = squeezed(head.substr(end));
  }
  return kinds;
}

/// One file's definitions at namespace scope that other files can see.
class Definitions {
 public:
  explicit Definitions(const std::string& code) {
    std::string head;
    for (const char c : bare(code)) {
      if (c == '{') {
        open(squeezed(head));
      } else if (c == '}') {
        if (!scopes_.empty()) scopes_.pop_back();
      } else if (c == ';') {
        if (visible()) keep_declaration(squeezed(head));
      } else {
        head += c;
        continue;
      }
      head.clear();
    }
  }

  const std::set<std::string>& names() const { return names_; }

 private:
  bool visible() const { return std::count(scopes_.begin(), scopes_.end(), "") == 0; }
  void keep(const std::string& what, const std::string& name) {
    std::string all = what + " ";
    for (const std::string& scope : scopes_) all += scope;
    names_.insert(all + name);
  }

  /// A brace opens behind `head`.
  void open(const std::string& head) {
    static const std::regex space(R"((?:.*\b)?namespace ?((?:inline |[\w:])*))");
    std::smatch match;
    if (std::regex_match(head, match, space)) {
      static const std::regex transparent(R"(\binline )");
      const std::string name = std::regex_replace(match[1].str(), transparent, "");
      scopes_.push_back(name.empty() ? name : name + "::");
      return;
    }
    if (visible()) keep_definition(head);
    scopes_.emplace_back();
  }

  void keep_definition(std::string head) {
    static const std::regex type(R"((?:.*\b)?(?:class|struct|union|enum) ?(?:alignas\([^)]*\))?)"
                                 R"((\w+(?:::\w+)*(?:<.*>)?)(?: final)?(?::[^:].*)?)");
    std::vector<std::string> parameters;
    const std::string whole = head, kinds = take_template(head, parameters);
    std::smatch match;
    if (std::regex_match(head, match, type))
      keep("type", match[1]);
    else if (head.find('(') != std::string::npos)
      keep_function(head, kinds, parameters);
    else
      keep_declaration(whole);
  }

  /// Of functions that several files may define: those of others the linker refuses.
  void keep_function(std::string head, const std::string& kinds,
                     const std::vector<std::string>& parameters) {
    static const std::regex many(R"(\b(inline|constexpr|consteval|\w+_INLINE|CULLHULL_MATH)\b)");
    if (kinds.empty() && !std::regex_search(head, many)) return;
    if (head.rfind("static ", 0) == 0 || head.find("friend ") != std::string::npos) return;
    static const std::regex specifier(R"(\b(decltype|__launch_bounds__|requires)\([^()]*\))");
    static const std::regex called(R"((operator[^\w(]+|operator\(\)|[\w:~]+)\()");
    head = std::regex_replace(head, specifier, " ");
    std::smatch match;
    if (!std::regex_search(head, match, called)) return;
    const auto [list, end] =
        bracketed(head, static_cast<std::size_t>(match.position() + match.length()) - 1);
    std::string signature = match[1].str() + "(";
    for (const std::string& p : at_commas(list))
      signature += (signature.back() == '(' ? "" : ", ") + type_of(p);
    signature += head.compare(end, 5, "const") == 0 ? ") const" : ")";
    for (std::size_t i = 0; i < parameters.size(); ++i)
      if (!parameters[i].empty())
        signature = std::regex_replace(signature, std::regex("\\b" + parameters[i] + "\\b"),
                                       "$$" + std::to_string(i));
    keep("function", kinds + signature);
  }

  /// What ends without a body, or whose value begins: an alias, an inline variable.
  void keep_declaration(std::string head) {
    static const std::regex alias(R"(using (\w+)=.*)");
    static const std::regex variable(R"(inline [\w:<>, *]*?(\w+)(\[.*\])?(=.*)?)");
    std::vector<std::string> parameters;
    take_template(head, parameters);
    std::smatch match;
    if (std::regex_match(head, match, alias))
      keep("type", match[1]);
    else if (std::regex_match(head, match, variable))
      keep("variable", match[1]);
  }

  std::vector<std::string> scopes_;  ///< namespaces, with `::` behind; empty: nothing is visible
  std::set<std::string> names_;
};

/// Implements other sources' declarations where these are not compiled.
const std::string alternative = "not_compiled.cpp";

/// What each file below `root` defines, with the files.
std::map<std::string, std::vector<std::string>> definitions_below(const fs::path& root) {
  static const std::set<std::string> kinds{".cpp", ".hpp", ".cu", ".cuh"};
  std::map<std::string, std::vector<std::string>> places;
  for (const char* part : {"src", "include", "viewer", "apps", "bench/suites", "bindings"}) {
    if (!fs::exists(root / part)) continue;
    for (const auto& entry : fs::recursive_directory_iterator(root / part)) {
      if (kinds.count(entry.path().extension().string()) == 0) continue;
      if (entry.path().filename() == alternative) continue;
      std::ifstream in(entry.path());
      const Definitions found(std::string{std::istreambuf_iterator<char>(in), {}});
      for (const std::string& name : found.names())
        places[name].push_back(entry.path().lexically_relative(root).generic_string());
    }
  }
  return places;
}

/// What two of them define, one line each.
std::vector<std::string> defined_twice(const fs::path& root) {
  std::vector<std::string> twice;
  for (auto& [name, files] : definitions_below(root)) {
    if (files.size() < 2) continue;
    std::vector<std::string> sorted = files;
    std::sort(sorted.begin(), sorted.end());
    std::string line = name + ":";
    for (const std::string& file : sorted) line += " " + file;
    twice.push_back(line);
  }
  return twice;
}

TEST(Names, NoTwoFilesDefineOne) {
  const fs::path root = CULLHULL_ROOT;
  EXPECT_EQ(defined_twice(root), std::vector<std::string>());
  // The scanner sees what is there.
  const auto all = definitions_below(root);
  EXPECT_GT(all.size(), 700U);
  for (const char* known :
       {"type cullhull::Hull", "type cullhull::Lists", "type cullhull::HullQuery::State",
        "function cullhull::internal::chunk_count(std::uint64_t, std::uint64_t)"})
    EXPECT_EQ(all.count(known), 1U) << known;
}

TEST(Names, PlantedPairsAreFound) {
  const fs::path root = fs::path(::testing::TempDir()) / "cullhull_names";
  fs::remove_all(root);
  const auto plant = [&](const char* name, const std::string& text) {
    fs::create_directories((root / name).parent_path());
    std::ofstream(root / name) << text;
  };
  const std::string types =
      "#define WORDS struct Macro { \\\n  };\nstruct Plain { int a{1}; };\n"
      "template <class T, unsigned K = (2 > 1)>\nclass Cells final : public Plain {};\n"
      "enum class Kind : int { one };\nusing Row = int;\nstruct alignas(64) Wide { int f() { } "
      "};\n";
  // As it should be: other namespaces, unnamed ones, declarations, overloads, local types, text.
  plant("src/a/a.hpp", "namespace one {\n" + types + "}  // namespace one\n");
  plant("src/a/b.hpp", "namespace two {\n" + types + "}\n");
  plant("src/a/c.cpp", "namespace one {\nnamespace {\n" + types + "}\nstruct Plain;\n}\n");
  plant("src/a/d.hpp",
        "namespace one {\ninline int f(int a) { struct Kind {}; return a; }\n"
        "template <unsigned K> void g(int b[K]) {}\n// struct Plain {};\n"
        "inline constexpr const char* text = R\"(struct Wide {)\";\n}\n");
  plant("src/a/e.hpp",
        "namespace one {\ninline int f(double a) { return a; }\n"
        "template <class K> void g(K b) {}\nconst int words = 1'000;\n}\n");
  plant("src/a/not_compiled.cpp", "namespace one { struct Plain {}; }\n");
  EXPECT_EQ(defined_twice(root), std::vector<std::string>());
  // One name twice: of each kind of type, in sources too, and of functions whatever their
  // parameters are called.
  plant("src/b/a.cpp", "namespace one::inner {}\nnamespace one {\n" + types + "}\n");
  plant("apps/d.hpp",
        "namespace one {\ninline int f(int other) { return other; }\n"
        "template <unsigned N>\nvoid g(int c[N]) {}\ninline auto text = 1;\n}\n");
  EXPECT_EQ(defined_twice(root),
            (std::vector<std::string>{
                "function one::f(int): apps/d.hpp src/a/d.hpp",
                "function one::template<unsigned,>g(int[$0]): apps/d.hpp src/a/d.hpp",
                "type one::Cells: src/a/a.hpp src/b/a.cpp",
                "type one::Kind: src/a/a.hpp src/b/a.cpp",
                "type one::Plain: src/a/a.hpp src/b/a.cpp",
                "type one::Row: src/a/a.hpp src/b/a.cpp",
                "type one::Wide: src/a/a.hpp src/b/a.cpp",
                "variable one::text: apps/d.hpp src/a/d.hpp",
            }));
  fs::remove_all(root);
}

}  // namespace names_test
