// write_group_hulls: points sorted by group, hulls in slices, a record for each.
#include <algorithm>
#include <chrono>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cullhull/batch.hpp"
#include "cullhull/group_hulls.hpp"
#include "cullhull/version.hpp"
#include "io/geometry_text.hpp"
#include "io/groups/collected.hpp"
#include "io/mesh.hpp"
#include "io/output_file.hpp"
#include "parallel/memory.hpp"

namespace cullhull {
namespace internal {
namespace {

void append_measure(std::string& out, double value) {
  if (value - value == 0)
    append_number(out, value);
  else
    out += "\"inf\"";
}

/// One hull of a batch, and the rows of its points.
struct GroupHull {
  std::string_view key;
  bool numeric = false;
  const HullBatch& batch;
  std::size_t set = 0;
  const double* rows = nullptr;
  std::uint32_t dimension = 0;
  const Grid& grid;

  std::span<const std::uint64_t> vertices() const { return batch.vertices[set]; }
  std::uint64_t points() const { return batch.point_counts[set]; }
  int affine_dimension() const { return batch.affine_dimensions[set]; }
  std::uint64_t facets() const { return batch.facet_starts[set + 1] - batch.facet_starts[set]; }
  double volume() const { return grid.measure_to_world(batch.volumes[set], affine()); }
  double area() const { return grid.measure_to_world(batch.areas[set], std::max(affine() - 1, 0)); }
  /// In the plane: the perimeter (twice a segment's length), and the area.
  double perimeter() const { return affine_dimension() == 2 ? area() : 2 * volume(); }
  double within() const { return affine_dimension() == 2 ? volume() : 0; }

  std::vector<double> boundary() const {
    std::vector<double> out;
    for (const std::uint64_t v : vertices())
      out.insert(out.end(), rows + v * dimension, rows + (v + 1) * dimension);
    to_world(out, grid);
    return out;
  }
  void append_key(std::string& out) const {
    if (numeric)
      out += key;
    else
      append_json_string(out, key);
  }

 private:
  int affine() const { return std::max(affine_dimension(), 0); }
};

/// The text of a record in a format, and what comes before, between and after records.
class GroupFormat {
 public:
  GroupFormat(std::string format, std::string key_name, std::uint32_t dimension)
      : format_(std::move(format)), key_name_(std::move(key_name)), dimension_(dimension) {
    if (format_ == "geojson" && dimension_ != 2 && dimension_ != 0)
      throw Error(ErrorCode::invalid_argument, ".geojson holds hulls of 2D points, not " +
                                                   std::to_string(dimension_) +
                                                   "D; .csv and .json hold any");
  }

  std::string head() const {
    std::string out;
    if (format_ == "geojson") return "{\"type\": \"FeatureCollection\", \"features\": [\n";
    if (format_ == "csv") {
      append_csv(out, key_name_);
      return out + (dimension_ == 2 ? ",points,vertices,perimeter,area,wkt\n"
                                    : ",points,affine_dimension,vertices,facets,area,volume\n");
    }
    out = "{\n\"version\": \"" CULLHULL_VERSION "\",\n\"schema\": " +
          std::to_string(json_schema_version) + ",\n\"by\": ";
    append_json_string(out, key_name_);
    return out + ",\n\"dimension\": " + std::to_string(dimension_) + ",\n\"groups\": [\n";
  }
  const char* between() const { return format_ == "csv" ? "" : ",\n"; }
  const char* tail() const {
    return format_ == "csv" ? "" : format_ == "geojson" ? "\n]}\n" : "\n]\n}\n";
  }
  void append(std::string& out, const GroupHull& hull) const {
    if (format_ == "geojson") return append_feature(out, hull);
    if (format_ == "csv") return append_row(out, hull);
    append_object(out, hull);
  }

