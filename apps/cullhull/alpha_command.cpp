// cullhull alpha: the alpha shape, or the concave hull by edges, of a file of points.
#include <fmt/format.h>

#include <charconv>
#include <cmath>
#include <limits>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "arguments.hpp"
#include "commands.hpp"
#include "cullhull/alpha_shape.hpp"
#include "cullhull/error.hpp"
#include "cullhull/triangulation.hpp"
#include "cullhull/triangulation_io.hpp"
#include "diagrams/memory_needs.hpp"
#include "group_hulls.hpp"
#include "kept_columns.hpp"
#include "measure.hpp"
#include "outputs.hpp"
#include "terminal.hpp"
#include "topics.hpp"

namespace app {
namespace {

using cullhull::AlphaShape;
using cullhull::Error;
using cullhull::ErrorCode;
using cullhull::PointView;
using cullhull::Triangulation;

constexpr const char* footer =
    "Alpha shape (--alpha): the Delaunay cells whose circumscribed circle or sphere has a radius "
    "of\n"
    "at most alpha:\n"
    "  one-region            the least alpha that gives a single region with all points (default)\n"
    "  all-points            the least alpha that leaves every point in a cell\n"
    "  NUMBER                this alpha, compared exactly; inf gives the convex hull\n"
    "\n"
    "Concave hull of 2D points (--edge-length, --ratio): a single ring without holes around all\n"
    "points. It starts as the convex hull; the longest boundary edge is replaced by the two other\n"
    "sides of its triangle as long as it exceeds a limit:\n"
    "  --edge-length NUMBER  this length, compared exactly\n"
    "  --ratio NUMBER        0: the shortest edge of the triangulation; 1: the longest, which "
    "gives\n"
    "                        the convex hull; linear between\n"
    "\n"
    "Output files (-o, by extension):\n"
    "  .geojson .wkt         2D: polygons with holes, one per region\n"
    "  .ply .obj .off .stl .glb .vtp   3D: the boundary; 2D: the triangles\n"
    "  .vtk                  cells of points of up to 3 dimensions\n"
    "  .json                 alpha, cells and boundary facets as point ids\n"
    "\n"
    "Examples:\n"
    "  cullhull alpha lidar.las --columns x,y -o outline.geojson   an outline with holes\n"
    "  cullhull alpha sites.csv --ratio 0.1 -o outline.wkt         one ring around all points\n"
    "  cullhull alpha points.csv --by id -o outlines.geojson       a shape for each value of id\n"
    "  cullhull alpha scan.ply --alpha 0.05 -o surface.stl         a surface around points\n"
    "\n"
    "All points must fit in memory.\n"
    "\n"
    "Exit status: 0 success; 1 bad input; 2 bad usage; 4 memory limit exceeded; 130 cancelled.";

struct AlphaArguments {
  InputArguments input;
  RunArguments run;
  std::vector<std::string> outputs;
  std::string alpha, json;  ///< alpha: a number or a word; empty: the default, or by edges
  std::string by;           ///< the column of the groups' keys
  std::string keep;         ///< columns beside the points
  double edge_length = -1, ratio = -1;  ///< negative: not given
  std::vector<std::string> files;       ///< that the words of the input stand for

