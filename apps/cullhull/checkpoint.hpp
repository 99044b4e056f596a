// A file from which an interrupted run continues.
#pragma once

#include <optional>
#include <string>

#include "cullhull/point_blocks.hpp"
#include "cullhull/stream.hpp"

namespace app {

struct Checkpoint {
  cullhull::BlockPosition position;
  cullhull::HullState state;
  std::string inputs;  ///< names, sizes and times of the inputs, and options of reading
};

/// Replaces the file atomically: where that fails (a full disk) the old one stays. Throws
/// Error{io}.
void write_checkpoint(const std::string& path, const Checkpoint& checkpoint);

/// Empty if there is no such file. Throws Error{bad_file} for a broken one.
std::optional<Checkpoint> read_checkpoint(const std::string& path);

}  // namespace app
