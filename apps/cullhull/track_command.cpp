// cullhull track: the hulls of moving points, frame by frame.
#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "arguments.hpp"
#include "commands.hpp"
#include "cullhull/cullhull.hpp"
#include "cullhull/io.hpp"
#include "measure.hpp"
#include "outputs.hpp"
#include "parallel/paths.hpp"
#include "signals.hpp"
#include "terminal.hpp"

namespace app {
namespace {

using cullhull::Certificate;
using cullhull::Error;
using cullhull::ErrorCode;
using cullhull::FrameReport;
using cullhull::Hull;
using cullhull::internal::native_path;
using cullhull::internal::utf8_name;
using Json = nlohmann::ordered_json;

constexpr const char* track_footer =
    "SEQUENCE is an .npy array (frames, n, d), of which one frame at a time is mapped, so that it "
    "may\n"
    "be larger than memory; or a folder, a quoted pattern or several files with one frame each,\n"
    "ordered by name, with numbers compared by value (2 before 10). Point i of a frame is point i "
    "of\n"
    "the next. Where the number of points or the dimension changes, tracking restarts.\n"
    "File formats: 'cullhull help formats'.\n"
    "\n"
    "Output files:\n"
    "  -o out-%04d.ply    one hull per frame, numbered from 0; .ply .obj .off .stl for 2D and 3D\n"
    "                     points, .json and .txt for all\n"
    "  -o FOLDER          the same as FOLDER/frame-%06d.ply (.json beyond 3 dimensions)\n"
    "  --json             per frame: counts, times, measures, vertices and facets that appeared "
    "and\n"
    "                     disappeared; then totals\n"
    "Every hull equals that of 'cullhull hull' for the frame, bit for bit.\n"
    "\n"
    "Examples:\n"
    "  cullhull track twist.npy --json=report.json         hulls of an array (frames, n, d)\n"
    "  cullhull track scans/ -o hulls/ --certify           a folder of files; hulls verified\n"
    "  cullhull track 'f*.xyz' --cull pseudo-hull          the filter of Tang et al. 2012\n"
    "\n"
    "Exit status: 0 success; 1 bad input; 2 bad usage; 3 not certified; 4 memory limit exceeded;\n"
    "5 backend not available; 130 cancelled.";

struct TrackArguments {
  std::vector<std::string> inputs;
  std::string format;
  bool raw = false;
  bool skip_nan = false;
  RunArguments run;
  std::string output;
  std::string json;
  bool certify = false;
  bool keep_going = false;
  FacesArguments faces;
};

/// Names of the files of -o: text around a frame number padded with zeros.
class FrameNames {
 public:
  explicit FrameNames(std::string pattern) : pattern_(std::move(pattern)) {
    if (pattern_.empty()) return;
    std::error_code ignored;
    folder_ = !native_path(pattern_).has_filename() ||
              std::filesystem::is_directory(native_path(pattern_), ignored);
    if (!folder_) split();
  }

  void make_folder() const {
    if (folder_) std::filesystem::create_directories(native_path(pattern_));
  }

  bool wanted() const { return !pattern_.empty(); }

  std::string of(std::uint64_t frame, std::uint32_t dimension) const {
    if (folder_)
      return utf8_name(native_path(pattern_) /
                       fmt::format("frame-{:06}{}", frame, dimension <= 3 ? ".ply" : ".json"));
    return fmt::format("{}{:0{}}{}", before_, frame, width_, after_);
  }

  void check(std::uint32_t dimension) const {
    if (wanted() && !folder_) check_hull_dimension(pattern_, dimension);
  }

  /// Refuses a name without a hull's extension.
  void check_ending() const {
    const Endings endings = cullhull::internal::output_endings({OutputKind::hull});
    if (wanted() && !folder_ &&
        std::find(endings.begin(), endings.end(), ending_of(pattern_)) == endings.end())
      refuse(must_end_in(endings));
  }

  /// Refuses names that are in use.
  void check(std::uint64_t frames, FilePlan& plan) const {
    if (!wanted()) return;
    for (std::uint64_t f = 0; f < frames; ++f)
      for (const std::uint32_t dimension : {3U, 4U}) plan.writes_frame(of(f, dimension));
  }

 private:
  [[noreturn]] void refuse(const std::string& reason) const {
    throw Error(ErrorCode::invalid_argument, "-o ", pattern_, ": ", reason);
  }

