// cullhull view: points and their hull as one HTML page.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <memory>

#include "arguments.hpp"
#include "commands.hpp"
#include "cullhull/cullhull.hpp"
#include "measure.hpp"
#include "signals.hpp"
#include "terminal.hpp"
#include "viewer/scene.hpp"

namespace app {
namespace {

using cullhull::Error;
using cullhull::ErrorCode;
using cullhull::viewer::Scene;
using cullhull::viewer::SceneFrame;

constexpr const char* help =
    "INPUT may also be HULL.json, as 'cullhull hull -o' writes it: the page then shows the hull "
    "alone.\n"
    "Or moving points: an .npy array (frames, n, d), or a folder of files, a frame each; the page "
    "has\n"
    "a slider, and at most 120 of the frames, evenly chosen.\n"
    "\n"
    "The page is one file that needs no network. 3D sets are turned, moved and zoomed; 2D sets are "
    "a\n"
    "plot; of four and more dimensions three axes are chosen. It stays under 12 MB: of many points "
    "a\n"
    "fair sample is drawn, with the true ids and exact coordinates, and the page says how many.\n"
    "\n"
    "Examples:\n"
    "  cullhull view scan.ply -o scan.html\n"
    "  cullhull view cloud.npy --columns 0:3 -o cloud.html --json=figures.json\n"
    "  cullhull hull big.npy -o hull.json && cullhull view hull.json -o hull.html\n"
    "\n"
    "Exit status: 0 success; 1 bad input; 2 bad usage; 4 out of the memory budget; 5 backend not\n"
    "available, or built without three.js; 130 cancelled.";

struct ViewArguments {
  InputArguments input;
  RunArguments run;
  std::string output;
  std::string json;
};

std::string title_of(const std::string& path) {
  return path == "-" ? "standard input" : std::filesystem::path(path).filename().string();
}

bool is_hull_file(const InputArguments& input) {
  return input.format.empty() && std::filesystem::path(input.path).extension() == ".json";
}

/// A folder, or an array that may have three axes.
bool may_be_sequence(const InputArguments& input) {
  if (input.path == "-" || input.dimension != 0 || !input.type.empty()) return false;
  std::error_code ignored;
  return std::filesystem::is_directory(input.path, ignored) || input.format == "npy" ||
         (input.format.empty() && std::filesystem::path(input.path).extension() == ".npy");
}

/// Hull and survivors of one set of points, and what --json says of the run.
struct Computed {
  cullhull::Hull hull;
  cullhull::Survivors survivors;
  std::string report;
};

Computed compute(const cullhull::PointView& points, double read_seconds,
                 const cullhull::Options& options) {
  Computed result;
  const Stopwatch watch;
  result.hull = cullhull::convex_hull(points, options);
  cullhull::JsonExtras extras;
  extras.compute_seconds_all = {watch.seconds()};
  extras.read_seconds = read_seconds;
  extras.peak_bytes = peak_bytes();
  // The hull tells how many points the filter kept, not which.
  if (result.hull.statistics.survivors < points.count)
    result.survivors = cullhull::cull(points, options);
  else
    result.survivors.all = true;
  result.report = cullhull::hull_to_json(points, result.hull, extras, false);
  return result;
}

std::string add_frame(const Input& input, std::uint64_t index, double read_seconds,
                      const cullhull::Options& options, Scene& scene) {
  const double seconds = read_seconds + warm_pages(input.points);
  const Computed computed = compute(input.points, seconds, options);
  SceneFrame frame;
  frame.index = index;
  frame.hull = &computed.hull;
  frame.vertex_rows = cullhull::viewer::vertex_rows(input.points, computed.hull);
  frame.points = input.points;
  frame.survivors = &computed.survivors;
  frame.report = computed.report;
  scene.add(frame);
  return computed.report;
}

/// What goes into a file: the page, and the figures in it.
struct Written {
  std::string page, report;
};

Written view_points(const ViewArguments& arguments, const cullhull::Options& options) {
  const Input input = open_input(arguments.input, arguments.run.threads);
  Scene scene(title_of(arguments.input.path), 1, 1);
  const std::string report = add_frame(input, 0, input.file.read_seconds(), options, scene);
  return {scene.page(), report};
}

Written view_sequence(const ViewArguments& arguments, cullhull::Options options,
                      TerminalProgress& progress) {
  cullhull::ReadOptions reading = read_options(arguments.input, arguments.run.threads);
  reading.stop = options.stop;
  cullhull::PointSequence sequence = cullhull::open_sequence({arguments.input.path}, reading);
  const std::uint64_t frames = sequence.frames();
  if (frames == 0)
    throw Error(ErrorCode::bad_file, arguments.input.path + ": a sequence without frames");
  const std::uint64_t shown = std::min(frames, Scene::most_frames);
  Scene scene(title_of(arguments.input.path), frames, shown);
  std::string reports;
  std::uint64_t added = 0;
  if (frames > 1) options.progress = nullptr;  // frames are counted instead
  while (sequence.next()) {
    if (sequence.index() != added * frames / shown) continue;
    if (const auto show = progress.callback(); show && frames > 1)
      show("frames", static_cast<double>(added) / static_cast<double>(shown));
    Input input;
    input.points = sequence.points();
    choose_columns(arguments.input, input);
    if (added++ > 0) reports += ",\n";
    reports += add_frame(input, sequence.index(), sequence.read_seconds(), options, scene);
  }
  return {scene.page(), frames > 1 ? "[\n" + reports + "]\n" : reports};
}

Written view_hull(const ViewArguments& arguments) {
  SceneFrame frame;
  const cullhull::Hull hull = cullhull::hull_from_json(arguments.input.path, &frame.vertex_rows);
  frame.hull = &hull;
  frame.report = cullhull::viewer::result_figures(cullhull::hull_to_json({}, hull, {}, false));
  Scene scene(title_of(arguments.input.path), 1, 1);
  scene.add(frame);
  return {scene.page(), frame.report};
}

int run(const ViewArguments& arguments) {
  if (!cullhull::viewer::available()) Scene("", 1, 1).page();  // says why, before the work
  if (arguments.output == "-" && arguments.json == "-")
    throw Error(ErrorCode::invalid_argument, "the page and --json both want standard output");
  cullhull::Options options = arguments.run.options();
  Written written;
  {
    TerminalProgress progress(arguments.run.quiet);
    options.progress = progress.callback();
    cancellable([&] {
      written = is_hull_file(arguments.input)      ? view_hull(arguments)
                : may_be_sequence(arguments.input) ? view_sequence(arguments, options, progress)
                                                   : view_points(arguments, options);
    });
  }
  cullhull::write_text(arguments.output, written.page);
  if (arguments.json == "-") write_stdout(written.report);
  if (!arguments.json.empty() && arguments.json != "-")
    cullhull::write_text(arguments.json, written.report);
  return 0;
}

}  // namespace

Command add_view(CLI::App& parent) {
  auto a = std::make_shared<ViewArguments>();
  CLI::App& command =
      *parent.add_subcommand("view", "Points and their hull as an HTML page to look at");
  command.add_option("-o,--output", a->output, "Write the page to this file")
      ->type_name("PAGE.html")
      ->required();
  command
      .add_option("--json", a->json,
                  "The figures of the page as JSON, on standard output or to FILE")
      ->type_name("[=FILE]");
  a->run.add_to(command, true);
  a->input.add_to(command);
  command.footer(std::string(input_help) + "\n\n" + help);
  return [a] { return run(*a); };
}

}  // namespace app
