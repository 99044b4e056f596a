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

/// Calls visit(id, value) for each GeoTIFF key whose value is a number of 16 bits.
template <class Visit>
void visit_keys(std::string_view keys, const Visit& visit) {
  const auto number = [&](std::size_t at) {
    return unsigned{load_little_endian<std::uint16_t>(keys.data() + 2 * at)};
  };
  if (keys.size() < 8) return;
  const std::size_t end = 4 + 4 * std::size_t{number(3)};
  for (std::size_t at = 4; at < end && 2 * at + 8 <= keys.size(); at += 4)
    if (number(at + 1) == 0)  // id, where its value is, how many, value
      visit(number(at), number(at + 3));
}

constexpr unsigned model_key = 1024, geographic_model = 2;

/// The unit that GeoTIFF keys name by number: ProjLinearUnits, but of a geographic model
/// GeogAngularUnits, degrees where there is none. Empty where keys name two.
std::string unit_of_keys(std::string_view keys) {
  constexpr unsigned angular = 2054, linear = 3076, degree = 9102;
  std::optional<unsigned> of_angles, of_lengths;
  bool degrees = false, contradictory = false;
  visit_keys(keys, [&](unsigned id, unsigned value) {
    if (id == model_key) degrees = value == geographic_model;
    if (id != angular && id != linear) return;
    std::optional<unsigned>& unit = id == linear ? of_lengths : of_angles;
    contradictory = contradictory || (unit && *unit != value);
    unit = value;
  });
  if (contradictory) return "";
  if (degrees) return of_angles.value_or(degree) == degree ? "degree" : "";
  return of_lengths ? length_unit(*of_lengths) : "";
}

/// The unit of the projected system that a WKT names, else of the geographic one: the last among
/// its direct members and those of its axes.
std::string unit_of_wkt(std::string_view text) {
  std::size_t at = horizontal_system(text);
  if (at == std::string_view::npos) return "";
  std::string unit;
  bool quoted = false, of_axis = false;
  int depth = 0;
  for (; at < text.size(); ++at) {
    if (text[at] == '"') quoted = !quoted;
    if (quoted) continue;
    if (text[at] == '[') {
      ++depth;
      const std::string_view word = at >= 4 ? text.substr(at - 4, 4) : "";
      if (depth == 2) of_axis = word == "AXIS";
      const bool member = (depth == 2 || (depth == 3 && of_axis)) && word == "UNIT";
      const std::size_t end = text.find('"', at + 2);
      if (member && text.substr(at + 1, 1) == "\"" && end != std::string_view::npos)
        unit = text.substr(at + 2, end - at - 2);
    }
    if (text[at] == ']' && --depth == 0) break;
  }
  const auto printable = [](char c) { return std::isprint(static_cast<unsigned char>(c)) != 0; };
  constexpr std::size_t longest = 40;
  return unit.size() <= longest && std::all_of(unit.begin(), unit.end(), printable) ? unit : "";
}

/// What a WKT among the records of the projection says, else GeoTIFF keys; of `count` records from
/// byte `begin` on.
template <class OfKeys, class OfWkt>
std::string found_by(const Source& head, std::size_t begin, std::size_t count,
                     const OfKeys& of_keys, const OfWkt& of_wkt) {
  constexpr unsigned geo_keys_record = 34735, wkt_record = 2112;
  std::string by_keys, by_wkt;
  for (std::size_t at = begin; count-- > 0 && at + record_head <= head.size;) {
    const std::size_t size = load_little_endian<std::uint16_t>(head.data + at + 20);
    const auto id = load_little_endian<std::uint16_t>(head.data + at + 18);
    const bool projection = std::strncmp(head.data + at + 2, "LASF_Projection", 16) == 0;
    if (size > head.size - at - record_head) break;
    const std::string_view contents(head.data + at + record_head, size);
    if (projection && id == geo_keys_record) by_keys = of_keys(contents);
    if (projection && id == wkt_record) by_wkt = of_wkt(contents);
    at += record_head + size;
  }
  return by_wkt.empty() ? by_keys : by_wkt;
}

/// The code of the system that GeoTIFF keys name: the projected one, of a geographic model the
/// geographic one.
std::string crs_of_keys(std::string_view keys) {
  constexpr unsigned of_angles = 2048, projected = 3072, user_defined = 32767;
  unsigned kind = 0, on_earth = 0, in_plane = 0;
  visit_keys(keys, [&](unsigned id, unsigned value) {
    if (id == model_key) kind = value;
    if (id == of_angles) on_earth = value;
    if (id == projected) in_plane = value;
  });
  const unsigned code = kind == geographic_model ? on_earth : in_plane;
  return code == 0 || code >= user_defined ? "" : "EPSG:" + std::to_string(code);
}

}  // namespace

std::string las_unit(const Source& head, std::size_t begin, std::size_t count) {
  return found_by(head, begin, count, unit_of_keys, unit_of_wkt);
}

std::string las_crs(const Source& head) {
  constexpr std::size_t oldest = 227;
  if (head.size < oldest) return "";
  return found_by(head, load_little_endian<std::uint16_t>(head.data + 94),
                  load_little_endian<std::uint32_t>(head.data + 100), crs_of_keys,
                  [](std::string_view wkt) { return crs_of_wkt(std::string(wkt)); });
}

}  // namespace cullhull::internal