  bool by_edges() const { return edge_length >= 0 || ratio >= 0; }
};

/// Refuses what contradicts itself, before the work.
void check_choice(const AlphaArguments& a) {
  const int given =
      (a.alpha.empty() ? 0 : 1) + (a.edge_length >= 0 ? 1 : 0) + (a.ratio >= 0 ? 1 : 0);
  if (given > 1)
    throw Error(ErrorCode::invalid_argument,
                "--alpha, --edge-length and --ratio exclude one another");
}

struct Outcome {
  Triangulation triangulation;
  AlphaShape shape;
  double alpha = 0, read_seconds = 0, compute_seconds = 0;
  std::optional<double> edge_length;  ///< by it, not by alpha
  std::uint64_t region_count = 0;
  cullhull::ShapeMeasures measures;
};

/// The number of --alpha; negative for one of the words.
double given_alpha(const std::string& text) {
  if (text.empty() || text == "one-region" || text == "all-points") return -1;
  if (text == "inf") return INFINITY;
  double value = -1;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !(value >= 0))
    throw Error(ErrorCode::invalid_argument,
                fmt::format("--alpha {}: expected one-region, all-points or a number >= 0", text));
  return value;
}

/// Pieces of the shape, joined through facets.
std::uint64_t count_regions(const Triangulation& t, const AlphaShape& shape) {
  std::vector<bool> todo(t.size());
  for (const std::uint32_t c : shape.cells) todo[c] = true;
  std::uint64_t regions = 0;
  std::vector<std::uint32_t> stack;
  for (const std::uint32_t first : shape.cells) {
    if (!todo[first]) continue;
    ++regions;
    todo[first] = false;
    for (stack.assign(1, first); !stack.empty();) {
      const std::uint32_t c = stack.back();
      stack.pop_back();
      for (const std::uint32_t o : t.neighbours_of(c)) {
        if (o == cullhull::no_index || !todo[o]) continue;
        todo[o] = false;
        stack.push_back(o);
      }
    }
  }
  return regions;
}

/// Lengths of `out` are on the grid that the points are on.
void find_shape(AlphaArguments a, const Input& input, const cullhull::Grid& grid, Outcome& out) {
  const PointView& points = input.points;
  const Stopwatch watch;
  out.triangulation =
      repeat(a.run, 1, [&](const cullhull::Options& options) {
        const auto o = cullhull::options_as<cullhull::TriangulationOptions>(options);
        return naming_file(input.places, [&] { return cullhull::delaunay(points, o); });
      }).result;
  const Triangulation& t = out.triangulation;
  a.run.held += cullhull::internal::held_bytes(t);
  out.alpha = a.by_edges() ? NAN : grid.to_grid(given_alpha(a.alpha));
  if (a.edge_length >= 0) out.edge_length = grid.to_grid(a.edge_length);
  out.shape = repeat(a.run, 1, [&](const cullhull::Options& options) {
                if (a.ratio >= 0)
                  out.edge_length = cullhull::concave_length(points, t, a.ratio, options);
                if (out.edge_length)
                  return cullhull::concave_hull(points, t, *out.edge_length, options);
                if (out.alpha < 0)
                  out.alpha = cullhull::critical_alpha(points, t, a.alpha != "all-points", options);
                return cullhull::alpha_shape(points, t, out.alpha, options);
              }).result;
  out.region_count = count_regions(t, out.shape);
  out.compute_seconds = watch.seconds();
}

std::string report(const Input& input, const Outcome& out) {
  const Triangulation& t = out.triangulation;
  nlohmann::ordered_json json;
  add_placing(json, input.placing, input.points);
  json["threads"] = t.statistics.threads;
  json["affine_dimension"] = t.affine_dimension;
  json["alpha"] = out.edge_length ? nlohmann::ordered_json() : nlohmann::ordered_json(out.alpha);
  if (out.edge_length) json["edge_length"] = *out.edge_length;
  json["cell_count"] = out.shape.cells.size();
  json["facet_count"] = out.shape.facet_cells.size();
  json["region_count"] = out.region_count;
  add_measures(json, t.affine_dimension, out.measures.boundary, out.measures.volume);
  json["read_seconds"] = out.read_seconds;
  json["compute_seconds"] = out.compute_seconds;
  json["peak_bytes"] = peak_bytes();
  return report_text("alpha_report", input.points, json);
}

std::string summary(const AlphaArguments& a, const Input& input, const Outcome& out) {
  const Triangulation& t = out.triangulation;
  std::string text = points_line(input) + units_lines(input.placing, input.points);
  if (t.affine_dimension >= 0 && t.affine_dimension != static_cast<int>(t.dimension))
    text += fmt::format("flat       the points span dimension {} only, and so does the shape\n",
                        t.affine_dimension);
  text += out.edge_length
              ? fmt::format("edges      replaced where longer than {}\n", *out.edge_length)
              : fmt::format("alpha      {}\n", out.alpha);
  text += fmt::format("cells      {} of {}, {} facets around {} region{}\n",
                      grouped(out.shape.cells.size()), grouped(t.size()),
                      grouped(out.shape.facet_cells.size()), grouped(out.region_count),
                      out.region_count == 1 ? "" : "s");
  text += measure_lines(t.affine_dimension, out.measures.boundary, out.measures.volume);
  text += fmt::format("seconds    {:.6f}; reading {:.6f}\n", out.compute_seconds, out.read_seconds);
  for (const std::string& path : a.outputs) text += wrote_line(path);
  return text + wrote_line(a.json);
}

/// Groups have a single kind of output.
int run_by(const AlphaArguments& a, FilePlan& plan) {
  if (a.outputs.size() != 1 || !a.json.empty())
    throw Error(ErrorCode::invalid_argument,
                "--by writes the shapes of groups to one -o (.geojson .csv .json), without --json");
  plan.writes("-o", a.outputs[0], {OutputKind::group_hulls});
  const cullhull::GroupShape shape{.one_region = a.alpha != "all-points",
                                   .alpha = given_alpha(a.alpha),
                                   .edge_length = a.edge_length,
                                   .ratio = a.ratio};
  return run_group_shapes(a.input, a.files, a.by, a.keep, a.outputs[0], shape, a.run);
}

int run(AlphaArguments a) {
  check_choice(a);
  (void)given_alpha(a.alpha);  // refused before the work
  a.files = a.input.find_files();
  FilePlan plan;
  plan.reads_inputs(a.input.words, a.files);
  check_keep(a.keep, a.files, maps_among(a.outputs), {".geojson"});
  if (!a.by.empty()) return run_by(a, plan);
  for (const std::string& path : a.outputs) plan.writes("-o", path, {OutputKind::triangulation});
  plan.writes_json(a.json);
  Input input = open_inputs(a.input, a.files, a.run.threads, a.run.memory_bytes());
  input.fill_skipped();
  for (const std::string& path : a.outputs)
    cullhull::check_alpha_shape_format(path, input.points.dimension);
  a.run.held = input.held();
  Outcome out;
  out.read_seconds = input.file.read_seconds() + warm_pages(input.points);
  const cullhull::Grid grid = input.placing.grid;
  find_shape(a, input, grid, out);
  input.skipped.restore_copies(out.triangulation);
  input.to_world();
  out.measures = cullhull::shape_measures(input.points, out.triangulation, out.shape);
  out.alpha = grid.to_world(out.alpha);
  if (out.edge_length) out.edge_length = grid.to_world(*out.edge_length);
  const cullhull::MapExtras extras{input.placing.crs,
                                   kept_columns(a.keep, a.input, a.files, a.run)};
  for (const std::string& path : a.outputs)
    cullhull::write_alpha_shape(path, input.points, out.triangulation, out.shape, out.alpha, "",
                                extras);
  if (!a.json.empty()) cullhull::write_text(a.json, report(input, out));
  if (!a.run.quiet && !plan.uses_stdout()) write_stdout(summary(a, input, out));
  return 0;
}

}  // namespace

