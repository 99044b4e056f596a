#include "io/formats/geometry_text.hpp"

#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/hull.hpp"
#include "io/json/json_text.hpp"
#include "io/write/mesh.hpp"

namespace cullhull::internal {
namespace {

/// How a language spells geometries: those of one point, of a line, of a polygon, of several.
struct Spelling {
  const char* none;
  const char* heads[4];
  const char* after_point;
  const char* tail;
  const char* brackets;     ///< around lists
  const char* position[3];  ///< around and between the numbers
  void (*number)(std::string& out, double value);
};

constexpr Spelling geojson{
    "null",
    {R"({"type": "Point", "coordinates": )", R"({"type": "LineString", "coordinates": )",
     R"({"type": "Polygon", "coordinates": )", R"({"type": "MultiPolygon", "coordinates": )"},
    "",
    "}",
    "[]",
    {"[", ", ", "]"},
    append_json_number};
constexpr Spelling wkt{"POLYGON EMPTY",
                       {"POINT (", "LINESTRING ", "POLYGON ", "MULTIPOLYGON "},
                       ")",
                       "",
                       "()",
                       {"", " ", ""},
                       append_number};

/// Writes one(i) of each item, separated by commas, in brackets.
template <class One>
void append_list(std::string& out, std::size_t count, const Spelling& by, const One& one) {
  out += by.brackets[0];
  for (std::size_t i = 0; i < count; ++i) {
    if (i > 0) out += ", ";
    one(i);
  }
  out += by.brackets[1];
}

void append_position(std::string& out, const double* at, const Spelling& by) {
  by.number(out += by.position[0], at[0]);
  by.number(out += by.position[1], at[1]);
  out += by.position[2];
}

void append_rings(std::string& out, const PlaneRings& rings, const Spelling& by) {
  append_list(out, rings.size(), by, [&](std::size_t i) {
    const std::size_t count = rings[i].size() / 2;
    append_list(out, count + 1, by, [&](std::size_t j) {  // closed
      append_position(out, rings[i].data() + (j < count ? 2 * j : 0), by);
    });
  });
}

void append_geometry(std::string& out, const PlanePolygons& polygons, const Spelling& by) {
  const std::size_t rings = polygons.empty() ? 0 : polygons[0].size();
  const std::size_t count = rings == 0 ? 0 : polygons[0][0].size() / 2;
  if (polygons.size() > 1) {
    out += by.heads[3];
    append_list(out, polygons.size(), by,
                [&](std::size_t i) { append_rings(out, polygons[i], by); });
  } else if (rings > 1 || count > 2) {
    append_rings(out += by.heads[2], polygons[0], by);
  } else if (count == 2) {
    append_list(out += by.heads[1], count, by,
                [&](std::size_t i) { append_position(out, polygons[0][0].data() + 2 * i, by); });
  } else if (count == 1) {
    append_position(out += by.heads[0], polygons[0][0].data(), by);
    out += by.after_point;
  } else {
    out += by.none;
    return;
  }
  out += by.tail;
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

void append_geojson(std::string& out, const PlanePolygons& polygons) {
  append_geometry(out, polygons, geojson);
}

void append_wkt(std::string& out, const PlanePolygons& polygons) {
  append_geometry(out, polygons, wkt);
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
  const PlanePolygons boundary{{ring_of(points, hull.vertices)}};
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
