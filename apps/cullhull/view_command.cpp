// cullhull view: points and their hull as one HTML page.
#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "arguments.hpp"
#include "commands.hpp"
#include "cullhull/cullhull.hpp"
#include "cullhull/io.hpp"
#include "io/json/json.hpp"
#include "io/json/json_writer.hpp"
#include "measure.hpp"
#include "outputs.hpp"
#include "parallel/paths.hpp"
#include "signals.hpp"
#include "system.hpp"
#include "terminal.hpp"
#include "topics.hpp"
#include "viewer/scene.hpp"

namespace app {
namespace {

using cullhull::Error;
using cullhull::ErrorCode;
using cullhull::internal::native_path;
using cullhull::internal::separators;
using cullhull::internal::utf8_name;
using cullhull::viewer::Scene;
using cullhull::viewer::SceneFrame;

constexpr const char* help =
    "Several files, also of a folder or a quoted pattern, are one set, as 'cullhull hull' reads "
    "them.\n"
    "With --frames each is a frame of moving points; an .npy array (frames, n, d) always is. "
    "INPUT\n"
    "may also be a hull, HULL.json of 'cullhull hull -o', shown without its points; several are\n"
    "frames ('cullhull track -o'). A page of frames has a slider, and shows at most 120 of them,\n"
    "evenly spaced.\n"
    "\n"
    "Without -o the page is written beside the input, scan.html for scan.ply, and opened in the\n"
    "browser where there is one (not with --no-open). A file of that name that cullhull did not\n"
    "write is not replaced.\n"
    "\n"
    "The page is one file that needs no network. 3D points can be rotated, moved and zoomed; 2D\n"
    "points are a plot; of more dimensions three axes are chosen. It stays below 12 MB: of many\n"
    "points a random sample is drawn, with ids and exact coordinates, and the page says how many.\n"
    "\n"
    "Examples:\n"
    "  cullhull view scan.ply                              scan.html, in the browser\n"
    "  cullhull view tiles/ -o site.html                   all tiles of a folder, one set\n"
    "  cullhull view cloud.npy --columns 0:3 -o cloud.html --json=figures.json\n"
    "  cullhull view wells.csv --delaunay -o cells.html\n"
    "  cullhull hull big.npy -o hull.json && cullhull view hull.json -o hull.html\n"
    "  cullhull track twist.npy -o 'f-%03d.json' && cullhull view 'f-*.json' -o twist.html\n"
    "  cullhull view scans/ --frames -o scans.html         a folder of frames\n"
    "\n"
    "Exit status: 0 success; 1 bad input; 2 bad usage; 4 memory limit exceeded; 5 backend not\n"
    "available, or built without three.js; 130 cancelled.";

struct ViewArguments {
  InputArguments input;
  RunArguments run;
  std::string output;
  std::string json;
  bool cells = false;
  bool outline = false;
  bool frames = false;
  bool no_open = false;
  std::vector<std::string> files;  ///< the files that the input's words stand for

  /// The word of the input where there is one.
  std::string only_word() const { return input.words.size() == 1 ? input.words[0] : ""; }
  std::string title() const;

