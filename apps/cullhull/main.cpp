// cullhull: exact convex hulls of very large point sets.
#include <string>
#include <utility>
#include <vector>

#include "commands.hpp"
#include "cullhull/version.hpp"
#include "endings.hpp"
#include "signals.hpp"
#include "system.hpp"
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
    "  cullhull delaunay disk.npy -o mesh.ply           the Delaunay triangulation\n"
    "  cullhull info ball.npy                           what is in a file\n"
    "\n"
    "Exit status: 0 success; 1 bad input or the system refused; 2 bad usage; 3 not certified;\n"
    "4 out of the memory budget; 5 backend or engine not available; 130 cancelled.\n"
    "Errors are one line on standard error. 'cullhull help COMMAND' tells more.";

int run(const std::vector<std::string>& given) {
  app::Parser parser("cullhull", description);
  parser.set_version(CULLHULL_VERSION);
  parser.footer(footer);
  parser.require_subcommand(1, 1);
  std::vector<std::pair<const app::Parser*, app::Command>> commands;
  for (const auto add : {app::add_hull, app::add_cull, app::add_track, app::add_delaunay,
                         app::add_voronoi, app::add_alpha, app::add_certify, app::add_generate,
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
    app::complain(app::usage_line(outcome, given, words, parser));
    return app::bad_usage;
  }
  for (const auto& [command, work] : commands)
    if (command->parsed()) return work();
  return app::bad_usage;
}

}  // namespace

int main(int argc, char** argv) {
  app::system::prepare_heap();
  app::keep_standard_streams();
  const std::vector<std::string> words(argv + 1, argv + argc);
  try {
    app::install_signals();
    return run(words);
  } catch (...) {
    const app::Ending ending = app::ending_of_exception(words);
    app::complain(ending.line);
    return ending.status;
  }
}
