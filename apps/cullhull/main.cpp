// cullhull: exact convex hulls of very large point sets.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <new>
#include <sstream>
#include <string>
#include <vector>

#include "commands.hpp"
#include "cullhull/error.hpp"
#include "cullhull/version.hpp"
#include "signals.hpp"
#include "terminal.hpp"

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
    "  cullhull track frames.npy --json                 hulls of moving points, frame by frame\n"
    "  cullhull info ball.npy                           what is in a file\n"
    "\n"
    "Exit status: 0 success; 1 bad input or the system refused; 2 bad usage; 3 not certified;\n"
    "4 out of the memory budget; 5 backend or engine not available; 130 cancelled.\n"
    "Errors are one line on standard error. 'cullhull COMMAND --help' tells more.";

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

// `--json` may stand alone or carry a file after '='. The parser would take the next word for the
// file, so the bare form is spelled out before it looks.
std::vector<std::string> spell_out(int argc, char** argv) {
  std::vector<std::string> words(argv + 1, argv + argc);
  for (std::string& word : words) {
    if (word == "--") break;
    if (word == "--json") word = "--json=-";
  }
  return words;
}

bool is_command(const CLI::App& parser, const std::string& word) {
  const auto known = parser.get_subcommands([](const CLI::App*) { return true; });
  return std::any_of(known.begin(), known.end(),
                     [&](const CLI::App* command) { return command->get_name() == word; });
}

struct Registered {
  CLI::App* parser;
  app::Command command;
};

int run(int argc, char** argv) {
  CLI::App parser(description, "cullhull");
  parser.set_version_flag("--version", CULLHULL_VERSION);
  parser.footer(footer);
  parser.require_subcommand(1);
  std::vector<Registered> commands;
  for (const auto add : {app::add_hull, app::add_cull, app::add_track, app::add_certify,
                         app::add_generate, app::add_info, app::add_view, app::add_bench}) {
    app::Command command = add(parser);
    commands.push_back({parser.get_subcommands({}).back(), std::move(command)});
  }
  auto words = spell_out(argc, argv);
  const bool command_given = !words.empty() && is_command(parser, words[0]);
  if (!command_given && !words.empty() && !words[0].empty() && words[0][0] != '-') {
    app::complain("unknown command '" + words[0] + "' (see cullhull --help)");
    return app::bad_usage;
  }
  const std::string help = command_given ? "cullhull " + words[0] + " --help" : "cullhull --help";
  try {
    std::reverse(words.begin(), words.end());  // the parser takes words from the back
    parser.parse(std::move(words));
  } catch (const CLI::ParseError& e) {
    if (e.get_exit_code() != static_cast<int>(CLI::ExitCodes::Success)) {
      app::complain(std::string(e.what()) + " (see " + help + ")");
      return app::bad_usage;
    }
    std::ostringstream text, unused;
    parser.exit(e, text, unused);  // help or version
    std::string shown = text.str();
    if (!shown.ends_with('\n')) shown += '\n';
    app::write_stdout(shown);
    return 0;
  }
  for (const Registered& registered : commands)
    if (registered.parser->parsed()) return registered.command();
  return app::bad_usage;
}

}  // namespace

int main(int argc, char** argv) {
  app::keep_standard_streams();
  try {
    app::install_signals();
    return run(argc, argv);
  } catch (const cullhull::Error& e) {
    app::complain(e.what());
    return exit_status(e.code());
  } catch (const std::bad_alloc&) {
    app::complain(app::out_of_memory);
    return app::over_budget;
  } catch (const std::exception& e) {
    app::complain(e.what());
    return app::bad_input;
  }
}
