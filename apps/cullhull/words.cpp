#include "words.hpp"

#include <algorithm>
#include <filesystem>
#include <numeric>
#include <utility>

#include "parallel/paths.hpp"

namespace app {
namespace {

/// Whether it is a file, or a name that looks like one.
bool looks_like_a_file(const std::string& word) {
  std::error_code ignored;
  return word == "-" || word.find('.') != std::string::npos ||
         word.find_first_of(cullhull::internal::separators) != std::string::npos ||
         std::filesystem::exists(cullhull::internal::native_path(word), ignored);
}

/// The Levenshtein distance (1966).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i + 1;
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j] + 1, row[j + 1] + 1});
    }
  }
  return row.back();
}

/// What users of other programs may look for, and the names here.
constexpr std::pair<std::string_view, std::string_view> other_words[] = {
    {"convex-hull", "hull"},
    {"convexhull", "hull"},
    {"convex", "hull"},
    {"area", "hull"},
    {"volume", "hull"},
    {"filter", "cull"},
    {"triangulate", "delaunay"},
    {"tin", "delaunay"},
    {"concave", "alpha"},
    {"concave-hull", "alpha"},
    {"alpha-shape", "alpha"},
    {"alphashape", "alpha"},
    {"verify", "certify"},
    {"check", "certify"},
    {"describe", "info"},
    {"show", "view"},
    {"plot", "view"},
    {"group", "hull"},
    {"--group", "--by"},
    {"--group-by", "--by"},
    {"--groupby", "--by"},
    {"--verify", "--certify"},
    {"--check", "--certify"},
    {"--fields", "--columns"},
    {"--output-format", "--output"},
    {"--radius", "--alpha"},
    {"--jobs", "--threads"},
    {"--polygon", "--clip"},
    {"--mask", "--clip"},
    {"--silent", "--quiet"},
    {"--constraints", "--edges"}};

}  // namespace

bool is_command(const Parser& parser, const std::string& word) {
  const auto names = parser.command_names();
  return std::find(names.begin(), names.end(), word) != names.end();
}

std::vector<std::string> spell_out(const std::vector<std::string>& given, const Parser& parser) {
  std::vector<std::string> words = given;
  // The parser would take the word after `--json` as its value.
  for (std::string& word : words) {
    if (word == "--") break;
    if (word == "--json") word = "--json=-";
  }
  if (words.empty()) return words;
  if (words[0] == "help") {
    words.erase(words.begin());
    words.emplace_back("--help");
  } else if (!is_command(parser, words[0]) && (words[0] == "-" || words[0][0] != '-') &&
             looks_like_a_file(words[0]) && is_command(parser, "hull")) {
    words.insert(words.begin(), "hull");
  }
  return words;
}

std::string second_output(const std::vector<std::string>& words) {
  const auto is_name = [&](std::size_t i) {
    return i < words.size() && !words[i].empty() && (words[i][0] != '-' || words[i] == "-");
  };
  if (!is_name(1)) return "";
  for (std::size_t i = 2; i < words.size() && words[i] != "--"; ++i) {
    const bool apart = words[i] == "-o" || words[i] == "--output";
    const bool together =
        words[i].starts_with("--output=") || (words[i].starts_with("-o") && words[i].size() > 2);
    if ((!apart && !together) || (apart && !is_name(i + 1))) continue;
    const std::size_t next = i + (apart ? 2 : 1);
    if (!is_name(next)) continue;
    return "'" + words[next] + "' after " + words[i] + (apart ? " " + words[i + 1] : "") +
           ": each output needs an -o of its own, and inputs stand together (see " + "cullhull " +
           words[0] + " --help)";
  }
  return "";
}

