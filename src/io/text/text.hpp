// Shared by the two halves of the text reader: the fields of a line, and the lines before the
// points.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/source.hpp"
#include "io/text/text_columns.hpp"
#include "io/text/text_scan.hpp"

namespace cullhull::internal {

/// The fields of a line, for the first lines and for messages.
struct Field {
  std::string_view text;
  Scan scan = Scan::not_a_number;
};

struct Fields {
  std::vector<Field> list;
  bool separators = false;  ///< at least one comma or semicolon
  bool mixed = false;       ///< both kinds, or one of them beside blanks that separate

  bool all_numbers() const;
  bool any_number() const;
};

/// `decimal`: with ',' a comma is part of a number.
Fields split_fields(const char* begin, const char* end, char decimal = '.');

/// The end of a message about text behind a number, which begins with `next`: how decimal commas
/// are read where it is a comma; nothing for other characters.
const char* about_decimal_mark(char next, char decimal);

/// Whether the line is neither empty nor a comment.
bool is_point_line(const char* begin, const char* end);

/// The lines before the points: none, a line of words, the number of points, Qhull's header, cdd's,
/// or Triangle's and TetGen's.
struct Preamble {
  enum Kind { none, count_line, qhull, cdd, node };
  Kind kind = none;
  const char* body = nullptr;  ///< the first line of points ...
  const char* end = nullptr;   ///< ... and where they end
  std::uint64_t lines = 0;     ///< before the body
  std::uint32_t dimension = 0;
  std::uint64_t count = 0;        ///< the number of points that a header promises
  std::uint64_t promised_at = 0;  ///< and its line
  char decimal = '.';             ///< or ','
  /// What separates numbers: ',' ';' or ' ' for blanks; 0: any of them, the same within a line.
  char separator = 0;
  /// Which columns are coordinates; null: all of them, and there are no others.
  std::shared_ptr<const ColumnLayout> layout;
  std::vector<std::string> columns;  ///< as PointFile::columns(); empty after a header of numbers
};

/// How many bytes of points find_preamble() looks at, to find decimal commas and the like. A stream
/// provides this much behind the first point, so that it finds the same.
inline constexpr std::size_t preview_bytes = std::size_t{1} << 16;

/// Why a line is not a row of such numbers.
std::string explain_row(const char* begin, const char* end, const Preamble& preamble);

/// `format`: as for read_text(). `options` name the columns wanted; options.remark is called if
/// some are left out. Throws Error{bad_file}, Error{invalid_argument} for columns that do not
/// exist.
Preamble find_preamble(const Source& source, const ReadOptions& options, const std::string& format);

/// The line, from 1, of a point. Throws as find_preamble does.
std::optional<std::uint64_t> line_of_row(const Source& file, std::uint64_t row,
                                         const std::string& format);

/// The points of whole lines of a text, which follow `lines_before` others. Points after cdd's
/// header may end before the file does, so such files are not read in pieces.
PointData read_text_piece(const Source& piece, std::uint64_t lines_before, const Preamble& preamble,
                          const ReadOptions& options);

}  // namespace cullhull::internal
