// Which coordinate reference system a file states.
#include "io/formats/crs.hpp"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "cullhull/error.hpp"
#include "cullhull/placement.hpp"
#include "cullhull/point_blocks.hpp"
#include "io/blocks/byte_stream.hpp"
#include "io/formats/las_fields.hpp"
#include "io/packed/unpack.hpp"
#include "io/records.hpp"
#include "io/source.hpp"
#include "io/system.hpp"
#include "parallel/byte_order.hpp"
#include "parallel/paths.hpp"

namespace cullhull::internal {
namespace {

bool is_word(std::string_view text) {
  return !text.empty() && text.size() <= 40 && std::all_of(text.begin(), text.end(), [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-';
  });
}

/// The code that belongs to the system at `at` itself: AUTHORITY["EPSG","25832"], or in WKT 2
/// ID["EPSG",25832]. Those of its parts lie deeper.
std::string code_within(std::string_view wkt, std::size_t at) {
  bool quoted = false;
  int depth = 0;
  for (; at < wkt.size(); ++at) {
    if (wkt[at] == '"') quoted = !quoted;
    if (quoted) continue;
    if (wkt[at] == ']' && --depth == 0) break;
    if (wkt[at] != '[' || ++depth != 2) continue;
    const std::string_view before = wkt.substr(0, at);
    if (!before.ends_with("AUTHORITY") && !before.ends_with(",ID") && !before.ends_with(" ID") &&
        !before.ends_with("\nID"))
      continue;
    std::string text(wkt.substr(at + 1, wkt.find(']', at) - at - 1));
    std::erase_if(
        text, [](char c) { return c == '"' || std::isspace(static_cast<unsigned char>(c)) != 0; });
    const std::size_t comma = text.find(',');
    if (comma == std::string::npos) continue;
    return crs_code(text.substr(0, comma) + ':' +
                    text.substr(comma + 1, text.find(',', comma + 1) - comma - 1));
  }
  return "";
}

/// Letters and digits of a name, small: "WGS_1984_UTM_Zone_32N" and "WGS 84 / UTM zone 32N" differ
/// by their years alone.
std::string plain_name(std::string_view name) {
  std::string plain;
  for (const char c : name)
    if (std::isalnum(static_cast<unsigned char>(c)) != 0)
      plain += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return plain;
}

/// The codes of systems that Esri's programs write without a code.
std::string code_of_name(std::string_view name) {
  static constexpr std::pair<std::string_view, std::string_view> known[] = {
      {"wgs84", "EPSG:4326"},
      {"gcswgs1984", "EPSG:4326"},
      {"etrs89", "EPSG:4258"},
      {"gcsetrs1989", "EPSG:4258"},
      {"wgs84pseudomercator", "EPSG:3857"},
      {"wgs1984webmercatorauxiliarysphere", "EPSG:3857"}};
  const std::string plain = plain_name(name);
  for (const auto& [of, code] : known)
    if (plain == of) return std::string(code);
  // Zones: the number of the first one less one, by the hemisphere; N alone where it is 0.
  struct Zones {
    std::string_view name;
    unsigned least, most, north, south;
  };
  static constexpr Zones zones[] = {
      {"wgs84utmzone", 1, 60, 32600, 32700}, {"wgs1984utmzone", 1, 60, 32600, 32700},
      {"etrs89utmzone", 28, 38, 25800, 0},   {"etrs1989utmzone", 28, 38, 25800, 0},
      {"nad83utmzone", 1, 23, 26900, 0},     {"nad1983utmzone", 1, 23, 26900, 0}};
  for (const Zones& z : zones) {
    if (!plain.starts_with(z.name)) continue;
    const std::string zone = plain.substr(z.name.size());
    if (zone.size() < 2 || zone.size() > 3) continue;
    const std::string digits = zone.substr(0, zone.size() - 1);
    if (digits.find_first_not_of("0123456789") != std::string::npos) continue;
    const unsigned number = static_cast<unsigned>(std::stoul(digits));
    const unsigned first = zone.back() == 'n' ? z.north : zone.back() == 's' ? z.south : 0;
    if (first != 0 && number >= z.least && number <= z.most)
      return "EPSG:" + std::to_string(first + number);
  }
  return "";
}

/// The value of a member `crs`, as GDAL and the format of 2008 have it.
std::string crs_of_json(const nlohmann::json& crs) {
  if (!crs.is_object()) return "";
  const auto properties = crs.find("properties");
  if (properties == crs.end() || !properties->is_object()) return "";
  if (const auto name = properties->find("name"); name != properties->end() && name->is_string())
    return crs_code(name->get<std::string>());
  const auto code = properties->find("code");
  if (crs.value("type", nlohmann::json()) == "EPSG" && code != properties->end())
    return crs_code("EPSG:" + (code->is_string() ? code->get<std::string>() : code->dump()));
  return "";
}

/// The object that begins at `at`.
std::string_view object_at(std::string_view text, std::size_t at) {
  const std::size_t begin = at;
  bool quoted = false;
  int depth = 0;
  for (; at < text.size(); ++at) {
    if (quoted && text[at] == '\\')
      ++at;
    else if (text[at] == '"')
      quoted = !quoted;
    else if (!quoted && text[at] == '{')
      ++depth;
    else if (!quoted && text[at] == '}' && --depth == 0)
      return text.substr(begin, at + 1 - begin);
  }
  return "";
}

/// The first member `crs` in a part of a GeoJSON text that names a system.
std::string crs_of_geojson(std::string_view text) {
  constexpr std::string_view key = "\"crs\"";
  for (std::size_t at = 0; (at = text.find(key, at)) != std::string_view::npos;) {
    at = text.find_first_not_of(" \t\r\n", at + key.size());
    if (at == std::string_view::npos || text[at] != ':') continue;
    at = text.find_first_not_of(" \t\r\n", at + 1);
    if (at == std::string_view::npos || text[at] != '{') continue;
    const nlohmann::json value = nlohmann::json::parse(object_at(text, at), nullptr, false);
    if (std::string crs = crs_of_json(value); !crs.empty()) return crs;
  }
  return "";
}

/// What is beside a file: NAME.prj, of a compressed one without its .gz.
std::string crs_beside(const std::string& file) {
  const std::filesystem::path name = native_path(unpacked_name(file));
  for (const char* ending : {".prj", ".PRJ"}) {
    std::filesystem::path beside = name;
    std::ifstream in(beside.replace_extension(ending), std::ios::binary);
    if (!in) continue;
    constexpr std::size_t most = std::size_t{1} << 16;
    std::string text(most, '\0');
    in.read(text.data(), static_cast<std::streamsize>(most));
    text.resize(static_cast<std::size_t>(in.gcount()));
    const std::size_t end = text.find_last_not_of(" \t\r\n");
    text.resize(end == std::string::npos ? 0 : end + 1);
    const std::string code = crs_code(text);
    return code.empty() ? crs_of_wkt(text) : code;
  }
  return "";
}

/// The WKT in a record behind the points, which LAS 1.4 allows.
std::string crs_behind_points(const OpenedBytes& opened) {
  constexpr std::size_t with_extended = 375, record_head = 60, most = std::size_t{1} << 20;
  const auto at = [&](std::size_t byte) {
    return load_little_endian<std::uint64_t>(opened.head.data() + byte);
  };
  const bool has = opened.head.size() >= with_extended && opened.head[25] == 4 &&
                   opened.file.get() >= 0 && opened.size != unknown_size;
  if (!has) return "";
  std::uint64_t byte = at(235);
  for (std::uint64_t i = load_little_endian<std::uint32_t>(opened.head.data() + 243); i-- > 0;) {
    char head[record_head];
    if (byte > opened.size || opened.size - byte < record_head) return "";
    read_at(opened, head, record_head, byte);
    const auto size = load_little_endian<std::uint64_t>(head + 20);
    byte += record_head;
    if (size > opened.size - byte) return "";
    const bool wkt = load_little_endian<std::uint16_t>(head + 18) == 2112 &&
                     std::string_view(head + 2, 15) == "LASF_Projection";
    if (wkt && size <= most) {
      std::string text(size, '\0');
      read_at(opened, text.data(), text.size(), byte);
      return crs_of_wkt(text);
    }
    byte += size;
  }
  return "";
}

/// What the first bytes of a file say, or its last: of GeoJSON `crs` may stand at the end.
std::string crs_within(const std::string& path) {
  const OpenedBytes opened = open_bytes(path, {});
  const std::string_view head = opened.head;
  if (head.starts_with("LASF")) {
    std::string crs = las_crs({opened.name, head.data(), head.size()});
    return crs.empty() ? crs_behind_points(opened) : crs;
  }
  const std::size_t first = head.find_first_not_of("\xEF\xBB\xBF \t\r\n");
  if (first == std::string_view::npos || head[first] != '{') return "";
  constexpr std::size_t looked_at = std::size_t{1} << 16;
  std::string crs = crs_of_geojson(head.substr(0, looked_at));
  if (!crs.empty() || opened.file.get() < 0 || opened.size == unknown_size) return crs;
  std::string tail(std::min<std::uint64_t>(opened.size, looked_at), '\0');
  read_at(opened, tail.data(), tail.size(), opened.size - tail.size());
  return crs_of_geojson(tail);
}

}  // namespace

std::size_t horizontal_system(std::string_view wkt) {
  for (const std::string_view kind : {"PROJCS[", "PROJCRS[", "PROJECTEDCRS[", "GEOGCS[", "GEOGCRS[",
                                      "GEOGRAPHICCRS[", "GEODCRS["})
    if (const std::size_t at = wkt.find(kind); at != std::string_view::npos) return at;
  return std::string_view::npos;
}

bool is_wgs84(std::string_view crs) {
  return crs == "EPSG:4326" || crs == "EPSG:4979" || crs == "OGC:CRS84" || crs == "OGC:CRS84H";
}

std::string crs_member(const std::string& crs) {
  const std::size_t colon = crs.find(':');
  if (colon == std::string::npos || is_wgs84(crs)) return "";
  return "\"crs\": {\"type\": \"name\", \"properties\": {\"name\": \"urn:ogc:def:crs:" +
         crs.substr(0, colon) + "::" + crs.substr(colon + 1) + "\"}}, ";
}

}  // namespace cullhull::internal

