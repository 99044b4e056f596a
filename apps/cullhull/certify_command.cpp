// cullhull certify: an independent check of a hull written earlier.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "arguments.hpp"
#include "commands.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/error.hpp"
#include "cullhull/io.hpp"
#include "cullhull/version.hpp"
#include "measure.hpp"
#include "outputs.hpp"
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
  std::string json;
};

std::string report(const Input& input, const cullhull::Certificate& certificate, unsigned threads,
                   double seconds) {
  const cullhull::PointView& points = input.points;
  nlohmann::ordered_json json;
  json["version"] = CULLHULL_VERSION;
  json["schema"] = cullhull::json_schema_version;
  json["points"] = {{"count", points.count},
                    {"dimension", points.dimension},
                    {"scalar", cullhull::scalar_name(points.scalar)}};
  json["threads"] = threads;
  json["certified"] = certificate.valid;
  json["reason"] =
      certificate.valid ? nlohmann::ordered_json() : nlohmann::ordered_json(certificate.reason);
  json["points_checked"] = certificate.points_checked;
  json["ridges_checked"] = certificate.ridges_checked;
  json["exact_decisions"] = certificate.exact_decisions;
  json["read_seconds"] = input.file.read_seconds();
  json["certify_seconds"] = seconds;
  json["peak_bytes"] = peak_bytes();
  // A reason may quote what the file says, whatever its bytes.
  return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + '\n';
}

int run(const CertifyArguments& arguments) {
  FilePlan plan;
  plan.reads({arguments.input.path, arguments.hull});
  plan.writes_json(arguments.json);
  if (arguments.input.path == "-" && arguments.hull == "-")
    throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                          "only one of INPUT and HULL can be standard input");
  const Input input = open_input(arguments.input, arguments.run.threads);
  cullhull::Certificate certificate;
  const Stopwatch watch;
  {
    TerminalProgress progress(arguments.run.quiet);
    cullhull::Options options = arguments.run.options();
    options.progress = progress.callback();
    cancellable([&] {
      naming_file(arguments.input.path, [&] {
        certificate = cullhull::certify_file(input.points, arguments.hull, options);
      });
    });
  }
  const double seconds = watch.seconds();
  if (!arguments.json.empty())
    cullhull::write_text(arguments.json,
                         report(input, certificate, threads_used(arguments.run.threads), seconds));
  if (!certificate.valid) {
    complain("not certified: " + certificate.reason);
    return not_certified;
  }
  if (!arguments.run.quiet && !plan.uses_stdout())
    write_stdout(fmt::format("certified  {} points, {} ridges, {} decisions by exact arithmetic, "
                             "{:.6f} seconds\n",
                             grouped(certificate.points_checked),
                             grouped(certificate.ridges_checked),
                             grouped(certificate.exact_decisions), seconds) +
                 wrote_line(arguments.json));
  return 0;
}

}  // namespace

Command add_certify(Parser& parent) {
  auto a = std::make_shared<CertifyArguments>();
  Parser& command = *parent.add_subcommand("certify", "Check a hull against its points, exactly");
  a->input.add_to(command);
  command.add_option("HULL", a->hull, "What 'cullhull hull INPUT -o HULL.json' wrote")
      ->type_name("")
      ->required();
  add_json_option(command, a->json, "The outcome, counts and times");
  a->run.add_to(command, false);
  command.footer(std::string(input_help) + "\n\n" + examples);
  return [a] { return run(*a); };
}

}  // namespace app