 private:
  static void append_csv(std::string& out, std::string_view text) {
    if (text.find_first_of("\",;\t#/ ") == std::string_view::npos) {
      out += text;
      return;
    }
    out += '"';
    for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
    out += '"';
  }
  void append_feature(std::string& out, const GroupHull& hull) const {
    out += "{\"type\": \"Feature\", \"properties\": {";
    append_json_string(out, key_name_);
    out += ": ";
    hull.append_key(out);
    out += ", \"points\": ";
    append_number(out, hull.points());
    out += ", \"perimeter\": ";
    append_measure(out, hull.perimeter());
    out += ", \"area\": ";
    append_measure(out, hull.within());
    out += "}, \"geometry\": ";
    append_geojson(out, hull.boundary());
    out += '}';
  }
  void append_row(std::string& out, const GroupHull& hull) const {
    append_csv(out, hull.key);
    const bool plane = dimension_ == 2;
    out += ',';
    append_number(out, hull.points());
    if (!plane) out += ',' + std::to_string(hull.affine_dimension());
    out += ',';
    append_number(out, std::uint64_t{hull.vertices().size()});
    if (!plane) {
      out += ',';
      append_number(out, hull.facets());
    }
    for (const double measure :
         {plane ? hull.perimeter() : hull.area(), plane ? hull.within() : hull.volume()}) {
      out += ',';
      append_number(out, measure);
    }
    if (plane) {
      out += ",\"";
      append_wkt(out, hull.boundary());
      out += '"';
    }
    out += '\n';
  }
  void append_object(std::string& out, const GroupHull& hull) const {
    out += "{\"key\": ";
    hull.append_key(out);
    out += ", \"points\": ";
    append_number(out, hull.points());
    out += ", \"affine_dimension\": " + std::to_string(hull.affine_dimension());
    out += ", \"area\": ";
    append_measure(out, hull.area());
    out += ", \"volume\": ";
    append_measure(out, hull.volume());
    out += ", \"vertex_coordinates\": [";
    const std::vector<double> rows = hull.boundary();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      out += i % dimension_ != 0 ? ", " : i > 0 ? ", [" : "[";
      append_number(out, rows[i]);
      if ((i + 1) % dimension_ == 0) out += ']';
    }
    out += "], \"facets\": [";
    append_facets(out, hull);
    out += "]}";
  }
  /// Each facet by the positions of its corners among the vertices.
  static void append_facets(std::string& out, const GroupHull& hull) {
    std::vector<std::pair<std::uint64_t, std::uint64_t>> places;
    for (const std::uint64_t v : hull.vertices()) places.emplace_back(v, places.size());
    std::sort(places.begin(), places.end());
    const std::uint64_t first = hull.batch.facet_starts[hull.set];
    for (std::uint64_t f = first; f < hull.batch.facet_starts[hull.set + 1]; ++f) {
      out += f > first ? ", [" : "[";
      bool any = false;
      for (const std::uint64_t v : hull.batch.facets[f]) {
        const auto place =
            std::lower_bound(places.begin(), places.end(), std::pair{v, std::uint64_t{0}});
        if (std::exchange(any, true)) out += ", ";
        append_number(out, place->second);
      }
      out += ']';
    }
  }

  std::string format_, key_name_;
  std::uint32_t dimension_;
};

void write_slices(const CollectedPoints& collected, const SortedGroups& sorted,
                  const GroupFormat& format, const Grid& grid, const Options& options,
                  OutputFile& out) {
  // Hulled and written at a time: some 100 MB of text at most. Not tuned.
  constexpr std::uint64_t slice_points = std::uint64_t{1} << 20;
  const std::uint32_t d = sorted.dimension;
  const std::size_t groups = sorted.order.size();
  std::string text = format.head();
  for (std::size_t begin = 0, end = 0; begin < groups; begin = end) {
    const std::uint64_t first = sorted.offsets[begin];
    while (end < groups && (end == begin || sorted.offsets[end + 1] - first <= slice_points)) ++end;
    std::vector<std::uint64_t> offsets;
    for (std::size_t i = begin; i <= end; ++i) offsets.push_back(sorted.offsets[i] - first);
    const double* const rows = sorted.coordinates.as<const double>() + first * d;
    const HullBatch batch = convex_hulls(PointView::row_major(rows, offsets.back(), d),
                                         offsets.data(), end - begin, options);
    for (std::size_t i = begin; i < end; ++i) {
      if (i > 0) text += format.between();
      format.append(text, {collected.words()[sorted.order[i]], collected.numeric(), batch,
                           i - begin, rows + offsets[i - begin] * d, d, grid});
      if (text.size() > std::size_t{1} << 20) {
        out.write(text);
        text.clear();
      }
    }
    if (options.progress)
      options.progress("hulls", static_cast<double>(end) / static_cast<double>(groups));
  }
  out.write(text + format.tail());
}

/// The key's name in the output: its own, or "column" and its number.
std::string name_of_key(const std::string& key) {
  return key.find_first_not_of("0123456789") == std::string::npos ? "column " + key : key;
}

}  // namespace
}  // namespace internal

GroupReport write_group_hulls(const std::vector<std::string>& files, const std::string& path,
                              const BlockOptions& reading, const Options& options) {
  using namespace internal;
  using Clock = std::chrono::steady_clock;
  if (reading.read.key.empty())
    throw Error(ErrorCode::invalid_argument, "groups need a column that tells them apart");
  const std::string format = output_format(path, "", "json");
  if (format != "geojson" && format != "csv" && format != "json")
    refuse_format(path, format, ".geojson .csv .json");
  const Clock::time_point start = Clock::now();
  CollectedPoints collected(resolve_budget(options.memory_budget));
  BlockVisitor visitor;
  visitor.keyed = [&](const PointView& block, std::uint64_t first, const PointKeys& keys) {
    collected.add(block, first, keys);
  };
  const BlockSummary read = visit_blocks(files, visitor, reading);
  const SortedGroups sorted = collected.sort();
  GroupReport report;
  report.points = read.end.points;
  report.groups = sorted.order.size();
  report.dimension = read.dimension;
  const Clock::time_point sorted_at = Clock::now();
  report.read_seconds = std::chrono::duration<double>(sorted_at - start).count();
  const GroupFormat records(format, name_of_key(reading.read.key), read.dimension);
  OutputFile out(path);
  write_slices(collected, sorted, records, read.grid, options, out);
  out.commit();
  report.hull_seconds = std::chrono::duration<double>(Clock::now() - sorted_at).count();
  return report;
}

}  // namespace cullhull
