// A file from which a run that was cut off goes on.
#pragma once

#include <optional>
#include <string>

#include "cullhull/point_blocks.hpp"
#include "cullhull/stream.hpp"

namespace app {

struct Checkpoint {
  cullhull::BlockPosition position;
  cullhull::HullState state;
  std::string inputs;  ///< names, sizes and times of the inputs, and how they are read
};

/// Replaces the file as a whole: where that fails (a full disk) the one before stays as it is.
/// Throws Error{io}.
void write_checkpoint(const std::string& path, const Checkpoint& checkpoint);

/// Nothing if there is no such file. Throws Error{bad_file} for one that is broken.
std::optional<Checkpoint> read_checkpoint(const std::string& path);

}  // namespace app
