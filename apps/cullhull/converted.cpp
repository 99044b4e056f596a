#include "converted.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "measure.hpp"

namespace app {
namespace {

using Json = nlohmann::ordered_json;

/// By the names of the temporary files: `name`, and where known `format`, `layers`, `fields`. The
/// file that $CULLHULL_CONVERTED names is written by bindings/python/cullhull/__main__.py.
const Json& converted() {
  static const Json all = [] {
    const char* const path = std::getenv("CULLHULL_CONVERTED");
    if (path == nullptr || *path == 0) return Json::object();
    std::ifstream in(path);
    Json read = Json::parse(in, nullptr, false);
    return read.is_object() ? read : Json::object();
  }();
  return all;
}

Json member(const std::string& path, const char* name) {
  const auto file = converted().find(path);
  return file == converted().end() ? Json() : file->value(name, Json());
}

}  // namespace

std::string in_users_names(std::string_view text) {
  std::string out(text);
  for (const auto& [path, file] : converted().items()) {
    const std::string name = file.value("name", path);
    for (std::size_t at = 0; (at = out.find(path, at)) != std::string::npos; at += name.size())
      out.replace(at, path.size(), name);
  }
  return out;
}

bool is_converted(const std::string& path) { return converted().contains(path); }

std::string users_format(const std::string& path, const std::string& read_as) {
  const Json format = member(path, "format");
  return format.is_string() ? format.get<std::string>() : read_as;
}

std::string users_lines(const std::string& path) {
  std::string text;
  for (const Json& layer : member(path, "layers")) {
    const std::uint64_t features = layer.value("features", std::uint64_t{0});
    text += fmt::format("layer      {}: {} feature{}, {}\n", layer.value("name", ""),
                        grouped(features), features == 1 ? "" : "s", layer.value("geometry", ""));
  }
  std::string fields;
  for (const Json& field : member(path, "fields"))
    fields += fmt::format("{}{} ({})", fields.empty() ? "" : ", ", field.value("name", ""),
                          field.value("type", ""));
  return fields.empty() ? text : text + "fields     " + fields + "\n";
}

void add_users_members(Json& report, const std::string& path) {
  for (const char* name : {"layers", "fields"})
    if (Json value = member(path, name); value.is_array()) report[name] = std::move(value);
}

}  // namespace app
