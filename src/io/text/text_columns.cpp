#include "io/text/text_columns.hpp"

#include <algorithm>

#include "io/text/lines.hpp"
#include "io/text/text.hpp"
#include "io/text/text_scan.hpp"

namespace cullhull::internal {

void ColumnScanner::take_quoted(std::string_view& column) {
  const char* const begin = ++at_;
  for (;; ++at_) {
    if (at_ >= end_) throw LineFault{"a column in quotes does not end on its line"};
    if (*at_ != '"') continue;
    if (at_ + 1 >= end_ || at_[1] != '"') break;
    ++at_;
  }
  column = {begin, static_cast<std::size_t>(at_ - begin)};
  ++at_;
}

bool ColumnScanner::next(std::string_view& column) {
  if (!more_) return false;
  // Where a tab is the separator, it is not a blank.
  const auto blank = [this](char c) {
    return is_blank(c) && (separator_ == ' ' || c != separator_);
  };
  while (at_ < end_ && blank(*at_)) ++at_;
  if (separator_ == ' ' && at_ == end_) return false;
  if (at_ < end_ && *at_ == '"') {
    take_quoted(column);
    while (at_ < end_ && blank(*at_)) ++at_;
    if (separator_ != ' ' && at_ < end_ && *at_ != separator_)
      throw LineFault{"characters behind a column in quotes"};
  } else {
    const char* const begin = at_;
    const auto ends = [this](char c) { return separator_ == ' ' ? is_blank(c) : c == separator_; };
    while (at_ < end_ && !ends(*at_)) ++at_;
    const char* last = at_;
    while (last > begin && is_blank(last[-1])) --last;
    column = {begin, static_cast<std::size_t>(last - begin)};
  }
  if (separator_ != ' ') {
    more_ = at_ < end_;
    at_ += more_ ? 1 : 0;
  }
  return true;
}

char find_separator(const char* p, const char* end, char decimal) {
  bool quoted = false, comma = false, tab = false;
  while (end > p && is_blank(end[-1])) --end;
  p = skip_blanks(p, end);
  for (; p < end; ++p) {
    if (*p == '"') quoted = !quoted;
    if (quoted) continue;
    if (*p == ';') return ';';
    comma = comma || (*p == ',' && decimal != ',');
    // Tabs in a row, or next to blanks, are used to align columns and are no separators.
    tab = tab || (*p == '\t' && !is_blank(p[-1]) && !is_blank(p[1]));
  }
  return comma ? ',' : tab ? '\t' : ' ';
}

std::string without_doubled_quotes(std::string_view text) {
  std::string column(text);
  for (std::size_t at = 0; (at = column.find("\"\"", at)) != std::string::npos; ++at)
    column.erase(at, 1);
  return column;
}

std::vector<std::string> split_columns(const char* begin, const char* end, char separator) {
  std::vector<std::string> columns;
  ColumnScanner scanner(begin, end, separator);
  for (std::string_view text; scanner.next(text);) columns.push_back(without_doubled_quotes(text));
  return columns;
}

ColumnLayout::ColumnLayout(char separator_, std::uint32_t width,
                           const std::vector<std::uint32_t>& columns,
                           std::vector<std::string> names_)
    : separator(separator_),
      coordinate(width, none),
      names(std::move(names_)),
      dimension(static_cast<std::uint32_t>(columns.size())) {
  for (std::uint32_t j = 0; j < dimension; ++j) coordinate[columns[j]] = j;
}

std::string ColumnLayout::name_of(std::size_t column) const {
  return column < names.size() ? "column " + quoted_text(names[column])
                               : "column " + std::to_string(column + 1);
}

void ColumnLayout::parse(const char* begin, const char* end, double* out,
                         std::string_view* key_text) const {
  if (comments) end = std::find(begin, end, '#');
  ColumnScanner scanner(begin, end, separator);
  std::size_t width = 0;
  for (std::string_view text; scanner.next(text); ++width) {
    if (width == key && key_text != nullptr) *key_text = text;
    if (width >= coordinate.size() || coordinate[width] == none) continue;
    text.remove_prefix(static_cast<std::size_t>(
        skip_blanks(text.data(), text.data() + text.size()) - text.data()));
    if (text.empty()) throw LineFault{name_of(width) + " is empty"};
    const char* p = text.data();
    const Scan scan = scan_number(p, p + text.size(), out[coordinate[width]], decimal);
    if (scan == Scan::out_of_range)
      throw LineFault{name_of(width) + ": " + quoted_text(text) + " exceeds the range of doubles"};
    if (scan != Scan::ok || skip_blanks(p, text.data() + text.size()) != text.data() + text.size())
      throw LineFault{name_of(width) + ": " + quoted_text(text) + " is not a number" +
                      (scan == Scan::ok ? about_decimal_mark(*p, decimal) : "")};
  }
  if (width != coordinate.size())
    throw LineFault{std::to_string(width) + (width == 1 ? " column" : " columns") +
                    " where there are " + std::to_string(coordinate.size())};
}

}  // namespace cullhull::internal
