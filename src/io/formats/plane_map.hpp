// Maps of polygons: GeoJSON and WKT.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "io/formats/geometry_text.hpp"
#include "io/write/output_text.hpp"

namespace cullhull::internal::inline io {

inline bool is_map(const std::string& f) { return f == "geojson" || f == "wkt"; }

/// Writes a collection of polygons, each with its number under `name`; rings(i): those of polygon
/// i.
template <class Rings>
void write_map(const std::string& path, const std::string& f, std::uint64_t count, const char* name,
               const Rings& rings) {
  OutputText out(path);
  const bool geojson = f == "geojson";
  out.add(geojson ? "{\"type\": \"FeatureCollection\", \"features\": [" : "GEOMETRYCOLLECTION ");
  if (!geojson) out.add(count == 0 ? "EMPTY" : "(");
  for (std::uint64_t i = 0; i < count; ++i) {
    if (i > 0) out.add(geojson ? "," : ", ");
    if (geojson) {
      out.add("\n{\"type\": \"Feature\", \"properties\": {\"").add(name).add("\": ").number(i);
      out.add("}, \"geometry\": ");
      append_geojson(out.text(), rings(i));
      out.add("}");
    } else {
      append_wkt(out.text(), rings(i));
    }
  }
  out.add(geojson ? "]}\n" : count == 0 ? "\n" : ")\n");
  out.commit();
}

}  // namespace cullhull::internal::inline io
