// cullhull certify: an independent check of a hull written earlier.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>

#include "arguments.hpp"
#include "commands.hpp"
#include "cullhull/io.hpp"
#include "measure.hpp"
#include "signals.hpp"
#include "terminal.hpp"

namespace app {
namespace {

constexpr const char* examples =
    "A valid certificate proves that the file holds the exact hull of the points: that its "
    "vertices\n"
    "are the extreme points (the lowest id of equal ones) and its facets the maximal ones, and "
    "that\n"
    "every number in it is as accurate as documented. The check uses exact predicates and none of\n"
    "the engine's code.\n"
    "\n"
    "Example:\n"
    "  cullhull hull scan.ply -o hull.json && cullhull certify scan.ply hull.json\n"
    "\n"
    "Exit status: 0 certified; 1 bad input; 2 bad usage; 3 not certified, with the reason on "
    "standard\n"
    "error; 130 cancelled.";

struct CertifyArguments {
  InputArguments input;
  RunArguments run;
  std::string hull;
};

int run(const CertifyArguments& arguments) {
  const Input input = open_input(arguments.input, arguments.run.threads);
  cullhull::Certificate certificate;
  const Stopwatch watch;
  {
    TerminalProgress progress(arguments.run.quiet);
    cullhull::Options options = arguments.run.options();
    options.progress = progress.callback();
    cancellable(
        [&] { certificate = cullhull::certify_file(input.points, arguments.hull, options); });
  }
  if (!certificate.valid) {
    complain("not certified: " + certificate.reason);
    return not_certified;
  }
  if (!arguments.run.quiet)
    write_stdout(
        fmt::format("certified  {} points, {} ridges, {} decisions by exact arithmetic, "
                    "{:.6f} seconds\n",
                    grouped(certificate.points_checked), grouped(certificate.ridges_checked),
                    grouped(certificate.exact_decisions), watch.seconds()));
  return 0;
}

}  // namespace

Command add_certify(CLI::App& parent) {
  auto a = std::make_shared<CertifyArguments>();
  CLI::App& command = *parent.add_subcommand("certify", "Check a hull against its points, exactly");
  a->input.add_to(command);
  command.add_option("HULL", a->hull, "What 'cullhull hull INPUT -o HULL.json' wrote")
      ->type_name("")
      ->required();
  a->run.add_to(command, false);
  command.footer(std::string(input_help) + "\n\n" + examples);
  return [a] { return run(*a); };
}

}  // namespace app
