// GeoJSON and WKT: geometries of hulls in the plane, maps of polygons, and the polygons that are
// read from GeoJSON (RFC 7946).
#pragma once

#include <cstdint>
#include <initializer_list>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "cullhull/alpha_shape.hpp"
#include "cullhull/io.hpp"
#include "cullhull/triangulation_io.hpp"
#include "io/coordinates.hpp"
#include "io/formats/crs.hpp"
#include "io/source.hpp"
#include "io/write/output_text.hpp"

namespace cullhull::internal {

/// Rings of a polygon: x y of its points, the outer ring first; the last point is not the first.
using PlaneRings = std::vector<std::vector<double>>;
using PlanePolygons = std::vector<PlaneRings>;

/// Polygons, of which a single one may be a line of two points or one point; none is null (GeoJSON)
/// or an empty polygon (WKT).
void append_geojson(std::string& out, const PlanePolygons& polygons);
void append_wkt(std::string& out, const PlanePolygons& polygons);

/// x y of the points with these ids. `Points`: PointView or Coordinates.
template <class Points, class Ids>
std::vector<double> ring_of(const Points& points, const Ids& ids) {
  std::vector<double> ring;
  for (const auto id : ids)
    for (std::uint32_t j = 0; j < 2; ++j) ring.push_back(points.at(id, j));
  return ring;
}

/// The rings of polygon i.
inline PlaneRings rings_of(const CellPolygons& polygons, std::uint64_t i, const PointView& points) {
  PlaneRings rings;
  for (std::uint64_t r = polygons.polygon_offsets[i]; r < polygons.polygon_offsets[i + 1]; ++r)
    rings.push_back(ring_of(points, polygons.rings[r]));
  return rings;
}

/// The whole file for one hull: a Feature with its measures, or one line.
/// Error{invalid_argument} unless the points are 2D.
std::string geometry_file(const Coordinates& points, const Hull& hull, const std::string& format,
                          const MapExtras& extras);

/// A field of .csv, in quotes where it needs them.
void append_csv(std::string& out, std::string_view text);

/// The name of a column beside the result's `own` members: "kept_id" where "id" is one of them.
std::string name_beside(const std::string& column, std::initializer_list<std::string_view> own);

/// Adds a kept value to properties, of which `own` are there: a JSON number unchanged, null for an
/// empty one, else a string.
void append_property(std::string& out, const PointColumn& column, std::uint64_t point,
                     std::initializer_list<std::string_view> own);

/// The value that `count` points have in common, id(i) of each; empty, as a missing one, where they
/// differ.
template <class Id>
std::string_view value_in_common(const PointColumn& column, std::uint64_t count, const Id& id) {
  const std::string_view value = count > 0 ? column.values[id(0)] : std::string_view();
  for (std::uint64_t i = 1; i < count; ++i)
    if (column.values[id(i)] != value) return {};
  return value;
}

/// The columns of `count` shapes; value(column, i): of shape i.
template <class Value>
MapExtras columns_of_shapes(const MapExtras& extras, std::uint64_t count, const Value& value) {
  MapExtras out{extras.crs, {}};
  for (const PointColumn& column : extras.columns) {
    out.columns.push_back({column.name, {}, column.numeric});
    for (std::uint64_t i = 0; i < count; ++i) out.columns.back().values.add(value(column, i));
  }
  return out;
}

/// What all points of a set have in common, for each of its `count` shapes.
MapExtras columns_in_common(const MapExtras& extras, std::uint64_t count);

/// Writes a collection of polygons, each with its number under `name` and in GeoJSON the values of
/// `extras`; polygons(i): what shape i consists of.
template <class Polygons>
void write_map(const std::string& path, const std::string& f, std::uint64_t count, const char* name,
               const MapExtras& extras, const Polygons& polygons) {
  OutputText out(path);
  const bool geojson = f == "geojson";
  if (geojson)
    out.add("{\"type\": \"FeatureCollection\", ")
        .add(crs_member(extras.crs))
        .add("\"features\": [");
  else
    out.add("GEOMETRYCOLLECTION ").add(count == 0 ? "EMPTY" : "(");
  for (std::uint64_t i = 0; i < count; ++i) {
    if (i > 0) out.add(geojson ? "," : ", ");
    if (geojson) {
      out.add("\n{\"type\": \"Feature\", \"properties\": {\"").add(name).add("\": ").number(i);
      for (const PointColumn& column : extras.columns)
        append_property(out.text(), column, i, {name});
      out.add("}, \"geometry\": ");
      append_geojson(out.text(), polygons(i));
      out.add("}");
    } else {
      append_wkt(out.text(), polygons(i));
    }
  }
  out.add(geojson ? "]}\n" : count == 0 ? "\n" : ")\n");
  out.commit();
}

// Polygons of GeoJSON (RFC 7946).

/// As the public read_polygons; `lines`: as read_lines.
Polygons read_polygons(const Source& source, bool lines = false);

}  // namespace cullhull::internal
