// cullhull hull: the exact hull of a file of points.
#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>
#include <type_traits>

#include "arguments.hpp"
#include "commands.hpp"
#include "cullhull/cullhull.hpp"
#include "cullhull/io.hpp"
#include "grid_hull.hpp"
#include "group_hulls.hpp"
#include "io/grid_axes.hpp"
#include "io/json/json.hpp"
#include "kept_columns.hpp"
#include "measure.hpp"
#include "outputs.hpp"
#include "streaming.hpp"
#include "terminal.hpp"
#include "topics.hpp"

namespace app {
namespace {

using cullhull::Certificate;
using cullhull::Error;
using cullhull::ErrorCode;
using cullhull::Hull;

constexpr const char* hull_footer =
    "Output files (-o, by extension):\n"
    "  .ply .obj .off .stl   mesh of the hull of 2D or 3D points\n"
    "  .glb .vtp             meshes for viewers: 32-bit floats relative to the centre; doubles\n"
    "  .geojson .wkt         polygon of 2D points\n"
    "  .json                 complete result: vertices, facets, planes, neighbours, simplices,\n"
    "                        measures; also written by -o - on standard output\n"
    "  .txt                  coordinates of the vertices\n"
    "  .hullstate .npz       mergeable partial result, as --partial writes it\n"
    "  --vertices writes ids (.npy, int64, .csv or .txt), in ascending order, or points (.ply,\n"
    "  .xyz or .geojson).\n"
    "  --format takes the words of qconvex: Fx i o n p f s Fa FA FC FD FF Fi FI Fn FN Fo Fs FS\n"
    "  Ft Fv FV (docs/formats.md): Fx extreme points, i facets, n normals, o OFF, ...\n"
    "An input file is never overwritten. Options change how the result is computed, never the\n"
    "result: files hold the result alone; the summary and --json also say how it was computed.\n"
    "\n"
    "Examples:\n"
    "  cullhull hull scan.ply -o hull.ply                  the hull as a mesh\n"
    "  cullhull hull tile.las --columns x,y -o hull.geojson    outline of a LiDAR tile\n"
    "  cullhull hull big.npy --certify --json              counts, times, memory; verified\n"
    "  cullhull hull cloud.npy --columns 0:3               x, y, z of longer rows\n"
    "  rbox 1000 D4 | cullhull hull - --format 'Fx n'      replaces qconvex\n"
    "  cullhull hull wide.npy --only vertices --vertices ids.npy   high dimensions: no facets\n"
    "  cullhull hull points.csv --by id -o hulls.geojson   a hull for each value of id\n"
    "  cullhull hull big.npy --repeat 7 --threads 2        median time of seven runs\n"
    "  cullhull hull big.las --part 3/16 -o 3.hullstate    one of 16 jobs; docs/clusters.md\n"
    "\n"
    "Exit status: 0 success; 1 bad input; 2 bad usage; 3 not certified; 4 memory limit exceeded;\n"
    "5 backend not available; 130 cancelled.";

struct HullArguments {
  InputArguments input;
  RunArguments run;
  std::vector<std::string> outputs;
  std::string vertices, keep;
  std::string json;
  std::vector<std::string> formats;  ///< words, several of which may be in one string
  std::string only;
  std::string by;  ///< the column of the groups' keys
  unsigned repeat = 1;
  bool certify = false;
  FacesArguments faces;
  StreamArguments stream;
  std::vector<std::string> files;  ///< the files that the input's words stand for
};

struct HullOutcome : Repeated<Hull> {
  std::optional<Certificate> certificate;
};

/// "Fx n" and "i" as Fx, n, i.
std::vector<std::string> format_words(const std::vector<std::string>& given) {
  std::vector<std::string> words;
  for (std::string text : given) {
    std::replace(text.begin(), text.end(), ',', ' ');
    std::istringstream in(text);
    for (std::string word; in >> word;) words.push_back(word);
    if (words.empty()) throw Error(ErrorCode::invalid_argument, "--format needs a word such as Fx");
  }
  for (const std::string& word : words) cullhull::check_qhull_format(word);
  return words;
}

FilePlan plan_files(const HullArguments& arguments) {
  arguments.faces.check(arguments.outputs);
  FilePlan plan;
  plan.reads_inputs(arguments.input.words, arguments.files);
  for (const std::string& path : arguments.outputs)
    if (arguments.by.empty())
      plan.writes("-o", path, {OutputKind::hull, OutputKind::state});
    else
      plan.writes("-o", path, {OutputKind::group_hulls});
  plan.writes("--vertices", arguments.vertices, {OutputKind::ids, OutputKind::points});
  std::vector<std::string> maps = maps_among(arguments.outputs);
  if (holds_points(arguments.vertices)) maps.push_back(arguments.vertices);
  check_keep(arguments.keep, arguments.files, maps, {".geojson"}, arguments.stream.first_id);
  plan.writes_json(arguments.json);
  arguments.stream.plan(plan);
  if (!arguments.formats.empty()) plan.prints("--format");
  return plan;
}

/// Runs `find` as often as requested; the result has the statistics of the run of median time.
template <class Find>
auto find_repeatedly(const HullArguments& arguments, const Places& places, const Find& find) {
  std::vector<cullhull::Statistics> statistics;
  auto found = repeat(arguments.run, arguments.repeat, [&](const cullhull::Options& options) {
    auto result = naming_file(places, [&] { return find(options); });
    statistics.push_back(result.statistics);
    return result;
  });
  found.result.statistics = statistics[median_run(found.seconds)];
  found.result.statistics.compute_seconds = median(found.seconds);
  return found;
}

/// Whether the points of one .las are as stored in the file, and on a grid.
bool in_place(const Input& input) {
  return !input.placing.raw && input.points.scalar == cullhull::ScalarType::i32 &&
         !input.placing.grid.empty();
}

HullOutcome compute(const HullArguments& arguments, const Input& input) {
  const cullhull::PointView& points = input.kept();
  HullOutcome outcome{find_repeatedly(
                          arguments, input.places,
                          [&](const cullhull::Options& options) {
    const Placing& placing = input.placing;
    return in_place(input) ? hull_on_grid(points, placing.placement, placing.grid, options)
                           : cullhull::convex_hull(points, options);
                          }),
                      {}};
  if (arguments.certify)
    outcome.certificate = repeat(arguments.run, 1, [&](const cullhull::Options& options) {
                            return cullhull::certify(points, outcome.result, options);
                          }).result;
  input.skipped.restore(outcome.result);
  return outcome;
}

/// Prints counts and measures.
std::string hull_lines(const Hull& hull) {
  std::string text;
  if (hull.affine_dimension >= 0 && hull.affine_dimension != static_cast<int>(hull.dimension))
    text += fmt::format(
        "flat       the points lie in a flat of dimension {}; the hull is computed in it\n",
        hull.affine_dimension);
  text +=
      fmt::format("vertices   {}\nfacets     {} ({} simplices)\n", grouped(hull.vertices.size()),
                  grouped(hull.facet_count()), grouped(hull.simplex_count()));
  return text + measure_lines(hull.affine_dimension, hull.area, hull.volume);
}

std::string run_lines(const Hull& hull, const std::optional<Certificate>& certificate,
                      std::uint64_t peak) {
  const cullhull::Statistics& s = hull.statistics;
  std::string text = fmt::format("run        {}, {} thread{}, peak memory {:.1f} MB\n",
                                 cullhull::backend_name(s.backend), s.threads,
                                 s.threads == 1 ? "" : "s", static_cast<double>(peak) / 1e6);
  if (certificate) text += fmt::format("certified  {}\n", certificate->valid ? "yes" : "NO");
  return text;
}

std::string summary(const HullOutcome& outcome, double read_seconds, std::uint64_t peak) {
  const Hull& hull = outcome.result;
  const cullhull::Statistics& s = hull.statistics;
  return survivors_line(s.survivors, hull.point_count, cullhull::filter_name(s.filter)) +
         hull_lines(hull) +
         fmt::format("seconds    {:.6f} = cull {:.6f} + hull {:.6f}; reading {:.6f}\n",
                     s.compute_seconds, s.cull_seconds, s.hull_seconds, read_seconds) +
         (outcome.seconds.size() > 1
              ? fmt::format("           the median of {} runs\n", outcome.seconds.size())
              : std::string()) +
         run_lines(hull, outcome.certificate, peak);
}

/// Names the files written.
std::string wrote_lines(const HullArguments& arguments) {
  std::string text;
  for (const std::string& path : arguments.outputs) text += wrote_line(path);
  return text + wrote_line(arguments.vertices) + wrote_line(arguments.json) +
         wrote_line(arguments.stream.partial);
}

/// The system, and the columns that --keep names.
cullhull::MapExtras extras_of(const HullArguments& arguments, const std::string& crs) {
  return {crs, kept_columns(arguments.keep, arguments.input, arguments.files, arguments.run)};
}

/// `points`: all points, or the state of these. `ids`: ascending.
template <class Points>
void write_vertices(const HullArguments& arguments, const Points& points,
                    const std::vector<std::uint64_t>& ids, const cullhull::MapExtras& extras) {
  if (!holds_points(arguments.vertices))
    cullhull::write_ids(arguments.vertices, ids);
  else if constexpr (std::is_same_v<Points, cullhull::HullState>)
    cullhull::write_points(arguments.vertices, points, "", extras);
  else
    cullhull::write_points(arguments.vertices, points, ids, "", extras);
}

/// `points`: all points, or their state.
template <class Points>
void write_results(const HullArguments& arguments, const Points& points, const Placing& placing,
                   const cullhull::PointView& extreme, const Hull& hull,
                   const cullhull::internal::JsonExtras& extras) {
  const cullhull::MapExtras beside = extras_of(arguments, placing.crs);
  for (const std::string& path : arguments.outputs)
    cullhull::write_hull(path, points, hull, "", arguments.faces.faces(), beside);
  if (!arguments.vertices.empty()) {
    std::vector<std::uint64_t> ids = hull.vertices;
    std::sort(ids.begin(), ids.end());  // in 2D they are counter-clockwise
    write_vertices(arguments, points, ids, beside);
  }
  if (!arguments.json.empty())
    cullhull::write_text(
        arguments.json,
        with_placing(cullhull::internal::hull_to_json(hull, extras), placing, extreme));
  for (const std::string& word : format_words(arguments.formats))
    write_stdout(cullhull::hull_to_qhull_text(points, hull, word));
}

cullhull::internal::JsonExtras extras_of(const std::optional<Certificate>& certificate,
                                         const std::vector<double>& seconds, double read_seconds,
                                         std::uint64_t peak) {
  cullhull::internal::JsonExtras extras;
  extras.read_seconds = read_seconds;
  extras.compute_seconds_all = seconds;
  extras.peak_bytes = peak;
  if (certificate) extras.certified = certificate->valid;
  return extras;
}

int exit_of(const std::optional<Certificate>& certificate) {
  if (!certificate || certificate->valid) return 0;
  complain("not certified: " + certificate->reason);
  return not_certified;
}

// ---------------------------------------------------------------------------- --only vertices

using Extreme = Repeated<cullhull::ExtremePoints>;

/// The members of a hull's JSON that do not need facets.
std::string extreme_json(const cullhull::PointView& view, const Extreme& found, double read_seconds,
                         std::uint64_t peak) {
  const cullhull::ExtremePoints& points = found.result;
  const cullhull::Statistics& s = points.statistics;
  nlohmann::ordered_json json;
  json["threads"] = s.threads;
  json["backend"] = cullhull::backend_name(s.backend);
  json["cull"] = {{"method", cullhull::filter_name(s.filter)},
                  {"survivors", s.survivors},
                  {"seconds", s.cull_seconds}};
  json["only"] = "vertices";
  json["affine_dimension"] = points.affine_dimension;
  json["vertex_count"] = points.ids.size();
  json["read_seconds"] = read_seconds;
  json["compute_seconds"] = s.compute_seconds;
  json["compute_seconds_all"] = found.seconds;
  json["peak_bytes"] = peak;
  json["vertices"] = points.ids;
  return report_text("extreme_report", view, json);
}

void check_vertices_only(const HullArguments& arguments) {
  if (!arguments.outputs.empty() || !arguments.formats.empty() || arguments.certify)
    throw Error(ErrorCode::invalid_argument,
                "--only vertices finds no facets: it goes with --vertices and --json, not with -o, "
                "--format or --certify");
}

/// Coordinates of points in the world, of inputs that have a placement.
std::vector<double> placed_rows(const Input& input, const std::vector<std::uint64_t>& ids) {
  std::vector<double> rows;
  for (std::size_t i = 0; input.placing.any && i < ids.size(); ++i)
    for (std::uint32_t j = 0; j < input.points.dimension; ++j)
      rows.push_back(input.placing.grid.to_world(input.points.at(ids[i], j)));
  return rows;
}

int run_vertices_only(HullArguments arguments, const FilePlan& plan) {
  Input input = open_inputs(arguments.input, arguments.files, arguments.run.threads,
                            arguments.run.memory_bytes());
  arguments.run.held = input.held();
  check_points_dimension(arguments.vertices, input.points.dimension);
  const double read_seconds = input.file.read_seconds() + warm_pages(input.points);
  Extreme found = find_repeatedly(arguments, input.places, [&](const cullhull::Options& options) {
    return cullhull::extreme_points(input.kept(), options);
  });
  input.skipped.restore(found.result.ids);
  const cullhull::ExtremePoints& extreme = found.result;
  const std::vector<double> rows = placed_rows(input, extreme.ids);
  const cullhull::PointView placed =
      cullhull::PointView::row_major(rows.data(), extreme.ids.size(), input.points.dimension);
  if (holds_points(arguments.vertices)) input.to_world();
  if (!arguments.vertices.empty())
    write_vertices(arguments, input.points, extreme.ids, extras_of(arguments, input.placing.crs));
  if (!arguments.json.empty())
    cullhull::write_text(arguments.json,
                         with_placing(extreme_json(input.points, found, read_seconds, peak_bytes()),
                                      input.placing, placed));
  if (arguments.run.quiet || plan.uses_stdout()) return 0;
  const cullhull::Statistics& s = extreme.statistics;
  write_stdout(points_line(input) + units_lines(input.placing, placed) +
               survivors_line(s.survivors, input.points.count, cullhull::filter_name(s.filter)) +
               fmt::format("vertices   {}\nseconds    {:.6f}; reading {:.6f}\n",
                           grouped(extreme.ids.size()), s.compute_seconds, read_seconds) +
               wrote_lines(arguments));
  return 0;
}

// ---------------------------------------------------------------------------- in blocks

/// The first option that lists every point; empty if no option does.
std::string lists_all_points(const HullArguments& arguments) {
  for (const std::string& word : format_words(arguments.formats))
    for (const char* whole : {"o", "f", "FF", "Ft", "FN"})
      if (word == whole) return "--format " + word;
  return "";
}

/// The first option that needs all points in memory; empty if no option does.
std::string needs_memory(const HullArguments& arguments) {
  if (arguments.repeat > 1) return "--repeat";
  if (arguments.run.cull != "auto") return "--cull " + arguments.run.cull;
  if (arguments.run.backend == "cuda") return "--backend cuda";
  if (const std::string lists = lists_all_points(arguments); !lists.empty()) return lists;
  // The points are read twice, or stay in memory.
  if (const std::string pipe = first_pipe(arguments.files); arguments.certify && !pipe.empty())
    return "--certify of " + input_name(pipe);
  return "";
}

/// A row for each vertex.
std::vector<double> vertex_rows(const cullhull::HullState& state, const Hull& hull) {
  std::vector<double> rows;
  const cullhull::PointView points = state.points();
  const std::vector<std::uint64_t>& ids = state.ids();
  for (const std::uint64_t v : hull.vertices) {
    const auto row = std::lower_bound(ids.begin(), ids.end(), v) - ids.begin();
    for (std::uint32_t j = 0; j < points.dimension; ++j)
      rows.push_back(points.at(static_cast<std::uint64_t>(row), j));
  }
  return rows;
}

/// Reads everything again and certifies the hull.
Certificate certify_streamed(const HullArguments& arguments, const Streamed& streamed,
                             const Hull& hull) {
  for (const std::string& file : arguments.files)
    if (file == "-" || ending_of(file) == ".hullstate")
      throw Error(ErrorCode::invalid_argument, "--certify reads all points once more, which ",
                  input_name(file), " does not have");
  std::vector<double> rows = vertex_rows(streamed.state, hull);
  cullhull::Options options = arguments.run.options();
  options.threads = 1;  // the reading threads do the work
  Hull from_zero = hull;
  from_zero.rename([&](std::uint64_t id) { return id - arguments.stream.first_id; });
  cullhull::CertifyStream check(from_zero, std::move(rows), options);
  stream_blocks(
      arguments.input, arguments.files, arguments.run,
      [&](const cullhull::PointView& block, std::uint64_t first) { check.push(block, first); },
      [&](std::uint64_t count) { check.skip(count); });
  return check.finish();
}

/// The bytes of its ids and coordinates, which --memory has to hold as well.
std::uint64_t bytes_of(const cullhull::HullState& state) {
  return state.ids().size() * (8 + state.dimension() * cullhull::scalar_size(state.scalar()));
}

Hull hull_of_state(const HullArguments& arguments, const Streamed& streamed) {
  const Stopwatch watch;
  const std::uint64_t held = bytes_of(streamed.state);
  Repeated<Hull> found = repeat(arguments.run, 1, [&](cullhull::Options options) {
    if (options.memory_budget > 0)
      options.memory_budget -= std::min(held, options.memory_budget - 1);
    return streamed.state.hull(options);
  });
  cullhull::Statistics& s = found.result.statistics;
  s.survivors = streamed.state.ids().size();
  s.filter = cullhull::UsedFilter::stream;
  s.cull_reason = fmt::format("points in {} blocks, {} maps, {} exact reductions; then {}",
                              streamed.read.blocks, streamed.report.maps,
                              streamed.report.reductions, s.cull_reason);
  s.cull_seconds = streamed.seconds;
  s.hull_seconds = watch.seconds();
  s.compute_seconds = s.cull_seconds + s.hull_seconds;
  return std::move(found.result);
}

/// The state's points, with their ids.
std::string extreme_json_of(const HullArguments& arguments, const Streamed& streamed) {
  cullhull::PointView all = streamed.state.points();
  Extreme found;
  found.result = cullhull::extreme_points(all, arguments.run.options());
  found.result.ids = streamed.state.ids();
  found.seconds = {streamed.seconds};
  cullhull::Statistics& s = found.result.statistics;
  s.filter = cullhull::UsedFilter::stream;
  s.survivors = all.count;
  s.cull_seconds = s.compute_seconds = streamed.seconds;
  all.count = streamed.state.point_count();
  cullhull::HullState placed = streamed.state;
  cullhull::to_world(placed, streamed.read.grid);
  return with_placing(extreme_json(all, found, 0, peak_bytes()), streamed.placing(),
                      placed.points());
}

std::string state_lines(const HullArguments& arguments, const Streamed& streamed) {
  return streamed_points_line(streamed, arguments.files.size()) +
         survivors_line(streamed.state.ids().size(), streamed.state.point_count(), "stream");
}

int run_streamed(const HullArguments& arguments, const FilePlan& plan) {
  Streamed streamed =
      stream_state(arguments.input, arguments.files, arguments.stream, arguments.run);
  cullhull::HullState& state = streamed.state;
  const cullhull::Grid& grid = streamed.read.grid;
  const bool speaks = !arguments.run.quiet && !plan.uses_stdout();
  write_partial(arguments.stream, state, grid);
  const bool only_vertices = !arguments.only.empty();
  const bool only_state = !arguments.stream.partial.empty() && arguments.outputs.empty() &&
                          arguments.vertices.empty() && arguments.json.empty() &&
                          arguments.formats.empty() && !arguments.certify;
  if (only_vertices || only_state) {
    check_points_dimension(arguments.vertices, state.dimension());
    if (!arguments.json.empty())
      cullhull::write_text(arguments.json, extreme_json_of(arguments, streamed));
    if (holds_points(arguments.vertices)) cullhull::to_world(state, grid);
    if (!arguments.vertices.empty())
      write_vertices(arguments, state, state.ids(), extras_of(arguments, streamed.placing().crs));
    if (speaks)
      write_stdout(state_lines(arguments, streamed) + skipped_line(streamed.placing()) +
                   fmt::format("seconds    {:.6f}\n", streamed.seconds) + wrote_lines(arguments));
    remove_checkpoint(arguments.stream);
    return 0;
  }
  for (const std::string& path : arguments.outputs) check_hull_dimension(path, state.dimension());
  check_points_dimension(arguments.vertices, state.dimension());
  Hull hull = hull_of_state(arguments, streamed);
  std::optional<Certificate> certificate;
  if (arguments.certify) certificate = certify_streamed(arguments, streamed, hull);
  const std::uint64_t peak = peak_bytes();
  cullhull::to_world(hull, grid);
  cullhull::to_world(state, grid);
  write_results(arguments, state, streamed.placing(), state.points(), hull,
                extras_of(certificate, {hull.statistics.compute_seconds}, 0, peak));
  if (speaks)
    write_stdout(state_lines(arguments, streamed) +
                 units_lines(streamed.placing(), state.points()) + hull_lines(hull) +
                 fmt::format("seconds    {:.6f} = stream {:.6f} + hull {:.6f}\n",
                             hull.statistics.compute_seconds, hull.statistics.cull_seconds,
                             hull.statistics.hull_seconds) +
                 run_lines(hull, certificate, peak) + wrote_lines(arguments));
  remove_checkpoint(arguments.stream);
  return exit_of(certificate);
}

/// A single .las stays where it is unless something needs all points at their places.
Input open_numbers(const HullArguments& arguments) {
  const RunArguments& run = arguments.run;
  if (arguments.files.size() > 1 || arguments.input.raw)
    return open_inputs(arguments.input, arguments.files, run.threads, run.memory_bytes());
  InputArguments one = arguments.input;
  one.path = arguments.files[0];
  cullhull::ReadOptions read = read_options(one, run.threads, run.memory_bytes());
  read.numbers = cullhull::Numbers::file;
  Input input = open_input(one, read);
  remark_on_shape(input_name(one.path), input.points.count, input.points.dimension);
  input.placing.grid = cullhull::common_grid({input.placing.placement});
  if (!in_place(input) || arguments.certify || !arguments.formats.empty()) input.to_grid(read);
  return input;
}

/// Coordinates of the vertices in the world.
std::vector<double> placed_vertices(const Input& input, const Hull& hull) {
  std::vector<double> rows;
  const cullhull::internal::GridAxes axes(input.placing.placement, input.placing.grid);
  for (const std::uint64_t v : hull.vertices)
    for (std::uint32_t j = 0; j < hull.dimension; ++j)
      rows.push_back(input.placing.grid.to_world(axes.at(j, input.points.at(v, j))));
  return rows;
}

int run_in_memory(HullArguments arguments, const FilePlan& plan) {
  if (!arguments.only.empty()) return run_vertices_only(std::move(arguments), plan);
  Input input = open_numbers(arguments);
  arguments.run.held = input.held();
  for (const std::string& path : arguments.outputs)
    check_hull_dimension(path, input.points.dimension);
  check_points_dimension(arguments.vertices, input.points.dimension);
  const double read_seconds = input.file.read_seconds() + warm_pages(input.points);
  HullOutcome outcome = compute(arguments, input);
  const std::uint64_t peak = peak_bytes();
  cullhull::to_world(outcome.result, input.placing.grid);
  const std::string points = points_line(input);
  std::vector<double> vertices;
  cullhull::PointView extreme = input.points;
  if (in_place(input)) {
    vertices = placed_vertices(input, outcome.result);
    const std::uint32_t d = input.points.dimension;
    extreme = cullhull::PointView::row_major(vertices.data(), vertices.size() / d, d);
  }
  const bool moves =
      !in_place(input) || !arguments.outputs.empty() || holds_points(arguments.vertices);
  if (moves) input.to_world();
  if (vertices.empty()) extreme = input.kept();
  write_results(arguments, input.points, input.placing, extreme, outcome.result,
                extras_of(outcome.certificate, outcome.seconds, read_seconds, peak));
  if (!arguments.run.quiet && !plan.uses_stdout())
    write_stdout(points + units_lines(input.placing, extreme) +
                 summary(outcome, read_seconds, peak) + wrote_lines(arguments));
  return exit_of(outcome.certificate);
}

/// Groups have a single kind of output.
void check_groups(const HullArguments& a) {
  const bool others = !a.vertices.empty() || !a.json.empty() || !a.formats.empty() || a.certify ||
                      a.faces.triangles || a.faces.polygons || a.repeat > 1 || !a.only.empty() ||
                      a.stream.any();
  if (a.outputs.empty() && !others)
    throw Error(ErrorCode::invalid_argument,
                "--by needs one -o FILE.geojson (2D), FILE.csv or FILE.json for the hulls");
  if (a.outputs.size() != 1 || others)
    throw Error(ErrorCode::invalid_argument,
                "--by writes the hulls of groups to one -o (.geojson .csv .json) and goes with "
                "--columns, --memory and --threads");
}

int run(HullArguments arguments) {
  (void)format_words(arguments.formats);  // refuses unknown words before the work
  arguments.files = arguments.input.find_files();
  if (arguments.by.empty()) arguments.stream.take_state(arguments.outputs);
  const FilePlan plan = plan_files(arguments);
  if (!arguments.by.empty()) {
    check_groups(arguments);
    return run_groups(arguments.input, arguments.files, arguments.by, arguments.keep,
                      arguments.outputs[0], arguments.run);
  }
  if (!arguments.only.empty()) check_vertices_only(arguments);
  if (arguments.certify && !arguments.stream.part.empty())
    throw Error(ErrorCode::invalid_argument,
                "--part with --certify: certify the merged hull, with 'cullhull certify'");
  const std::string lists = lists_all_points(arguments);
  if (arguments.input.skip_nan && !lists.empty())
    throw Error(ErrorCode::invalid_argument, "--skip-nan: ", lists, " lists every point");
  const std::string why_not = needs_memory(arguments);
  if (arguments.stream.wanted(arguments.files, arguments.run, why_not))
    return run_streamed(arguments, plan);
  arguments.input.blocks_hint = StreamArguments::hint(why_not);
  return run_in_memory(std::move(arguments), plan);
}

}  // namespace

Command add_hull(Parser& parent) {
  auto a = std::make_shared<HullArguments>();
  Parser& command = *parent.add_subcommand("hull", "Compute the exact convex hull of points");
  a->input.add_many_to(command);
  add_crs_option(command, a->input.crs);
  command.group("Output");
  needs_value(*command.add_option("-o,--output", a->outputs,
                                  "Write the hull; the extension chooses the format. Repeat\n"
                                  "-o for more files"))
      .allow_extra_args(false)
      ->type_name("FILE");
  needs_value(*command.add_option("--vertices", a->vertices,
                                  "Write the extreme points: ids (.npy .csv .txt) or points (.ply\n"
                                  ".xyz .geojson)"))
      .type_name("FILE");
  add_json_option(command, a->json, "Report counts, times and measures");
  needs_value(*command.add_option("--format", a->formats,
                                  "Print the hull as qconvex does. Quote several words:\n"
                                  "--format 'Fx n'"))
      .allow_extra_args(false)
      ->offers(cullhull::qhull_formats())
      ->type_name("WORDS");
  needs_value(*command.add_option("--by", a->by,
                                  "Compute one hull per group: the points with the same value in\n"
                                  "COLUMN (name or number); -o .geojson (2D), .csv or .json"))
      .type_name("COLUMN");
  add_keep_option(command, a->keep,
                  "of each point of --vertices,\n"
                  "and what the points of a hull have in common, to .geojson");
  a->faces.add_to(command, "merged facets");
  allow_words(
      *command.add_option("--only", a->only,
                          "Compute only the vertices, not the facets (for high dimensions)"),
      {"vertices"});
  a->run.add_to(command, true);
  command.group("Verification and timing");
  command.add_flag("--certify", a->certify, "Verify the result with an independent exact checker");
  allow_range(
      *command.add_option("--repeat", a->repeat, "Compute N times and report the median time"), 1,
      1000000);
  a->stream.add_to(command, true);
  a->stream.add_part_to(command);
  command.footer(std::string(input_footer) + "\n\n" + hull_footer);
  return [a] { return run(*a); };
}

}  // namespace app
