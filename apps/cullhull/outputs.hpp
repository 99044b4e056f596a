// What several subcommands say and write.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "arguments.hpp"

namespace app {

/// "points     20,000 x 3 f64, npy, in place\n"
std::string points_line(const Input& input);

/// "survivors  1,000 (5 %), cull: gauge\n", of `count` points.
std::string survivors_line(std::uint64_t survivors, std::uint64_t count, std::string_view method);

/// Refuses, before the work, a file that write_hull could not write for points of this dimension:
/// Error{invalid_argument}, beginning "-o PATH: ".
void check_hull_file(const std::string& path, std::uint32_t dimension);

}  // namespace app