Command add_alpha(Parser& parent) {
  auto a = std::make_shared<AlphaArguments>();
  Parser& command =
      *parent.add_subcommand("alpha", "Compute the alpha shape or a concave hull of points");
  a->input.add_many_to(command);
  add_crs_option(command, a->input.crs);
  command.group("Output");
  needs_value(*command.add_option("-o,--output", a->outputs,
                                  "Write the shape; the extension chooses the format. Repeat\n"
                                  "-o for more files"))
      .allow_extra_args(false)
      ->type_name("FILE");
  add_json_option(command, a->json, "Report counts, measures and times");
  needs_value(*command.add_option("--by", a->by,
                                  "Compute one shape per group: the points with the same value in\n"
                                  "COLUMN (name or number); -o .geojson (2D), .csv or .json"))
      .type_name("COLUMN");
  add_keep_option(command, a->keep, "what the points of a shape have in common, to .geojson");
  command.group("Shape");
  needs_value(*command.add_option("--alpha", a->alpha,
                                  "Largest circumradius of a cell: a number, one-region (default)\n"
                                  "or all-points"))
      .type_name("NUMBER|WORD");
  allow_real_range(*command
                        .add_option("--edge-length", a->edge_length,
                                    "Concave hull instead: replace boundary edges longer than this")
                        ->type_name("NUMBER"),
                   0, std::numeric_limits<double>::max());
  allow_real_range(*command
                        .add_option("--ratio", a->ratio,
                                    "Concave hull instead, with a limit relative to the edge\n"
                                    "lengths, from 0 to 1")
                        ->type_name("NUMBER"),
                   0, 1);
  a->run.add_to(command, false);
  a->run.add_memory_to(command);
  command.footer(std::string(input_footer) + "\n\n" + footer);
  return [a] { return run(*a); };
}

}  // namespace app