  void split() {
    const auto percent = pattern_.find('%');
    if (percent == std::string::npos)
      refuse("needs a place for the frame's number, such as %04d, or a folder");
    std::size_t at = percent + 1;
    std::string width;
    while (at < pattern_.size() && std::isdigit(static_cast<unsigned char>(pattern_[at])) != 0)
      width += pattern_[at++];
    if (at >= pattern_.size() || pattern_[at] != 'd' || width.size() > 3 || width == "0" ||
        (!width.empty() && width[0] != '0') || pattern_.find('%', at) != std::string::npos)
      refuse("needs one place for the frame's number, %d or such as %04d");
    width_ = width.empty() ? 1 : std::stoi(width);
    before_ = pattern_.substr(0, percent);
    after_ = pattern_.substr(at + 1);
  }

  std::string pattern_, before_, after_;
  int width_ = 1;
  bool folder_ = false;
};

/// Sums over the frames, and a record of each if a report is requested.
struct TrackOutcome {
  Json frames = Json::array();
  std::uint64_t done = 0, led = 0, failed = 0;
  std::uint64_t on_device = 0;                                  ///< frames culled by a CUDA device
  std::uint64_t points = 0, scan_survivors = 0, survivors = 0;  ///< of frames that had leaders
  std::uint64_t fewest = ~std::uint64_t{0}, most = 0;           ///< vertices
  double read = 0, scan = 0, cull = 0, hull = 0, compute = 0;
  std::uint64_t count = 0;
  std::uint32_t dimension = 0;
  cullhull::ScalarType scalar = cullhull::ScalarType::f64;
  unsigned threads = 0;
  std::string error;  ///< the first frame that failed
  std::optional<bool> certified;
  std::string not_certified;
  Placing placing;  ///< of the first frame that has one
  Extent extent;    ///< of the vertices, in the world

  /// The placement of a frame whose `view` is in world coordinates.
  void place(bool raw, const cullhull::PointSequence& sequence, const cullhull::PointView& view,
             const Hull& h) {
    if (placing.columns.empty()) placing.note_columns(sequence.columns(), sequence.format(), "");
    if (sequence.placement().empty()) return;
    if (!placing.any) {
      placing.placement = sequence.placement();
      placing.grid = sequence.grid();
      placing.any = true;
      placing.raw = raw;
    }
    std::vector<double> rows;
    for (const std::uint64_t v : h.vertices)
      for (std::uint32_t j = 0; j < view.dimension; ++j) rows.push_back(view.at(v, j));
    extent.add(cullhull::PointView::row_major(rows.data(), h.vertices.size(), view.dimension));
  }

  void add(const FrameReport& r, const Hull& h, double read_seconds) {
    ++done;
    if (h.statistics.backend == cullhull::Backend::cuda) ++on_device;
    if (std::string_view(r.method) != "static") {
      ++led;
      points += h.point_count;
      scan_survivors += r.scan_survivors;
      survivors += r.survivors;
    }
    fewest = std::min<std::uint64_t>(fewest, h.vertices.size());
    most = std::max<std::uint64_t>(most, h.vertices.size());
    read += read_seconds;
    scan += r.scan_seconds;
    cull += r.cull_seconds;
    hull += r.hull_seconds;
    compute += r.compute_seconds;
    count = h.point_count;
    dimension = h.dimension;
    scalar = h.scalar;
    threads = h.statistics.threads;
  }
  const char* backend() const {
    return on_device == 0 ? "cpu" : on_device == done ? "cuda" : "mixed";
  }
  double share(std::uint64_t part) const {
    return points == 0 ? 0 : static_cast<double>(part) / static_cast<double>(points);
  }
  double frames_per_second() const { return compute > 0 ? static_cast<double>(done) / compute : 0; }
};

Json frame_record(std::uint64_t index, const FrameReport& r, const Hull& h, double read_seconds) {
  Json record = {{"index", index},
                 {"method", r.method},
                 {"backend", cullhull::backend_name(h.statistics.backend)},
                 {"affine_dimension", h.affine_dimension},
                 {"vertex_count", h.vertices.size()},
                 {"facet_count", h.facet_count()},
                 {"scan_survivors", r.scan_survivors},
                 {"survivors", r.survivors},
                 {"vertices_came", r.vertices_came},
                 {"vertices_went", r.vertices_went},
                 {"facets_came", r.facets_came},
                 {"facets_went", r.facets_went},
                 {"read_seconds", read_seconds},
                 {"scan_seconds", r.scan_seconds},
                 {"cull_seconds", r.cull_seconds},
                 {"hull_seconds", r.hull_seconds},
                 {"compute_seconds", r.compute_seconds}};
  add_measures(record, h.affine_dimension, h.area, h.volume);
  return record;
}

/// A frame in the world, whose points may be on a grid.
class Placed {
 public:
  Placed(const cullhull::PointView& points, const Hull& hull, const cullhull::Grid& grid)
      : points_(points), hull_(&hull) {
    if (grid.empty()) return;
    moved_ = hull;
    cullhull::to_world(moved_, grid);
    hull_ = &moved_;
    rows_.reserve(points.count * points.dimension);
    for (std::uint64_t i = 0; i < points.count; ++i)
      for (std::uint32_t j = 0; j < points.dimension; ++j)
        rows_.push_back(grid.to_world(points.at(i, j)));
    points_ = cullhull::PointView::row_major(rows_.data(), points.count, points.dimension);
  }
  Placed(const Placed&) = delete;
  Placed& operator=(const Placed&) = delete;
  const cullhull::PointView& points() const { return points_; }
  const Hull& hull() const { return *hull_; }

