// What the two halves of the text reader share: the fields of a line, and what precedes the points.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "io/source.hpp"
#include "io/text_columns.hpp"
#include "io/text_scan.hpp"

namespace cullhull::internal {

/// The fields of a line, for the first lines and for messages.
struct Field {
  std::string_view text;
  Scan scan = Scan::not_a_number;
};

struct Fields {
  std::vector<Field> list;
  bool separators = false;  ///< at least one comma or semicolon
  bool mixed = false;       ///< both kinds

  bool all_numbers() const;
  bool no_number() const;
};

Fields split_fields(const char* begin, const char* end);

/// Why a line is no row of `dimension` numbers.
std::string explain_row(const char* begin, const char* end, std::uint32_t dimension);

/// Neither empty nor a comment.
bool is_point_line(const char* begin, const char* end);

/// What precedes the points: nothing, a line of words, Qhull's header or cdd's.
struct Preamble {
  enum Kind { none, qhull, cdd };
  Kind kind = none;
  const char* body = nullptr;  ///< the first line of points ...
  const char* end = nullptr;   ///< ... and where they end
  std::uint64_t lines = 0;     ///< before the body
  std::uint32_t dimension = 0;
  std::uint64_t count = 0;       ///< what a header promises
  std::uint64_t count_line = 0;  ///< and where
  /// Which columns are coordinates; null: all of them, and no other is there.
  std::shared_ptr<const ColumnLayout> layout;
};

/// `csv`: the first line may be words. `options` say which columns are wanted and are told which
/// were taken. Throws Error{bad_file}, Error{invalid_argument} for columns that are not there.
Preamble find_preamble(const Source& source, const ReadOptions& options, bool csv);

/// The points of some whole lines of a text, of which `lines_before` precede them. Those of cdd's
/// header end before their file does, so that they are not read in pieces.
PointData read_text_piece(const Source& piece, std::uint64_t lines_before, const Preamble& preamble,
                          const ReadOptions& options);

}  // namespace cullhull::internal
