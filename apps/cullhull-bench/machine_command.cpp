// cullhull-bench machine: rates of memory and link, for reports and for the planner.
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>

#include "arguments.hpp"
#include "bench_commands.hpp"
#include "cullhull/error.hpp"
#include "cullhull/io.hpp"
#include "machine.hpp"
#include "outputs.hpp"
#include "signals.hpp"
#include "terminal.hpp"

namespace app {
namespace {

constexpr const char* examples =
    "--save keeps what the planner uses to decide where to run, in $CULLHULL_MACHINE, or else in\n"
    "~/.config/cullhull/machine.json. Without it the planner goes by defaults.\n"
    "\n"
    "Exit status: 0 success; 1 the system refused; 2 bad usage; 4 out of memory; 130 cancelled.";

struct MachineArguments {
  std::string json, bytes;
  unsigned passes = 9;
  bool save = false, quiet = false;
};

/// The file that the planner's constants go to; its folder exists afterwards.
std::string place_of_constants() {
  const std::string path = machine_file();
  if (path.empty())
    throw cullhull::Error(
        cullhull::ErrorCode::io,
        "no place for the planner's constants: set CULLHULL_MACHINE to a file name");
  std::error_code error;
  if (const auto folder = std::filesystem::path(path).parent_path(); !folder.empty())
    std::filesystem::create_directories(folder, error);
  if (error) throw cullhull::Error(cullhull::ErrorCode::io, path + ": " + error.message());
  return path;
}

int run(const MachineArguments& arguments) {
  FilePlan plan;
  plan.writes_json(arguments.json);
  const std::string place = arguments.save ? place_of_constants() : "";
  if (arguments.save) plan.writes_any("--save", place);
  cullhull::bench::MachineSettings settings;
  if (!arguments.bytes.empty()) settings.bytes = parse_size(arguments.bytes, "--bytes");
  settings.passes = arguments.passes;
  cullhull::bench::MachineRates rates;
  {
    TerminalProgress progress(arguments.quiet);
    cancellable([&] {
      rates = cullhull::bench::measure_machine(settings, progress.callback(), stop_token());
    });
  }
  if (arguments.save) cullhull::write_text(place, cullhull::bench::planner_constants(rates));
  if (!arguments.json.empty())
    cullhull::write_text(arguments.json, cullhull::bench::machine_json(rates));
  if (!arguments.quiet && !plan.uses_stdout()) write_stdout(cullhull::bench::machine_table(rates));
  return 0;
}

}  // namespace

Command add_machine(Parser& parent) {
  auto a = std::make_shared<MachineArguments>();
  Parser& command = *parent.add_subcommand(
      "machine", "Bandwidth of memory, of the link to the device, of the device");
  add_json_option(command, a->json, "The rates");
  command.add_flag("--save", a->save, "Keep the rates for the planner");
  needs_value(*command.add_option("--bytes", a->bytes, "Size of the arrays, e.g. 512MiB"))
      .type_name("SIZE");
  allow_range(*command.add_option("--passes", a->passes, "Passes over them; the best counts"), 1,
              1000);
  command.add_flag("-q,--quiet", a->quiet, "No table and no progress");
  command.footer(examples);
  return [a] { return run(*a); };
}

}  // namespace app
