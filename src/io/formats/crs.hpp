// Coordinate reference systems: where a WKT has one, and how GeoJSON names it.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace cullhull::internal {

/// Where the system of x and y begins in a WKT: the projected one, else the geographic one; npos
/// without either.
std::size_t horizontal_system(std::string_view wkt);

/// Whether a system is WGS 84 by longitude and latitude, which is what GeoJSON without the member
/// `crs` has (RFC 7946).
bool is_wgs84(std::string_view crs);

/// The member `crs` of a GeoJSON object as GDAL writes and reads it, with the comma behind it;
/// empty without a system and for WGS 84.
std::string crs_member(const std::string& crs);

}  // namespace cullhull::internal
