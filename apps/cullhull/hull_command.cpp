// cullhull hull: the exact hull of a file of points.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <optional>

#include "arguments.hpp"
#include "commands.hpp"
#include "cullhull/cullhull.hpp"
#include "measure.hpp"
#include "outputs.hpp"
#include "terminal.hpp"

namespace app {
namespace {

using cullhull::Certificate;
using cullhull::Error;
using cullhull::ErrorCode;
using cullhull::Hull;

constexpr const char* examples =
    "Output (-o, by extension; may be given more than once):\n"
    "  .ply .obj .off .stl   a mesh, for points of dimension 2 and 3\n"
    "  .json                 everything: vertices, facets, planes, neighbours, simplices, "
    "measures\n"
    "  .txt                  the coordinates of the vertices\n"
    "  --vertices IDS.npy    ids of the extreme points, ascending, int64\n"
    "  --format F            on standard output, as qconvex prints it: Fx extreme points, i "
    "facets\n"
    "                        by vertices, o OFF, n normals, p vertex coordinates, FV a point "
    "inside,\n"
    "                        FS area and volume\n"
    "Every option reaches the same result, bit for bit; only --json tells how it was reached.\n"
    "\n"
    "Examples:\n"
    "  cullhull hull scan.ply -o hull.ply                  the hull as a mesh\n"
    "  cullhull hull big.npy --certify --json              counts, times, memory; result checked\n"
    "  cullhull hull cloud.npy --columns 0:3               x y z of longer records\n"
    "  rbox 1000 D4 | cullhull hull - --format Fx          in the place of qconvex\n"
    "  cullhull hull wide.npy --only vertices --vertices ids.npy   9 dimensions, say: no facets\n"
    "  cullhull hull big.npy --repeat 7 --threads 2        the median of seven runs\n"
    "\n"
    "Exit status: 0 success; 1 bad input; 2 bad usage; 3 not certified; 4 out of the memory "
    "budget;\n"
    "5 backend or engine not available; 130 cancelled.";

struct HullArguments {
  InputArguments input;
  RunArguments run;
  std::vector<std::string> outputs;
  std::string vertices;
  std::string json;
  std::string format;
  std::string engine = "native";
  std::string only;
  unsigned repeat = 1;
  bool certify = false;

