// What `python3 -m cullhull` has converted for this run: the program reads and writes files of a
// temporary folder, and names the user's own.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>

namespace app {

/// A text for the user, in which every name of a temporary file is replaced by the user's.
std::string in_users_names(std::string_view text);

/// Whether a file is one of those.
bool is_converted(const std::string& path);

/// The format of the user's file; `read_as` for a file that is none of those.
std::string users_format(const std::string& path, const std::string& read_as);

/// Layers and fields of the user's file as lines of a summary, and as members of a report.
std::string users_lines(const std::string& path);
void add_users_members(nlohmann::ordered_json& report, const std::string& path);

}  // namespace app
