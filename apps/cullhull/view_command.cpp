// cullhull view: points and their hull as one HTML page.
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "arguments.hpp"
#include "commands.hpp"
#include "cullhull/cullhull.hpp"
#include "cullhull/io.hpp"
#include "io/json/json_writer.hpp"
#include "measure.hpp"
#include "outputs.hpp"
#include "signals.hpp"
#include "terminal.hpp"
#include "topics.hpp"
#include "viewer/scene.hpp"

namespace app {
namespace {

using cullhull::Error;
using cullhull::ErrorCode;
using cullhull::viewer::Scene;
using cullhull::viewer::SceneFrame;

constexpr const char* help =
    "INPUT may also be a hull, HULL.json of 'cullhull hull -o', shown without its points; or "
    "moving\n"
    "points: an .npy array (frames, n, d), or a folder or quoted pattern of files with one frame\n"
    "each, of points or of hulls ('cullhull track -o'). The page then has a slider, and shows at\n"
    "most 120 frames, evenly spaced.\n"
    "\n"
    "The page is one file that needs no network. 3D points can be rotated, moved and zoomed; 2D\n"
    "points are a plot; of more dimensions three axes are chosen. It stays below 12 MB: of many\n"
    "points a random sample is drawn, with ids and exact coordinates, and the page says how many.\n"
    "\n"
    "Examples:\n"
    "  cullhull view scan.ply -o scan.html\n"
    "  cullhull view cloud.npy --columns 0:3 -o cloud.html --json=figures.json\n"
    "  cullhull view wells.csv --delaunay -o cells.html\n"
    "  cullhull hull big.npy -o hull.json && cullhull view hull.json -o hull.html\n"
    "  cullhull track twist.npy -o 'f-%03d.json' && cullhull view 'f-*.json' -o twist.html\n"
    "\n"
    "Exit status: 0 success; 1 bad input; 2 bad usage; 4 memory limit exceeded; 5 backend not\n"
    "available, or built without three.js; 130 cancelled.";

struct ViewArguments {
  InputArguments input;
  RunArguments run;
  std::string output;
  std::string json;
  bool cells = false;

