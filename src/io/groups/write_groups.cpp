// write_group_hulls: points sorted by group, hulls in slices, a record for each; and of a batch.
#include <algorithm>
#include <numeric>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "cullhull/batch.hpp"
#include "cullhull/group_hulls.hpp"
#include "io/file_formats.hpp"
#include "io/formats/crs.hpp"
#include "io/formats/geometry_text.hpp"
#include "io/groups/collected.hpp"
#include "io/groups/group_files.hpp"
#include "io/json/json_writer.hpp"
#include "io/write/mesh.hpp"
#include "io/write/output_file.hpp"
#include "parallel/memory/memory.hpp"

namespace cullhull::internal {
namespace {

/// One hull of a batch, and the coordinates of its vertices, a row each.
struct GroupHull {
  std::string_view key;
  bool numeric = false;
  const HullBatch& batch;
  std::size_t set = 0;
  const double* corners = nullptr;
  const Grid& grid;
  std::size_t number = 0;                     ///< among all groups
  std::span<const PointColumn> columns = {};  ///< of which the group has the value `number`

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
    std::vector<double> out(corners, corners + vertices().size() * batch.dimension);
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

/// Writes the records of a file to a text, and what comes before, between and after them.
class GroupRecords {
 public:
  GroupRecords(std::string format, std::string key_name, const JsonPoints& points,
               std::string& text, const MapExtras& extras)
      : format_(std::move(format)),
        key_name_(std::move(key_name)),
        points_(points),
        crs_(extras.crs),
        dimension_(points.dimension),
        text_(text),
        json_(text) {
    if (format_ == "geojson" && dimension_ != 2 && dimension_ != 0)
      throw Error(ErrorCode::invalid_argument, ".geojson holds hulls of 2D points, not ",
                  dimension_, "D; .csv and .json hold any");
  }

  void begin() {
    if (format_ == "geojson") {
      text_ += "{\"type\": \"FeatureCollection\", " + crs_member(crs_) + "\"features\": [";
    } else if (format_ == "csv") {
      append_csv(text_, key_name_);
      text_ += dimension_ == 2 ? ",points,vertices,perimeter,area,wkt\n"
                               : ",points,affine_dimension,vertices,facets,area,volume\n";
    } else {
      json_.begin_document({"groups", points_});
      json_.member("by", key_name_);
      json_.key("groups");
      json_.begin_list(true);
    }
  }
  void add(const GroupHull& hull) {
    const bool first = std::exchange(first_, false);
    if (format_ == "csv") return append_row(text_, hull);
    if (format_ == "json") return write_record(hull);
    text_ += first ? "\n" : ",\n";
    append_feature(text_, hull);
  }
  void end() {
    if (format_ == "geojson") text_ += "\n]}\n";
    if (format_ != "json") return;
    json_.end_list();
    json_.end_document();
  }