 private:
  cullhull::PointView points_;
  const Hull* hull_;
  Hull moved_;
  std::vector<double> rows_;
};

/// Processes one frame; false if its points have no hull and --keep-going was given.
bool track_frame(const TrackArguments& arguments, const FrameNames& names,
                 const cullhull::PointSequence& sequence, cullhull::HullTracker& tracker,
                 const cullhull::Options& options, TrackOutcome& outcome) {
  cullhull::PointView points = sequence.points();
  names.check(points.dimension);
  const Skipped skipped = arguments.skip_nan ? Skipped(points) : Skipped();
  outcome.placing.skipped =
      arguments.skip_nan ? std::optional(skipped.count() + outcome.placing.skipped.value_or(0))
                         : std::nullopt;
  std::vector<std::byte> memory;
  if (skipped.any() && skipped.count() < points.count)
    points = skipped.with_copies(points, memory);
  else if (skipped.any())
    points.count = 0;
  try {
    naming_file(sequence.name(), [&] { tracker.update(points); });
  } catch (const Error& e) {
    if (!arguments.keep_going || e.code() != ErrorCode::not_finite) throw;
    ++outcome.failed;
    if (outcome.error.empty()) outcome.error = e.what();
    if (!arguments.json.empty())
      outcome.frames.push_back({{"index", sequence.index()}, {"error", e.what()}});
    return false;
  }
  std::optional<Certificate> certificate;
  if (arguments.certify) certificate = cullhull::certify(points, tracker.hull(), options);
  Hull restored;
  if (skipped.any()) {
    restored = tracker.hull();
    skipped.restore_copies(restored);
  }
  const Placed frame(points, skipped.any() ? restored : tracker.hull(), sequence.grid());
  const Hull& hull = frame.hull();
  outcome.add(tracker.report(), hull, sequence.read_seconds());
  outcome.place(arguments.raw, sequence, frame.points(), hull);
  if (!arguments.json.empty())
    outcome.frames.push_back(
        frame_record(sequence.index(), tracker.report(), hull, sequence.read_seconds()));
  if (certificate) {
    const Certificate& c = *certificate;
    outcome.certified = outcome.certified.value_or(true) && c.valid;
    if (!arguments.json.empty()) outcome.frames.back()["certified"] = c.valid;
    if (!c.valid && outcome.not_certified.empty())
      outcome.not_certified = fmt::format("frame {}: {}", sequence.index(), c.reason);
  }
  if (names.wanted())
    cullhull::write_hull(names.of(sequence.index(), points.dimension), frame.points(), hull, "",
                         arguments.faces.faces(), {cullhull::file_crs(sequence.name()), {}});
  return true;
}

TrackOutcome track(const TrackArguments& arguments, const FrameNames& names,
                   cullhull::PointSequence& sequence) {
  TrackOutcome outcome;
  const cullhull::Options options = arguments.run.options();
  cullhull::HullTracker tracker(options);
  const auto total = static_cast<double>(sequence.frames());
  TerminalProgress progress(arguments.run.quiet, "frames", total);
  const cullhull::Progress report = progress.callback();
  cancellable([&] {
    while (sequence.next()) {
      if (stop_token().stop_requested()) return;
      track_frame(arguments, names, sequence, tracker, options, outcome);
      if (report) report("frames", static_cast<double>(sequence.index() + 1) / total);
    }
  });
  return outcome;
}

std::string report_of(const TrackArguments& arguments, const cullhull::PointSequence& sequence,
                      TrackOutcome&& o) {
  Json report = {{"format", sequence.format()},
                 {"threads", o.threads},
                 {"backend", o.backend()},
                 {"cull", arguments.run.cull},
                 {"frames", std::move(o.frames)},
                 {"totals",
                  {{"frames", sequence.frames()},
                   {"failed_frames", o.failed},
                   {"led_frames", o.led},
                   {"scan_share", o.share(o.scan_survivors)},
                   {"survivor_share", o.share(o.survivors)},
                   {"read_seconds", o.read},
                   {"scan_seconds", o.scan},
                   {"cull_seconds", o.cull},
                   {"hull_seconds", o.hull},
                   {"compute_seconds", o.compute},
                   {"frames_per_second", o.frames_per_second()}}},
                 {"peak_bytes", peak_bytes()}};
  if (o.certified) report["certified"] = *o.certified;
  cullhull::PointView points;
  points.count = o.count;
  points.dimension = o.dimension;
  points.scalar = o.scalar;
  return with_placing(report_text("track_report", points, report), o.placing,
                      o.extent.corners(cullhull::Grid()));
}

std::string summary(const cullhull::PointSequence& sequence, const TrackOutcome& o) {
  if (sequence.frames() == 0) return "frames     0\n";
  std::string text =
      fmt::format("frames     {}, {}\n", grouped(sequence.frames()), sequence.format());
  text += columns_line(o.placing) + skipped_line(o.placing);
  if (o.done > 0) {
    text += fmt::format("points     {} x {}, {}\n", grouped(o.count), o.dimension,
                        cullhull::scalar_name(o.scalar));
    text += fmt::format("filter     {} frames reused the last hull", grouped(o.led));
    if (o.led > 0)
      text += fmt::format("; it left {:.3g} % of their points, the whole filter {:.3g} %",
                          100 * o.share(o.scan_survivors), 100 * o.share(o.survivors));
    text += "\n";
    text += fmt::format("vertices   {} to {}\n", grouped(o.fewest), grouped(o.most));
    text += fmt::format("seconds    {:.6f} = cull {:.6f} + hull {:.6f}; reading {:.6f}\n",
                        o.compute, o.cull, o.hull, o.read);
    text += fmt::format("mean       {:.6f} a frame, {:.4g} frames/s\n",
                        o.compute / static_cast<double>(o.done), o.frames_per_second());
  }
  if (o.certified) text += fmt::format("certified  {}\n", *o.certified ? "all frames" : "NO");
  return text;
}

int run(const TrackArguments& arguments) {
  cullhull::ReadOptions read;
  read.format = arguments.format;
  read.threads = arguments.run.threads;
  read.memory_budget = arguments.run.memory_bytes();
  read.stop = stop_token();
  read.remark = print_remark;
  read.numbers = arguments.raw ? cullhull::Numbers::raw : cullhull::Numbers::grid;
  const FrameNames names(arguments.output);
  names.check_ending();
  arguments.faces.check({names.wanted() ? names.of(0, 3) : std::string()});
  cullhull::PointSequence sequence = cullhull::open_sequence(arguments.inputs, read);
  FilePlan plan;
  plan.reads(cullhull::sequence_files(arguments.inputs, read));
  plan.writes_json(arguments.json);
  names.check(sequence.frames(), plan);
  names.make_folder();
  TrackOutcome outcome = track(arguments, names, sequence);
  const std::string failed = outcome.error, not_proved = outcome.not_certified;
  std::string text = summary(sequence, outcome);
  if (!arguments.json.empty()) {
    const std::string report = report_of(arguments, sequence, std::move(outcome));
    cullhull::write_text(arguments.json, report);
  }
  if (!arguments.run.quiet && !plan.uses_stdout()) {
    if (names.wanted()) text += fmt::format("wrote      {}\n", arguments.output);
    write_stdout(text + wrote_line(arguments.json));
  }
  if (!not_proved.empty()) {
    complain("not certified: " + not_proved);
    return not_certified;
  }
  if (!failed.empty()) {
    complain(failed);
    return bad_input;
  }
  return 0;
}

}  // namespace

Command add_track(Parser& parent) {
  auto a = std::make_shared<TrackArguments>();
  Parser& command =
      *parent.add_subcommand("track", "Compute the hulls of moving points, frame by frame");
  command.group("Input");
  command
      .add_option("SEQUENCE", a->inputs, "An array (frames, n, d), or files, a folder or a pattern")
      ->type_name("")
      ->required();
  std::vector<std::string> formats = cullhull::input_formats();
  std::erase(formats, "raw");
  allow_words(*command.add_option("--input-format", a->format,
                                  "Read each file in this format, whatever its name and content"),
              formats);
  add_raw_option(command, a->raw);
  add_skip_option(command, a->skip_nan);
  command.add_flag(
      "--keep-going", a->keep_going,
      "Continue after frames with NaN or infinite coordinates; the exit\nstatus is still 1");
  command.group("Output");
  needs_value(*command.add_option("-o,--output", a->output, "Write the hull of each frame"))
      .type_name("PATTERN|FOLDER");
  a->faces.add_to(command, "merged facets");
  add_json_option(command, a->json, "Report each frame");
  a->run.add_to(command, true);
  command.group("Verification and timing");
  command.add_flag("--certify", a->certify, "Verify each hull with an independent exact checker");
  command.footer(track_footer);
  return [a] { return run(*a); };
}

}  // namespace app
