// Polygons and lines of GeoJSON (RFC 7946).
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <utility>

#include "cullhull/error.hpp"
#include "cullhull/triangulation_io.hpp"
#include "io/formats/geometry_text.hpp"
#include "io/mapped_file.hpp"
#include "io/packed/unpack.hpp"

namespace cullhull::internal {
namespace {

using nlohmann::json;

class PolygonReader {
 public:
  /// `lines`: also lines, which bound nothing.
  PolygonReader(const std::string& name, bool lines) : name_(name), lines_(lines) {}

  Polygons read(const json& document) {
    add(document);
    if (out_.ring_offsets.size() == 1)
      fault(lines_ ? "there is no line and no polygon in it" : "there is no polygon in it");
    return std::move(out_);
  }

 private:
  [[noreturn]] void fault(const std::string& message) const {
    throw Error(ErrorCode::bad_file, name_, ": ", message);
  }
  const json& member(const json& object, const char* key) const {
    const auto found = object.find(key);
    if (found == object.end()) fault("a geometry without " + std::string(key));
    return *found;
  }

  /// Points and lines beside polygons bound nothing.
  void add(const json& object) {
    if (object.is_null()) return;  // a feature without a place
    if (!object.is_object()) fault("not GeoJSON: an object is expected");
    const json& type = member(object, "type");
    if (type == "FeatureCollection") {
      for (const json& feature : list(member(object, "features"))) add(feature);
    } else if (type == "GeometryCollection") {
      for (const json& geometry : list(member(object, "geometries"))) add(geometry);
    } else if (type == "Feature") {
      add(member(object, "geometry"));
    } else if (type == "Polygon") {
      add_polygon(member(object, "coordinates"));
    } else if (type == "MultiPolygon") {
      for (const json& polygon : list(member(object, "coordinates"))) add_polygon(polygon);
    } else if (lines_ && type == "LineString") {
      add_line(member(object, "coordinates"));
    } else if (lines_ && type == "MultiLineString") {
      add_polygon(member(object, "coordinates"));
    } else if (type != "Point" && type != "MultiPoint" && type != "LineString" &&
               type != "MultiLineString") {
      fault("not GeoJSON: its type is " + type.dump(-1, ' ', true).substr(0, 40));
    }
  }
  const json& list(const json& value) const {
    if (!value.is_array()) fault("not GeoJSON: a list is expected");
    return value;
  }
  void add_polygon(const json& rings) {
    for (const json& ring : list(rings)) add_line(ring);
  }
  void add_line(const json& line) {
    const std::string which =
        (lines_ ? "line " : "ring ") + std::to_string(out_.ring_offsets.size() - 1);
    for (const json& position : list(line)) {
      if (!position.is_array() || position.size() < 2)
        fault(which + " has a position without x and y");
      for (unsigned j = 0; j < 2; ++j) {
        if (!position[j].is_number() || !std::isfinite(position[j].get<double>()))
          fault(which + " has a coordinate that is not a finite number");
        out_.corners.push_back(position[j].get<double>());
      }
    }
    out_.ring_offsets.push_back(out_.corners.size() / 2);
  }

  const std::string& name_;
  bool lines_;
  Polygons out_;
};

}  // namespace

Polygons read_polygons(const Source& source, bool lines) {
  json document;
  try {
    document = json::parse(source.data, source.data + source.size);
  } catch (const json::parse_error& e) {
    const auto before = static_cast<std::ptrdiff_t>(std::min(e.byte, source.size));
    const auto line = 1 + std::count(source.data, source.data + before, '\n');
    fail_at_line(source, static_cast<std::uint64_t>(line), "not GeoJSON: not valid JSON");
  } catch (const json::out_of_range&) {
    throw Error(ErrorCode::bad_file, source.name, ": not GeoJSON: a number out of range");
  }
  return PolygonReader(source.name, lines).read(document);
}

}  // namespace cullhull::internal

namespace cullhull {

namespace {

Polygons read_rings(const std::string& path, bool lines) {
  using namespace internal;
  const MappedFile file(path);
  Source source = file.source();
  const std::string_view bytes(source.data, source.size);
  RawArray<char> unpacked;
  if (const Packing packing = packing_of(bytes, source.name, {}); packing != Packing::none) {
    unpacked =
        read_all(*unpack(packing, stream_of(bytes), source.name), source.name, {}, source.size);
    source.data = unpacked.data();
  }
  Polygons polygons = internal::read_polygons(source, lines);
  file.check_size();
  return polygons;
}

}  // namespace

Polygons read_polygons(const std::string& path) { return read_rings(path, false); }
Polygons read_lines(const std::string& path) { return read_rings(path, true); }

}  // namespace cullhull