std::string nearest(std::string_view word, const std::vector<std::string>& known) {
  const auto is_known = [&](std::string_view name) {
    return std::find(known.begin(), known.end(), name) != known.end();
  };
  for (const auto& [other, name] : other_words)
    if (word == other && is_known(name)) return std::string(name);
  std::string best;
  const std::size_t dashes = std::min(word.find_first_not_of('-'), word.size());
  const std::size_t letters = word.size() - dashes;
  if (letters < 3) return best;
  // Words at a greater distance are different words.
  std::size_t least = std::min<std::size_t>(letters / 3 + 1, 2);
  for (const std::string& name : known) {
    const bool begun = word.size() >= 4 && name.starts_with(word);
    const std::size_t distance = begun ? 0 : edit_distance(word, name);
    if (distance > least || (distance == least && !best.empty())) continue;
    least = distance;
    best = name;
  }
  return best;
}

std::string unknown_command(const std::string& word, const Parser& parser) {
  if (word == "bench" && parser.full_name() == "cullhull")
    return "unknown command 'bench'; it is now the program cullhull-bench (make bench)";
  const std::string meant = nearest(word, parser.command_names());
  return "unknown command '" + word + "'" + (meant.empty() ? "" : "; did you mean " + meant + "?") +
         " (see " + parser.full_name() + " --help)";
}

std::string unknown_topic(const std::string& word, const std::vector<std::string>& known,
                          const Parser& parser) {
  const std::string meant = nearest(word, known);
  return "no command or topic '" + word + "'" +
         (meant.empty() ? "" : "; did you mean " + meant + "?") + " (see " + parser.full_name() +
         " --help)";
}

std::string unexpected_words(const std::vector<std::string>& words, const Parser& command) {
  const std::vector<std::string> names = command.option_names();
  for (const std::string& word : words) {
    if (word == "--") break;
    if (word.size() < 2 || word[0] != '-') continue;
    const std::string name = word.substr(0, word.find('='));
    const bool known =
        std::find(names.begin(), names.end(), name) != names.end() ||
        (name[1] != '-' && std::find(names.begin(), names.end(), name.substr(0, 2)) != names.end());
    if (known) continue;
    const std::string meant = nearest(name, names);
    return "unknown option " + name + (meant.empty() ? "" : "; did you mean " + meant + "?");
  }
  std::string list;
  for (const std::string& word : command.remaining()) list += " '" + word + "'";
  return "unexpected words:" + list;
}

std::string without_foreign_options(const std::string& message, const Parser& command) {
  const std::vector<std::string> known = command.option_names();
  const auto names_foreign = [&](std::string_view clause) {
    for (std::size_t at = 0; (at = clause.find("--", at)) != std::string_view::npos;) {
      const std::size_t end = clause.find_first_not_of("abcdefghijklmnopqrstuvwxyz-", at);
      const std::string_view option = clause.substr(at, end - at);
      const bool alone = at == 0 || clause[at - 1] == ' ' || clause[at - 1] == '(';
      if (alone && option.size() > 2 &&
          std::find(known.begin(), known.end(), option) == known.end())
        return true;
      at += option.size();
    }
    return false;
  };
  // The first part says what is wrong; the others are advice.
  std::string kept;
  for (std::size_t begin = 0; begin < message.size();) {
    const std::size_t end =
        std::min({message.size(), message.find("; ", begin + 1), message.find(", or ", begin + 1)});
    const std::string clause = message.substr(begin, end - begin);
    if (begin == 0 || !names_foreign(clause)) kept += clause;
    begin = end;
  }
  return kept;
}

std::string with_arguments_cut(std::string message, const std::vector<std::string>& arguments) {
  constexpr std::size_t most = 200, head = 120, tail = 60;
  const auto cut = [&](const std::string& text) {
    if (text.size() <= most) return;
    const std::string shorter = text.substr(0, head) + "..." + text.substr(text.size() - tail);
    for (std::size_t at = 0; (at = message.find(text, at)) != std::string::npos;
         at += shorter.size())
      message.replace(at, text.size(), shorter);
  };
  for (const std::string& word : arguments) {
    std::string plain = word;  // as the library repeats it, on one line
    for (char& c : plain)
      if (static_cast<unsigned char>(c) < ' ' || c == 127) c = '?';
    for (const std::string& text : {word, plain}) {
      cut(text);
      if (const auto equals = text.find('='); equals != std::string::npos) {
        cut(text.substr(equals + 1));
        cut(text.substr(0, equals));
      }
    }
  }
  return message;
}

}  // namespace app
