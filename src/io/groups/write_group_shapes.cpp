// write_group_shapes: alpha shapes and concave hulls of groups of points, a record for each.
#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/group_hulls.hpp"
#include "io/formats/crs.hpp"
#include "io/formats/geometry_text.hpp"
#include "io/groups/collected.hpp"
#include "io/groups/group_files.hpp"
#include "io/json/json_writer.hpp"
#include "io/write/mesh.hpp"

namespace cullhull::internal {

void write_if_long(std::string& text, OutputFile& out) {
  if (text.size() <= std::size_t{1} << 20) return;
  out.write(text);
  text.clear();
}

std::string checked_format(const std::string& path, const std::string& format) {
  std::string found = output_format(path, format, "json");
  if (!holds(found, {OutputKind::group_hulls}))
    refuse_format(path, found, {OutputKind::group_hulls});
  return found;
}

std::string name_of_key(const std::string& key) {
  return key.find_first_not_of("0123456789") == std::string::npos ? "column " + key : key;
}

namespace {

/// The shape of one group. Points and numbers are in world units.
struct GroupOfShape {
  std::string_view key;
  bool numeric = false;
  PointView points;
  Triangulation triangulation;
  AlphaShape shape;
  double limit = 0;  ///< alpha, or the length of edges
  ShapeMeasures measures;
  std::size_t number = 0;                     ///< among all groups
  std::span<const PointColumn> columns = {};  ///< of which the group has the value `number`
};

/// The shape of points on a grid; `alpha` and `edge_length` are on it, and so is the limit.
void find_shape(const PointView& points, const GroupShape& wanted, const Options& options,
                GroupOfShape& out) {
  out.triangulation = delaunay(points, options_as<TriangulationOptions>(options));
  const Triangulation& t = out.triangulation;
  if (wanted.edge_length >= 0 || wanted.ratio >= 0) {
    out.limit = wanted.edge_length >= 0 ? wanted.edge_length
                                        : concave_length(points, t, wanted.ratio, options);
    out.shape = concave_hull(points, t, out.limit, options);
    return;
  }
  out.limit =
      wanted.alpha >= 0 ? wanted.alpha : critical_alpha(points, t, wanted.one_region, options);
  out.shape = alpha_shape(points, t, out.limit, options);
}

/// In the plane: polygons, of points on a line the segment and of equal ones the point. Empty for
/// segments with gaps.
PlanePolygons polygons_of(const GroupOfShape& group) {
  const Triangulation& t = group.triangulation;
  PlanePolygons out;
  const auto add = [&](std::vector<double>& row, std::uint32_t id) {
    for (std::uint32_t j = 0; j < 2; ++j) row.push_back(group.points.at(id, j));
  };
  if (t.affine_dimension == 2) {
    const CellPolygons all = cell_polygons(group.points, t, group.shape.cells);
    for (std::uint64_t i = 0; i < all.polygon_count(); ++i) {
      out.emplace_back();
      for (std::uint64_t r = all.polygon_offsets[i]; r < all.polygon_offsets[i + 1]; ++r) {
        out.back().emplace_back();
        for (const std::uint32_t id : all.rings[r]) add(out.back().back(), id);
      }
    }
    return out;
  }
  const Array<std::uint32_t>& ends = t.affine_dimension == 1 ? group.shape.facets : t.cells;
  if (ends.size() != static_cast<std::size_t>(t.affine_dimension) + 1) return out;
  out.emplace_back(1);
  for (const std::uint32_t id : ends) add(out[0][0], id);
  return out;
}

/// In the plane the perimeter (twice a segment's length) and the area; else area and volume.
std::pair<double, double> measures_of(const GroupOfShape& group) {
  const int k = group.triangulation.affine_dimension;
  if (group.points.dimension != 2) return {group.measures.boundary, group.measures.volume};
  if (k < 2) return {2 * group.measures.volume, 0};
  return {group.measures.boundary, group.measures.volume};
}

class ShapeRecords {
 public:
  ShapeRecords(std::string format, std::string key_name, const char* limit_name,
               const JsonPoints& points, std::string& text, const MapExtras& extras)
      : format_(std::move(format)),
        key_name_(std::move(key_name)),
        limit_name_(limit_name),
        crs_(extras.crs),
        points_(points),
        text_(text),
        json_(text) {
    if (format_ == "geojson" && !plane() && points.dimension != 0)
      throw Error(ErrorCode::invalid_argument, ".geojson holds shapes of 2D points, not ",
                  points.dimension, "D; .csv and .json hold any");
  }

