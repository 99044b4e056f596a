// The lines before the points of a text: column names, Qhull's header, or that of cdd and lrs.
#include <algorithm>
#include <iterator>
#include <numeric>

#include "io/columns.hpp"
#include "io/text/lines.hpp"
#include "io/text/text.hpp"

namespace cullhull::internal::inline io {
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

/// The integers at the beginning of a line, two at most, and whether a comment ends it: words of
/// which the first is no number ("3 rbox 10 D3 P0.5,0.5"). The words themselves are ignored.
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

/// Qhull's format: the dimension and the number of points, on one line or two, each perhaps
/// followed by words; then the points. Without words, "3" could be a point of R^1, and "2 1" one of
/// the plane: then the next line must have as many numbers as the dimension says.
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
    fail_at_line(source, first.number, "dimension ", dimension);
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
    fail_at_line(source, line.number, "dimension ", width > 0 ? width - 1 : 0);
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
    // The title may have commas; but after a line of column names the rows have them, too.
    if (!next_data_line(scanner, line) || line.fields.separators) return false;
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

std::vector<std::string> columns_of_line(const Source& source, const DataLine& line,
                                         char separator) {
  try {
    return split_columns(line.begin, line.end, separator);
  } catch (const LineFault& fault) {
    fail_at_line(source, line.number, fault.message);
  }
}

bool has_all(const std::vector<std::string>& names, const std::vector<std::string>& wanted) {
  for (const std::string& name : wanted)
    if (std::none_of(names.begin(), names.end(), [&](const auto& n) { return alike(n, name); }))
      return false;
  return !wanted.empty();
}

/// Whether the line is a header: words, none of them a number; or all the names asked for, whatever
/// else there is. Without separators, in a text that is no CSV, the words have to name coordinates.
bool is_header(const DataLine& line, const std::vector<std::string>& names, bool csv,
               const std::vector<std::string>& wanted) {
  if (has_all(names, wanted)) return true;
  if (!csv && wanted.empty() && !line.fields.separators &&
      find_known_columns(names).columns.empty())
    return false;
  bool any = false;
  for (const std::string& name : names) {
    double unused;
    const char* p = name.data();
    const char* const end = p + name.size();
    const Scan scan = scan_number(p, end, unused);
    if (scan == Scan::ok) p = skip_blanks(p, end);
    if (scan == Scan::out_of_range || (scan == Scan::ok && (p == end || *p == ',' || *p == ';')))
      return false;  // perhaps decimal commas, which no column name has
    any = any || !name.empty();
  }
  return any;
}

/// Some programs write the names of columns in a comment: finds the last one before the points that
/// has all the names asked for, otherwise empty.
std::vector<std::string> names_in_comment(const Source& source, const char* end,
                                          const std::vector<std::string>& wanted) {
  std::vector<std::string> found;
  LineScanner lines(source.data, end);
  while (lines.next()) {
    const char* p = skip_blanks(lines.begin(), lines.end());
    if (!is_comment(p, lines.end())) continue;
    p += *p == '#' ? 1 : 2;
    try {
      std::vector<std::string> names =
          split_columns(p, lines.end(), find_separator(p, lines.end()));
      if (has_all(names, wanted)) found = std::move(names);
    } catch (const LineFault&) {  // words with a quote in them: no names
    }
  }
  return found;
}

/// The columns that a header of other than coordinates gives by itself: those with known names,
/// else all but those that number the points. Empty where all columns are coordinates, in order.
std::vector<std::uint32_t> columns_by_name(const Source& source, const ReadOptions& options,
                                           const std::vector<std::string>& names) {
  KnownColumns known = find_known_columns(names);
  std::vector<std::uint32_t> all(names.size());
  std::iota(all.begin(), all.end(), 0U);
  if (known.columns == all) return {};
  if (!known.columns.empty()) {
    // The column of a key that was asked for is not missed.
    const std::size_t taken = known.columns.size() + (options.key.empty() ? 0 : 1);
    if (known.columns.size() == names.size())
      remark(source, options, known.text + " are taken as coordinates, in this order",
             Remark::Kind::columns);
    else if (taken < names.size())
      remark(
          source, options,
          known.text + " of " + std::to_string(names.size()) + " columns are taken as coordinates",
          Remark::Kind::columns);
    return known.columns;
  }
  std::vector<std::uint32_t> numbering = find_numbering(names);
  if (!options.key.empty())
    std::erase_if(numbering, [&](std::uint32_t j) { return alike(names[j], options.key); });
  if (numbering.empty()) return {};
  std::vector<std::uint32_t> taken;
  std::set_difference(all.begin(), all.end(), numbering.begin(), numbering.end(),
                      std::back_inserter(taken));
  const auto list = [&](const std::vector<std::uint32_t>& columns) {
    std::string text;
    constexpr std::size_t most = 6;
    for (std::size_t i = 0; i < columns.size() && i < most; ++i)
      text += (i > 0 ? ", " : "") + quoted_text(names[columns[i]]);
    return text + (columns.size() > most ? ", ..." : "");
  };
  if (taken.empty())
    fail(source, "the only columns, ", list(numbering),
         ", number the points; --columns (in "
         "Python columns=) takes them all the same");
  remark(source, options, list(taken) + " are taken as coordinates, not " + list(numbering),
         Remark::Kind::columns);
  return taken;
}

/// Sets preamble.layout to the columns that are coordinates and, with options.key, the key's: those
/// that options.columns names or numbers; else those whose names in the header are known (x, y, z
/// and the like); else all columns, which need no layout unless there is a key or text in quotes.
/// `first` and `separator`: the first line of points, and what divides it into columns. Throws what
/// find_preamble() throws.
void lay_out_columns(const Source& source, const ReadOptions& options, const DataLine& first,
                     std::vector<std::string> names, char separator, Preamble& preamble) {
  const bool quotes = std::find(first.begin, first.end, '"') != first.end;
  std::vector<std::uint32_t> columns;
  if (options.columns.empty()) {
    columns = columns_by_name(source, options, names);
    if (columns.empty() && !quotes && options.key.empty()) return;
  }
  // Without a header the first row determines the number of columns.
  const std::size_t width =
      names.empty() ? columns_of_line(source, first, separator).size() : names.size();
  const auto count = static_cast<std::uint32_t>(width);
  if (columns.empty())
    columns =
        find_columns(options.columns.empty() ? ":" : options.columns, source.name, names, count);
  const std::uint32_t key = find_key(options, source.name, names, count, columns);
  auto layout = std::make_shared<ColumnLayout>(separator, count, columns, std::move(names));
  layout->key = key;
  preamble.layout = std::move(layout);
  preamble.dimension = preamble.layout->dimension;
}

/// Points without a header of Qhull or cdd: perhaps a line of names, then rows.
Preamble find_rows(const Source& source, DataLine first, LineScanner scanner,
                   const ReadOptions& options, bool csv) {
  Preamble preamble;
  preamble.end = source.data + source.size;
  std::vector<std::string> wanted = names_in(options.columns);
  for (std::string& name : names_in(options.key)) wanted.push_back(std::move(name));
  char separator = find_separator(first.begin, first.end);
  std::vector<std::string> names;
  const bool may_have_names =
      csv || first.fields.separators || !wanted.empty() || !first.fields.all_numbers();
  if (may_have_names) names = columns_of_line(source, first, separator);
  if (may_have_names && is_header(first, names, csv, wanted)) {
    preamble.body = scanner.rest();
    preamble.lines = first.number;
    if (!next_data_line(scanner, first)) fail(source, "no points after the line of column names");
  } else {
    preamble.body = first.begin;
    preamble.lines = first.number - 1;
    names =
        wanted.empty() ? std::vector<std::string>() : names_in_comment(source, first.begin, wanted);
  }
  lay_out_columns(source, options, first, std::move(names), separator, preamble);
  if (preamble.layout != nullptr) return preamble;
  preamble.dimension = static_cast<std::uint32_t>(first.fields.list.size());
  if (!first.fields.all_numbers() || first.fields.mixed)
    fail_at_line(source, first.number, explain_row(first.begin, first.end, preamble.dimension));
  return preamble;
}

}  // namespace

Preamble find_preamble(const Source& source, const ReadOptions& options, bool csv) {
  LineScanner scanner(source.data, source.data + source.size);
  DataLine first;
  if (!next_data_line(scanner, first)) fail(source, "no points");
  Preamble preamble;
  preamble.end = source.data + source.size;
  if (find_qhull_header(source, first, scanner, preamble) ||
      find_cdd_header(source, first, scanner, preamble))
    return preamble;
  return find_rows(source, first, scanner, options, csv);
}

}  // namespace cullhull::internal::inline io
