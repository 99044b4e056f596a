// The beginning of a pipe, read before it is known whether its points will be read in blocks.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>

#include "io/blocks/byte_stream.hpp"

namespace cullhull::internal {

/// What was read ahead, and the pipe, from which the rest follows.
struct ReadAhead {
  Descriptor file;
  std::string bytes;
};

/// Whether `path` ("-": standard input) is not a regular file, so that it can be read only once.
bool is_pipe(const std::string& path);

/// Reads the first `most` bytes of a pipe, or all if there are fewer, and keeps them for
/// take_read_ahead(). Returns whether there were so many. Throws Error{io}, and Error{cancelled} if
/// a stop is requested while the pipe is idle.
bool read_ahead(const std::string& path, std::size_t most, const stop_token& stop);

/// Hands over what was read ahead of this path; nothing if that was not asked for, or is taken.
std::optional<ReadAhead> take_read_ahead(const std::string& path);

/// The bytes that were read ahead of this path and not taken; empty if there are none.
std::string_view seen_ahead(const std::string& path);

}  // namespace cullhull::internal
