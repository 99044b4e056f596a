// What precedes the points in a text: column names, Qhull's header, or that of cdd and lrs.
#include "io/text.hpp"

namespace cullhull::internal {
namespace {

struct DataLine {
  Fields fields;
  const char* begin = nullptr;
  const char* end = nullptr;
  std::uint64_t number = 0;

  std::string_view word() const { return first_word(begin, end); }
};

bool next_data_line(LineScanner& scanner, DataLine& line) {
  while (scanner.next()) {
    if (!is_point_line(scanner.begin(), scanner.end())) continue;
    line = {split_fields(scanner.begin(), scanner.end()), scanner.begin(), scanner.end(),
            scanner.number()};
    return true;
  }
  return false;
}

/// The whole numbers that begin a line, two at most, and whether a comment ends it: words of which
/// the first is no number ("3 rbox 10 D3 P0.5,0.5"). What the words hold is of no concern.
struct LeadingIntegers {
  std::uint64_t values[2] = {0, 0};
  unsigned count = 0;
  bool words = false;
  bool numbers = false;  ///< a number follows, so that this is no header
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

/// Qhull's format: the dimension and the number of points, on one line or two, each perhaps
/// followed by words; then the points. Without words, "3" could be a point of R^1, and "2 1" one of
/// the plane: then the line that follows must have as many numbers as the dimension says.
bool find_qhull_header(const Source& source, const DataLine& first, LineScanner scanner,
                       Preamble& preamble) {
  const LeadingIntegers head = leading_integers(first);
  if (head.count == 0 || head.numbers) return false;
  const std::uint64_t dimension = head.values[0];
  std::uint64_t count = head.values[1];
  DataLine count_line = first, point;
  if (head.count == 1) {
    LeadingIntegers second;
    if (next_data_line(scanner, count_line)) second = leading_integers(count_line);
    if (second.count != 1 || second.numbers || (second.words && !head.words)) return false;
    count = second.values[0];
  }
  preamble.kind = Preamble::qhull;
  preamble.body = scanner.rest();
  preamble.lines = preamble.count_line = count_line.number;
  preamble.dimension = static_cast<std::uint32_t>(dimension);
  preamble.count = count;
  const bool fits = next_data_line(scanner, point) && point.fields.list.size() == dimension;
  if (head.count == 2 ? dimension < 3 || !fits : !head.words && (dimension < 2 || !fits))
    return false;
  if (dimension == 0 || dimension > UINT32_MAX)
    fail_at_line(source, first.number, "dimension " + std::to_string(dimension));
  return true;
}

bool is_word_line(const char* begin, const char* end, std::string_view wanted) {
  const std::string_view word = first_word(begin, end);
  return word == wanted && skip_blanks(word.data() + word.size(), end) == end;
}

/// The line of cdd's header: number of points, dimension + 1, type.
void read_cdd_counts(const Source& source, LineScanner& scanner, Preamble& preamble) {
  DataLine line;
  const bool any = next_data_line(scanner, line);
  const auto& list = line.fields.list;
  std::uint64_t width = 0;
  if (!any || list.size() != 3 || !parse_unsigned(list[0].text, preamble.count) ||
      !parse_unsigned(list[1].text, width))
    fail_at_line(source, any ? line.number : scanner.number(),
                 "'begin' is followed by the number of points, the dimension + 1 and the type");
  if (width < 2 || width > UINT32_MAX)
    fail_at_line(source, line.number, "dimension " + std::to_string(width > 0 ? width - 1 : 0));
  preamble.dimension = static_cast<std::uint32_t>(width - 1);
  preamble.lines = preamble.count_line = line.number;
  preamble.body = scanner.rest();
}

/// cdd's and lrs's V-representation: words, "begin", the counts, rows that begin with 1, "end".
bool find_cdd_header(const Source& source, const DataLine& first, LineScanner scanner,
                     Preamble& preamble) {
  DataLine line = first;
  while (!is_word_line(line.begin, line.end, "begin")) {
    double unused;
    const char* p = skip_blanks(line.begin, line.end);
    if (scan_number(p, line.end, unused) != Scan::not_a_number) return false;
    if (line.word() == "H-representation")
      fail_at_line(source, line.number, "holds halfspaces, not points");
    if (!next_data_line(scanner, line)) return false;
  }
  preamble.kind = Preamble::cdd;
  read_cdd_counts(source, scanner, preamble);
  while (scanner.next()) {
    if (!is_word_line(scanner.begin(), scanner.end(), "end")) continue;
    preamble.end = scanner.begin();
    return true;
  }
  fail(source, "no line 'end' after the points");
}

}  // namespace

Preamble find_preamble(const Source& source, bool csv) {
  const char* const end = source.data + source.size;
  LineScanner scanner(source.data, end);
  DataLine first;
  if (!next_data_line(scanner, first)) fail(source, "no points");
  Preamble preamble;
  preamble.end = end;
  if (find_qhull_header(source, first, scanner, preamble) ||
      find_cdd_header(source, first, scanner, preamble))
    return preamble;
  preamble = {};
  preamble.end = end;
  if ((csv || first.fields.separators) && first.fields.no_number()) {
    preamble.body = scanner.rest();
    preamble.lines = first.number;
    if (!next_data_line(scanner, first)) fail(source, "no points after the line of column names");
  } else {
    preamble.body = first.begin;
    preamble.lines = first.number - 1;
  }
  preamble.dimension = static_cast<std::uint32_t>(first.fields.list.size());
  if (!first.fields.all_numbers() || first.fields.mixed)
    fail_at_line(source, first.number, explain_row(first.begin, first.end, preamble.dimension));
  return preamble;
}

}  // namespace cullhull::internal
