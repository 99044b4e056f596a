// Which columns of a file are the coordinates, by ReadOptions::columns and the file's names.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/source.hpp"

namespace cullhull::internal::inline io {

/// The numbers of the columns asked for, in that order. `text`: names, numbers from 0 and ranges
/// such as 0:3, separated by commas; a name may stand in double quotes. `names` are the file's,
/// empty where it has none; `width` is its number of columns. Throws Error{invalid_argument},
/// naming the file.
std::vector<std::uint32_t> find_columns(const std::string& text, const std::string& file,
                                        const std::vector<std::string>& names, std::uint32_t width);

/// The names in such a text as written: the items that are neither numbers nor ranges.
std::vector<std::string> names_in(const std::string& text);

/// Equal regardless of case.
bool alike(std::string_view a, std::string_view b);

/// Columns that are coordinates by their names, regardless of case.
struct KnownColumns {
  std::vector<std::uint32_t> columns;  ///< empty: the names say nothing
  std::string text;                    ///< of their names, for a remark: "x, y and z"
};

/// The columns named x, y and, if there is one, z; else lon and lat, longitude and latitude, or
/// easting and northing, and a z, height, elevation or altitude. None where one of the names occurs
/// twice.
KnownColumns find_known_columns(const std::vector<std::string>& names);

/// The columns whose names say that they number the points: id, index, fid, or an empty name.
std::vector<std::uint32_t> find_numbering(const std::vector<std::string>& names);

/// The column of ReadOptions::key, which is removed from `columns` unless these were asked for; the
/// largest number where there is no key. Throws as find_columns does.
std::uint32_t find_key(const ReadOptions& options, const std::string& file,
                       const std::vector<std::string>& names, std::uint32_t width,
                       std::vector<std::uint32_t>& columns);

/// Restricts the view to the columns that `options` ask for: by strides where possible, else by a
/// copy. Keys, where asked for, are numbers as decimals. Of `names` those beyond the file's
/// dimension name nothing.
void choose_columns(PointData& data, const std::string& file, std::vector<std::string> names,
                    const ReadOptions& options);
/// Restricts the view, and its placement, to these columns.
void take_columns(PointData& data, const std::vector<std::uint32_t>& columns);

}  // namespace cullhull::internal::inline io
