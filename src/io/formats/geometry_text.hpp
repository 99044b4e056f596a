// A hull in the plane as GeoJSON and WKT geometries.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "cullhull/io.hpp"
#include "io/coordinates.hpp"

namespace cullhull::internal::inline io {

/// `boundary`: x y of the hull's vertices, counter-clockwise. A polygon is one closed ring; two
/// points are a line, one is a point, none is null (GeoJSON) or an empty polygon (WKT).
void append_geojson(std::string& out, std::span<const double> boundary);
void append_wkt(std::string& out, std::span<const double> boundary);

/// Rings of a polygon: x y of its points, the outer ring first.
using PlaneRings = std::vector<std::vector<double>>;

/// The same of a polygon with holes; one ring as above.
void append_geojson(std::string& out, const PlaneRings& rings);
void append_wkt(std::string& out, const PlaneRings& rings);

/// Several polygons; one or none as above.
using PlanePolygons = std::vector<PlaneRings>;
void append_geojson(std::string& out, const PlanePolygons& polygons);
void append_wkt(std::string& out, const PlanePolygons& polygons);

/// The whole file for one hull: a Feature with its measures, or one line. Error{invalid_argument}
/// unless the points are 2D.
std::string geometry_file(const Coordinates& points, const Hull& hull, const std::string& format);

}  // namespace cullhull::internal::inline io
