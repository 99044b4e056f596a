// cullhull hull --by: a hull for each group.
#pragma once

#include <string>
#include <vector>

#include "arguments.hpp"

namespace app {

/// Writes the hulls of the groups of equal values in column `key`; prints a summary unless quiet or
/// the hulls go to standard output.
int run_groups(const InputArguments& input, const std::vector<std::string>& files,
               const std::string& key, const std::string& output, const RunArguments& run);

}  // namespace app
