// Files within files: the array in an archive, the contents of a compressed file.
#pragma once

#include <string>

#include "io/packed/archive.hpp"
#include "io/source.hpp"

namespace cullhull::internal::inline io {

/// Whether the file is an archive to look into. `file`: the name without a member's.
bool is_archive(const std::string& file, std::string_view head, const ReadOptions& options);

/// Replaces `source`, the bytes of the file `input.file`, by the contents, and sets `options` to
/// read those. Decompressed bytes are stored in `memory`; else `source` is a part of what it was.
/// Throws Error{bad_file}, Error{out_of_budget}, Error{invalid_argument}.
void unwrap(const InputName& input, Source& source, ReadOptions& options, Buffer& memory);

}  // namespace cullhull::internal::inline io
