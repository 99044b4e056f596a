#include "program.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <string>
#include <utility>

#include "arguments.hpp"
#include "cullhull/error.hpp"
#include "cullhull/version.hpp"
#include "endings.hpp"
#include "licenses.hpp"
#include "signals.hpp"
#include "system.hpp"
#include "terminal.hpp"
#include "words.hpp"
#include "wrap.hpp"

namespace app {
namespace {

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
  system::prepare_heap();
  keep_standard_streams();
  const std::vector<std::string> words(argv + 1, argv + argc);
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
