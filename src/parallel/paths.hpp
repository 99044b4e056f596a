// Names of files, which are UTF-8 in all of our code, as the system's paths. On Windows a path made
// of chars takes them for letters of the process's code page.
#pragma once

#include <filesystem>
#include <string>
#include <string_view>

namespace cullhull::internal {

/// What stands between the folders of a name.
inline constexpr std::string_view separators =
    std::filesystem::path::preferred_separator == '/' ? "/" : "/\\";

inline std::filesystem::path native_path(std::string_view name) {
  return {std::u8string(name.begin(), name.end())};
}
inline std::string utf8_name(const std::filesystem::path& path) {
  const std::u8string name = path.u8string();
  return {name.begin(), name.end()};
}

}  // namespace cullhull::internal
