// cullhull delaunay, cullhull voronoi: triangulations of a file of points and their duals.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <numeric>
#include <optional>
#include <sstream>

#include "arguments.hpp"
#include "commands.hpp"
#include "cullhull/alpha_shape.hpp"
#include "cullhull/constrained.hpp"
#include "cullhull/error.hpp"
#include "cullhull/triangulation.hpp"
#include "cullhull/triangulation_io.hpp"
#include "cullhull/voronoi.hpp"
#include "delaunay/memory_needs.hpp"
#include "diagrams/memory_needs.hpp"
#include "io/formats/crs.hpp"
#include "kept_columns.hpp"
#include "measure.hpp"
#include "outputs.hpp"
#include "parallel/paths.hpp"
#include "terminal.hpp"
#include "topics.hpp"

namespace app {
namespace {

using cullhull::Certificate;
using cullhull::Error;
using cullhull::ErrorCode;
using cullhull::PointView;
using cullhull::Triangulation;
using cullhull::Voronoi;
using cullhull::internal::native_path;
using cullhull::internal::utf8_name;

constexpr const char* delaunay_footer =
    "Output files (-o, by extension):\n"
    "  .ply .obj .off .stl .glb .vtp   triangles of 2D points, at the heights of --height\n"
    "  .vtk                  cells of points of up to 3 dimensions\n"
    "  .geojson .wkt         triangles of 2D points\n"
    "  .json                 complete result: cells, neighbours, groups, hull, duplicates, hidden\n"
    "                        points\n"
    "  --format takes: i cells, Fn neighbours, Fx points of the hull, p all points.\n"
    "\n"
    "Examples:\n"
    "  cullhull delaunay disk.npy -o mesh.ply --certify      the mesh, verified\n"
    "  cullhull delaunay sites.csv --columns x,y --weights w -o regular.json\n"
    "  cullhull delaunay terrain.csv --columns x,y --height z -o tin.obj   a surface (TIN)\n"
    "  cullhull delaunay terrain.csv --columns x,y --height z --max-edge 50 -o tin.ply\n"
    "  rbox 100 D2 | cullhull delaunay - --format i          replaces qdelaunay\n"
    "  cullhull delaunay map.csv --edges rings.csv --inside -o map.vtp   a polygon's interior\n"
    "\n"
    "All points must fit in memory.\n"
    "\n"
    "Exit status: 0 success; 1 bad input; 2 bad usage; 3 not certified; 4 memory limit exceeded;\n"
    "130 cancelled.";

constexpr const char* voronoi_footer =
    "Output files (-o, by extension):\n"
    "  .geojson .wkt         clipped cells of 2D points, one polygon per point\n"
    "  .ply .obj .off .vtp   the same as a mesh; in 3D the faces of all cells\n"
    "  .json                 the unclipped diagram: vertices, ridges, regions, unbounded rays\n"
    "  --measures FILE       length, area or volume of each clipped cell (.npy, .csv, .txt)\n"
    "  --format takes: p vertices, o vertices and regions, Fv ridges.\n"
    "Cells are clipped to --box or --clip; default: the bounding box of the points, padded on "
    "each\n"
    "side by 10 % of its longest side.\n"
    "\n"
    "Examples:\n"
    "  cullhull voronoi disk.npy -o cells.geojson            the cells as polygons\n"
    "  cullhull voronoi wells.csv --box 0,0,100,100 --measures areas.csv\n"
    "  cullhull voronoi cities.csv --clip country.geojson -o cells.geojson\n"
    "  rbox 100 D2 | cullhull voronoi - --format 'p Fv'      replaces qvoronoi\n"
    "\n"
    "All points must fit in memory.\n"
    "\n"
    "Exit status: 0 success; 1 bad input; 2 bad usage; 3 not certified; 4 memory limit exceeded;\n"
    "130 cancelled.";

struct DualArguments {
  InputArguments input;
  RunArguments run;
  std::vector<std::string> outputs, formats;
  std::string weights, heights, json, measures, box, clip, edges, keep;
  bool furthest = false, certify = false, inside = false;
  FacesArguments faces;
  double max_edge = -1;            ///< negative: not given
  std::vector<std::string> files;  ///< that the words of the input stand for
};

std::vector<std::string> words_of(const std::vector<std::string>& given,
                                  const std::vector<std::string>& known) {
  std::vector<std::string> words;
  for (std::string text : given) {
    std::replace(text.begin(), text.end(), ',', ' ');
    std::istringstream in(text);
    for (std::string word; in >> word;) {
      if (std::find(known.begin(), known.end(), word) == known.end())
        throw Error(ErrorCode::invalid_argument,
                    fmt::format("--format {}: expected {}", word, fmt::join(known, " ")));
      words.push_back(word);
    }
  }
  return words;
}

bool names_file(const std::string& given) {
  std::error_code ignored;
  return !given.empty() && std::filesystem::exists(native_path(given), ignored);
}

/// The numbers of a file with one a point, or of a column of the input; `option` names `given`.
std::vector<double> read_numbers(const DualArguments& a, const char* option,
                                 const std::string& given, std::uint64_t count) {
  if (given.empty()) return {};
  InputArguments from;
  const bool is_file = names_file(given);
  if (is_file) {
    from.path = given;
  } else {
    from = a.input;
    from.columns = given;
    from.weights.clear();
    from.skip_nan = false;  // a number for each point, also those left out
  }
  from.grid = cullhull::Grid();  // unchanged
  const Input input = is_file ? open_input(from, a.run.threads, a.run.memory_bytes())
                              : open_inputs(from, a.files, a.run.threads, a.run.memory_bytes());
  if (input.points.dimension != 1)
    throw Error(ErrorCode::invalid_argument,
                fmt::format("{} {}: {} columns; expected one number per point", option, given,
                            input.points.dimension));
  if (input.points.count != count)
    throw Error(ErrorCode::invalid_argument, fmt::format("{} {}: {} numbers for {} points", option,
                                                         given, input.points.count, count));
  std::vector<double> numbers(count);
  for (std::uint64_t i = 0; i < count; ++i) numbers[i] = input.points.at(i, 0);
  return numbers;
}

/// Whether the name is one of GeoJSON, compressed or not.
bool is_geojson(const std::string& file) {
  std::filesystem::path name = native_path(file);
  if (const std::string ending = ending_of(file); ending == ".gz" || ending == ".zst")
    name.replace_extension();
  return ending_of(utf8_name(name)) == ".geojson";
}

/// "FILE:LINE" of an edge, or "FILE" where it has no line of its own.
std::string place_of_edge(const DualArguments& a, std::uint64_t edge) {
  if (is_geojson(a.edges)) return input_name(a.edges);
  const auto line = cullhull::line_of_point(a.edges, edge);
  return input_name(a.edges) + (line ? ":" + std::to_string(*line) : "");
}

[[noreturn]] void refuse_edge(const DualArguments& a, std::uint64_t edge, const std::string& has) {
  throw Error(ErrorCode::bad_file, place_of_edge(a, edge), ": edge ", edge, " has ", has);
}

/// Refuses a file that `option` names in another system than the points.
void check_same_crs(const DualArguments& a, const char* option, const std::string& file) {
  const std::string& crs = a.input.crs;
  if (crs.empty()) return;
  const std::string other = cullhull::file_crs(file);
  const auto is_wgs84 = cullhull::internal::is_wgs84;
  if (other.empty() || other == crs || (is_wgs84(other) && is_wgs84(crs))) return;
  throw Error(ErrorCode::bad_file, option, ' ', file, ": states ", other,
              ", but the points are in ", crs);
}

/// The segments of lines whose corners are points, by the points' ids; of equal points the first.
std::vector<std::uint32_t> read_line_edges(const DualArguments& a, const Input& input) {
  check_same_crs(a, "--edges", a.edges);
  const cullhull::Polygons lines = cullhull::read_lines(a.edges);
  const PointView& points = input.points;
  if (points.dimension != 2)
    throw Error(ErrorCode::invalid_argument,
                fmt::format("--edges needs 2D points, but these are {}D; --columns x,y leaves the "
                            "height out",
                            points.dimension));
  const cullhull::Grid& grid = input.placing.grid;
  std::map<std::pair<double, double>, std::uint32_t> ids;
  for (std::uint64_t i = 0; i < points.count; ++i)
    if (!input.skipped.contains(i))
      ids.emplace(std::pair{grid.to_world(points.at(i, 0)), grid.to_world(points.at(i, 1))},
                  static_cast<std::uint32_t>(i));
  std::vector<std::uint32_t> edges;
  for (std::size_t line = 0; line + 1 < lines.ring_offsets.size(); ++line) {
    std::optional<std::uint32_t> before;
    for (std::uint64_t i = lines.ring_offsets[line]; i < lines.ring_offsets[line + 1]; ++i) {
      const double x = lines.corners[2 * i], y = lines.corners[2 * i + 1];
      const auto found = ids.find({x, y});
      if (found == ids.end())
        throw Error(ErrorCode::bad_file,
                    fmt::format("--edges {}: line {} has a corner at {} {}, where no point is; "
                                "corners of lines must be points (INPUT may be several files)",
                                a.edges, line, x, y));
      if (before && *before != found->second) edges.insert(edges.end(), {*before, found->second});
      before = found->second;
    }
  }
  return edges;
}

/// Pairs of numbers of points, a pair a line; or the segments of GeoJSON's lines.
std::vector<std::uint32_t> read_edges(const DualArguments& a, const Input& of) {
  if (is_geojson(a.edges)) return read_line_edges(a, of);
  const std::uint64_t count = of.points.count;
  InputArguments from;
  from.path = a.edges;
  from.grid = cullhull::Grid();  // point numbers, unchanged
  const Input input = open_input(from, a.run.threads, a.run.memory_bytes());
  if (input.points.dimension != 2)
    throw Error(
        ErrorCode::bad_file, input_name(a.edges), ": ",
        fmt::format("{} columns; --edges expects two point ids per line", input.points.dimension));
  std::vector<std::uint32_t> edges;
  for (std::uint64_t i = 0; i < input.points.count; ++i)
    for (std::uint32_t j = 0; j < 2; ++j) {
      const double v = input.points.at(i, j);
      if (!(v >= 0 && v < static_cast<double>(count) && v == std::floor(v)))
        refuse_edge(a, i, fmt::format("{}, which is not the id of one of {} points", v, count));
      if (of.skipped.contains(static_cast<std::uint64_t>(v)))
        refuse_edge(a, i, fmt::format("point {}, which --skip-nan leaves out", v));
      edges.push_back(static_cast<std::uint32_t>(v));
    }
  return edges;
}

/// A fault that the constraints have together, such as edges that cross, is one of their file.
[[noreturn]] void rethrow_of_edges(const DualArguments& a, const Error& e) {
  constexpr std::string_view begin = "edges ";
  const std::string_view message = e.what();
  std::uint64_t edge = 0;
  const bool named =
      message.starts_with(begin) &&
      std::from_chars(message.data() + begin.size(), message.data() + message.size(), edge).ec ==
          std::errc();
  throw Error(ErrorCode::bad_file, named ? place_of_edge(a, edge) : input_name(a.edges), ": ",
              message);
}

struct Box {
  std::vector<double> low, high;
};

/// The numbers of --box; `axes`: of the points, 0 where these are not known yet.
std::vector<double> box_numbers(const std::string& box, std::uint32_t axes) {
  std::string text = box;
  std::replace(text.begin(), text.end(), ',', ' ');
  std::istringstream in(text);
  std::vector<double> numbers;
  for (double v; in >> v;) numbers.push_back(v);
  const bool fits = axes == 0 ? !numbers.empty() && numbers.size() % 2 == 0
                              : numbers.size() == std::size_t{2} * axes;
  if (in.eof() && fits) return numbers;
  throw Error(ErrorCode::invalid_argument,
              fmt::format("--box {}: expected {}numbers joined by commas, the lower bound of each "
                          "axis, then the upper bounds",
                          box, axes == 0 ? "" : fmt::format("{} ", 2 * axes)));
}

/// On the points' grid.
Box box_of(const DualArguments& a, const PointView& points, const cullhull::Grid& grid) {
  const std::uint32_t d = points.dimension;
  Box box;
  if (!a.box.empty()) {
    std::vector<double> numbers = box_numbers(a.box, d);
    for (double& v : numbers) v = grid.to_grid(v);
    box.low.assign(numbers.begin(), numbers.begin() + d);
    box.high.assign(numbers.begin() + d, numbers.end());
    return box;
  }
  double widest = 0;
  for (std::uint32_t j = 0; j < d; ++j) {
    double low = points.count > 0 ? points.at(0, j) : 0, high = low;
    for (std::uint64_t i = 1; i < points.count; ++i) {
      low = std::min(low, points.at(i, j));
      high = std::max(high, points.at(i, j));
    }
    box.low.push_back(low);
    box.high.push_back(high);
    widest = std::max(widest, high - low);
  }
  const double margin = widest > 0 ? widest / 10 : grid.to_grid(1);
  for (std::uint32_t j = 0; j < d; ++j) {
    box.low[j] -= margin;
    box.high[j] += margin;
  }
  return box;
}

/// On the points' grid.
cullhull::Polygons read_region(const DualArguments& a, const cullhull::Grid& grid) {
  check_same_crs(a, "--clip", a.clip);
  cullhull::Polygons region = cullhull::read_polygons(a.clip);
  for (double& x : region.corners) x = grid.to_grid(x);
  return region;
}

struct DualOutcome {
  Triangulation triangulation;
  std::optional<Voronoi> voronoi;
  std::optional<cullhull::ClippedCells> cells;
  std::optional<Certificate> certificate;
  std::optional<std::uint64_t> piece_count;  ///< of forced edges
  std::optional<std::uint64_t> dropped;      ///< cells with edges longer than --max-edge
  std::vector<double> weights, heights;
  double read_seconds = 0, dual_seconds = 0;
};

void triangulate_with_edges(const DualArguments& a, const Input& input, DualOutcome& out) {
  const PointView& points = input.points;
  const std::vector<std::uint32_t> edges = read_edges(a, input);
  cullhull::ConstrainedTriangulation found =
      repeat(a.run, 1, [&](const cullhull::Options& options) {
        auto o = cullhull::options_as<cullhull::ConstrainedOptions>(options);
        o.inside_only = a.inside;
        return naming_file(input.places, [&] {
          cullhull::ConstrainedTriangulation made;
          try {
            made = cullhull::constrained_delaunay(points, edges, o);
          } catch (const Error& e) {
            // The points' dimension is no fault of the edges.
            if (e.code() != ErrorCode::invalid_argument || points.dimension != 2) throw;
            rethrow_of_edges(a, e);
          }
          if (a.certify) out.certificate = cullhull::certify(points, edges, made, o);
          return made;
        });
      }).result;
  out.piece_count = found.piece_sources.size();
  out.triangulation = std::move(found.triangulation);
}

/// Whether an output holds clipped cells: all but the JSON of the diagram.
bool writes_cells(const DualArguments& a) {
  return !a.measures.empty() ||
         std::any_of(a.outputs.begin(), a.outputs.end(), [](const std::string& path) {
           return path != "-" && ending_of(path) != ".json";
         });
}

bool wants_cells(const DualArguments& a) {
  return writes_cells(a) || !a.clip.empty() || !a.box.empty();
}

/// How many times as much memory the diagram needs, with the triangulation that it is made of, as
/// the triangulation needs by itself.
double share_of_diagram(const DualArguments& a, std::uint32_t d) {
  using namespace cullhull::internal;
  // Cells for each point, as points that fill a region have them; beyond 3D what counts by the
  // point is negligible.
  const std::uint64_t n = 1, cells = d <= 2 ? d : d == 3 ? 7 : 32;
  const std::uint64_t held = cells * 8 * (d + 1);
  std::uint64_t most = held + voronoi_bytes(n, cells, d, d);
  // The diagram holds about half of what it needed to be made.
  if (wants_cells(a))
    most = std::max(most,
                    held + voronoi_bytes(n, cells, d, d) / 2 + clip_bytes(n, cells, d, true, true));
  const std::uint64_t alone = n * bytes_per_point(d) + cells * bytes_per_cell(d);
  return std::max(1.0, static_cast<double>(most) / static_cast<double>(alone));
}

/// Triangulates within the memory limit less `share` times the triangulation's need, which is kept
/// for the diagram: a diagram that does not fit is refused before any work.
Triangulation within_share(const DualArguments& a, double share, const Input& input,
                           const std::vector<double>& weights) {
  const auto make = [&](cullhull::Options options) {
    const std::uint64_t budget = cullhull::internal::resolve_budget(options.memory_budget);
    options.memory_budget =
        std::max<std::uint64_t>(1, static_cast<std::uint64_t>(double(budget) / share));
    auto o = cullhull::options_as<cullhull::TriangulationOptions>(options);
    o.furthest_site = a.furthest;
    return naming_file(input.places, [&] {
      return weights.empty() ? cullhull::delaunay(input.points, o)
                             : cullhull::regular_triangulation(input.points, weights, o);
    });
  };
  if (share == 1) return repeat(a.run, 1, make).result;
  try {
    return repeat(a.run, 1, make).result;
  } catch (const Error& e) {
    if (e.code() != ErrorCode::out_of_budget) throw;
    throw Error(e.code(), e.what(), "; the rest of the limit is for the diagram");
  }
}

void triangulate(const DualArguments& a, bool dual, const Input& input, DualOutcome& out) {
  if (!a.edges.empty()) return triangulate_with_edges(a, input, out);
  const PointView& points = input.points;
  out.triangulation =
      within_share(a, dual ? share_of_diagram(a, points.dimension) : 1.0, input, out.weights);
  if (!a.certify) return;
  out.certificate = out.weights.empty() ? cullhull::certify(points, out.triangulation)
                                        : cullhull::certify(points, out.weights, out.triangulation);
}

/// Leaves the cells out that have an edge longer than --max-edge.
void drop_long(const DualArguments& a, const Input& input, DualOutcome& out) {
  if (a.max_edge < 0) return;
  const std::uint64_t all = out.triangulation.size();
  const double length = input.placing.grid.to_grid(a.max_edge);
  out.triangulation = repeat(a.run, 1, [&](const cullhull::Options& options) {
                        return cullhull::without_long_edges(
                            input.points, std::move(out.triangulation), length, options);
                      }).result;
  out.dropped = all - out.triangulation.size();
}

double sum_of(const cullhull::Array<double>& numbers) {
  return std::accumulate(numbers.begin(), numbers.end(), 0.0);
}

std::string_view size_name(std::uint32_t dimension) {
  constexpr std::string_view names[] = {"size", "length", "area", "volume"};
  return names[dimension < std::size(names) ? dimension : 0];
}

void find_dual(DualArguments a, const PointView& points, const cullhull::Grid& grid,
               DualOutcome& out) {
  const Stopwatch watch;
  a.run.held += cullhull::internal::held_bytes(out.triangulation);
  out.voronoi = repeat(a.run, 1, [&](const cullhull::Options& options) {
                  return cullhull::voronoi(points, out.triangulation, out.weights, options);
                }).result;
  a.run.held += cullhull::internal::held_bytes(*out.voronoi);
  const auto clipping = [&](const cullhull::Options& options) {
    auto o = cullhull::options_as<cullhull::ClipOptions>(options);
    o.diagram = &*out.voronoi;
    return o;
  };
  if (wants_cells(a) && !a.clip.empty()) {
    const cullhull::Polygons region = read_region(a, grid);
    const auto clip = [&](const cullhull::Options& options) {
      return cullhull::clip_voronoi(points, out.triangulation, region.points(), region.ring_offsets,
                                    out.weights, clipping(options));
    };
    try {
      out.cells = repeat(a.run, 1, clip).result;
    } catch (const Error& e) {
      if (e.code() != ErrorCode::invalid_argument) throw;
      throw Error(ErrorCode::bad_file, a.clip, ": ", e.what());
    }
  } else if (wants_cells(a)) {
    const Box box = box_of(a, points, grid);
    out.cells = repeat(a.run, 1, [&](const cullhull::Options& options) {
                  return cullhull::clip_voronoi(points, out.triangulation, box.low, box.high,
                                                out.weights, clipping(options));
                }).result;
  }
  out.dual_seconds = watch.seconds();
}

std::string report(const DualArguments& a, const Input& input, const DualOutcome& out) {
  const PointView& points = input.points;
  const Triangulation& t = out.triangulation;
  nlohmann::ordered_json json;
  add_placing(json, input.placing, points);
  json["threads"] = t.statistics.threads;
  json["weights"] = !out.weights.empty();
  json["furthest_site"] = a.furthest;
  json["affine_dimension"] = t.affine_dimension;
  json["cell_count"] = t.size();
  json["merged_cell_count"] =
      t.size() == 0 ? 0
      : t.cell_groups.empty()
          ? t.size()
          : std::uint64_t{*std::max_element(t.cell_groups.begin(), t.cell_groups.end())} + 1;
  json["hull_facet_count"] = t.hull_facet_count();
  json["duplicate_count"] = t.duplicates.size();
  json["hidden_count"] = t.hidden.size() - input.skipped_points();
  if (out.piece_count) json["piece_count"] = *out.piece_count;
  if (out.dropped) json["dropped_cell_count"] = *out.dropped;
  if (out.voronoi) {
    json["vertex_count"] = out.voronoi->vertex_count();
    json["ridge_count"] = out.voronoi->ridge_count();
    json["measure"] =
        out.cells ? nlohmann::ordered_json(sum_of(out.cells->measures)) : nlohmann::ordered_json();
    json["dual_seconds"] = out.dual_seconds;
  }
  json["certified"] =
      out.certificate ? nlohmann::ordered_json(out.certificate->valid) : nlohmann::ordered_json();
  json["read_seconds"] = out.read_seconds;
  json["compute_seconds"] = t.statistics.compute_seconds;
  json["peak_bytes"] = peak_bytes();
  return report_text(out.voronoi ? "voronoi_report" : "triangulation_report", points, json);
}

std::string summary(const DualArguments& a, const Input& input, const DualOutcome& out) {
  const Triangulation& t = out.triangulation;
  std::string text = points_line(input) + units_lines(input.placing, input.points);
  if (t.affine_dimension >= 0 && t.affine_dimension != static_cast<int>(t.dimension))
    text += fmt::format(
        "flat       the points lie in a flat of dimension {}; they are triangulated in it\n",
        t.affine_dimension);
  text += fmt::format("{}, {} facets on the hull\n",
                      out.voronoi ? fmt::format("delaunay   {} cells", grouped(t.size()))
                                  : fmt::format("cells      {}", grouped(t.size())),
                      grouped(t.hull_facet_count()));
  if (out.piece_count) text += fmt::format("edges      {} forced\n", grouped(*out.piece_count));
  if (out.dropped)
    text += fmt::format("dropped    {} cells with an edge longer than {}\n", grouped(*out.dropped),
                        a.max_edge);
  const std::uint64_t hidden = t.hidden.size() - input.skipped_points();
  if (!t.duplicates.empty() || hidden > 0)
    text += fmt::format("left out   {} duplicates, {} hidden\n", grouped(t.duplicates.size()),
                        grouped(hidden));
  if (out.voronoi)
    text += fmt::format("diagram    {} vertices, {} ridges\n", grouped(out.voronoi->vertex_count()),
                        grouped(out.voronoi->ridge_count()));
  if (out.cells) {
    const cullhull::Array<double>& sizes = out.cells->measures;
    text += fmt::format(
        "clipped    {} cells, {} of them empty; total {} {}\n", grouped(sizes.size()),
        grouped(static_cast<std::uint64_t>(std::count(sizes.begin(), sizes.end(), 0.0))),
        size_name(t.dimension), sum_of(sizes));
  }
  text += fmt::format("seconds    {:.6f}; reading {:.6f}\n",
                      t.statistics.compute_seconds + out.dual_seconds, out.read_seconds);
  text +=
      fmt::format("run        {} thread{}, peak memory {:.1f} MB\n", t.statistics.threads,
                  t.statistics.threads == 1 ? "" : "s", static_cast<double>(peak_bytes()) / 1e6);
  if (out.certificate)
    text += fmt::format("certified  {}\n", out.certificate->valid ? "yes" : "NO");
  for (const std::string& path : a.outputs) text += wrote_line(path);
  return text + wrote_line(a.measures) + wrote_line(a.json);
}

void write_results(const DualArguments& a, const Input& input, const DualOutcome& out) {
  const PointView& points = input.points;
  const cullhull::MapExtras extras{input.placing.crs,
                                   kept_columns(a.keep, a.input, a.files, a.run)};
  for (const std::string& path : a.outputs) {
    if (!out.voronoi)
      cullhull::write_triangulation(path, points, out.triangulation, "", out.heights, extras);
    else if (ending_of(path) == ".json" || path == "-")
      cullhull::write_voronoi(path, *out.voronoi);
    else
      cullhull::write_cells(path, *out.cells, "", a.faces.faces(), extras);
  }
  if (!a.measures.empty()) {
    const std::uint64_t n = out.cells->measures.size();
    const PointView rows = PointView::row_major(out.cells->measures.data(), n, 1);
    std::vector<std::uint64_t> ids(n);
    for (std::uint64_t i = 0; i < n; ++i) ids[i] = i;
    if (ending_of(a.measures) == ".csv") {
      std::string text = fmt::format("{}\n", size_name(points.dimension));
      for (const double m : out.cells->measures) text += fmt::format("{}\n", m);
      cullhull::write_text(a.measures, text);
    } else {
      cullhull::write_points(a.measures, rows, ids);
    }
  }
  if (!a.json.empty()) cullhull::write_text(a.json, report(a, input, out));
  const auto& known = out.voronoi ? cullhull::voronoi_formats() : cullhull::delaunay_formats();
  for (const std::string& word : words_of(a.formats, known))
    write_stdout(out.voronoi
                     ? cullhull::voronoi_to_qhull_text(*out.voronoi, word)
                     : cullhull::triangulation_to_qhull_text(points, out.triangulation, word));
}

int run(DualArguments a, bool dual) {
  (void)words_of(a.formats, dual ? cullhull::voronoi_formats() : cullhull::delaunay_formats());
  if (!a.edges.empty() && (!a.weights.empty() || a.furthest))
    throw Error(ErrorCode::invalid_argument,
                "--edges cannot be combined with --weights or --furthest");
  if (a.inside && a.edges.empty())
    throw Error(ErrorCode::invalid_argument, "--inside needs --edges");
  if (!a.clip.empty() && !a.box.empty())
    throw Error(ErrorCode::invalid_argument, "--clip and --box exclude each other");
  if (!a.box.empty()) (void)box_numbers(a.box, 0);
  if (wants_cells(a) && !writes_cells(a) && !a.outputs.empty())
    throw Error(
        ErrorCode::invalid_argument, a.clip.empty() ? "--box" : "--clip",
        " clips cells, but .json holds the unclipped diagram; write cells to .geojson or .wkt "
        "(2D), or their sizes with --measures");
  a.faces.check(a.outputs);
  a.files = a.input.find_files();
  FilePlan plan;
  plan.reads_inputs(a.input.words, a.files);
  if (!a.edges.empty()) plan.reads(a.edges);
  if (!a.clip.empty()) plan.reads(a.clip);
  for (const std::string& given : {a.weights, a.heights})
    if (names_file(given)) plan.reads(given);
  // One column is read with the points, which may come from a pipe.
  const bool weights_beside = !a.weights.empty() && !names_file(a.weights);
  const bool heights_beside = !weights_beside && !a.heights.empty() && !names_file(a.heights);
  a.input.weights = weights_beside ? a.weights : heights_beside ? a.heights : "";
  for (const std::string& path : a.outputs)
    if (dual)
      plan.writes("-o", path, {OutputKind::voronoi, OutputKind::cells});
    else
      plan.writes("-o", path, {OutputKind::triangulation});
  check_keep(a.keep, a.files, maps_among(a.outputs), {".geojson"});
  plan.writes("--measures", a.measures, {OutputKind::ids});
  plan.writes_json(a.json);
  if (!a.formats.empty()) plan.prints("--format");
  Input input = open_inputs(a.input, a.files, a.run.threads, a.run.memory_bytes());
  input.fill_skipped();
  for (const std::string& path : a.outputs)
    cullhull::check_triangulation_format(path, input.points.dimension, dual, !a.heights.empty());
  if (!a.heights.empty() && input.points.dimension != 2)
    throw Error(ErrorCode::invalid_argument,
                fmt::format("--height needs 2D points, but these are {}D; use --columns x,y beside "
                            "--height z",
                            input.points.dimension));
  if (!a.box.empty()) (void)box_of(a, input.points, {});  // refused before the work
  if (!a.clip.empty() && input.points.dimension != 2)
    throw Error(ErrorCode::invalid_argument,
                fmt::format("--clip needs 2D points, but these are {}D; --columns x,y leaves the "
                            "height out",
                            input.points.dimension));
  a.run.held = input.held();
  DualOutcome out;
  out.read_seconds = input.file.read_seconds() + warm_pages(input.points);
  const cullhull::Grid grid = input.placing.grid;
  out.weights = weights_beside ? std::move(input.weights)
                               : read_numbers(a, "--weights", a.weights, input.points.count);
  for (double& w : out.weights) w = grid.measure_to_grid(w, 2);  // squares of lengths
  out.heights = heights_beside ? std::move(input.weights)
                               : read_numbers(a, "--height", a.heights, input.points.count);
  input.skipped.copy_numbers(out.weights);
  input.skipped.copy_numbers(out.heights);
  triangulate(a, dual, input, out);
  input.skipped.restore_copies(out.triangulation);
  drop_long(a, input, out);
  if (dual) find_dual(a, input.points, grid, out);
  if (out.voronoi) cullhull::to_world(*out.voronoi, grid);
  if (out.cells) cullhull::to_world(*out.cells, grid);
  input.to_world();
  write_results(a, input, out);
  if (!a.run.quiet && !plan.uses_stdout()) write_stdout(summary(a, input, out));
  if (!out.certificate || out.certificate->valid) return 0;
  complain("not certified: " + out.certificate->reason);
  return not_certified;
}

/// `furthest`: the help of --furthest.
Parser& add_common(Parser& parent, const char* name, const char* about, const char* furthest,
                   bool dual, DualArguments& a) {
  Parser& command = *parent.add_subcommand(name, about);
  a.input.add_many_to(command);
  add_crs_option(command, a.input.crs);
  needs_value(*command.add_option("--weights", a.weights,
                                  "Weights of the points: a column of INPUT, or a file with one\n"
                                  "number per point"))
      .type_name("COLUMN|FILE");
  command.group("Output");
  needs_value(*command.add_option("-o,--output", a.outputs,
                                  "Write the result; the extension chooses the format. Repeat\n"
                                  "-o for more files"))
      .allow_extra_args(false)
      ->type_name("FILE");
  add_json_option(command, a.json, "Report counts and times");
  needs_value(*command.add_option("--format", a.formats, "Print the result as Qhull's programs do"))
      .allow_extra_args(false)
      ->offers(dual ? cullhull::voronoi_formats() : cullhull::delaunay_formats())
      ->type_name("WORDS");
  command.group("Kind of result");
  command.add_flag("--furthest", a.furthest, furthest);
  a.run.add_to(command, false);
  a.run.add_memory_to(command);
  command.group("Verification and timing");
  command.add_flag("--certify", a.certify,
                   "Verify the triangulation with an independent exact checker");
  return command;
}

}  // namespace

Command add_delaunay(Parser& parent) {
  auto a = std::make_shared<DualArguments>();
  Parser& command = add_common(
      parent, "delaunay", "Compute the exact Delaunay or regular triangulation of points",
      "Furthest-site triangulation: the sphere of a cell encloses all\npoints", false, *a);
  command.group("Input");
  needs_value(*command.add_option("--edges", a->edges,
                                  "Constraint edges of 2D points: a file of pairs of ids, from 0,\n"
                                  "or a .geojson of lines whose corners are points; a point on an\n"
                                  "edge splits it"))
      .type_name("FILE");
  needs_value(*command.add_option("--height", a->heights,
                                  "Heights of 2D points, kept in meshes, .vtk and .json: a column\n"
                                  "of INPUT, or a file with one number per point"))
      .type_name("COLUMN|FILE");
  command.group("Output");
  add_keep_option(command, a->keep, "what a triangle's points have in common, to .geojson");
  command.group("Kind of result");
  allow_real_range(
      *command
           .add_option("--max-edge", a->max_edge,
                       "Drop every cell with an edge longer than this, in the units of\n"
                       "the points: a surface (TIN) without long triangles at its border")
           ->type_name("NUMBER"),
      0, std::numeric_limits<double>::max());
  command.add_flag("--inside", a->inside,
                   "Keep only triangles inside the outline that --edges form (even-odd\n"
                   "rule)");
  command.footer(std::string(input_footer) + "\n\n" + delaunay_footer);
  return [a] { return run(*a, false); };
}

Command add_voronoi(Parser& parent) {
  auto a = std::make_shared<DualArguments>();
  Parser& command = add_common(parent, "voronoi", "Compute the Voronoi or power diagram of points",
                               "Furthest-site diagram: the cell of a point is where it is the\n"
                               "furthest of all points",
                               true, *a);
  command.group("Kind of result");
  needs_value(*command.add_option("--box", a->box,
                                  "Clip cells to this box: the lower bounds of all axes, then the\n"
                                  "upper bounds"))
      .type_name("X,Y,..");
  needs_value(
      *command.add_option("--clip", a->clip,
                          "Clip cells of 2D points to the polygons of a GeoJSON file, which\n"
                          "may be concave, with holes and several parts"))
      .type_name("FILE");
  command.group("Output");
  a->faces.add_to(command, "faces of cells");
  needs_value(*command.add_option("--measures", a->measures,
                                  "Write the length, area or volume of each clipped cell"))
      .type_name("FILE");
  add_keep_option(command, a->keep, "of each cell's point, to .geojson");
  command.footer(std::string(input_footer) + "\n\n" + voronoi_footer);
  return [a] { return run(*a, true); };
}

}  // namespace app
