#include "io/formats/geometry_text.hpp"

#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "io/json/json_text.hpp"
#include "io/write/mesh.hpp"

namespace cullhull::internal {
namespace {

/// Writes each position by one(x, y), separated by commas; of a ring the first once more at the
/// end.
template <class One>
void append_positions(std::string& out, std::span<const double> boundary, bool ring,
                      const One& one) {
  const std::size_t count = boundary.size() / 2;
  for (std::size_t i = 0; i < count + (ring ? 1 : 0); ++i) {
    if (i > 0) out += ", ";
    const double* const at = boundary.data() + (i < count ? 2 * i : 0);
    one(at[0], at[1]);
  }
}

void append_json_positions(std::string& out, std::span<const double> boundary, bool ring) {
  append_positions(out, boundary, ring, [&](double x, double y) {
    out += '[';
    append_json_number(out, x);
    out += ", ";
    append_json_number(out, y);
    out += ']';
  });
}

void append_wkt_positions(std::string& out, std::span<const double> boundary, bool ring) {
  append_positions(out, boundary, ring, [&](double x, double y) {
    append_number(out, x);
    out += ' ';
    append_number(out, y);
  });
}

struct PlaneMeasures {
  double perimeter = 0, area = 0;
};

/// Perimeter and area: of a segment twice its length and 0, of a point 0 and 0.
PlaneMeasures measures_of(const Hull& hull) {
  if (hull.affine_dimension <= 0) return {};
  if (hull.affine_dimension == 1) return {2 * hull.volume, 0};
  return {hull.area, hull.volume};
}

}  // namespace

void append_geojson(std::string& out, std::span<const double> boundary) {
  const std::size_t count = boundary.size() / 2;
  if (count == 0) {
    out += "null";
    return;
  }
  static constexpr const char* kinds[] = {"Point", "LineString", "Polygon"};
  out += std::string("{\"type\": \"") + kinds[count > 2 ? 2 : count - 1] + "\", \"coordinates\": ";
  out += count > 2 ? "[[" : count > 1 ? "[" : "";
  append_json_positions(out, boundary, count > 2);
  out += count > 2 ? "]]}" : count > 1 ? "]}" : "}";
}

void append_wkt(std::string& out, std::span<const double> boundary) {
  const std::size_t count = boundary.size() / 2;
  if (count == 0) {
    out += "POLYGON EMPTY";
    return;
  }
  out += count > 2 ? "POLYGON ((" : count > 1 ? "LINESTRING (" : "POINT (";
  append_wkt_positions(out, boundary, count > 2);
  out += count > 2 ? "))" : ")";
}

namespace {

/// Every ring closed, within a pair of brackets.
void append_rings(std::string& out, const PlaneRings& rings, const char* brackets,
                  void (*positions)(std::string&, std::span<const double>, bool)) {
  out += brackets[0];
  for (std::size_t i = 0; i < rings.size(); ++i) {
    if (i > 0) out += ", ";
    out += brackets[0];
    positions(out, rings[i], true);
    out += brackets[1];
  }
  out += brackets[1];
}

}  // namespace

void append_geojson(std::string& out, const PlaneRings& rings) {
  if (rings.size() < 2)
    return append_geojson(out, rings.empty() ? std::span<const double>() : rings[0]);
  out += "{\"type\": \"Polygon\", \"coordinates\": ";
  append_rings(out, rings, "[]", append_json_positions);
  out += "}";
}

void append_wkt(std::string& out, const PlaneRings& rings) {
  if (rings.size() < 2)
    return append_wkt(out, rings.empty() ? std::span<const double>() : rings[0]);
  out += "POLYGON ";
  append_rings(out, rings, "()", append_wkt_positions);
}

void append_geojson(std::string& out, const PlanePolygons& polygons) {
  if (polygons.size() < 2)
    return append_geojson(out, polygons.empty() ? PlaneRings() : polygons[0]);
  out += "{\"type\": \"MultiPolygon\", \"coordinates\": [";
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    if (i > 0) out += ", ";
    append_rings(out, polygons[i], "[]", append_json_positions);
  }
  out += "]}";
}

void append_wkt(std::string& out, const PlanePolygons& polygons) {
  if (polygons.size() < 2) return append_wkt(out, polygons.empty() ? PlaneRings() : polygons[0]);
  out += "MULTIPOLYGON (";
  for (std::size_t i = 0; i < polygons.size(); ++i) {
    if (i > 0) out += ", ";
    append_rings(out, polygons[i], "()", append_wkt_positions);
  }
  out += ")";
}

void append_csv(std::string& out, std::string_view text) {
  if (text.find_first_of("\",;\t\r\n#/ ") == std::string_view::npos) {
    out += text;
    return;
  }
  out += '"';
  for (const char c : text) out += c == '"' ? "\"\"" : std::string(1, c);
  out += '"';
}

std::string name_beside(const std::string& column, std::initializer_list<std::string_view> own) {
  return std::find(own.begin(), own.end(), column) == own.end() ? column : "kept_" + column;
}

void append_property(std::string& out, const PointColumn& column, std::uint64_t point,
                     std::initializer_list<std::string_view> own) {
  out += ", ";
  append_json_string(out, name_beside(column.name, own));
  out += ": ";
  const std::string_view value = column.values[point];
  if (value.empty())
    out += "null";
  else if (column.numeric)
    out += value;
  else
    append_json_string(out, value);
}

MapExtras columns_in_common(const MapExtras& extras, std::uint64_t count) {
  std::vector<std::string_view> values;
  for (const PointColumn& column : extras.columns)
    values.push_back(
        value_in_common(column, column.values.size(), [](std::uint64_t i) { return i; }));
  return columns_of_shapes(extras, count, [&](const PointColumn& column, std::uint64_t) {
    return values[static_cast<std::size_t>(&column - extras.columns.data())];
  });
}

std::string geometry_file(const Coordinates& points, const Hull& hull, const std::string& format,
                          const MapExtras& extras) {
  if (hull.dimension != 2)
    throw Error(ErrorCode::invalid_argument, ".", format, " holds hulls of 2D points, not ",
                hull.dimension, "D; meshes hold 3D, .json any");
  std::vector<double> boundary;
  for (const std::uint64_t id : hull.vertices)
    for (std::uint32_t j = 0; j < 2; ++j) boundary.push_back(points.at(id, j));
  std::string out;
  if (format == "wkt") {
    append_wkt(out, boundary);
    return out + '\n';
  }
  out = "{\"type\": \"Feature\", " + crs_member(extras.crs) + "\"properties\": {\"points\": ";
  append_number(out, hull.point_count);
  const PlaneMeasures m = measures_of(hull);
  for (const auto& [name, value] : {std::pair{"perimeter", m.perimeter}, {"area", m.area}}) {
    out += std::string(", \"") + name + "\": ";
    append_json_number(out, value);
  }
  for (const PointColumn& column : columns_in_common(extras, 1).columns)
    append_property(out, column, 0, {"points", "perimeter", "area"});
  out += "}, \"geometry\": ";
  append_geojson(out, boundary);
  return out + "}\n";
}

}  // namespace cullhull::internal
