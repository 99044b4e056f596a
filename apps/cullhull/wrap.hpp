// Help texts that fit the terminal.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace app {

/// `text`, whose lines have 100 columns at most, with lines of at most `width` columns, broken at
/// blanks. Of "  TERM    text" the text stays in its column, with the lines below that continue it;
/// paragraphs stay paragraphs. Words longer than a line are not broken.
std::string wrapped(std::string_view text, std::size_t width);

/// The same for standard output, if that is a terminal: its width is $COLUMNS, if set, else that of
/// the window, else 80 columns.
std::string for_terminal(const std::string& text);

}  // namespace app
