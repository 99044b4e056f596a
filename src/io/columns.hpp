// Which columns of a file are the coordinates: what ReadOptions::columns says, held against what
// the file has.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/source.hpp"

namespace cullhull::internal {

/// The numbers of the columns asked for, in that order. `text`: names, numbers from 0 and ranges
/// such as 0:3, between commas; a name may stand in double quotes. `names` are the file's, empty
/// where it has none; `width` is how many columns there are. Throws Error{invalid_argument}, naming
/// the file.
std::vector<std::uint32_t> find_columns(const std::string& text, const std::string& file,
                                        const std::vector<std::string>& names, std::uint32_t width);

/// The names in such a text, as they were written: what is neither number nor range.
std::vector<std::string> names_in(const std::string& text);

/// The same but for capitals.
bool alike(std::string_view a, std::string_view b);

/// x, y and, if there, z by name, in capitals or not; nothing where x or y is missing, or where one
/// of them is there twice.
std::vector<std::uint32_t> find_xyz(const std::vector<std::string>& names);

/// The column of ReadOptions::key, which is taken out of `columns` unless these were asked for; the
/// largest number where there is no key. Throws as find_columns does.
std::uint32_t find_key(const ReadOptions& options, const std::string& file,
                       const std::vector<std::string>& names, std::uint32_t width,
                       std::vector<std::uint32_t>& columns);

/// Makes the view that of the columns that `options` ask for: by strides where these describe them,
/// else by a copy. Keys, where these are asked for, are numbers as decimals.
void choose_columns(PointData& data, const std::string& file, const std::vector<std::string>& names,
                    const ReadOptions& options);

}  // namespace cullhull::internal
