// Which columns of a file are the coordinates, by ReadOptions::columns and the file's names.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/source.hpp"

namespace cullhull::internal {

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

/// The columns that are coordinates by their names, in order; empty: the names say nothing, or more
/// than one column has one of the names. x, y and z; else longitude, latitude and a height; else
/// easting, northing and a height, in the words of several languages (docs/formats.md), in any
/// case, with units ("X [m]", "lat_dd") and words such as "point" and "coordinate" beside them.
std::vector<std::uint32_t> find_known_columns(const std::vector<std::string>& names);

/// Whether the name is a height's, which is a coordinate only beside known names.
bool is_height_name(const std::string& name);

/// Whether the word is a unit of length or angle, as lines of units below the names have it.
bool is_unit(std::string_view word);

/// The columns whose names say that they number the points: id, index, fid, or an empty name.
std::vector<std::uint32_t> find_numbering(const std::vector<std::string>& names);

/// Whether these names, all there are, are a series: one stem with numbers that follow one another
/// (x1 x2 x3, dim_0 dim_1, PC1 PC2), letters that do (a b c, u v w), or one stem with x, y and z.
bool are_series(const std::vector<std::string>& names);

/// The names of such columns, or their numbers where there are no names.
std::vector<std::string> column_labels(const std::vector<std::uint32_t>& columns,
                                       const std::vector<std::string>& names);

/// The column of ReadOptions::key, which is removed from `columns` unless these were asked for; the
/// largest number where there is no key. Throws as find_columns does.
std::uint32_t find_key(const ReadOptions& options, const std::string& file,
                       const std::vector<std::string>& names, std::uint32_t width,
                       std::vector<std::uint32_t>& columns);

/// The columns of a format that names its fields: numbers of names, of which the first `axes` are
/// x, y and perhaps z.
struct ChosenFields {
  std::vector<std::uint32_t> columns;  ///< the coordinates, and behind them the key
  bool keyed = false;                  ///< whether the last one is the key
  std::vector<std::string> labels;     ///< of the coordinates: PointFile::columns()
};

/// The axes, or what `options` ask for; numbers and ranges are of axes, other fields have names.
ChosenFields choose_fields(const ReadOptions& options, const std::string& file,
                           const std::vector<std::string>& names, std::uint32_t axes);
/// Points of chosen fields, with the labels of their columns; their last column becomes their keys,
/// as decimals, if it is the key.
PointData with_keys(PointData data, const ChosenFields& chosen);

/// Restricts the view to the columns that `options` ask for, unless the reader has chosen them: by
/// strides where possible, else by a copy. Keys, where asked for, are numbers as decimals. Of
/// `names` those beyond the file's dimension name nothing.
void choose_columns(PointData& data, const std::string& file, std::vector<std::string> names,
                    const ReadOptions& options);
/// Restricts the view, and its placement, to these columns.
void take_columns(PointData& data, const std::vector<std::uint32_t>& columns);

}  // namespace cullhull::internal
