// Polygons of GeoJSON (RFC 7946).
#pragma once

#include "cullhull/triangulation_io.hpp"
#include "io/source.hpp"

namespace cullhull::internal::inline io {

/// As the public read_polygons.
Polygons read_polygons(const Source& source);

}  // namespace cullhull::internal::inline io
