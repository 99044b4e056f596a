#include "wrap.hpp"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <vector>

#include "system.hpp"

namespace app {
namespace {

constexpr std::size_t least_width = 20;  // narrower windows get lines of this width

std::vector<std::string_view> lines_of(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    lines.push_back(text.substr(0, end));
    text.remove_prefix(std::min(end + 1, text.size()));
  }
  return lines;
}

/// Characters of UTF-8.
std::size_t columns_of(std::string_view text) {
  return static_cast<std::size_t>(
      std::count_if(text.begin(), text.end(), [](char c) { return (c & 0xC0) != 0x80; }));
}

std::size_t indent_of(std::string_view line) {
  return std::min(line.find_first_not_of(' '), line.size());
}

/// The column of the text behind a term, which two blanks or more precede; else that of the first
/// word.
std::size_t column_of(std::string_view line) {
  const std::size_t indent = indent_of(line);
  const std::size_t gap = line.find("  ", indent);
  if (gap == std::string_view::npos) return indent;
  return std::min(line.find_first_not_of(' ', gap), line.size());
}

void add_line(std::string& out, std::string_view line) {
  out.append(line.substr(0, line.find_last_not_of(' ') + 1));
  out += '\n';
}

/// Words in lines of at most `width` columns. The first begins with `head`, the others with
/// `indent` blanks.
void fill(std::string& out, std::string_view head, std::string_view text, std::size_t indent,
          std::size_t width) {
  std::string line(head);
  bool empty = true;
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(word.size() + 1, text.size()));
    if (word.empty()) continue;
    if (!empty && columns_of(line) + 1 + columns_of(word) > width) {
      add_line(out, line);
      line.assign(indent, ' ');
      empty = true;
    }
    if (!empty) line += ' ';
    line += word;
    empty = false;
  }
  add_line(out, line);
}

std::size_t longest_word(std::string_view text) {
  std::size_t longest = 0;
  while (!text.empty()) {
    const std::string_view word = text.substr(0, text.find(' '));
    text.remove_prefix(std::min(word.size() + 1, text.size()));
    longest = std::max(longest, columns_of(word));
  }
  return longest;
}

/// A term and its text, or a paragraph, joined from the lines it had.
void add_block(std::string& out, std::string_view head, std::string_view text, std::size_t column,
               std::size_t width) {
  const std::size_t indent = indent_of(head);
  if (indent == head.size() || column + std::max<std::size_t>(24, longest_word(text)) <= width)
    return fill(out, head, text, column, width);
  // A text that would be a narrow ribbon, or leave it, begins below its term.
  fill(out, head.substr(0, indent), head.substr(indent), indent + 4, width);
  fill(out, std::string(indent + 4, ' '), text, indent + 4, width);
}

}  // namespace

std::string wrapped(std::string_view text, std::size_t width) {
  width = std::max(width, least_width);
  const std::vector<std::string_view> lines = lines_of(text);
  std::string out;
  for (std::size_t at = 0, end = 0; at < lines.size(); at = end) {
    const std::size_t column = column_of(lines[at]), indent = indent_of(lines[at]);
    // The lines that continue the text, or the term of an option, whose text begins below it.
    end = at + 1;
    std::size_t widest = columns_of(lines[at]);
    while (end < lines.size() && !lines[at].empty() && !lines[end].empty() &&
           indent_of(lines[end]) == column && column_of(lines[end]) == column) {
      widest = std::max(widest, columns_of(lines[end]));
      ++end;
    }
    if (widest <= width) {
      for (std::size_t i = at; i < end; ++i) add_line(out, lines[i]);
      continue;
    }
    std::string joined(lines[at].substr(column));
    for (std::size_t i = at + 1; i < end; ++i) (joined += ' ') += lines[i].substr(column);
    std::string head(lines[at].substr(0, column));
    if (column == indent) head.assign(indent, ' ');
    add_block(out, head, joined, column, width);
  }
  return out;
}

std::string for_terminal(const std::string& text) {
  if (!system::is_terminal(system::standard_output)) return text;
  std::size_t width = 0;
  if (const char* const given = std::getenv("COLUMNS")) {
    const std::string_view number(given);
    (void)std::from_chars(number.data(), number.data() + number.size(), width);
  }
  if (width == 0) width = system::terminal_columns(system::standard_output);
  return wrapped(text, width == 0 ? 80 : width);
}

}  // namespace app
