// What a file holds in another: the array in an archive, the bytes of which it is a compressed
// form.
#pragma once

#include <string>

#include "io/packed/archive.hpp"
#include "io/source.hpp"

namespace cullhull::internal {

/// Whether to look into an archive. `file`: the name without a member's.
bool is_archive(const std::string& file, std::string_view head, const ReadOptions& options);

/// Makes `source` what is in the file `input.file`, of which it has the bytes, and `options` say
/// how to read that. Bytes that had to be unpacked are in `memory`; else `source` is part of what
/// it was. Throws Error{bad_file}, Error{out_of_budget}, Error{invalid_argument}.
void unwrap(const InputName& input, Source& source, ReadOptions& options, Buffer& memory);

}  // namespace cullhull::internal
