// The lines of a text that are neither empty nor comments, for the search of its header.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "io/text/text.hpp"

namespace cullhull::internal {

struct DataLine {
  Fields fields;
  const char* begin = nullptr;
  const char* end = nullptr;
  std::uint64_t number = 0;

  std::string_view word() const { return first_word(begin, end); }
};

/// The lines that are neither empty nor comments.
class DataLines {
 public:
  DataLines(const Source& source, char decimal)
      : lines_(source.data, source.data + source.size), decimal_(decimal) {}
  bool next(DataLine& line) {
    while (lines_.next()) {
      if (!is_point_line(lines_.begin(), lines_.end())) continue;
      line = {split_fields(lines_.begin(), lines_.end(), decimal_), lines_.begin(), lines_.end(),
              lines_.number()};
      return true;
    }
    return false;
  }
  const char* rest() const { return lines_.rest(); }
  std::uint64_t number() const { return lines_.number(); }
  /// Any line.
  LineScanner& all() { return lines_; }

 private:
  LineScanner lines_;
  char decimal_;
};

/// CloudCompare's header, before the first line `first` that is no comment: the names of columns go
/// to `preamble`. False if there is none. Throws as find_preamble does.
bool find_cloud_compare_header(const Source& source, const ReadOptions& options,
                               const DataLine& first, Preamble& preamble);

/// Fills a preamble whose kind is none, perhaps with names in `columns`, or node with its: the
/// names of columns, what separates them, and which of them are coordinates. `first`: the first
/// line of the rows or their names, without text if there is none; `lines` is behind it. Throws as
/// find_preamble does.
void find_rows(const Source& source, const ReadOptions& options, const std::string& format,
               const DataLine& first, const DataLines& lines, Preamble& preamble);

}  // namespace cullhull::internal
