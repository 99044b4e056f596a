// cullhull certify: an independent check of a hull written earlier.
#include <fmt/format.h>

#include <memory>
#include <mutex>
#include <nlohmann/json.hpp>

#include "arguments.hpp"
#include "commands.hpp"
#include "cullhull/certify.hpp"
#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/io.hpp"
#include "measure.hpp"
#include "outputs.hpp"
#include "signals.hpp"
#include "streaming.hpp"
#include "terminal.hpp"
#include "topics.hpp"

namespace app {
namespace {

constexpr const char* certify_footer =
    "A valid certificate proves that the file holds the exact hull of the points: its vertices "
    "are\n"
    "the extreme points (of equal points the one with the lowest id), its facets are the maximal\n"
    "ones, and every number in it is as accurate as documented. The checker uses exact predicates\n"
    "and shares no code with the engine.\n"
    "\n"
    "Examples:\n"
    "  cullhull hull scan.ply -o hull.json && cullhull certify scan.ply hull.json\n"
    "\n"
    "Exit status: 0 certified; 1 bad input; 2 bad usage; 3 not certified, with the reason on\n"
    "standard error; 130 cancelled.";

struct CertifyArguments {
  InputArguments input;
  RunArguments run;
  std::string hull;
  std::string json;
  StreamArguments stream;
  std::vector<std::string> files;  ///< the files that the input's words stand for
};

std::string report(const cullhull::PointView& points, const cullhull::Certificate& certificate,
                   unsigned threads, double read_seconds, double seconds) {
  nlohmann::ordered_json json;
  json["threads"] = threads;
  json["certified"] = certificate.valid;
  json["reason"] =
      certificate.valid ? nlohmann::ordered_json() : nlohmann::ordered_json(certificate.reason);
  json["points_checked"] = certificate.points_checked;
  json["ridges_checked"] = certificate.ridges_checked;
  json["exact_decisions"] = certificate.exact_decisions;
  json["read_seconds"] = read_seconds;
  json["certify_seconds"] = seconds;
  json["peak_bytes"] = peak_bytes();
  return report_text("certify_report", points, json);
}

struct CertifyOutcome {
  cullhull::Certificate certificate;
  cullhull::PointView points;  ///< only number, dimension and scalar type
  double read_seconds = 0, seconds = 0;
  Placing placing;
  std::vector<double> extent;  ///< as Extent::corners()
};

CertifyOutcome certify_in_memory(const CertifyArguments& arguments) {
  const Input input = open_inputs(arguments.input, arguments.files, arguments.run.threads,
                                  arguments.run.memory_bytes());
  CertifyOutcome outcome;
  outcome.points = input.points;
  outcome.read_seconds = input.file.read_seconds();
  outcome.placing = input.placing;
  if (outcome.placing.any) {
    Extent extent;
    extent.add(input.points);
    outcome.extent = extent.corners(input.placing.grid);
  }
  const Stopwatch watch;
  TerminalProgress progress(arguments.run.quiet);
  cullhull::Options options = arguments.run.options();
  options.progress = progress.callback();
  cancellable([&] {
    naming_file(input.places, [&] {
      outcome.certificate = cullhull::certify_file(input.points, arguments.hull, options,
                                                   input.placing.grid, arguments.stream.first_id);
    });
  });
  outcome.seconds = watch.seconds();
  return outcome;
}

CertifyOutcome certify_streamed(const CertifyArguments& arguments) {
  CertifyOutcome outcome;
  std::vector<double> rows;
  const cullhull::Options options = arguments.run.options();
  cullhull::Hull hull =
      cullhull::hull_from_json(arguments.hull, &rows, options, arguments.stream.first_id);
  InputArguments from = arguments.input;
  // Before anything is read: the hull is to be on the grid as its points will be.
  from.grid = arguments.input.raw ? cullhull::Grid()
                                  : cullhull::common_grid(arguments.files, read_options(from, 1));
  cullhull::to_grid(hull, rows, *from.grid);
  outcome.points.count = hull.point_count;
  outcome.points.dimension = hull.dimension;
  outcome.points.scalar = hull.scalar;
  const Stopwatch watch;
  cullhull::CertifyStream check(hull, std::move(rows), options);
  std::mutex mutex;
  Extent extent;
  const bool told = !arguments.json.empty();
  const cullhull::BlockSummary read = stream_blocks(
      from, arguments.files, arguments.run,
      [&](const cullhull::PointView& block, std::uint64_t first) {
    check.push(block, first);
    if (!told) return;
    Extent of_block;
    of_block.add(block);
    const std::lock_guard lock(mutex);
    extent.add(of_block);
      },
      [&](std::uint64_t count) { check.skip(count); });
  outcome.certificate = check.finish();
  outcome.placing = placing_of(read, arguments.input);
  outcome.extent = extent.corners(read.grid);
  outcome.seconds = watch.seconds();
  return outcome;
}

int run(CertifyArguments arguments) {
  if (arguments.input.words.size() < 2)
    throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                          "certify needs the points and, as the last word, the hull to verify");
  arguments.hull = arguments.input.words.back();
  arguments.input.words.pop_back();
  for (const char* mesh : {".ply", ".obj", ".off", ".stl", ".glb", ".vtp", ".geojson", ".wkt"})
    if (ending_of(arguments.hull) == mesh)
      throw cullhull::Error(cullhull::ErrorCode::invalid_argument, arguments.hull,
                            ": the hull to verify is the last word, as 'cullhull hull INPUT -o "
                            "HULL.json' writes it");
  arguments.files = arguments.input.find_files();
  arguments.stream.check_ids();
  FilePlan plan;
  plan.reads_inputs(arguments.input.words, arguments.files);
  plan.reads(arguments.hull);
  plan.writes_json(arguments.json);
  for (const std::string& file : arguments.files)
    if (file == "-" && arguments.hull == "-")
      throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                            "only one of INPUT and HULL can be standard input");
  StreamArguments reading = arguments.stream;
  reading.first_id = 0;  // names points, and is no reason to read in blocks
  if (arguments.input.skip_nan && reading.stream == "off")
    throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                          "--skip-nan reads in blocks, which --stream off forbids");
  if (arguments.input.skip_nan) reading.stream = "on";
  arguments.input.blocks_hint = StreamArguments::hint("");
  CertifyOutcome outcome = reading.wanted(arguments.files, arguments.run, "")
                               ? certify_streamed(arguments)
                               : certify_in_memory(arguments);
  // Numbers are compared in the integers that a grid holds.
  if (!outcome.placing.raw && !outcome.placing.grid.empty() &&
      outcome.certificate.reason.find("should be") != std::string::npos)
    outcome.certificate.reason += " (in units of the points' grid)";
  const cullhull::Certificate& certificate = outcome.certificate;
  if (!arguments.json.empty())
    cullhull::write_text(arguments.json, with_placing(report(outcome.points, certificate,
                                                             threads_used(arguments.run.threads),
                                                             outcome.read_seconds, outcome.seconds),
                                                      outcome.placing, outcome.extent));
  if (!certificate.valid) {
    complain("not certified: " + certificate.reason);
    return not_certified;
  }
  if (!arguments.run.quiet && !plan.uses_stdout())
    write_stdout(fmt::format("certified  {} points, {} ridges, {} decisions by exact arithmetic, "
                             "{:.6f} seconds\n",
                             grouped(certificate.points_checked),
                             grouped(certificate.ridges_checked),
                             grouped(certificate.exact_decisions), outcome.seconds) +
                 skipped_line(outcome.placing) + wrote_line(arguments.json));
  return 0;
}

}  // namespace

Command add_certify(Parser& parent) {
  auto a = std::make_shared<CertifyArguments>();
  Parser& command =
      *parent.add_subcommand("certify", "Verify a written hull against its points, exactly");
  a->input.add_many_to(command, ";\nlast the result of 'cullhull hull INPUT -o HULL.json'");
  add_json_option(command, a->json, "Report the outcome, counts and times");
  a->run.add_to(command, false);
  a->stream.add_to(command, false);
  a->stream.add_first_id_to(command);
  command.footer(std::string(input_footer) + "\n\n" + certify_footer);
  return [a] { return run(*a); };
}

}  // namespace app