  /// How many outputs go to standard output.
  int stdout_users() const { return (vertices == "-") + (json == "-") + !format.empty(); }
};

struct Outcome : Repeated<Hull> {
  std::optional<Certificate> certificate;
};

void check_stdout(const HullArguments& arguments) {
  if (arguments.stdout_users() > 1)
    throw Error(ErrorCode::invalid_argument,
                "only one of --vertices -, --json and --format can go to standard output");
}

/// Runs `find` as often as asked; the result's statistics are those of the run of median time.
template <class Find>
auto find_repeatedly(const HullArguments& arguments, const Find& find) {
  std::vector<cullhull::Statistics> statistics;
  auto found = repeat(arguments.run, arguments.repeat, [&](const cullhull::Options& options) {
    auto result = find(options);
    statistics.push_back(result.statistics);
    return result;
  });
  found.result.statistics = statistics[median_run(found.seconds)];
  found.result.statistics.compute_seconds = median(found.seconds);
  return found;
}

Outcome compute(const HullArguments& arguments, const cullhull::PointView& points) {
  Outcome outcome{find_repeatedly(arguments,
                                  [&](cullhull::Options options) {
                                    if (arguments.engine == "qhull")
                                      options.engine = cullhull::Engine::qhull;
                                    return cullhull::convex_hull(points, options);
                                  }),
                  {}};
  if (arguments.certify)
    outcome.certificate = repeat(arguments.run, 1, [&](const cullhull::Options& options) {
                            return cullhull::certify(points, outcome.result, options);
                          }).result;
  return outcome;
}

std::string summary(const Input& input, const Outcome& outcome, double read_seconds,
                    std::uint64_t peak) {
  const Hull& hull = outcome.result;
  const cullhull::Statistics& s = hull.statistics;
  std::string text =
      points_line(input) + survivors_line(s.survivors, hull.point_count, s.cull_method);
  if (hull.affine_dimension >= 0 && hull.affine_dimension != static_cast<int>(hull.dimension))
    text += fmt::format("flat       the points span dimension {} only; the hull is taken there\n",
                        hull.affine_dimension);
  text +=
      fmt::format("vertices   {}\nfacets     {} ({} simplices)\n", grouped(hull.vertices.size()),
                  grouped(hull.facet_count()), grouped(hull.simplex_count()));
  text += fmt::format("area       {}\nvolume     {}\n", hull.area, hull.volume);
  text += fmt::format("seconds    {:.6f} = cull {:.6f} + hull {:.6f}; reading {:.6f}\n",
                      s.compute_seconds, s.cull_seconds, s.hull_seconds, read_seconds);
  if (outcome.seconds.size() > 1)
    text += fmt::format("           the median of {} runs\n", outcome.seconds.size());
  text +=
      fmt::format("run        {} engine, {}, {} thread{}, peak memory {:.1f} MB\n", s.engine,
                  s.backend, s.threads, s.threads == 1 ? "" : "s", static_cast<double>(peak) / 1e6);
  if (outcome.certificate)
    text += fmt::format("certified  {}\n", outcome.certificate->valid ? "yes" : "NO");
  return text;
}

void write_results(const HullArguments& arguments, const Input& input, const Outcome& outcome,
                   double read_seconds, std::uint64_t peak) {
  const Hull& hull = outcome.result;
  for (const std::string& path : arguments.outputs) cullhull::write_hull(path, input.points, hull);
  if (!arguments.vertices.empty()) {
    std::vector<std::uint64_t> ids = hull.vertices;
    std::sort(ids.begin(), ids.end());  // in 2D they come counter-clockwise
    cullhull::write_npy_ids(arguments.vertices, ids);
  }
  if (!arguments.json.empty()) {
    cullhull::JsonExtras extras;
    extras.read_seconds = read_seconds;
    extras.compute_seconds_all = outcome.seconds;
    extras.peak_bytes = peak;
    if (outcome.certificate) extras.certified = outcome.certificate->valid;
    cullhull::write_text(arguments.json, cullhull::hull_to_json(input.points, hull, extras, false));
  }
  if (!arguments.format.empty())
    write_stdout(cullhull::hull_to_qhull_text(input.points, hull, arguments.format));
  if (!arguments.run.quiet && arguments.stdout_users() == 0)
    write_stdout(summary(input, outcome, read_seconds, peak));
}

// ---------------------------------------------------------------------------- --only vertices

using Extreme = Repeated<cullhull::ExtremePoints>;

/// The keys of a hull's JSON that mean something without facets.
std::string extreme_json(const cullhull::PointView& view, const Extreme& found, double read_seconds,
                         std::uint64_t peak) {
  const cullhull::ExtremePoints& points = found.result;
  const cullhull::Statistics& s = points.statistics;
  return fmt::format(
      "{{\n"
      "  \"version\": \"{}\",\n"
      "  \"points\": {{\"count\": {}, \"dimension\": {}, \"scalar\": \"{}\"}},\n"
      "  \"threads\": {},\n"
      "  \"backend\": \"{}\",\n"
      "  \"cull\": {{\"method\": \"{}\", \"survivors\": {}, \"seconds\": {}}},\n"
      "  \"only\": \"vertices\",\n"
      "  \"affine_dimension\": {},\n"
      "  \"vertex_count\": {},\n"
      "  \"read_seconds\": {},\n"
      "  \"compute_seconds\": {},\n"
      "  \"compute_seconds_all\": [{}],\n"
      "  \"peak_bytes\": {},\n"
      "  \"vertices\": [{}]\n"
      "}}\n",
      CULLHULL_VERSION, view.count, view.dimension, cullhull::scalar_name(view.scalar), s.threads,
      s.backend, s.cull_method, s.survivors, s.cull_seconds, points.affine_dimension,
      points.ids.size(), read_seconds, s.compute_seconds, fmt::join(found.seconds, ", "), peak,
      fmt::join(points.ids, ", "));
}

int run_vertices_only(const HullArguments& arguments) {
  if (!arguments.outputs.empty() || !arguments.format.empty() || arguments.certify ||
      arguments.engine != "native")
    throw Error(ErrorCode::invalid_argument,
                "--only vertices finds no facets: it goes with --vertices and --json, not with -o, "
                "--format, --certify or --engine qhull");
  const Input input = open_input(arguments.input, arguments.run.threads);
  const double read_seconds = input.file.read_seconds() + warm_pages(input.points);
  const Extreme found = find_repeatedly(arguments, [&](const cullhull::Options& options) {
    return cullhull::extreme_points(input.points, options);
  });
  const cullhull::ExtremePoints& extreme = found.result;
  if (!arguments.vertices.empty()) cullhull::write_npy_ids(arguments.vertices, extreme.ids);
  if (!arguments.json.empty())
    cullhull::write_text(arguments.json,
                         extreme_json(input.points, found, read_seconds, peak_bytes()));
  if (arguments.run.quiet || arguments.stdout_users() > 0) return 0;
  const cullhull::Statistics& s = extreme.statistics;
  write_stdout(points_line(input) + survivors_line(s.survivors, input.points.count, s.cull_method) +
               fmt::format("vertices   {}\nseconds    {:.6f}; reading {:.6f}\n",
                           grouped(extreme.ids.size()), s.compute_seconds, read_seconds));
  return 0;
}

int run(const HullArguments& arguments) {
  check_stdout(arguments);
  if (!arguments.only.empty()) return run_vertices_only(arguments);
  const Input input = open_input(arguments.input, arguments.run.threads);
  for (const std::string& path : arguments.outputs) check_hull_file(path, input.points.dimension);
  const double read_seconds = input.file.read_seconds() + warm_pages(input.points);
  const Outcome outcome = compute(arguments, input.points);
  write_results(arguments, input, outcome, read_seconds, peak_bytes());
  if (outcome.certificate && !outcome.certificate->valid) {
    complain("not certified: " + outcome.certificate->reason);
    return not_certified;
  }
  return 0;
}

}  // namespace

Command add_hull(CLI::App& parent) {
  auto a = std::make_shared<HullArguments>();
  CLI::App& command = *parent.add_subcommand("hull", "The exact convex hull of a file of points");
  command.add_option("-o,--output", a->outputs, "Write the hull to this file")
      ->allow_extra_args(false)
      ->type_name("FILE");
  command.add_option("--vertices", a->vertices, "Write the ids of the extreme points")
      ->type_name("IDS.npy");
  command
      .add_option("--json", a->json,
                  "Counts, times and measures as JSON, on standard output or to FILE")
      ->type_name("[=FILE]");
  allow_words(*command.add_option("--format", a->format, "Print the hull as qconvex does"),
              {"Fx", "i", "o", "n", "p", "FV", "FS"});
  a->run.add_to(command, true);
  allow_words(*command.add_option("--engine", a->engine, "Hull code behind the filter"),
              {"native", "qhull"});
  allow_words(*command.add_option("--only", a->only,
                                  "vertices: which points are extreme, without facets (for high "
                                  "dimensions)"),
              {"vertices"});
  allow_range(*command.add_option("--repeat", a->repeat, "Compute N times, report the median"), 1,
              1000000);
  command.add_flag("--certify", a->certify,
                   "Check the result exactly, by none of the engine's code");
  a->input.add_to(command);
  command.footer(std::string(input_help) + "\n\n" + examples);
  return [a] { return run(*a); };
}

}  // namespace app
