// cullhull cull: the filter alone, for use in front of any other hull code.
#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <thread>

#include "arguments.hpp"
#include "commands.hpp"
#include "cullhull/cull.hpp"
#include "cullhull/error.hpp"
#include "cullhull/version.hpp"
#include "measure.hpp"
#include "outputs.hpp"

namespace app {
namespace {

constexpr const char* examples =
    "Every extreme point, and every duplicate of one, is among the survivors; a dropped point "
    "lies\n"
    "strictly inside the hull. So any hull code gives the same hull for the survivors.\n"
    "\n"
    "Examples:\n"
    "  cullhull cull big.npy -o ids.npy\n"
    "  python3 -c \"import numpy, scipy.spatial as s; p = numpy.load('big.npy', mmap_mode='r');\n"
    "    ids = numpy.load('ids.npy'); print(s.ConvexHull(p[ids]).volume)\"\n"
    "\n"
    "Exit status: 0 success; 1 bad input; 2 bad usage; 4 out of the memory budget; 5 backend not\n"
    "available; 130 cancelled.";

struct CullArguments {
  InputArguments input;
  RunArguments run;
  std::string output;
  std::string json;
  unsigned repeat = 1;
};

using Outcome = Repeated<cullhull::Survivors>;

std::string report(const CullArguments& arguments, const Input& input, const Outcome& outcome,
                   double read_seconds) {
  const cullhull::PointView& points = input.points;
  nlohmann::ordered_json json;
  json["version"] = CULLHULL_VERSION;
  json["points"] = {{"count", points.count},
                    {"dimension", points.dimension},
                    {"scalar", cullhull::scalar_name(points.scalar)}};
  json["threads"] = arguments.run.threads != 0 ? arguments.run.threads
                                               : std::max(1U, std::thread::hardware_concurrency());
  const cullhull::Survivors& survivors = outcome.result;
  json["backend"] = survivors.backend;
  json["cull"] = {{"method", survivors.method},
                  {"survivors", survivors.size(points.count)},
                  {"seconds", median(outcome.seconds)},
                  {"reason", survivors.reason}};
  json["read_seconds"] = read_seconds;
  json["compute_seconds"] = median(outcome.seconds);
  json["compute_seconds_all"] = outcome.seconds;
  json["peak_bytes"] = peak_bytes();
  return json.dump(2) + '\n';
}

std::string summary(const Input& input, const Outcome& outcome, double read_seconds) {
  const std::uint64_t count = input.points.count;
  const cullhull::Survivors& survivors = outcome.result;
  return points_line(input) + survivors_line(survivors.size(count), count, survivors.method) +
         fmt::format("seconds    {:.6f}; reading {:.6f}\n", median(outcome.seconds), read_seconds);
}

int run(const CullArguments& arguments) {
  if (arguments.output == "-" && arguments.json == "-")
    throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                          "only one of -o - and --json can go to standard output");
  const Input input = open_input(arguments.input, arguments.run.threads);
  const double read_seconds = input.file.read_seconds() + warm_pages(input.points);
  Outcome outcome = repeat(arguments.run, arguments.repeat, [&](const cullhull::Options& options) {
    return cullhull::cull(input.points, options);
  });
  if (!arguments.output.empty()) {
    cullhull::Survivors& survivors = outcome.result;
    if (survivors.all) {
      survivors.ids.resize(input.points.count);
      std::iota(survivors.ids.begin(), survivors.ids.end(), std::uint64_t{0});
    }
    cullhull::write_npy_ids(arguments.output, survivors.ids);
  }
  if (!arguments.json.empty())
    cullhull::write_text(arguments.json, report(arguments, input, outcome, read_seconds));
  if (!arguments.run.quiet && arguments.json != "-" && arguments.output != "-")
    write_stdout(summary(input, outcome, read_seconds));
  return 0;
}

}  // namespace

Command add_cull(CLI::App& parent) {
  auto a = std::make_shared<CullArguments>();
  CLI::App& command =
      *parent.add_subcommand("cull", "The filter alone: ids of the points that may be extreme");
  command.add_option("-o,--output", a->output, "Write the ids of the survivors, int64")
      ->type_name("SURVIVORS.npy");
  command.add_option("--json", a->json, "Counts and times as JSON, on standard output or to FILE")
      ->type_name("[=FILE]");
  a->run.add_to(command, true);
  allow_range(*command.add_option("--repeat", a->repeat, "Compute N times, report the median"), 1,
              1000000);
  a->input.add_to(command);
  command.footer(std::string(input_help) + "\n\n" + examples);
  return [a] { return run(*a); };
}

}  // namespace app