  void begin() {
    if (format_ == "geojson") {
      text_ += "{\"type\": \"FeatureCollection\", " + crs_member(crs_) + "\"features\": [";
    } else if (format_ == "csv") {
      append_csv(text_, key_name_);
      text_ += plane() ? ",points," : ",points,affine_dimension,";
      text_ += limit_name_;
      text_ += plane() ? ",perimeter,area,wkt\n" : ",cells,facets,area,volume\n";
    } else {
      json_.begin_document({"group_shapes", points_});
      json_.member("by", key_name_);
      json_.key("groups");
      json_.begin_list(true);
    }
  }
  void add(const GroupOfShape& group) {
    const bool first = std::exchange(first_, false);
    if (format_ == "csv") return append_row(group);
    if (format_ == "json") return write_record(group);
    text_ += first ? "\n" : ",\n";
    append_feature(group);
  }
  void end() {
    if (format_ == "geojson") text_ += "\n]}\n";
    if (format_ != "json") return;
    json_.end_list();
    json_.end_document();
  }

 private:
  bool plane() const { return points_.dimension == 2; }
  void append_key(const GroupOfShape& group) {
    if (group.numeric)
      text_ += group.key;
    else
      append_json_string(text_, group.key);
  }
  void append_feature(const GroupOfShape& group) {
    const auto [perimeter, area] = measures_of(group);
    text_ += "{\"type\": \"Feature\", \"properties\": {";
    append_json_string(text_, key_name_);
    text_ += ": ";
    append_key(group);
    text_ += ", \"points\": ";
    append_number(text_, group.points.count);
    text_ += std::string(", \"") + limit_name_ + "\": ";
    append_json_number(text_, group.limit);
    text_ += ", \"perimeter\": ";
    append_json_number(text_, perimeter);
    text_ += ", \"area\": ";
    append_json_number(text_, area);
    for (const PointColumn& column : group.columns)
      append_property(text_, column, group.number,
                      {key_name_, "points", limit_name_, "perimeter", "area"});
    text_ += "}, \"geometry\": ";
    append_geojson(text_, polygons_of(group));
    text_ += '}';
  }
  void append_row(const GroupOfShape& group) {
    append_csv(text_, group.key);
    text_ += ',';
    append_number(text_, group.points.count);
    text_ += ',';
    if (!plane()) text_ += std::to_string(group.triangulation.affine_dimension) + ',';
    append_number(text_, group.limit);
    if (!plane()) {
      for (const std::size_t count : {group.shape.cells.size(), group.shape.facet_cells.size()}) {
        text_ += ',';
        append_number(text_, std::uint64_t{count});
      }
    }
    const auto [boundary, volume] = measures_of(group);
    for (const double measure : {boundary, volume}) {
      text_ += ',';
      append_number(text_, measure);
    }
    if (plane()) {
      text_ += ",\"";
      append_wkt(text_, polygons_of(group));
      text_ += '"';
    }
    text_ += '\n';
  }
  void write_record(const GroupOfShape& group) {
    const Triangulation& t = group.triangulation;
    json_.item();
    json_.begin_object();
    json_.key("key");
    append_key(group);
    json_.member("points", group.points.count);
    json_.member("affine_dimension", t.affine_dimension);
    json_.member(limit_name_, group.limit);
    put_measures(t.affine_dimension, group.measures.boundary, group.measures.volume,
                 [&](const char* name, double measure) { json_.member(name, measure); });
    std::vector<std::uint32_t> ids;  // of the shape's points, ascending
    for (const std::uint32_t c : group.shape.cells)
      ids.insert(ids.end(), t.cell(c).begin(), t.cell(c).end());
    std::sort(ids.begin(), ids.end());
    ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
    json_.key("coordinates");
    json_.begin_list(false);
    for (const std::uint32_t id : ids) {
      json_.item();
      std::vector<double> row;
      for (std::uint32_t j = 0; j < group.points.dimension; ++j)
        row.push_back(group.points.at(id, j));
      json_.list(row, 0, row.size());
    }
    json_.end_list();
    const auto place = [&](std::uint32_t id) {
      json_.value(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin());
    };
    const auto rows = [&](const char* name, std::uint64_t count, const auto& row) {
      json_.key(name);
      json_.begin_list(false);
      for (std::uint64_t i = 0; i < count; ++i) {
        json_.item();
        const auto corners = row(i);
        json_.list_by(corners, 0, corners.size(), place);
      }
      json_.end_list();
    };
    rows("cells", group.shape.cells.size(),
         [&](std::uint64_t i) { return t.cell(group.shape.cells[i]); });
    const std::size_t k = t.corners() > 1 ? t.corners() - 1 : 0;
    rows("facets", group.shape.facet_cells.size(),
         [&](std::uint64_t i) { return std::span(group.shape.facets).subspan(i * k, k); });
    json_.end_object();
  }

