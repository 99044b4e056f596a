// The machine's constants as `cullhull-bench machine` writes them.
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "cullhull/error.hpp"
#include "cullhull/io.hpp"
#include "io/mapped_file.hpp"
#include "io/source.hpp"
namespace cullhull {

namespace {

[[noreturn]] void refuse(const std::string& path, const std::string& why) {
  throw Error(ErrorCode::bad_file, internal::display_name(path), ": ", why,
              "; run cullhull-bench machine again");
}

double rate(const nlohmann::json& json, const char* key, const std::string& path) {
  const auto found = json.find(key);
  if (found == json.end()) refuse(path, std::string("the key ") + key + " is missing");
  const double value = found->is_number() ? found->get<double>() : 0;
  if (!(value > 0) || !std::isfinite(value))
    refuse(path, std::string(key) + " must be a positive number");
  return value;
}

}  // namespace

MachineConstants machine_from_json(const std::string& path) {
  const internal::MappedFile file(path);
  const internal::Source& source = file.source();
  const nlohmann::json json =
      nlohmann::json::parse(source.data, source.data + source.size, nullptr, false);
  if (!json.is_object()) refuse(path, "not a JSON object");
  MachineConstants m;
  m.host_read_bytes_per_second = rate(json, "host_read_bytes_per_second", path);
  m.host_copy_bytes_per_second = rate(json, "host_copy_bytes_per_second", path);
  // A machine without a device has no such rates; the defaults remain, for a device added later.
  for (const auto& [key, value] :
       {std::pair{"link_bytes_per_second", &m.link_bytes_per_second},
        {"device_copy_bytes_per_second", &m.device_copy_bytes_per_second}})
    if (const auto found = json.find(key); found != json.end() && !found->is_null())
      *value = rate(json, key, path);
  const auto cores = json.find("cores");
  if (cores != json.end()) {
    if (!cores->is_number_unsigned() || cores->get<std::uint64_t>() > 1U << 20)
      refuse(path, "cores must be a whole number");
    m.cores = cores->get<unsigned>();
  }
  const auto date = json.find("date");
  if (date != json.end() && date->is_string()) m.date = date->get<std::string>();
  return m;
}

}  // namespace cullhull
