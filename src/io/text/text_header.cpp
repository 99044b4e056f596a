// The lines before the points of a text: column names, their number, Qhull's header, that of cdd
// and lrs, or that of Triangle and TetGen.
#include <algorithm>
#include <iterator>

#include "io/file_formats.hpp"
#include "io/text/data_lines.hpp"
#include "io/text/text.hpp"

namespace cullhull::internal {
namespace {

/// The integers at the beginning of a line, two at most, and whether a comment ends it: words of
/// which the first is not a number ("3 rbox 10 D3 P0.5,0.5"). The words themselves are ignored.
struct LeadingIntegers {
  std::uint64_t values[2] = {0, 0};
  unsigned count = 0;
  bool words = false;
  bool numbers = false;  ///< a number follows, so this is no header
};

LeadingIntegers leading_integers(const DataLine& line) {
  LeadingIntegers found;
  const char* p = line.begin;
  for (;;) {
    p = skip_blanks(p, line.end);
    if (p == line.end || is_comment(p, line.end)) return found;
    const std::string_view word = first_word(p, line.end);
    if (found.count < 2 && parse_unsigned(word, found.values[found.count])) {
      ++found.count;
      p += word.size();
      continue;
    }
    double unused;
    found.numbers = scan_number(p, line.end, unused) != Scan::not_a_number;
    found.words = !found.numbers && *p != ',' && *p != ';';
    found.numbers = !found.words;
    return found;
  }
}

/// The largest dimension that a header may give: of no points, of which no row shows that it is so,
/// one whose columns can be listed.
std::uint64_t most_dimensions(std::uint64_t points) { return points > 0 ? UINT32_MAX : 65536; }

/// Qhull's format: the dimension and the number of points, on one line or two, each perhaps
/// followed by words; then the points. Without words, "3" could be a point of R^1, and "2 1" one of
/// the plane: then the next line must have as many numbers as the dimension says.
bool find_qhull_header(const Source& source, const DataLine& first, DataLines lines,
                       Preamble& preamble) {
  const LeadingIntegers head = leading_integers(first);
  if (head.count == 0 || head.numbers) return false;
  const std::uint64_t dimension = head.values[0];
  std::uint64_t count = head.values[1];
  DataLine count_line = first, point;
  if (head.count == 1) {
    LeadingIntegers second;
    if (lines.next(count_line)) second = leading_integers(count_line);
    if (second.count != 1 || second.numbers || (second.words && !head.words)) return false;
    count = second.values[0];
  }
  preamble.kind = Preamble::qhull;
  preamble.body = lines.rest();
  preamble.lines = preamble.promised_at = count_line.number;
  preamble.dimension = static_cast<std::uint32_t>(dimension);
  preamble.count = count;
  const bool fits = lines.next(point) && point.fields.list.size() == dimension;
  if (head.count == 2 ? dimension < 3 || !fits : !head.words && (dimension < 2 || !fits))
    return false;
  if (dimension == 0 || dimension > most_dimensions(count))
    fail_at_line(source, first.number, "dimension ", dimension);
  return true;
}

bool is_word_line(const char* begin, const char* end, std::string_view wanted) {
  const std::string_view word = first_word(begin, end);
  return word == wanted && skip_blanks(word.data() + word.size(), end) == end;
}

/// The line of cdd's header: number of points, dimension + 1, type.
void read_cdd_counts(const Source& source, DataLines& lines, Preamble& preamble) {
  DataLine line;
  const bool any = lines.next(line);
  const auto& list = line.fields.list;
  std::uint64_t width = 0;
  if (!any || list.size() != 3 || !parse_unsigned(list[0].text, preamble.count) ||
      !parse_unsigned(list[1].text, width))
    fail_at_line(source, any ? line.number : lines.number(),
                 "'begin' is followed by the number of points, the dimension + 1 and the type");
  if (width < 2 || width - 1 > most_dimensions(preamble.count))
    fail_at_line(source, line.number, "dimension ", width > 0 ? width - 1 : 0);
  preamble.dimension = static_cast<std::uint32_t>(width - 1);
  preamble.lines = preamble.promised_at = line.number;
  preamble.body = lines.rest();
}

/// cdd's and lrs's V-representation: words, "begin", the counts, rows that begin with 1, "end".
bool find_cdd_header(const Source& source, const DataLine& first, DataLines lines,
                     Preamble& preamble) {
  DataLine line = first;
  while (!is_word_line(line.begin, line.end, "begin")) {
    double unused;
    const char* p = skip_blanks(line.begin, line.end);
    if (scan_number(p, line.end, unused) != Scan::not_a_number) return false;
    if (line.word() == "H-representation")
      fail_at_line(source, line.number, "holds halfspaces, not points");
    // The title may have commas; but after a line of column names the rows have them, too.
    if (!lines.next(line) || line.fields.separators) return false;
  }
  preamble.kind = Preamble::cdd;
  read_cdd_counts(source, lines, preamble);
  while (lines.all().next()) {
    if (!is_word_line(lines.all().begin(), lines.all().end(), "end")) continue;
    preamble.end = lines.all().begin();
    return true;
  }
  fail(source, "no line 'end' after the points");
}

/// Triangle's and TetGen's .node: points, dimension, attributes and whether there are markers; then
/// rows of a number, coordinates, attributes and perhaps a marker. In a file of another name a
/// first line of four whole numbers could be a point: there all rows have to fit.
bool find_node_header(const Source& source, const DataLine& first, DataLines lines, bool named,
                      Preamble& preamble) {
  std::uint64_t head[4] = {0, 0, 0, 0};  // attributes and markers may be missing
  const auto& list = first.fields.list;
  bool numbers = list.size() >= (named ? 2 : 4) && list.size() <= 4 && !first.fields.separators;
  for (std::size_t i = 0; numbers && i < list.size(); ++i)
    numbers = parse_unsigned(list[i].text, head[i]);
  const auto [count, dimension, attributes, markers] = head;
  constexpr std::uint64_t most = 1U << 20;
  if (!numbers || (dimension != 2 && dimension != 3) || attributes > most || markers > 1) {
    if (named)
      fail_at_line(source, first.number,
                   "a .node begins with the numbers of points, dimensions (2 or 3), attributes and "
                   "markers");
    return false;
  }
  preamble.body = lines.rest();
  const std::uint64_t width = 1 + dimension + attributes + markers;
  if (!named) {
    const bool all_here =
        source.size - static_cast<std::size_t>(first.begin - source.data) <= preview_bytes;
    std::uint64_t rows = 0, start = 0;
    for (DataLine row; all_here && lines.next(row); ++rows) {
      std::uint64_t number = 0;
      if (row.fields.list.size() != width || !parse_unsigned(row.fields.list[0].text, number) ||
          (rows == 0 ? number > 1 : number != start + rows))
        return false;
      if (rows == 0) start = number;
    }
    if (!all_here || rows != count || count == 0) return false;
  }
  std::vector<std::string> names{"index", "x", "y"};
  if (dimension == 3) names.emplace_back("z");
  for (std::uint64_t i = 0; i < attributes; ++i)
    names.push_back("attribute" + std::to_string(i + 1));
  if (markers == 1) names.emplace_back("marker");
  preamble.kind = Preamble::node;
  preamble.count = count;
  preamble.lines = preamble.promised_at = first.number;
  preamble.columns = std::move(names);
  return true;
}

}  // namespace

Preamble find_preamble(const Source& source, const ReadOptions& options,
                       const std::string& format) {
  DataLines lines(source, options.decimal);
  DataLine first;
  if (!lines.next(first)) fail(source, "no points");
  const char* const text_end = std::find_if_not(std::make_reverse_iterator(first.end),
                                                std::make_reverse_iterator(first.begin), is_blank)
                                   .base();
  if (std::find(first.begin, text_end, '\r') != text_end)
    fail_at_line(source, first.number,
                 "a carriage return within a line; lines have to end with a line feed");
  Preamble preamble;
  preamble.end = source.data + source.size;
  preamble.decimal = options.decimal == ',' ? ',' : '.';
  if (find_node_header(source, first, lines, format == "node", preamble)) {
    DataLine row;
    if (!lines.next(row)) row = {};
    const Preamble head = preamble;
    find_rows(source, options, format, row, lines, preamble);
    preamble.body = head.body;
    preamble.lines = head.lines;
    return preamble;
  }
  const FileFormat* const row = format_named(format);
  if (row != nullptr && row->header != nullptr && row->header(source, options, first, preamble)) {
    find_rows(source, options, format, first, lines, preamble);
    return preamble;
  }
  if (find_qhull_header(source, first, lines, preamble) ||
      find_cdd_header(source, first, lines, preamble))
    return preamble;
  preamble.kind = Preamble::none;
  preamble.dimension = 0;
  preamble.count = 0;
  find_rows(source, options, format, first, lines, preamble);
  return preamble;
}

}  // namespace cullhull::internal
