// cullhull: exact convex hulls of very large point sets.
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "cullhull/error.hpp"
#include "cullhull/version.hpp"
#include "signals.hpp"
#include "terminal.hpp"
#include "words.hpp"

namespace {

constexpr const char* description =
    "cullhull: exact convex hulls of very large point sets, in any dimension.\n"
    "It drops the points that provably lie strictly inside the hull, then computes the hull of "
    "the\n"
    "few that are left with exact predicates. No tolerance, nothing to tune.";

constexpr const char* footer =
    "Examples:\n"
    "  cullhull generate ball -n 1M -d 3 -o ball.npy    make a million points\n"
    "  cullhull hull ball.npy -o hull.ply --certify     their hull, checked, as a mesh\n"
    "  cullhull ball.npy                                the same as cullhull hull ball.npy\n"
    "  cullhull track frames.npy --json                 hulls of moving points, frame by frame\n"
    "  cullhull info ball.npy                           what is in a file\n"
    "\n"
    "Exit status: 0 success; 1 bad input or the system refused; 2 bad usage; 3 not certified;\n"
    "4 out of the memory budget; 5 backend or engine not available; 130 cancelled.\n"
    "Errors are one line on standard error. 'cullhull help COMMAND' tells more.";

int exit_status(cullhull::ErrorCode code) {
  switch (code) {
    case cullhull::ErrorCode::invalid_argument:
      return app::bad_usage;
    case cullhull::ErrorCode::not_finite:
    case cullhull::ErrorCode::bad_file:
    case cullhull::ErrorCode::io:
      return app::bad_input;
    case cullhull::ErrorCode::out_of_budget:
      return app::over_budget;
    case cullhull::ErrorCode::backend_unavailable:
      return app::no_backend;
    case cullhull::ErrorCode::cancelled:
      return app::cancelled;
    case cullhull::ErrorCode::not_exact:
    case cullhull::ErrorCode::internal:
      return app::not_certified;
  }
  return app::bad_input;
}

/// "The words (see cullhull hull --help)" for what the parser did not understand.
void complain_of_usage(const app::Parsed& outcome, const std::vector<std::string>& given,
                       const std::vector<std::string>& words, const app::Parser& parser) {
  const app::Parser& command = parser.innermost();
  std::string why = outcome.text;
  if (outcome.kind == app::Parsed::Kind::unexpected && !words.empty())
    why = app::unexpected_words({words.begin() + 1, words.end()}, command);
  app::complain(app::with_arguments_cut(why + " (see " + command.full_name() + " --help)", given));
}

int run(const std::vector<std::string>& given) {
  app::Parser parser("cullhull", description);
  parser.set_version(CULLHULL_VERSION);
  parser.footer(footer);
  parser.require_subcommand(1, 1);
  std::vector<std::pair<const app::Parser*, app::Command>> commands;
  for (const auto add :
       {app::add_hull, app::add_cull, app::add_track, app::add_certify, app::add_generate,
        app::add_info, app::add_view, app::add_qconvex, app::add_bench}) {
    app::Command command = add(parser);
    commands.emplace_back(parser.last_subcommand(), std::move(command));
  }
  const std::vector<std::string> words = app::spell_out(given, parser);
  if (!words.empty() && !words[0].empty() && words[0][0] != '-' &&
      !app::is_command(parser, words[0])) {
    app::complain(app::with_arguments_cut(app::unknown_command(words[0], parser), given));
    return app::bad_usage;
  }
  const app::Parsed outcome = parser.parse(words);
  if (outcome.kind == app::Parsed::Kind::help) {
    app::write_stdout(outcome.text.ends_with('\n') ? outcome.text : outcome.text + '\n');
    return 0;
  }
  if (outcome.kind != app::Parsed::Kind::command) {
    complain_of_usage(outcome, given, words, parser);
    return app::bad_usage;
  }
  for (const auto& [command, work] : commands)
    if (command->parsed()) return work();
  return app::bad_usage;
}

/// The budget in the words it was given in: a message of the library has it in MiB.
std::string with_memory(std::string message, const std::vector<std::string>& words) {
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (words[i].starts_with("--memory=")) return message + " (" + words[i] + ")";
    if (words[i] == "--memory" && i + 1 < words.size())
      return message + " (--memory " + words[i + 1] + ")";
  }
  return message;
}

}  // namespace

int main(int argc, char** argv) {
  app::keep_standard_streams();
  const std::vector<std::string> words(argv + 1, argv + argc);
  try {
    app::install_signals();
    return run(words);
  } catch (const cullhull::Error& e) {
    std::string message = e.what();
    if (e.code() == cullhull::ErrorCode::out_of_budget)
      message = with_memory(std::move(message), words);
    app::complain(app::with_arguments_cut(std::move(message), words));
    return exit_status(e.code());
  } catch (const std::bad_alloc&) {
    app::complain(app::out_of_memory);
    return app::over_budget;
  } catch (const std::exception& e) {
    app::complain(app::with_arguments_cut(e.what(), words));
    return app::bad_input;
  }
}
