// cullhull qconvex: the command line of Qhull's qconvex, for scripts that call that program.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <memory>
#include <optional>

#include "arguments.hpp"
#include "commands.hpp"
#include "cullhull/cullhull.hpp"
#include "cullhull/io.hpp"
#include "measure.hpp"
#include "outputs.hpp"
#include "terminal.hpp"

namespace app {
namespace {

using cullhull::Error;
using cullhull::ErrorCode;

constexpr const char* help =
    "Takes the words of Qhull's qconvex. Points are read from standard input, in Qhull's format "
    "or\n"
    "any other ('cullhull help formats'); results go to standard output, in the order of the "
    "words:\n"
    "  Fx i o n p f s Fa FA FC FD FF Fi FI Fn FN Fo Fs FS Ft Fv FV (docs/formats.md)\n"
    "  TI FILE   read the points from FILE           TO FILE   write the results to FILE\n"
    "  TFn       print a summary if there are n or more facets, on standard error\n"
    "  Tv        verify the result exactly           Tz        print the summary on standard "
    "output\n"
    "The summaries s and FA go to standard error; s is printed if no word asks for a result.\n"
    "Words that only tune Qhull's computation (Pp Qs Qw Qx Qz Q0 to Q14 Tc Tf C-0 Fd) are "
    "ignored,\n"
    "because there is no tolerance here. Words that ask for a different result (QJ, Qt, Qc, QG, "
    "...)\n"
    "are refused.\n"
    "\n"
    "Examples:\n"
    "  rbox 1000 D4 | cullhull qconvex Fx\n"
    "  cullhull qconvex TI points.txt TO hull.txt i n FS\n"
    "\n"
    "Exit status: 0 success; 1 bad input; 2 bad usage; 3 not certified; 4 memory limit exceeded;\n"
    "5 backend not available; 130 cancelled.";

struct QconvexArguments {
  std::vector<std::string> words;
  RunArguments run;
};

/// The parsed words.
struct Request {
  std::string input = "-", output = "-";
  std::vector<std::string> texts;
  std::optional<std::uint64_t> report_from;  ///< TFn
  bool certify = false;
  bool summary_to_stdout = false;
};

[[noreturn]] void refuse(const std::string& word, const std::string& why) {
  throw Error(ErrorCode::invalid_argument, "qconvex ", word, ": ", why);
}

/// Q0 to Q14, and other words that change how Qhull computes, but not the result.
bool is_passed_over(const std::string& word) {
  static constexpr std::string_view words[] = {"Pp", "Qs", "Qw", "Qx",  "Qz",
                                               "Tc", "Tf", "Fd", "C-0", "C0"};
  if (std::find(std::begin(words), std::end(words), word) != std::end(words)) return true;
  return word.size() >= 2 && word.size() <= 3 && word[0] == 'Q' &&
         word.find_first_not_of("0123456789", 1) == std::string::npos;
}

std::uint64_t number_behind(const std::string& word, std::size_t letters) {
  std::uint64_t value = 0;
  const char* const end = word.data() + word.size();
  const auto [at, error] = std::from_chars(word.data() + letters, end, value);
  if (error != std::errc() || at != end) refuse(word, "needs a whole number, such as TF100");
  return value;
}

/// A name with an ending: points.txt, but not.
bool names_a_file(const std::string& word) {
  const std::size_t dot = word.rfind('.');
  return dot != std::string::npos && dot + 1 < word.size() &&
         std::isalpha(static_cast<unsigned char>(word[dot + 1])) != 0;
}

Request read_words(const std::vector<std::string>& words) {
  Request request;
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string& word = words[i];
    if (word == "TI" || word == "TO") {
      if (i + 1 == words.size() || words[i + 1].empty()) refuse(word, "needs a file name after it");
      (word == "TI" ? request.input : request.output) = words[++i];
    } else if (word.starts_with("TF")) {
      request.report_from = number_behind(word, 2);
    } else if (word == "Tv") {
      request.certify = true;
    } else if (word == "Tz") {
      request.summary_to_stdout = true;
    } else if (!word.empty() && (word[0] == 'Q' || word[0] == 'C' || word[0] == 'P' ||
                                 word[0] == 'T' || word == "Fd")) {
      if (!is_passed_over(word))
        refuse(word,
               "asks Qhull for a different result or for a trace, which cullhull does not have");
    } else {
      if (names_a_file(word))
        refuse(word, "is no word of qconvex; TI " + word + " reads points from a file");
      cullhull::check_qhull_format(word);
      request.texts.push_back(word);
    }
  }
  if (request.texts.empty()) request.texts.emplace_back("s");
  return request;
}

/// The texts of a hull, without the summaries.
struct Texts {
  std::string text, summary;
};

Texts texts_of(const Request& request, const cullhull::PointView& points,
               const cullhull::Hull& hull) {
  Texts texts;
  for (const std::string& word : request.texts) {
    const bool summary = (word == "s" || word == "FA") && !request.summary_to_stdout;
    (summary ? texts.summary : texts.text) += cullhull::hull_to_qhull_text(points, hull, word);
  }
  if (request.report_from && hull.facet_count() >= *request.report_from)
    texts.summary += cullhull::hull_to_qhull_text(points, hull, "s");
  return texts;
}

int run(QconvexArguments arguments) {
  const Request request = read_words(arguments.words);
  FilePlan plan;
  plan.reads(request.input);
  if (request.output != "-") plan.writes_any("TO", request.output);
  InputArguments from;
  from.path = request.input;
  Input input = open_input(from, arguments.run.threads, arguments.run.memory_bytes());
  arguments.run.held = input.held();
  auto found = repeat(arguments.run, 1, [&](const cullhull::Options& options) {
    return naming_file(input.places, [&] { return cullhull::convex_hull(input.points, options); });
  });
  if (request.certify) {
    const auto checked = repeat(arguments.run, 1, [&](const cullhull::Options& options) {
      return cullhull::certify(input.points, found.result, options);
    });
    if (!checked.result.valid) {
      complain("not certified: " + checked.result.reason);
      return not_certified;
    }
  }
  cullhull::to_world(found.result, input.placing.grid);
  input.to_world();
  const Texts texts = texts_of(request, input.points, found.result);
  cullhull::write_text(request.output, texts.text);
  write_stderr(texts.summary);
  return 0;
}

}  // namespace

Command add_qconvex(Parser& parent) {
  auto a = std::make_shared<QconvexArguments>();
  Parser& command =
      *parent.add_subcommand("qconvex", "Drop-in replacement for Qhull's program qconvex");
  command.add_option("WORDS", a->words, "Words of qconvex, see below")->type_name("");
  a->run.add_to(command, true);
  command.footer(help);
  return [a] { return run(*a); };
}

}  // namespace app
