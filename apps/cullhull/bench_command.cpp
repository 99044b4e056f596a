// cullhull bench: measurements of this machine, and of the library on it.
#include "bench_command.hpp"

#include <utility>
#include <vector>

#include "cullhull/error.hpp"

namespace app {

Command add_bench(Parser& parent) {
  Parser& command = *parent.add_subcommand(
      "bench",
      "Measurements: this machine, the paper, rivals, single calls, triangulations,"
      " streams");
  command.require_subcommand(0, 1);
  command.footer(
      "'cullhull bench SUITE --help' tells more.\n"
      "\n"
      "Exit status: 0 success; 1 the system refused; 2 bad usage; 130 cancelled.");
  std::vector<std::pair<const Parser*, Command>> suites;
  for (const auto add : {add_bench_machine, add_bench_paper, add_bench_rivals, add_bench_calls,
                         add_bench_lifting, add_bench_stream}) {
    Command suite = add(command);
    suites.emplace_back(command.last_subcommand(), std::move(suite));
  }
  return [suites = std::move(suites)]() -> int {
    for (const auto& [parser, run] : suites)
      if (parser->parsed()) return run();
    throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                          "bench: which suite? (see cullhull bench --help)");
  };
}

}  // namespace app
