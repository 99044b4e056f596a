// cullhull hull --by, alpha --by: a hull or a shape for each group.
#pragma once

#include <string>
#include <vector>

#include "arguments.hpp"
#include "cullhull/group_hulls.hpp"

namespace app {

/// Writes the hulls of the groups of equal values in column `key`, with what --keep names; prints a
/// summary unless quiet or the hulls go to standard output.
int run_groups(const InputArguments& input, const std::vector<std::string>& files,
               const std::string& key, const std::string& keep, const std::string& output,
               const RunArguments& run);

/// The same with the alpha shape or concave hull of each group.
int run_group_shapes(const InputArguments& input, const std::vector<std::string>& files,
                     const std::string& key, const std::string& keep, const std::string& output,
                     const cullhull::GroupShape& shape, const RunArguments& run);

}  // namespace app
