// Rows of which only some columns are read: the others may hold anything, words and quotes too.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace cullhull::internal {

/// Cuts a line into columns. With a separator each column stands between two of them, blanks around
/// it left out; without one (' ') columns are parted by blanks. A column in double quotes may hold
/// separators, and quotes doubled; it ends on its line.
class ColumnScanner {
 public:
  ColumnScanner(const char* begin, const char* end, char separator)
      : at_(begin), end_(end), separator_(separator) {}
  /// The next column as it is written, without its quotes; false after the last. Throws LineFault.
  bool next(std::string_view& column);

 private:
  void take_quoted(std::string_view& column);
  const char* at_;
  const char* end_;
  char separator_;
  bool more_ = true;
};

/// What parts the columns of a line: ';' ',' or a tab, whichever is there first in this order
/// outside of quotes; else blanks, ' '.
char find_separator(const char* begin, const char* end);

/// A column with its doubled quotes made one.
std::string without_doubled_quotes(std::string_view column);

/// All columns of a line, doubled quotes made one. Throws LineFault.
std::vector<std::string> split_columns(const char* begin, const char* end, char separator);

/// Where the coordinates stand in a row.
struct ColumnLayout {
  static constexpr std::uint32_t none = 0xFFFFFFFF;
  char separator = ' ';
  std::vector<std::uint32_t> coordinate;  ///< of each column: which one it is, or none
  std::vector<std::string> names;         ///< of columns, for messages; may be empty
  std::uint32_t dimension = 0;
  std::uint32_t key = none;  ///< the column of ReadOptions::key

  ColumnLayout(char separator_, std::uint32_t width, const std::vector<std::uint32_t>& columns,
               std::vector<std::string> names_);
  /// Writes `dimension` numbers, and what the key's column holds, as it is written. Throws
  /// LineFault.
  void parse(const char* begin, const char* end, double* out,
             std::string_view* key_text = nullptr) const;

 private:
  std::string name_of(std::size_t column) const;
};

}  // namespace cullhull::internal