namespace cullhull {

std::string crs_code(const std::string& text) {
  // The parts between colons or slashes: EPSG:25832, urn:ogc:def:crs:EPSG::25832,
  // http://www.opengis.net/def/crs/EPSG/0/25832, urn:ogc:def:crs:OGC:1.3:CRS84.
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ':' || c == '/')
      parts.emplace_back();
    else
      parts.back() += static_cast<char>(std::toupper(static_cast<unsigned char>(c)));
  }
  const std::string code = parts.back();
  std::size_t authority = 0;
  if (parts.size() > 2) {
    const auto crs = std::find(parts.begin(), parts.end(), "CRS");
    authority = static_cast<std::size_t>(crs - parts.begin()) + 1;
    // An authority, a version that may be empty, and a code.
    if (authority + 3 != parts.size()) return "";
  } else if (parts.size() != 2) {
    return "";
  }
  if (!internal::is_word(parts[authority]) || !internal::is_word(code)) return "";
  if (parts[authority] == "EPSG" && code.find_first_not_of("0123456789") != std::string::npos)
    return "";
  return parts[authority] + ':' + code;
}

std::string crs_of_wkt(const std::string& wkt) {
  const std::size_t at = internal::horizontal_system(wkt);
  if (at == std::string::npos) return "";
  if (std::string code = internal::code_within(wkt, at); !code.empty()) return code;
  const std::size_t begin = wkt.find('"', at), end = wkt.find('"', begin + 1);
  if (begin == std::string::npos || end == std::string::npos) return "";
  return internal::code_of_name(std::string_view(wkt).substr(begin + 1, end - begin - 1));
}

std::string file_crs(const std::string& path) {
  using namespace internal;
  const std::string file = file_of_input(path);
  system::FileStatus status{};
  if (path == "-" || system::status_of(file.c_str(), status) != 0 || !system::is_regular(status))
    return "";
  std::string crs;
  try {
    if (file == path) crs = crs_within(path);
  } catch (const Error&) {
    // Whoever reads the points says what is wrong.
  }
  return crs.empty() ? crs_beside(file) : crs;
}

std::string common_crs(const std::vector<std::string>& files,
                       std::pair<std::string, std::string>* differing) {
  std::string common, first;
  for (const std::string& file : files) {
    const std::string crs = file_crs(file);
    const bool same = crs == common || (internal::is_wgs84(crs) && internal::is_wgs84(common));
    if (crs.empty() || same) continue;
    if (!first.empty()) {
      if (differing != nullptr) *differing = {first, file};
      return "";
    }
    common = crs;
    first = file;
  }
  return common;
}

}  // namespace cullhull