  /// Options of the triangulation of `--delaunay` and `--outline`; nothing without them.
  std::optional<cullhull::TriangulationOptions> triangulation(
      const cullhull::Options& given) const {
    if (!cells && !outline) return std::nullopt;
    return cullhull::options_as<cullhull::TriangulationOptions>(given);
  }
};

std::string title_of(const std::string& path) {
  return path == "-" ? "standard input" : utf8_name(native_path(path).filename());
}

bool is_json(const std::string& path) { return native_path(path).extension() == ".json"; }

/// JSON that is neither GeoJSON, which alone has a member "type", nor rows of points: a hull's
/// member "points" is an object.
bool may_be_hull(const std::string& path) {
  if (path == "-" || !is_json(path)) return false;
  std::string head(std::size_t{1} << 16, '\0');
  std::ifstream file(native_path(path), std::ios::binary);
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  head.resize(static_cast<std::size_t>(file.gcount()));
  std::erase_if(head, [](unsigned char c) { return std::isspace(c) != 0; });
  return head.find("\"type\":") == std::string::npos && !head.starts_with('[') &&
         head.find("\"points\":[") == std::string::npos;
}

std::string ViewArguments::title() const {
  const std::string one = files.size() == 1 ? files[0] : only_word();
  if (one.empty()) return title_of(files[0]) + " and " + std::to_string(files.size() - 1) + " more";
  std::string path = one;
  while (path.size() > 1 && separators.find(path.back()) != std::string::npos)
    path.pop_back();  // of a folder
  return title_of(path);
}

/// Frames where they are asked for, or an array that may have three axes.
bool is_sequence(const ViewArguments& arguments) {
  const InputArguments& input = arguments.input;
  if (arguments.frames) return true;
  if (arguments.files.size() != 1 || arguments.files[0] == "-") return false;
  if (input.dimension != 0 || !input.type.empty()) return false;
  const std::string extension = utf8_name(native_path(arguments.files[0]).extension());
  return input.format == "npy" || (input.format.empty() && extension == ".npy");
}

/// Whether the input is hulls, and no points.
bool are_hulls(const ViewArguments& arguments) {
  const std::vector<std::string>& files = arguments.files;
  return arguments.input.format.empty() && std::all_of(files.begin(), files.end(), may_be_hull);
}

/// The page beside the input: scan.html for scan.ply, tiles.html for tiles/.
std::string page_beside(const ViewArguments& arguments) {
  const std::string word = arguments.only_word();
  if (word.empty() || word == "-" || word[0] == '@' ||
      word.find_first_of("*?[") != std::string::npos)
    throw Error(ErrorCode::invalid_argument,
                "-o PAGE.html is needed for several inputs and for standard input");
  std::filesystem::path path = native_path(cullhull::file_of_input(word));
  if (!path.has_filename()) path = path.parent_path();
  std::error_code ignored;
  if (!std::filesystem::is_directory(path, ignored))
    while (path.has_extension()) path.replace_extension();
  std::string page = utf8_name(path) + ".html";
  std::ifstream file(native_path(page), std::ios::binary);
  if (!file) return page;
  std::string head(std::size_t{1} << 16, '\0');  // behind licences
  file.read(head.data(), static_cast<std::streamsize>(head.size()));
  if (head.find("<meta name=\"generator\" content=\"cullhull\">") == std::string::npos)
    throw Error(ErrorCode::invalid_argument, page,
                ": is there and is no page of cullhull's; -o PAGE.html names another");
  return page;
}

/// Hull and survivors of one set of points, and the run's report for --json.
struct Computed {
  cullhull::Hull hull;
  cullhull::Survivors survivors;
  std::string report;
};

Computed compute(Input& input, double read_seconds, const cullhull::Options& options) {
  const cullhull::PointView& kept = input.kept();
  Computed result;
  const Stopwatch watch;
  result.hull = cullhull::convex_hull(kept, options);
  cullhull::internal::JsonExtras extras;
  extras.compute_seconds_all = {watch.seconds()};
  extras.read_seconds = read_seconds;
  extras.peak_bytes = peak_bytes();
  // The hull has the number of survivors, but not which points they are.
  if (result.hull.statistics.survivors < kept.count)
    result.survivors = cullhull::cull(kept, options);
  else
    result.survivors.all = true;
  input.skipped.restore(result.hull);
  input.skipped.restore(result.survivors);
  cullhull::to_world(result.hull, input.placing.grid);
  input.to_world();
  result.report =
      with_placing(cullhull::internal::hull_to_json(result.hull, extras), input.placing, kept);
  return result;
}

/// A frame that says how many points are not drawn.
SceneFrame skipping(const Input& input) {
  SceneFrame frame;
  frame.skipped = input.skipped_points();
  return frame;
}

void add_frame(const ViewArguments& arguments, const cullhull::Options& options,
               const cullhull::PointView& points, std::uint64_t index, const cullhull::Hull& hull,
               const cullhull::Survivors& survivors, const std::string& report, Scene& scene,
               SceneFrame frame) {
  const auto triangulation = arguments.triangulation(options);
  if (triangulation && points.count > 0) frame.triangulate = &*triangulation;
  frame.outline = arguments.outline;
  frame.index = index;
  frame.hull = &hull;
  frame.vertex_rows = cullhull::viewer::vertex_rows(points, hull);
  frame.points = points;
  frame.survivors = &survivors;
  frame.report = report;
  scene.add(frame);
}

/// The contents of the file: the page, and its figures.
struct Written {
  std::string page, report;
};

/// What the records of .las files have beside coordinates, for "Colour by".
struct LasFields {
  Input fields;
  std::vector<std::string> names;
  std::vector<std::uint8_t> colours;
};

/// Columns of all points, or none where the point format has no such field.
std::optional<Input> read_fields(const ViewArguments& arguments, const std::string& columns) {
  InputArguments from = arguments.input;
  from.columns = columns;
  from.grid = cullhull::Grid();  // unchanged
  from.skip_nan = false;
  try {
    return open_inputs(from, arguments.files, arguments.run.threads, arguments.run.memory_bytes());
  } catch (const Error& e) {
    if (e.code() != ErrorCode::invalid_argument) throw;
    return std::nullopt;
  }
}

LasFields read_las_fields(const ViewArguments& arguments, const Input& input) {
  LasFields las;
  const std::vector<std::string>& files = arguments.files;
  if (!input.file.format().starts_with("las") ||
      std::find(files.begin(), files.end(), "-") != files.end())
    return las;
  if (std::optional<Input> fields = read_fields(arguments, "classification,intensity")) {
    las.fields = std::move(*fields);
    las.names = {"classification", "intensity"};
  }
  if (const std::optional<Input> rgb = read_fields(arguments, "red,green,blue")) {
    const cullhull::PointView& view = rgb->points;
    double most = 0;
    for (std::uint64_t i = 0; i < view.count; ++i)
      for (std::uint32_t c = 0; c < 3; ++c) most = std::max(most, view.at(i, c));
    const double scale = most > 255 ? 257 : 1;  // some writers fill the low byte alone
    for (std::uint64_t i = 0; most > 0 && i < view.count; ++i)
      for (std::uint32_t c = 0; c < 3; ++c)
        las.colours.push_back(static_cast<std::uint8_t>(view.at(i, c) / scale));
  }
  return las;
}

Written view_input(const ViewArguments& arguments, Input& input, const cullhull::Options& options) {
  Scene scene(arguments.title(), 1, 1);
  const double read = input.file.read_seconds() + warm_pages(input.points);
  const LasFields las = read_las_fields(arguments, input);
  const std::uint64_t n = input.points.count;
  cullhull::PointView colours = input.file.colours();  // of the first file
  if (las.colours.size() == 3 * n)
    colours = cullhull::PointView::row_major(las.colours.data(), n, 3);
  if (colours.count != n) colours = {};
  const Computed computed =
      naming_file(input.places, [&] { return compute(input, read, options); });
  SceneFrame extras;
  extras.colours = colours;
  extras.skipped = input.skipped_points();
  if (las.fields.points.count == n) {
    extras.attributes = las.fields.points;
    extras.attribute_names = las.names;
  }
  add_frame(arguments, options, input.points, 0, computed.hull, computed.survivors, computed.report,
            scene, std::move(extras));
  return {scene.page(), computed.report};
}

Written view_points(const ViewArguments& arguments, cullhull::Options options) {
  // Writing to a pipe has nothing to clean up: a signal ends it at once.
  Input input = open_inputs(arguments.input, arguments.files, arguments.run.threads,
                            arguments.run.memory_bytes());
  RunArguments beside = arguments.run;
  beside.held = input.held();
  options.memory_budget = beside.options().memory_budget;
  Written written;
  cancellable(
      [&] { naming_held(beside.held, [&] { written = view_input(arguments, input, options); }); });
  return written;
}

/// A frame's figures: of its hull, and of its filter.
std::string tracked_report(const cullhull::HullTracker& tracker, const cullhull::Hull& hull,
                           double read_seconds) {
  const cullhull::FrameReport& r = tracker.report();
  cullhull::internal::JsonExtras extras;
  extras.compute_seconds_all = {r.compute_seconds};
  extras.read_seconds = read_seconds;
  extras.peak_bytes = peak_bytes();
  auto report = nlohmann::ordered_json::parse(cullhull::internal::hull_to_json(hull, extras));
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
    return cullhull::internal::json_document("view_report", {},
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
  reading.skip_nan = false;                                              // frame by frame, below
  if (!arguments.input.raw) reading.numbers = cullhull::Numbers::world;  // for looking at
  cullhull::PointSequence sequence = cullhull::open_sequence(arguments.files, reading);
  const std::uint64_t frames = sequence.frames();
  if (frames == 0)
    throw Error(ErrorCode::bad_file, arguments.input.path, ": a sequence without frames");
  Shown chosen(frames);
  Scene scene(arguments.title(), frames, chosen.shown());
  if (frames > 1) options.progress = nullptr;  // the number of frames is shown instead
  cullhull::HullTracker tracker(options);
  while (sequence.next()) {
    if (!chosen.wants(sequence.index())) continue;
    if (progress && frames > 1) progress("frames", chosen.share());
    Input input;
    input.points = sequence.points();
    if (arguments.input.skip_nan) input.skip_nan();
    const cullhull::PointView drawn = input.points;
    const double read = sequence.read_seconds() + warm_pages(input.points);
    if (frames == 1) {  // a single frame: not a moving set
      const Computed computed =
          naming_file(sequence.name(), [&] { return compute(input, read, options); });
      chosen.add(computed.report);
      add_frame(arguments, options, input.points, 0, computed.hull, computed.survivors,
                computed.report, scene, skipping(input));
      continue;
    }
    input.fill_skipped();
    naming_file(sequence.name(), [&] { tracker.update(input.points); });
    cullhull::Hull hull = tracker.hull();
    input.skipped.restore_copies(hull);
    const std::string report =
        with_placing(tracked_report(tracker, hull, read), input.placing, drawn);
    chosen.add(report);
    add_frame(arguments, options, drawn, sequence.index(), hull, tracker.survivors(), report, scene,
              skipping(input));
  }
  return {scene.page(), chosen.report()};
}

/// The members of a hull's report that tell nothing of a run.
std::string result_figures(const cullhull::Hull& hull) {
  auto figures = nlohmann::ordered_json::parse(cullhull::internal::hull_to_json(hull, {}));
  for (const char* key : {"threads", "backend", "cull", "hull", "read_seconds", "compute_seconds",
                          "compute_seconds_all", "peak_bytes", "certified"})
    figures.erase(key);
  figures["kind"] = "hull_figures";
  return cullhull::internal::json_text(figures);
}

Written view_hulls(const ViewArguments& arguments, const std::vector<std::string>& files,
                   const cullhull::Options& options) {
  Shown chosen(files.size());
  Scene scene(arguments.title(), files.size(), chosen.shown());
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

int run(ViewArguments arguments) {
  if (arguments.cells && arguments.outline)
    throw Error(ErrorCode::invalid_argument, "--delaunay and --outline exclude one another");
  if (!cullhull::viewer::available()) Scene("", 1, 1).page();  // throws its reason, before the work
  arguments.files = arguments.input.find_files();
  const bool beside = arguments.output.empty();
  if (beside) arguments.output = page_beside(arguments);
  FilePlan plan;
  plan.reads_inputs(arguments.input.words, arguments.files);
  plan.writes("-o", arguments.output, page_endings);
  plan.writes_json(arguments.json);
  cullhull::Options options = arguments.run.options();
  Written written;
  {
    TerminalProgress progress(arguments.run.quiet);
    options.progress = progress.callback();
    const bool hulls = are_hulls(arguments);
    if ((arguments.cells || arguments.outline) && hulls)
      throw Error(ErrorCode::invalid_argument,
                  arguments.outline ? "--outline: " : "--delaunay: ", arguments.input.path,
                  " is a hull, without its points");
    if (!hulls && !is_sequence(arguments))
      written = view_points(arguments, options);
    else
      cancellable([&] {
        written = hulls ? view_hulls(arguments, arguments.files, options)
                        : view_sequence(arguments, options, options.progress);
      });
  }
  cullhull::write_text(arguments.output, written.page);
  if (!arguments.json.empty()) cullhull::write_text(arguments.json, written.report);
  if (!arguments.run.quiet && !plan.uses_stdout())
    write_stdout(wrote_line(arguments.output) + wrote_line(arguments.json));
  if (beside && !arguments.no_open) system::open_in_browser(arguments.output);
  return 0;
}

}  // namespace

Command add_view(Parser& parent) {
  auto a = std::make_shared<ViewArguments>();
  Parser& command =
      *parent.add_subcommand("view", "Show points and their hull in an interactive HTML page");
  a->input.add_many_to(command);
  command.add_flag("--frames", a->frames,
                   "Show each file as a frame of moving points, with a slider");
  command.group("Output");
  needs_value(*command.add_option("-o,--output", a->output,
                                  "Write the page (default: beside INPUT, and open it)"))
      .type_name("PAGE.html");
  command.add_flag("--no-open", a->no_open, "Do not open the page in a browser");
  command.add_flag("--delaunay", a->cells,
                   "Also show the cells of the Delaunay triangulation: in 2D all of\n"
                   "them, in 3D those that the clipping plane cuts");
  command.add_flag("--outline", a->outline,
                   "Instead show the outline (alpha shape of one region) and its cells");
  add_json_option(command, a->json, "Report the figures of the page");
  a->run.add_to(command, true);
  command.footer(std::string(input_footer) + "\n\n" + help);
  return [a] { return run(*a); };
}

}  // namespace app