  std::string format_, key_name_;
  const char* limit_name_;
  std::string crs_;
  JsonPoints points_;
  std::string& text_;
  JsonWriter json_;
  bool first_ = true;
};

/// Lengths that are wanted, on the grid of the points.
GroupShape on_grid(GroupShape wanted, const Grid& grid) {
  if (wanted.alpha >= 0) wanted.alpha = grid.to_grid(wanted.alpha);
  if (wanted.edge_length >= 0) wanted.edge_length = grid.to_grid(wanted.edge_length);
  return wanted;
}

void write_shapes(const CollectedPoints& collected, const SortedGroups& sorted,
                  const GroupShape& wanted, ShapeRecords& records, std::string& text,
                  const Grid& grid, const Options& options, OutputFile& out) {
  constexpr std::uint64_t few = 10000;  // threads do not pay for fewer points
  const std::uint32_t d = sorted.dimension;
  const std::size_t groups = sorted.keys.order.size();
  const GroupShape shape = on_grid(wanted, grid);
  records.begin();
  for (std::size_t i = 0; i < groups; ++i) {
    const std::uint64_t first = sorted.offsets[i], count = sorted.offsets[i + 1] - first;
    const double* const rows = sorted.coordinates.as<const double>() + first * d;
    Options own = options;
    own.progress = {};
    if (count < few) own.threads = 1;
    GroupOfShape group{.key = collected.words()[sorted.keys.order[i]],
                       .numeric = sorted.keys.numeric,
                       .points = {},
                       .triangulation = {},
                       .shape = {},
                       .measures = {},
                       .number = i,
                       .columns = sorted.columns};
    find_shape(PointView::row_major(rows, count, d), shape, own, group);
    std::vector<double> world(rows, rows + count * d);
    to_world(world, grid);
    group.points = PointView::row_major(world.data(), count, d);
    group.limit = grid.to_world(group.limit);
    group.measures = shape_measures(group.points, group.triangulation, group.shape);
    records.add(group);
    write_if_long(text, out);
    if (options.progress)
      options.progress("shapes", static_cast<double>(i + 1) / static_cast<double>(groups));
  }
  records.end();
  out.write(text);
}

}  // namespace
}  // namespace cullhull::internal

namespace cullhull {

GroupReport write_group_shapes(const std::vector<std::string>& files, const std::string& path,
                               const GroupShape& shape, const BlockOptions& reading,
                               const Options& options, const MapExtras& extras) {
  using namespace internal;
  const bool by_edges = shape.edge_length >= 0 || shape.ratio >= 0;
  if ((shape.alpha >= 0 ? 1 : 0) + (shape.edge_length >= 0 ? 1 : 0) + (shape.ratio >= 0 ? 1 : 0) >
      1)
    throw Error(ErrorCode::invalid_argument, "alpha, edge_length and ratio exclude one another");
  const std::string format = checked_format(path, "");
  return write_sorted_groups(
      files, reading, options, extras.columns,
      [&](const auto& collected, const auto& sorted, const auto& read, const auto& report) {
    std::string text;
    ShapeRecords records(format, name_of_key(reading.read.key), by_edges ? "edge_length" : "alpha",
                         {report.points, report.dimension, read.scalar}, text, extras);
    OutputFile out(path);
    write_shapes(collected, sorted, shape, records, text, read.grid, options, out);
    out.commit();
      });
}

}  // namespace cullhull