  /// Of the cells of `--delaunay`; nothing without it.
  std::optional<cullhull::TriangulationOptions> triangulation(
      const cullhull::Options& given) const {
    if (!cells) return std::nullopt;
    return cullhull::TriangulationOptions{given};
  }
};

std::string title_of(const std::string& path) {
  return path == "-" ? "standard input" : std::filesystem::path(path).filename().string();
}

bool is_json(const std::string& path) { return std::filesystem::path(path).extension() == ".json"; }

/// JSON that is no GeoJSON: only that has a member "type".
bool may_be_hull(const std::string& path) {
  if (!is_json(path)) return false;
  std::string head(std::size_t{1} << 16, '\0');
  std::ifstream file(path, std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  return head.find("\"type\"") == std::string::npos;
}

/// A folder, a pattern, or an array that may have three axes.
bool may_be_sequence(const InputArguments& input) {
  if (input.path == "-" || input.dimension != 0 || !input.type.empty()) return false;
  std::error_code ignored;
  return std::filesystem::is_directory(input.path, ignored) || input.format == "npy" ||
         (!std::filesystem::exists(input.path, ignored) &&
          input.path.find_first_of("*?[") != std::string::npos) ||
         (input.format.empty() && std::filesystem::path(input.path).extension() == ".npy");
}

/// All files that INPUT names.
std::vector<std::string> input_files(const InputArguments& input) {
  if (!may_be_sequence(input)) return {input.path};
  return cullhull::sequence_files({input.path}, read_options(input, 0));
}

/// The hull files that INPUT names; empty where it names points.
std::vector<std::string> hull_files(const InputArguments& input) {
  if (!input.format.empty() || input.path == "-") return {};
  if (!may_be_sequence(input) && !is_json(input.path)) return {};
  std::vector<std::string> files = cullhull::sequence_files({input.path}, read_options(input, 0));
  return std::all_of(files.begin(), files.end(), may_be_hull) ? files : std::vector<std::string>();
}

/// Hull and survivors of one set of points, and the run's report for --json.
struct Computed {
  cullhull::Hull hull;
  cullhull::Survivors survivors;
  std::string report;
};

Computed compute(Input& input, double read_seconds, const cullhull::Options& options) {
  const cullhull::PointView& points = input.points;
  Computed result;
  const Stopwatch watch;
  result.hull = cullhull::convex_hull(points, options);
  cullhull::JsonExtras extras;
  extras.compute_seconds_all = {watch.seconds()};
  extras.read_seconds = read_seconds;
  extras.peak_bytes = peak_bytes();
  // The hull has the number of survivors, but not which points they are.
  if (result.hull.statistics.survivors < points.count)
    result.survivors = cullhull::cull(points, options);
  else
    result.survivors.all = true;
  cullhull::to_world(result.hull, input.placing.grid);
  input.to_world();
  result.report = with_placing(cullhull::hull_to_json(points, result.hull, extras, false),
                               input.placing, points);
  return result;
}

void add_frame(const cullhull::PointView& points, std::uint64_t index, const cullhull::Hull& hull,
               const cullhull::Survivors& survivors, const std::string& report,
               const std::optional<cullhull::TriangulationOptions>& triangulation, Scene& scene,
               const cullhull::PointView& colours = {}) {
  SceneFrame frame;
  if (triangulation && points.count > 0) frame.triangulate = &*triangulation;
  frame.index = index;
  frame.hull = &hull;
  frame.vertex_rows = cullhull::viewer::vertex_rows(points, hull);
  frame.points = points;
  frame.colours = colours;
  frame.survivors = &survivors;
  frame.report = report;
  scene.add(frame);
}

/// The contents of the file: the page, and its figures.
struct Written {
  std::string page, report;
};

Written view_input(const ViewArguments& arguments, Input& input, const cullhull::Options& options) {
  Scene scene(title_of(arguments.input.path), 1, 1);
  const double read = input.file.read_seconds() + warm_pages(input.points);
  const Computed computed =
      naming_file(input.places, [&] { return compute(input, read, options); });
  add_frame(input.points, 0, computed.hull, computed.survivors, computed.report,
            arguments.triangulation(options), scene, input.file.colours());
  return {scene.page(), computed.report};
}

Written view_points(const ViewArguments& arguments, cullhull::Options options) {
  // Writing to a pipe has nothing to clean up: a signal ends it at once.
  Input input = open_input(arguments.input, arguments.run.threads, arguments.run.memory_bytes());
  RunArguments beside = arguments.run;
  beside.held = input.held();
  options.memory_budget = beside.options().memory_budget;
  Written written;
  cancellable(
      [&] { naming_held(beside.held, [&] { written = view_input(arguments, input, options); }); });
  return written;
}

/// A frame's figures: of its hull, and of its filter.
std::string tracked_report(const cullhull::HullTracker& tracker, const cullhull::PointView& points,
                           double read_seconds) {
  const cullhull::FrameReport& r = tracker.report();
  cullhull::JsonExtras extras;
  extras.compute_seconds_all = {r.compute_seconds};
  extras.read_seconds = read_seconds;
  extras.peak_bytes = peak_bytes();
  auto report =
      nlohmann::ordered_json::parse(cullhull::hull_to_json(points, tracker.hull(), extras, false));
  report["track"] = {{"method", r.method},
                     {"scan_survivors", r.scan_survivors},
                     {"vertices_came", r.vertices_came},
                     {"vertices_went", r.vertices_went},
                     {"facets_came", r.facets_came},
                     {"facets_went", r.facets_went},
                     {"scan_seconds", r.scan_seconds}};
  return cullhull::internal::json_text(report);
}

/// Which of `count` frames are shown, and their reports as one text.
class Shown {
 public:
  explicit Shown(std::uint64_t count)
      : count_(count), shown_(std::min(count, Scene::most_frames)) {}
  std::uint64_t shown() const { return shown_; }
  double share() const { return static_cast<double>(added_) / static_cast<double>(shown_); }
  bool wants(std::uint64_t index) const {
    return added_ < shown_ && index == added_ * count_ / shown_;
  }
  void add(const std::string& report) {
    ++added_;
    reports_.push_back(nlohmann::ordered_json::parse(report));
  }
  /// One frame's report, or a document of all.
  std::string report() const {
    if (count_ == 1) return cullhull::internal::json_text(reports_[0]);
    return cullhull::internal::json_document({"view_report", {}},
                                             nlohmann::ordered_json{{"frames", reports_}});
  }

 private:
  std::uint64_t count_, shown_, added_ = 0;
  nlohmann::ordered_json reports_ = nlohmann::ordered_json::array();
};

/// Frames tracked one after the other; each hull is the one that `hull` gives for that frame.
Written view_sequence(const ViewArguments& arguments, cullhull::Options options,
                      const cullhull::Progress& progress) {
  cullhull::ReadOptions reading =
      read_options(arguments.input, arguments.run.threads, arguments.run.memory_bytes());
  reading.stop = options.stop;
  if (!arguments.input.raw) reading.numbers = cullhull::Numbers::world;  // for looking at
  cullhull::PointSequence sequence = cullhull::open_sequence({arguments.input.path}, reading);
  const std::uint64_t frames = sequence.frames();
  if (frames == 0)
    throw Error(ErrorCode::bad_file, arguments.input.path, ": a sequence without frames");
  Shown chosen(frames);
  Scene scene(title_of(arguments.input.path), frames, chosen.shown());
  if (frames > 1) options.progress = nullptr;  // the number of frames is shown instead
  cullhull::HullTracker tracker(options);
  while (sequence.next()) {
    if (!chosen.wants(sequence.index())) continue;
    if (progress && frames > 1) progress("frames", chosen.share());
    Input input;
    input.points = sequence.points();
    const double read = sequence.read_seconds() + warm_pages(input.points);
    if (frames == 1) {  // a single frame: not a moving set
      const Computed computed =
          naming_file(sequence.name(), [&] { return compute(input, read, options); });
      chosen.add(computed.report);
      add_frame(input.points, 0, computed.hull, computed.survivors, computed.report,
                arguments.triangulation(options), scene);
      continue;
    }
    naming_file(sequence.name(), [&] { tracker.update(input.points); });
    const std::string report = tracked_report(tracker, input.points, read);
    chosen.add(report);
    add_frame(input.points, sequence.index(), tracker.hull(), tracker.survivors(), report,
              arguments.triangulation(options), scene);
  }
  return {scene.page(), chosen.report()};
}

/// The members of a hull's report that tell nothing of a run.
std::string result_figures(const cullhull::Hull& hull) {
  auto figures =
      nlohmann::ordered_json::parse(cullhull::hull_to_json(cullhull::PointView{}, hull, {}, false));
  for (const char* key : {"threads", "backend", "cull", "hull", "read_seconds", "compute_seconds",
                          "compute_seconds_all", "peak_bytes", "certified"})
    figures.erase(key);
  figures["kind"] = "hull_figures";
  return cullhull::internal::json_text(figures);
}

Written view_hulls(const ViewArguments& arguments, const std::vector<std::string>& files,
                   const cullhull::Options& options) {
  Shown chosen(files.size());
  Scene scene(title_of(arguments.input.path), files.size(), chosen.shown());
  for (std::uint64_t i = 0; i < files.size(); ++i) {
    if (!chosen.wants(i)) continue;
    if (options.stop.stop_requested()) throw Error(ErrorCode::cancelled, "cancelled");
    if (options.progress && files.size() > 1) options.progress("frames", chosen.share());
    SceneFrame frame;
    const cullhull::Hull hull = cullhull::hull_from_json(files[i], &frame.vertex_rows);
    frame.index = i;
    frame.hull = &hull;
    frame.report = result_figures(hull);
    chosen.add(frame.report);
    scene.add(frame);
  }
  return {scene.page(), chosen.report()};
}

int run(const ViewArguments& arguments) {
  if (!cullhull::viewer::available()) Scene("", 1, 1).page();  // throws its reason, before the work
  FilePlan plan;
  plan.reads(input_files(arguments.input));
  plan.writes("-o", arguments.output, page_endings);
  plan.writes_json(arguments.json);
  cullhull::Options options = arguments.run.options();
  Written written;
  {
    TerminalProgress progress(arguments.run.quiet);
    options.progress = progress.callback();
    const std::vector<std::string> hulls = hull_files(arguments.input);
    if (arguments.cells && !hulls.empty())
      throw Error(ErrorCode::invalid_argument, "--delaunay: ", arguments.input.path,
                  " is a hull, without its points");
    if (hulls.empty() && !may_be_sequence(arguments.input))
      written = view_points(arguments, options);
    else
      cancellable([&] {
        written = !hulls.empty() ? view_hulls(arguments, hulls, options)
                                 : view_sequence(arguments, options, options.progress);
      });
  }
  cullhull::write_text(arguments.output, written.page);
  if (!arguments.json.empty()) cullhull::write_text(arguments.json, written.report);
  if (!arguments.run.quiet && !plan.uses_stdout())
    write_stdout(wrote_line(arguments.output) + wrote_line(arguments.json));
  return 0;
}

}  // namespace

Command add_view(Parser& parent) {
  auto a = std::make_shared<ViewArguments>();
  Parser& command =
      *parent.add_subcommand("view", "Show points and their hull in an interactive HTML page");
  a->input.add_to(command);
  command.group("Output");
  needs_value(*command.add_option("-o,--output", a->output, "Write the page"))
      .type_name("PAGE.html")
      ->required();
  command.add_flag("--delaunay", a->cells,
                   "Also show the cells of the Delaunay triangulation: in 2D all of\n"
                   "them, in 3D those that the clipping plane cuts");
  add_json_option(command, a->json, "Report the figures of the page");
  a->run.add_to(command, true);
  command.footer(std::string(input_footer) + "\n\n" + help);
  return [a] { return run(*a); };
}

}  // namespace app
