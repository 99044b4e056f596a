// cullhull cull: the filter alone, for use in front of any other hull code.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>

#include "arguments.hpp"
#include "commands.hpp"
#include "cullhull/cull.hpp"
#include "cullhull/error.hpp"
#include "kept_columns.hpp"
#include "measure.hpp"
#include "outputs.hpp"
#include "streaming.hpp"
#include "topics.hpp"

namespace app {
namespace {

constexpr const char* cull_footer =
    "The survivors have the same hull as all points, for any hull code: every extreme point\n"
    "survives, with its duplicates, and a discarded point is strictly inside the hull. When "
    "points\n"
    "are read in blocks (--stream), only the extreme points survive, and of duplicates the first.\n"
    "\n"
    "Output files (-o and --points, by extension):\n"
    "  -o .npy .csv .txt   ids of the survivors in ascending order (.npy: int64; -o -: .npy)\n"
    "  -o .ply .xyz        coordinates of the survivors\n"
    "  -o .geojson         2D and 3D: a Point with its id for each survivor\n"
    "  -o .las             of one .las or .laz: the survivors' records, scale and offset\n"
    "  --points            coordinates as .npy .ply .csv .xyz .txt .geojson, or .las; .npy and "
    ".ply\n"
    "                      keep the scalar type\n"
    "\n"
    "Examples:\n"
    "  cullhull cull big.npy -o ids.npy\n"
    "  cullhull cull scan.ply -o fewer.ply                 fewer points for a mesh tool\n"
    "  python3 -c \"import numpy, scipy.spatial as s; p = numpy.load('big.npy', mmap_mode='r');\n"
    "    ids = numpy.load('ids.npy'); print(s.ConvexHull(p[ids]).volume)\"\n"
    "\n"
    "Exit status: 0 success; 1 bad input; 2 bad usage; 4 memory limit exceeded; 5 backend not\n"
    "available; 130 cancelled.";

struct CullArguments {
  InputArguments input;
  RunArguments run;
  std::string output;
  std::string points;
  std::string json;
  std::string keep;  ///< columns beside the points
  unsigned repeat = 1;
  StreamArguments stream;
  std::vector<std::string> files;  ///< the files that the input's words stand for
};

using CullOutcome = Repeated<cullhull::Survivors>;

std::string report(const CullArguments& arguments, const cullhull::PointView& points,
                   const CullOutcome& outcome, double read_seconds) {
  nlohmann::ordered_json json;
  json["threads"] = threads_used(arguments.run.threads);
  const cullhull::Survivors& survivors = outcome.result;
  json["backend"] = cullhull::backend_name(survivors.backend);
  json["cull"] = {{"method", cullhull::filter_name(survivors.filter)},
                  {"survivors", survivors.size(points.count)},
                  {"seconds", median(outcome.seconds)},
                  {"reason", survivors.reason}};
  json["read_seconds"] = read_seconds;
  json["compute_seconds"] = median(outcome.seconds);
  json["compute_seconds_all"] = outcome.seconds;
  json["peak_bytes"] = peak_bytes();
  return report_text("cull_report", points, json);
}

std::string summary(const Input& input, const CullOutcome& outcome, double read_seconds) {
  const std::uint64_t count = input.points.count;
  const cullhull::Survivors& survivors = outcome.result;
  return points_line(input) + units_lines(input.placing, input.kept()) +
         survivors_line(survivors.size(count), count, cullhull::filter_name(survivors.filter)) +
         fmt::format("seconds    {:.6f}; reading {:.6f}\n", median(outcome.seconds), read_seconds);
}

std::string wrote_lines(const CullArguments& arguments) {
  return wrote_line(arguments.output) + wrote_line(arguments.points) + wrote_line(arguments.json) +
         wrote_line(arguments.stream.partial);
}

/// Compressed or not.
bool has_las_name(const std::string& path) {
  const std::string ending = ending_of(path);
  const bool packed = ending == ".gz" || ending == ".zst";
  const std::string inner =
      packed ? ending_of(path.substr(0, path.size() - ending.size())) : ending;
  return inner == ".las" || inner == ".laz";
}

/// Records are copied from one file: those of several may differ in scale and point format.
void check_one_las(const CullArguments& arguments, const std::string& output) {
  const std::string& named = arguments.input.format;
  const bool las = named.empty() ? has_las_name(arguments.files[0]) : named == "las";
  if (arguments.files.size() != 1 || !las)
    throw cullhull::Error(cullhull::ErrorCode::invalid_argument,
                          output + ": .las is written of the records of one .las");
}

/// Ids are written without columns.
void check_kept(const CullArguments& arguments) {
  std::vector<std::string> outputs;
  for (const std::string& path : {arguments.output, arguments.points})
    if (!path.empty() && (path == arguments.points || holds_points(path))) outputs.push_back(path);
  check_keep(arguments.keep, arguments.files, outputs, {".geojson", ".csv"},
             arguments.stream.first_id);
}

FilePlan plan_files(const CullArguments& arguments) {
  FilePlan plan;
  plan.reads_inputs(arguments.input.words, arguments.files);
  plan.writes("-o", arguments.output, {OutputKind::ids, OutputKind::points, OutputKind::records});
  plan.writes("--points", arguments.points, {OutputKind::points, OutputKind::records});
  plan.writes_json(arguments.json);
  check_kept(arguments);
  arguments.stream.plan(plan);
  for (const auto& [option, path] :
       {std::pair{"-o", arguments.output}, {"--points", arguments.points}})
    if (ending_of(path) == ".las") check_one_las(arguments, option + (" " + path));
  return plan;
}

/// The system, and the columns that --keep names.
cullhull::MapExtras extras_of(const CullArguments& arguments) {
  return {arguments.input.crs,
          kept_columns(arguments.keep, arguments.input, arguments.files, arguments.run)};
}

/// `coordinates(path)` writes those of the points whose ids are given.
template <class Coordinates>
void write_outputs(const CullArguments& arguments, const std::vector<std::uint64_t>& ids,
                   const Coordinates& coordinates) {
  const auto points = [&](const std::string& path) {
    if (ending_of(path) == ".las")
      cullhull::write_las_records(path, arguments.files[0], ids);
    else
      coordinates(path);
  };
  if (holds_points(arguments.output))
    points(arguments.output);
  else if (!arguments.output.empty())
    cullhull::write_ids(arguments.output, ids);
  if (!arguments.points.empty()) points(arguments.points);
}

void write_survivors(const CullArguments& arguments, const cullhull::PointView& points,
                     cullhull::Survivors& survivors) {
  if (arguments.output.empty() && arguments.points.empty()) return;
  if (survivors.all) {
    survivors.ids.resize(points.count);
    std::iota(survivors.ids.begin(), survivors.ids.end(), std::uint64_t{0});
  }
  const cullhull::MapExtras extras = extras_of(arguments);
  write_outputs(arguments, survivors.ids, [&](const std::string& path) {
    cullhull::write_points(path, points, survivors.ids, "", extras);
  });
}

int run_in_memory(CullArguments arguments, const FilePlan& plan) {
  Input input = open_inputs(arguments.input, arguments.files, arguments.run.threads,
                            arguments.run.memory_bytes());
  arguments.run.held = input.held();
  for (const std::string& path : {arguments.output, arguments.points})
    check_points_dimension(path, input.points.dimension);
  const double read_seconds = input.file.read_seconds() + warm_pages(input.points);
  CullOutcome outcome =
      repeat(arguments.run, arguments.repeat, [&](const cullhull::Options& options) {
        return naming_file(input.places, [&] { return cullhull::cull(input.kept(), options); });
      });
  input.skipped.restore(outcome.result);
  input.to_world();
  write_survivors(arguments, input.points, outcome.result);
  if (!arguments.json.empty())
    cullhull::write_text(arguments.json,
                         with_placing(report(arguments, input.points, outcome, read_seconds),
                                      input.placing, input.kept()));
  if (!arguments.run.quiet && !plan.uses_stdout())
    write_stdout(summary(input, outcome, read_seconds) + wrote_lines(arguments));
  return 0;
}

/// In one pass the filter is complete only at its end: the survivors are the extreme points.
int run_streamed(const CullArguments& arguments, const FilePlan& plan) {
  Streamed streamed =
      stream_state(arguments.input, arguments.files, arguments.stream, arguments.run);
  cullhull::HullState& state = streamed.state;
  for (const std::string& path : {arguments.output, arguments.points})
    check_points_dimension(path, state.dimension());
  cullhull::to_world(state, streamed.read.grid);
  write_partial(arguments.stream, state, {});
  const cullhull::MapExtras extras = extras_of(arguments);
  write_outputs(arguments, state.ids(),
                [&](const std::string& path) { cullhull::write_points(path, state, "", extras); });
  if (!arguments.json.empty()) {
    CullOutcome outcome;
    outcome.result.ids = state.ids();
    outcome.result.filter = cullhull::UsedFilter::stream;
    outcome.result.reason = "points in blocks, of which the extreme ones are left";
    outcome.seconds = {streamed.seconds};
    cullhull::PointView all = state.points();
    all.count = state.point_count();
    cullhull::write_text(arguments.json, with_placing(report(arguments, all, outcome, 0),
                                                      streamed.placing(), state.points()));
  }
  if (!arguments.run.quiet && !plan.uses_stdout())
    write_stdout(streamed_points_line(streamed, arguments.files.size()) +
                 units_lines(streamed.placing(), state.points()) +
                 survivors_line(state.ids().size(), state.point_count(), "stream") +
                 fmt::format("seconds    {:.6f}\n", streamed.seconds) + wrote_lines(arguments));
  remove_checkpoint(arguments.stream);
  return 0;
}

std::string needs_memory(const CullArguments& arguments) {
  if (arguments.repeat > 1) return "--repeat";
  if (arguments.run.cull != "auto") return "--cull " + arguments.run.cull;
  return arguments.run.backend == "cuda" ? "--backend cuda" : "";
}

int run(CullArguments arguments) {
  arguments.files = arguments.input.find_files();
  const FilePlan plan = plan_files(arguments);
  const std::string why_not = needs_memory(arguments);
  if (arguments.stream.wanted(arguments.files, arguments.run, why_not))
    return run_streamed(arguments, plan);
  arguments.input.blocks_hint = StreamArguments::hint(why_not);
  return run_in_memory(std::move(arguments), plan);
}

}  // namespace

Command add_cull(Parser& parent) {
  auto a = std::make_shared<CullArguments>();
  Parser& command =
      *parent.add_subcommand("cull", "Discard interior points: the filter without the hull");
  a->input.add_many_to(command);
  add_crs_option(command, a->input.crs);
  command.group("Output");
  needs_value(*command.add_option("-o,--output", a->output,
                                  "Write the survivors: ids (.npy .csv .txt) or points (.ply .xyz\n"
                                  ".geojson .las)"))
      .type_name("FILE");
  needs_value(*command.add_option("--points", a->points, "Write the survivors' coordinates"))
      .type_name("FILE");
  add_json_option(command, a->json, "Report counts and times");
  add_keep_option(command, a->keep, "of each survivor, to .geojson and the .csv of --points");
  a->run.add_to(command, true);
  command.group("Verification and timing");
  allow_range(
      *command.add_option("--repeat", a->repeat, "Compute N times and report the median time"), 1,
      1000000);
  a->stream.add_to(command, true);
  command.footer(std::string(input_footer) + "\n\n" + cull_footer);
  return [a] { return run(*a); };
}

}  // namespace app
