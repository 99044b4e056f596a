// Rows of which only some columns are read: the others may hold any text, quotes included.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace cullhull::internal {

/// Splits a line into columns. With a separator each column is the text between two of them,
/// without blanks around it; without one (' ') columns are separated by blanks. A column in double
/// quotes may hold separators, and doubled quotes; it ends on its line.
class ColumnScanner {
 public:
  ColumnScanner(const char* begin, const char* end, char separator)
      : at_(begin), end_(end), separator_(separator) {}
  /// The next column as written, without its quotes; false after the last. Throws LineFault.
  bool next(std::string_view& column);

 private:
  void take_quoted(std::string_view& column);
  const char* at_;
  const char* end_;
  char separator_;
  bool more_ = true;
};

/// The separator of the columns of a line: ';' ',' or a tab, the first in this order that occurs
/// outside of quotes; else a blank. `decimal`: ',' where commas are decimal marks.
char find_separator(const char* begin, const char* end, char decimal = '.');

/// Replaces doubled quotes by single ones.
std::string without_doubled_quotes(std::string_view column);

/// All columns of a line, doubled quotes replaced. Throws LineFault.
std::vector<std::string> split_columns(const char* begin, const char* end, char separator);

/// Which columns of a row are the coordinates.
struct ColumnLayout {
  static constexpr std::uint32_t none = 0xFFFFFFFF;
  char separator = ' ';
  std::vector<std::uint32_t> coordinate;  ///< by column: the number of its coordinate, or `none`
  std::vector<std::string> names;         ///< of columns, for messages; may be empty
  std::uint32_t dimension = 0;
  std::uint32_t key = none;  ///< the column of ReadOptions::key
  char decimal = '.';        ///< or ','
  bool comments = false;     ///< whether # ends a row

  ColumnLayout(char separator_, std::uint32_t width, const std::vector<std::uint32_t>& columns,
               std::vector<std::string> names_);
  /// Writes `dimension` numbers, and the key's column as written. Throws LineFault.
  void parse(const char* begin, const char* end, double* out,
             std::string_view* key_text = nullptr) const;

 private:
  std::string name_of(std::size_t column) const;
};

}  // namespace cullhull::internal
