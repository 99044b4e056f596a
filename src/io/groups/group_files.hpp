// What files of groups have in common: a record for each group, named by its key.
#pragma once

#include <string>
#include <string_view>

#include "io/write/output_file.hpp"

namespace cullhull::internal::inline io {

/// A field of .csv, in quotes where it needs them.
void append_csv(std::string& out, std::string_view text);

/// Writes and clears a text of more than a megabyte.
void write_if_long(std::string& text, OutputFile& out);

/// The format of a file of groups. Throws Error{invalid_argument} for another one.
std::string checked_format(const std::string& path, const std::string& format);

/// The key's name in the output: its own, or "column" and its number.
std::string name_of_key(const std::string& key);

}  // namespace cullhull::internal::inline io
