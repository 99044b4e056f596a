#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <string_view>

#include "io/formats/crs.hpp"
#include "io/formats/las_fields.hpp"
#include "parallel/byte_order.hpp"

namespace cullhull::internal {
namespace {

constexpr std::size_t record_head = 54;  // bytes before the contents of a variable-length record

/// Units of x and y by their numbers; empty for others.
std::string length_unit(unsigned number) {
  switch (number) {
    case 9001:
      return "metre";
    case 9002:
      return "foot";
    case 9003:
      return "US survey foot";
    default:
      return "";
  }
}

/// The unit that GeoTIFF keys name by number: ProjLinearUnits, but of a geographic model
/// GeogAngularUnits, degrees where there is none. Empty where keys name two.
std::string unit_of_keys(std::string_view keys) {
  constexpr unsigned model = 1024, geographic = 2, angular = 2054, linear = 3076, degree = 9102;
  const auto number = [&](std::size_t at) {
    return unsigned{load_little_endian<std::uint16_t>(keys.data() + 2 * at)};
  };
  if (keys.size() < 8) return "";
  std::optional<unsigned> of_angles, of_lengths;
  bool degrees = false, contradictory = false;
  const std::size_t end = 4 + 4 * std::size_t{number(3)};
  for (std::size_t at = 4; at < end && 2 * at + 8 <= keys.size(); at += 4) {
    if (number(at + 1) != 0) continue;  // id, where its value is, how many, value
    const unsigned id = number(at), value = number(at + 3);
    if (id == model) degrees = value == geographic;
    if (id != angular && id != linear) continue;
    std::optional<unsigned>& unit = id == linear ? of_lengths : of_angles;
    contradictory = contradictory || (unit && *unit != value);
    unit = value;
  }
  if (contradictory) return "";
  if (degrees) return of_angles.value_or(degree) == degree ? "degree" : "";
  return of_lengths ? length_unit(*of_lengths) : "";
}

/// The unit of the projected system that a WKT names, else of the geographic one: the last among
/// its direct members and those of its axes.
std::string unit_of_wkt(std::string_view wkt) {
  std::size_t at = horizontal_system(wkt);
  if (at == std::string_view::npos) return "";
  std::string unit;
  bool quoted = false, of_axis = false;
  int depth = 0;
  for (; at < wkt.size(); ++at) {
    if (wkt[at] == '"') quoted = !quoted;
    if (quoted) continue;
    if (wkt[at] == '[') {
      ++depth;
      const std::string_view word = at >= 4 ? wkt.substr(at - 4, 4) : "";
      if (depth == 2) of_axis = word == "AXIS";
      const bool member = (depth == 2 || (depth == 3 && of_axis)) && word == "UNIT";
      const std::size_t end = wkt.find('"', at + 2);
      if (member && wkt.substr(at + 1, 1) == "\"" && end != std::string_view::npos)
        unit = wkt.substr(at + 2, end - at - 2);
    }
    if (wkt[at] == ']' && --depth == 0) break;
  }
  const auto printable = [](char c) { return std::isprint(static_cast<unsigned char>(c)) != 0; };
  constexpr std::size_t longest = 40;
  return unit.size() <= longest && std::all_of(unit.begin(), unit.end(), printable) ? unit : "";
}

}  // namespace

namespace {

/// Calls `visit` with the number and the contents of each record of the projection, of `count`
/// records from byte `begin` on.
template <class Visit>
void visit_projection(const Source& head, std::size_t begin, std::size_t count,
                      const Visit& visit) {
  for (std::size_t at = begin; count-- > 0 && at + record_head <= head.size;) {
    const std::size_t size = load_little_endian<std::uint16_t>(head.data + at + 20);
    const auto id = load_little_endian<std::uint16_t>(head.data + at + 18);
    const bool projection = std::strncmp(head.data + at + 2, "LASF_Projection", 16) == 0;
    if (size > head.size - at - record_head) break;
    if (projection) visit(id, std::string_view(head.data + at + record_head, size));
    at += record_head + size;
  }
}

constexpr unsigned geo_keys_record = 34735, wkt_record = 2112;

/// The code of the system that GeoTIFF keys name: the projected one, of a geographic model the
/// geographic one.
std::string crs_of_keys(std::string_view keys) {
  constexpr unsigned model = 1024, geographic = 2, of_angles = 2048, projected = 3072;
  constexpr unsigned user_defined = 32767;
  const auto number = [&](std::size_t at) {
    return unsigned{load_little_endian<std::uint16_t>(keys.data() + 2 * at)};
  };
  if (keys.size() < 8) return "";
  unsigned kind = 0, on_earth = 0, in_plane = 0;
  const std::size_t end = 4 + 4 * std::size_t{number(3)};
  for (std::size_t at = 4; at < end && 2 * at + 8 <= keys.size(); at += 4) {
    if (number(at + 1) != 0) continue;
    const unsigned id = number(at), value = number(at + 3);
    if (id == model) kind = value;
    if (id == of_angles) on_earth = value;
    if (id == projected) in_plane = value;
  }
  const unsigned code = kind == geographic ? on_earth : in_plane;
  return code == 0 || code >= user_defined ? "" : "EPSG:" + std::to_string(code);
}

}  // namespace

std::string las_unit(const Source& head, std::size_t begin, std::size_t count) {
  std::string of_keys, of_wkt;
  visit_projection(head, begin, count, [&](unsigned id, std::string_view contents) {
    if (id == geo_keys_record) of_keys = unit_of_keys(contents);
    if (id == wkt_record) of_wkt = unit_of_wkt(contents);
  });
  return of_wkt.empty() ? of_keys : of_wkt;
}

std::string las_crs(const Source& head) {
  constexpr std::size_t oldest = 227;
  if (head.size < oldest) return "";
  const std::size_t begin = load_little_endian<std::uint16_t>(head.data + 94);
  const std::size_t count = load_little_endian<std::uint32_t>(head.data + 100);
  std::string of_keys, of_wkt;
  visit_projection(head, begin, count, [&](unsigned id, std::string_view contents) {
    if (id == geo_keys_record) of_keys = crs_of_keys(contents);
    if (id == wkt_record) of_wkt = crs_of_wkt(std::string(contents));
  });
  return of_wkt.empty() ? of_keys : of_wkt;
}

}  // namespace cullhull::internal
