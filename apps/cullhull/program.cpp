#include "program.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "arguments.hpp"
#include "commands.hpp"
#include "cullhull/error.hpp"
#include "cullhull/version.hpp"
#include "licenses.hpp"
#include "signals.hpp"
#include "system.hpp"
#include "terminal.hpp"
#include "words.hpp"
#include "wrap.hpp"

namespace app {
namespace {

int exit_status(cullhull::ErrorCode code) {
  switch (code) {
    case cullhull::ErrorCode::invalid_argument:
      return bad_usage;
    case cullhull::ErrorCode::not_finite:
    case cullhull::ErrorCode::bad_file:
    case cullhull::ErrorCode::io:
      return bad_input;
    case cullhull::ErrorCode::out_of_budget:
      return over_budget;
    case cullhull::ErrorCode::backend_unavailable:
      return no_backend;
    case cullhull::ErrorCode::cancelled:
      return cancelled;
    case cullhull::ErrorCode::not_exact:
    case cullhull::ErrorCode::internal:
      return not_certified;
  }
  return bad_input;
}

/// Adds the budget as it was given, since the library's message has it in MiB.
std::string with_memory(std::string message, const std::vector<std::string>& words) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i].starts_with("--memory=")) return message + " (" + words[i] + ")";
    if (words[i] == "--memory" && i + 1 < words.size())
      return message + " (--memory " + words[i + 1] + ")";
  }
  return message;
}

/// Names the option that leaves out points with a NaN, which all commands have that read points but
/// for the one that takes Qhull's words.
std::string with_skip_nan(std::string message, const std::vector<std::string>& words) {
  constexpr std::string_view advice = " is NaN; remove or repair such points first";
  const std::size_t at = message.find(advice);
  if (at == std::string::npos || (!words.empty() && words[0] == "qconvex")) return message;
  return message.replace(at, advice.size(), " is NaN; --skip-nan leaves such points out");
}

/// Explains a file that is not there where the words before it make it one by mistake: `--json
/// FILE` and `--columns x y`.
std::string with_hint(std::string message, const std::vector<std::string>& words) {
  for (std::size_t i = 1; i < words.size(); ++i) {
    if (!message.starts_with(words[i] + ": cannot open")) continue;
    if (words[i - 1] == "--json") return message + " (--json=" + words[i] + " writes it)";
    if (i > 1 && words[i - 2] == "--columns")
      return message + " (--columns " + words[i - 1] + "," + words[i] + " takes both columns)";
  }
  return message;
}

/// "MESSAGE (see cullhull hull --help)" for words that the parser did not accept. `given`: the
/// command line after spell_out().
std::string usage_line(const Parsed& outcome, const std::vector<std::string>& given,
                       const std::vector<std::string>& words, const Parser& parser) {
  const Parser& command = parser.innermost();
  std::string why = outcome.text;
  if (outcome.kind == Parsed::Kind::unexpected && !words.empty())
    why = unexpected_words({words.begin() + 1, words.end()}, command);
  return with_arguments_cut(why + " (see " + command.full_name() + " --help)", given);
}

/// How the program ends.
struct Ending {
  int status = 0;
  std::string line;
};

/// To be called in a catch block; `words`: the command line.
Ending ending_of_exception(const std::vector<std::string>& words) {
  try {
    throw;
  } catch (const cullhull::Error& e) {
    std::string message = e.what();
    if (e.code() == cullhull::ErrorCode::out_of_budget)
      message = with_memory(std::move(message), words);
    if (e.code() == cullhull::ErrorCode::not_finite)
      message = with_skip_nan(std::move(message), words);
    if (e.code() == cullhull::ErrorCode::io) message = with_hint(std::move(message), words);
    return {exit_status(e.code()), with_arguments_cut(std::move(message), words)};
  } catch (const std::bad_alloc&) {
    return {over_budget, out_of_memory};
  } catch (const std::exception& e) {
    return {bad_input, with_arguments_cut(e.what(), words)};
  }
}

std::string footer_of(const Program& program) {
  std::string text = program.topics.empty() ? "" : "Topics:\n";
  for (const Topic& topic : program.topics)
    text += fmt::format("  {:<26}  {}\n", topic.name, topic.about);
  return text + (text.empty() ? "" : "\n") + program.footer;
}

/// `help TOPIC`, or a mistyped one; nothing for other command lines.
std::optional<int> show_topic(const Program& program, const std::vector<std::string>& words,
                              const Parser& parser) {
  if (program.topics.empty() || words.size() < 2 || words[0] != "help" || words[1].empty() ||
      words[1][0] == '-' || is_command(parser, words[1]))
    return std::nullopt;
  std::vector<std::string> known = parser.command_names();
  for (const Topic& topic : program.topics) {
    if (words[1] == topic.name && words.size() == 2) {
      write_stdout(for_terminal(std::string(topic.text) + '\n'));
      return 0;
    }
    known.emplace_back(topic.name);
  }
  complain(with_arguments_cut(unknown_topic(words[1], known, parser), words));
  return bad_usage;
}

/// An error then advises only what the command takes.
int run_command(const Parser& command, const Command& work) {
  const std::vector<std::string> options = command.option_names();
  columns_can_be_chosen = std::find(options.begin(), options.end(), "--columns") != options.end();
  try {
    return work();
  } catch (const cullhull::Error& e) {
    throw cullhull::Error(e.code(), without_foreign_options(e.what(), command));
  }
}

int run(const Program& program, const std::vector<std::string>& given) {
  Parser parser(program.name, program.description);
  parser.set_version(CULLHULL_VERSION);
  parser.set_licenses(licenses);
  parser.footer(footer_of(program));
  parser.require_subcommand(1, 1);
  std::vector<std::pair<const Parser*, Command>> commands;
  for (const auto add : program.commands) {
    Command command = add(parser);
    commands.emplace_back(parser.last_subcommand(), std::move(command));
  }
  if (const auto shown = show_topic(program, given, parser)) return *shown;
  const std::vector<std::string> words =
      given.empty() ? std::vector<std::string>{"--help"} : spell_out(given, parser);
  if (!words.empty() && !words[0].empty() && words[0][0] != '-' && !is_command(parser, words[0])) {
    complain(with_arguments_cut(unknown_command(words[0], parser), given));
    return bad_usage;
  }
  if (const std::string second = second_output(words); !second.empty()) {
    complain(with_arguments_cut(second, given));
    return bad_usage;
  }
  const Parsed outcome = parser.parse(words);
  if (outcome.kind == Parsed::Kind::help) {
    const std::string text = outcome.text.ends_with('\n') ? outcome.text : outcome.text + '\n';
    write_stdout(text.find("\nUsage: ") == std::string::npos ? text : for_terminal(text));
    return 0;
  }
  if (outcome.kind != Parsed::Kind::command) {
    complain(usage_line(outcome, given, words, parser));
    return bad_usage;
  }
  for (const auto& [command, work] : commands)
    if (command->parsed()) return run_command(*command, work);
  return bad_usage;
}

}  // namespace

int run_program(const Program& program, int argc, char** argv) {
  system::prepare_process();
  keep_standard_streams();
  const std::vector<std::string> words = system::arguments(argc, argv);
  try {
    install_signals();
    return run(program, words);
  } catch (...) {
    const Ending ending = ending_of_exception(words);
    complain(ending.line);
    return ending.status;
  }
}

}  // namespace app