 private:
  void append_feature(std::string& out, const GroupHull& hull) const {
    out += "{\"type\": \"Feature\", \"properties\": {";
    append_json_string(out, key_name_);
    out += ": ";
    hull.append_key(out);
    out += ", \"points\": ";
    append_number(out, hull.points());
    out += ", \"perimeter\": ";
    append_json_number(out, hull.perimeter());
    out += ", \"area\": ";
    append_json_number(out, hull.within());
    for (const PointColumn& column : hull.columns)
      append_property(out, column, hull.number, {key_name_, "points", "perimeter", "area"});
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
  void write_record(const GroupHull& hull) {
    json_.item();
    json_.begin_object();
    json_.key("key");
    hull.append_key(text_);
    json_.member("points", hull.points());
    json_.member("affine_dimension", hull.affine_dimension());
    put_measures(hull.affine_dimension(), hull.area(), hull.volume(),
                 [&](const char* name, double measure) { json_.member(name, measure); });
    json_.key("vertex_coordinates");
    json_.begin_list(false);
    const std::vector<double> rows = hull.boundary();
    for (std::size_t i = 0; i < rows.size(); i += dimension_) {
      json_.item();
      json_.list(rows, i, i + dimension_);
    }
    json_.end_list();
    write_facets(hull);
    json_.end_object();
  }
  /// Each facet by the positions of its corners among the vertices.
  void write_facets(const GroupHull& hull) {
    std::vector<std::pair<std::uint64_t, std::uint64_t>> places;
    for (const std::uint64_t v : hull.vertices()) places.emplace_back(v, places.size());
    std::sort(places.begin(), places.end());
    const auto place_of = [&](std::uint64_t v) {
      json_.value(
          std::lower_bound(places.begin(), places.end(), std::pair{v, std::uint64_t{0}})->second);
    };
    json_.key("facets");
    json_.begin_list(false);
    for (std::uint64_t f = hull.batch.facet_starts[hull.set];
         f < hull.batch.facet_starts[hull.set + 1]; ++f) {
      json_.item();
      const auto corners = hull.batch.facets[f];
      json_.list_by(corners, 0, corners.size(), place_of);
    }
    json_.end_list();
  }

  std::string format_, key_name_;
  JsonPoints points_;
  std::string crs_;
  std::uint32_t dimension_;
  std::string& text_;
  JsonWriter json_;
  bool first_ = true;
};

void write_slices(const CollectedPoints& collected, const SortedGroups& sorted,
                  GroupRecords& records, std::string& text, const Grid& grid,
                  const Options& options, OutputFile& out) {
  // Hulled and written at a time: some 100 MB of text at most. Not tuned.
  constexpr std::uint64_t slice_points = std::uint64_t{1} << 20;
  const std::uint32_t d = sorted.dimension;
  const std::size_t groups = sorted.keys.order.size();
  std::vector<double> corners;  // of the hulls of a slice, end to end
  records.begin();
  for (std::size_t begin = 0, end = 0; begin < groups; begin = end) {
    const std::uint64_t first = sorted.offsets[begin];
    while (end < groups && (end == begin || sorted.offsets[end + 1] - first <= slice_points)) ++end;
    std::vector<std::uint64_t> offsets;
    for (std::size_t i = begin; i <= end; ++i) offsets.push_back(sorted.offsets[i] - first);
    const double* const rows = sorted.coordinates.as<const double>() + first * d;
    const HullBatch batch =
        convex_hulls(PointView::row_major(rows, offsets.back(), d), offsets, options);
    corners.clear();
    for (std::size_t set = 0; set < batch.size(); ++set)
      for (const std::uint64_t v : batch.vertices[set]) {
        const double* const row = rows + (offsets[set] + v) * d;
        corners.insert(corners.end(), row, row + d);
      }
    for (std::size_t i = begin; i < end; ++i) {
      const std::size_t set = i - begin;
      records.add({collected.words()[sorted.keys.order[i]], sorted.keys.numeric, batch, set,
                   corners.data() + batch.vertices.offsets[set] * d, grid, i, sorted.columns});
      write_if_long(text, out);
    }
    if (options.progress)
      options.progress("hulls", static_cast<double>(end) / static_cast<double>(groups));
  }
  records.end();
  out.write(text);
}

}  // namespace
}  // namespace cullhull::internal

namespace cullhull {

GroupReport write_group_hulls(const std::vector<std::string>& files, const std::string& path,
                              const BlockOptions& reading, const Options& options,
                              const MapExtras& extras) {
  using namespace internal;
  const std::string format = checked_format(path, "");
  return write_sorted_groups(
      files, reading, options, extras.columns,
      [&](const auto& collected, const auto& sorted, const auto& read, const auto& report) {
    std::string text;
    GroupRecords records(format, name_of_key(reading.read.key),
                         {report.points, report.dimension, read.scalar}, text, extras);
    OutputFile out(path);
    write_slices(collected, sorted, records, text, read.grid, options, out);
    out.commit();
      });
}

void write_group_hulls(const std::string& path, const HullBatch& hulls,
                       std::span<const double> vertex_coordinates, const PointKeys& keys,
                       const std::string& key_name, const std::string& format,
                       const MapExtras& extras) {
  using namespace internal;
  if (keys.size() != hulls.size())
    throw Error(ErrorCode::invalid_argument, hulls.size(), " hulls have ", keys.size(), " keys");
  const std::size_t numbers = hulls.vertices.items.size() * hulls.dimension;
  if (vertex_coordinates.size() != numbers)
    throw Error(ErrorCode::invalid_argument, "the vertices of the hulls have ", numbers,
                " coordinates, not ", vertex_coordinates.size());
  const std::uint64_t points =
      std::accumulate(hulls.point_counts.begin(), hulls.point_counts.end(), std::uint64_t{0});
  std::string text;
  GroupRecords records(checked_format(path, format), key_name,
                       {points, hulls.dimension, hulls.scalar}, text, extras);
  const KeyOrder order(keys);
  const Grid grid;
  OutputFile out(path);
  records.begin();
  for (const std::uint32_t set : order.order) {
    const std::uint64_t first = hulls.vertices.offsets[set] * hulls.dimension;
    records.add({keys[set], order.numeric, hulls, set, vertex_coordinates.data() + first, grid});
    write_if_long(text, out);
  }
  records.end();
  out.write(text);
  out.commit();
}

}  // namespace cullhull
