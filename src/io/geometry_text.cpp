#include "io/geometry_text.hpp"

#include <nlohmann/json.hpp>
#include <vector>

#include "cullhull/error.hpp"
#include "io/mesh.hpp"

namespace cullhull::internal {
namespace {

void append_position(std::string& out, std::span<const double> boundary, std::size_t i,
                     const char* between) {
  append_number(out, boundary[2 * i]);
  out += between;
  append_number(out, boundary[2 * i + 1]);
}

/// The first `count` positions and, for a ring, the first one again.
void append_positions(std::string& out, std::span<const double> boundary, bool ring,
                      const char* open, const char* between, const char* close,
                      const char* separator) {
  const std::size_t count = boundary.size() / 2;
  for (std::size_t i = 0; i < count + (ring ? 1 : 0); ++i) {
    if (i > 0) out += separator;
    out += open;
    append_position(out, boundary, i < count ? i : 0, between);
    out += close;
  }
}

struct PlaneMeasures {
  double perimeter = 0, area = 0;
};

/// As .json has them: of a polygon `area` is the perimeter, `volume` the area.
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
  append_positions(out, boundary, count > 2, "[", ", ", "]", ", ");
  out += count > 2 ? "]]}" : count > 1 ? "]}" : "}";
}

void append_wkt(std::string& out, std::span<const double> boundary) {
  const std::size_t count = boundary.size() / 2;
  if (count == 0) {
    out += "POLYGON EMPTY";
    return;
  }
  out += count > 2 ? "POLYGON ((" : count > 1 ? "LINESTRING (" : "POINT (";
  append_positions(out, boundary, count > 2, "", " ", "", ", ");
  out += count > 2 ? "))" : ")";
}

void append_geojson(std::string& out, const PlaneRings& rings) {
  if (rings.size() < 2)
    return append_geojson(out, rings.empty() ? std::span<const double>() : rings[0]);
  out += "{\"type\": \"Polygon\", \"coordinates\": [";
  for (std::size_t i = 0; i < rings.size(); ++i) {
    out += i > 0 ? ", [" : "[";
    append_positions(out, rings[i], true, "[", ", ", "]", ", ");
    out += "]";
  }
  out += "]}";
}

void append_wkt(std::string& out, const PlaneRings& rings) {
  if (rings.size() < 2)
    return append_wkt(out, rings.empty() ? std::span<const double>() : rings[0]);
  out += "POLYGON (";
  for (std::size_t i = 0; i < rings.size(); ++i) {
    out += i > 0 ? ", (" : "(";
    append_positions(out, rings[i], true, "", " ", "", ", ");
    out += ")";
  }
  out += ")";
}

void append_json_string(std::string& out, std::string_view text) {
  out += nlohmann::json(std::string(text))
             .dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

std::string geometry_file(const Coordinates& points, const Hull& hull, const std::string& format) {
  if (hull.dimension != 2)
    throw Error(ErrorCode::invalid_argument, "." + format + " holds hulls of 2D points, not " +
                                                 std::to_string(hull.dimension) +
                                                 "D; meshes hold 3D, .json any");
  std::vector<double> boundary;
  for (const std::uint64_t id : hull.vertices)
    for (std::uint32_t j = 0; j < 2; ++j) boundary.push_back(points.at(id, j));
  std::string out;
  if (format == "wkt") {
    append_wkt(out, boundary);
    return out + '\n';
  }
  out = "{\"type\": \"Feature\", \"properties\": {\"points\": ";
  append_number(out, hull.point_count);
  const PlaneMeasures m = measures_of(hull);
  for (const auto& [name, value] : {std::pair{"perimeter", m.perimeter}, {"area", m.area}}) {
    out += std::string(", \"") + name + "\": ";
    if (value - value == 0)
      append_number(out, value);
    else
      out += "\"inf\"";
  }
  out += "}, \"geometry\": ";
  append_geojson(out, boundary);
  return out + "}\n";
}

}  // namespace cullhull::internal
