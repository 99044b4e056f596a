// --keep: values beside the coordinates, for what is written of points and of shapes.
#pragma once

#include <string>
#include <vector>

#include "arguments.hpp"
#include "cullhull/io.hpp"

namespace app {

/// Adds `--keep NAME,...`. `where`: the outputs that take the values.
void add_keep_option(Parser& command, std::string& keep, const std::string& where);

/// Refuses, before the work, what contradicts itself: inputs that are read once, ids that do
/// not count from 0, and outputs of which none holds columns. `endings`: of those that do.
void check_keep(const std::string& keep, const std::vector<std::string>& files,
                const std::vector<std::string>& outputs, const std::vector<std::string>& endings,
                std::uint64_t first_id = 0);

/// The maps among these outputs: they hold columns.
std::vector<std::string> maps_among(const std::vector<std::string>& outputs);

/// The columns that --keep names, of all points; the inputs are read once more for each. Throws
/// Error{out_of_budget} where they exceed what --memory leaves.
std::vector<cullhull::PointColumn> kept_columns(const std::string& keep,
                                                const InputArguments& input,
                                                const std::vector<std::string>& files,
                                                const RunArguments& run);

}  // namespace app
