// Rows of a text: the names of their columns, their separator and decimal mark, and which columns
// are coordinates.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <numeric>

#include "io/columns.hpp"
#include "io/file_formats.hpp"
#include "io/text/data_lines.hpp"
#include "io/text/lines.hpp"

namespace cullhull::internal {
namespace {

/// From Latin-1, which German and French Excel write, unless the text is UTF-8.
std::string in_utf8(std::string text) {
  const auto is_ascii = [](char c) { return static_cast<unsigned char>(c) < 0x80; };
  if (std::all_of(text.begin(), text.end(), is_ascii)) return text;
  const auto marks = [](const std::string& s) { return std::count(s.begin(), s.end(), '?'); };
  if (marks(printable_text(text)) == marks(text)) return text;
  std::string converted;
  for (const char c : text) {
    const auto byte = static_cast<unsigned char>(c);
    if (byte >= 0x80) converted += static_cast<char>(0xC0U | byte >> 6);
    converted += byte >= 0x80 ? static_cast<char>(0x80U | (byte & 0x3FU)) : c;
  }
  return converted;
}

std::vector<std::string> columns_of_line(const Source& source, const DataLine& line,
                                         char separator) {
  try {
    std::vector<std::string> columns = split_columns(line.begin, line.end, separator);
    for (std::string& column : columns) column = in_utf8(std::move(column));
    return columns;
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

/// Whether the text begins with a number: "5", "5,2" and "5;2", which perhaps has a decimal comma,
/// but not "5th".
bool begins_with_number(const std::string& text) {
  double unused;
  const char* p = text.data();
  const char* const end = p + text.size();
  const Scan scan = scan_number(p, end, unused);
  if (scan == Scan::ok) p = skip_blanks(p, end);
  return scan == Scan::out_of_range || (scan == Scan::ok && (p == end || *p == ',' || *p == ';'));
}

/// pandas' index without a name, and the numbers 0, 1, ... as names of columns.
bool are_numbered_by_pandas(const std::vector<std::string>& names) {
  for (std::size_t j = 1; j < names.size(); ++j)
    if (names[j] != std::to_string(j - 1)) return false;
  return names.size() > 1 && names[0].empty();
}

/// What a text is read by, as far as the first lines say.
class RowFinder {
 public:
  RowFinder(const Source& source, const ReadOptions& options, std::string format,
            Preamble& preamble)
      : source_(source),
        options_(options),
        format_(std::move(format)),
        preamble_(preamble),
        wanted_(names_in(options.columns)) {
    for (std::string& name : names_in(options.key)) wanted_.push_back(std::move(name));
  }

  /// `lines` is behind `first`.
  void find(DataLine first, DataLines lines) {
    row_ = std::move(first);
    preamble_.body = row_.begin;
    preamble_.lines = row_.number - 1;
    take_excels_separator(lines);
    take_count(lines);
    if (preamble_.kind == Preamble::node) {
      names_ = std::move(preamble_.columns);
      names_at_ = preamble_.lines;
      separator_ = ' ';
      if (row_.begin == nullptr) return take_columns_of_no_rows();
    } else {
      if (preamble_.columns.empty()) {
        find_names(lines);
      } else {
        names_ = std::move(preamble_.columns);
        names_at_ = 1;
      }
      divide();
    }
    take_columns();
  }

 private:
  /// The next line of points begins the body.
  bool move_on(DataLines& lines) {
    preamble_.body = lines.rest();
    preamble_.lines = row_.number;
    return lines.next(row_);
  }

  /// A first line "sep=;".
  void take_excels_separator(DataLines& lines) {
    std::string_view line(row_.begin, static_cast<std::size_t>(row_.end - row_.begin));
    if (line.ends_with('\r')) line.remove_suffix(1);
    if (line.size() > 1 && line.front() == '"' && line.back() == '"')
      line = line.substr(1, line.size() - 2);
    if (line.size() != 5 || !alike(line.substr(0, 4), "sep=")) return;
    separator_ = line[4];
    said_separator_ = true;
    if (std::string_view(";,\t |").find(separator_) == std::string_view::npos)
      fail_at_line(source_, row_.number, "the separator ", quoted_text(line.substr(4)),
                   " is none of ; , | a tab and a blank");
    if (!move_on(lines)) fail(source_, "no points");
  }

  /// A line with the number of points, and nothing else, before rows of more than one column. Rows
  /// of one column look the same: there the number has to be right, where all of them are near.
  void take_count(DataLines& lines) {
    if (preamble_.kind != Preamble::none) return;
    std::uint64_t count = 0;
    if (row_.fields.list.size() != 1 || !parse_unsigned(row_.fields.list[0].text, count)) return;
    DataLines following = lines;
    DataLine next;
    if (!following.next(next)) return;
    if (next.fields.list.size() == 1 && !next.fields.separators) {
      std::uint64_t rows = 1;
      const bool all_here =
          source_.size - static_cast<std::size_t>(row_.begin - source_.data) <= preview_bytes;
      while (all_here && following.next(next) && next.fields.list.size() == 1) ++rows;
      if (!all_here || next.fields.list.size() != 1 || rows != count) return;
      say("the first line is taken as the number of points, which follow");
    }
    preamble_.kind = Preamble::count_line;
    preamble_.count = count;
    preamble_.promised_at = row_.number;
    if (!move_on(lines)) fail(source_, "no points");
  }

  void say(const std::string& text) const { remark(source_, options_, text); }
  void say_of_columns(const std::string& text) const { remark(source_, options_, text, true); }

  char separator_of(const DataLine& line) const {
    return said_separator_ ? separator_ : find_separator(line.begin, line.end, options_.decimal);
  }

  // ------------------------------------------------------------------------------- names

  void find_names(DataLines& lines) {
    const bool may_have_names = format_ == "csv" || row_.fields.separators || !wanted_.empty() ||
                                !row_.fields.all_numbers();
    if (may_have_names) {
      const char separator = separator_of(row_);
      std::vector<std::string> names = columns_of_line(source_, row_, separator);
      if (is_header(names, lines)) {
        names_ = std::move(names);
        names_at_ = row_.number;
        separator_ = separator;
        quoted_names_ = *skip_blanks(row_.begin, row_.end) == '"';
        if (!move_on(lines)) fail(source_, "no points after the line of column names");
        if (row_.fields.list.size() == 1 && names_.size() > 1) take_count(lines);
        skip_units(lines);
        return;
      }
    }
    find_names_in_comments();
  }

  /// Whether the line is a header: words, none of them a number; or all the names asked for, or
  /// known coordinates, whatever else there is. Without separators, in a text that is no CSV, the
  /// words have to name coordinates, or to be as many as a row after them has columns.
  bool is_header(const std::vector<std::string>& names, const DataLines& lines) const {
    if (has_all(names, wanted_) || are_numbered_by_pandas(names)) return true;
    if (!find_known_columns(names).empty()) return true;
    bool any = false;
    for (const std::string& name : names) {
      if (begins_with_number(name)) return false;
      any = any || !name.empty();
    }
    if (!any || format_ == "csv" || row_.fields.separators || !wanted_.empty()) return any;
    DataLines following = lines;
    DataLine next;
    if (!following.next(next)) return false;
    const std::size_t width = columns_of_line(source_, next, separator_of(next)).size();
    return next.fields.any_number() && (width == names.size() || width == names.size() + 1);
  }

  /// Some programs write the names of columns in a comment: finds the last one before the points
  /// that has all the names asked for or, without names, known ones for all columns.
  void find_names_in_comments() {
    const char separator = separator_of(row_);
    const std::size_t width = width_of(row_, separator);
    LineScanner lines(source_.data, row_.begin);
    while (lines.next()) {
      const char* p = skip_blanks(lines.begin(), lines.end());
      if (!is_comment(p, lines.end())) continue;
      p += *p == '#' ? 1 : 2;
      try {
        std::vector<std::string> names =
            split_columns(p, lines.end(), find_separator(p, lines.end(), options_.decimal));
        for (std::string& name : names) name = in_utf8(std::move(name));
        if (wanted_.empty() ? names_columns(names, width, lines.number())
                            : has_all(names, wanted_)) {
          names_ = std::move(names);
          names_at_ = lines.number();
        }
      } catch (const LineFault&) {  // words with a quote in them: no names
      }
    }
  }

  /// Whether a comment names the columns, and does not only talk about x and y. A comment of
  /// nothing but coordinates that are fewer than the columns is refused, unless columns are asked
  /// for.
  bool names_columns(const std::vector<std::string>& names, std::size_t width,
                     std::uint64_t line) const {
    static constexpr std::string_view prose[] = {"a",    "and", "are", "as",  "by",  "for", "from",
                                                 "in",   "is",  "of",  "on",  "or",  "the", "to",
                                                 "with", "und", "et",  "der", "die", "das", "="};
    const std::vector<std::uint32_t> known = find_known_columns(names);
    if (known.empty()) return false;
    for (const std::string& name : names)
      for (const std::string_view word : prose)
        if (alike(name, word)) return false;
    if (names.size() == width) return true;
    if (known.size() == names.size() && options_.columns.empty()) {
      const std::size_t first = std::min(width, names.size());
      fail_at_line(source_, row_.number, width, " columns, but the comment on line ", line,
                   " names ", names.size(), "; --columns 0:", first, " takes the first ", first,
                   " (in Python columns=)");
    }
    return false;
  }

  /// A row "m,m,m" below the names.
  void skip_units(DataLines& lines) {
    const std::vector<std::string> cells = columns_of_line(source_, row_, separator_of_row());
    bool any = false;
    for (const std::string& cell : cells) {
      if (!cell.empty() && !is_unit(cell)) return;
      any = any || !cell.empty();
    }
    if (!any) return;
    say("line " + std::to_string(row_.number) + ", of units, is skipped");
    if (!move_on(lines)) fail(source_, "no points after the line of column names");
  }

  // ------------------------------------------------------------------------------- columns

  /// The columns of a line; a comment behind them does not count.
  std::size_t width_of(const DataLine& line, char separator) const {
    if (separator == ' ' && line.fields.all_numbers() && !line.fields.separators)
      return line.fields.list.size();
    return columns_of_line(source_, line, separator).size();
  }

  /// A tab or semicolon separates where the commas of each column are within a number.
  char separator_of_row() const {
    if (said_separator_) return separator_;
    const char found = find_separator(row_.begin, row_.end, options_.decimal);
    if (found != ',') return found;
    const char tab = find_separator(row_.begin, row_.end, ',');
    if (tab != '\t' || options_.decimal == '.') return found;
    for (const std::string& cell : columns_of_line(source_, row_, '\t'))
      if (cell.find(',') != std::string::npos && !has_decimal_comma(cell)) return found;
    return '\t';
  }

  static bool has_decimal_comma(std::string_view cell) {
    if (cell.find(',') == std::string_view::npos) return false;
    const char* p = skip_blanks(cell.data(), cell.data() + cell.size());
    const char* const end = cell.data() + cell.size();
    double ignored;
    return scan_number(p, end, ignored, ',') == Scan::ok && skip_blanks(p, end) == end &&
           cell.back() != ',';
  }

  /// Finds what separates the columns of rows, and holds the names against their number.
  void divide() {
    const char of_row = separator_of_row();
    if (names_.empty()) {
      separator_ = of_row;
      return;
    }
    const char of_names = separator_ != 0 ? separator_ : of_row;
    const std::size_t width = width_of(row_, of_names), other = width_of(row_, of_row);
    if (width == names_.size()) {
      separator_ = of_names;
    } else if (other == names_.size()) {
      separator_ = of_row;
    } else {
      separator_ = of_row == ' ' || other > width ? of_row : of_names;
      take_other_width(std::max(width, other));
    }
  }

  /// The names are not as many as the columns. R writes no name above the names of rows, which are
  /// in quotes; --columns by number needs no names.
  void take_other_width(std::size_t width) {
    const std::size_t named = names_.size();
    const bool one_more = width == named + 1;
    if (one_more && quoted_names_ && *skip_blanks(row_.begin, row_.end) == '"') {
      names_.insert(names_.begin(), "");
      say("the first column, which has no name, is left out");
      return;
    }
    if (!options_.columns.empty() && wanted_.empty()) {
      names_.clear();
      return;
    }
    const std::string all = "0:" + std::to_string(width), python = " (in Python columns=)";
    std::string way = "; --columns takes columns by number, as --columns " + all + python;
    if (one_more)
      way = "; if the first column has no name, as R writes names of rows, --columns 1:" +
            std::to_string(width) + " leaves it out; --columns " + all + " takes all" + python;
    if (separator_ == ',' && named == 1) way = about_decimal_mark(',', '.');
    if (separator_ == ',' && named > 1 && width == 2 * named)
      way += "; if commas are decimal marks, columns need another separator";
    fail_at_line(source_, row_.number, width, width == 1 ? " column" : " columns", " where line ",
                 names_at_, " names ", named, way);
  }

  /// The columns that are coordinates.
  void take_columns() {
    const bool quotes = std::find(row_.begin, row_.end, '"') != row_.end;
    const bool node = preamble_.kind == Preamble::node;
    const std::size_t width = names_.empty() ? width_of(row_, separator_) : names_.size();
    const auto count = static_cast<std::uint32_t>(width);
    std::vector<std::uint32_t> all(count);
    std::iota(all.begin(), all.end(), 0U);
    std::vector<std::uint32_t> columns;
    if (!options_.columns.empty())
      columns = find_columns(options_.columns, source_.name, names_, count);
    else if (node)
      columns = node_columns();
    else
      columns = names_.empty() ? unnamed_columns(all) : columns_by_name(all);
    const std::uint32_t key = find_key(options_, source_.name, names_, count, columns);
    choose_decimal(columns);
    preamble_.columns = column_labels(columns, names_);
    const bool plain_separator =
        separator_ == ' ' || separator_ == '\t' || separator_ == ',' || separator_ == ';';
    if (columns == all && !quotes && options_.key.empty() && plain_separator && !node)
      return take_plain_rows(count);
    auto layout = std::make_shared<ColumnLayout>(separator_, count, columns, names_);
    layout->key = key;
    layout->decimal = preamble_.decimal;
    layout->comments = node;
    preamble_.dimension = layout->dimension;
    preamble_.layout = std::move(layout);
  }

  /// All columns are coordinates, and nothing else is there.
  void take_plain_rows(std::uint32_t width) {
    row_.fields = split_fields(row_.begin, row_.end, preamble_.decimal);
    preamble_.separator = separator_ == ',' || separator_ == ';' ? separator_ : ' ';
    preamble_.dimension =
        names_.empty() ? static_cast<std::uint32_t>(row_.fields.list.size()) : width;
    if (row_.fields.all_numbers() && !row_.fields.mixed &&
        row_.fields.list.size() == preamble_.dimension) {
      if (names_.empty()) remark_on_unnamed();
      return;
    }
    fail_at_line(source_, row_.number, explain_row(row_.begin, row_.end, preamble_),
                 way_past_words());
  }

  /// Without names, words in the first row need to be left out.
  std::string way_past_words() const {
    if (!names_.empty() || !row_.fields.any_number() || row_.fields.mixed) return "";
    std::string numbers;
    std::size_t words = 0;
    for (std::size_t j = 0; j < row_.fields.list.size(); ++j)
      if (row_.fields.list[j].scan == Scan::ok)
        numbers += (numbers.empty() ? "" : ",") + std::to_string(j);
      else if (!row_.fields.list[j].text.empty() &&
               !begins_with_number(std::string(row_.fields.list[j].text)))
        ++words;
    constexpr std::size_t most = 40;
    if (words == 0 || numbers.size() > most) return "";
    return "; --columns " + numbers + " takes the columns of numbers (in Python columns=)";
  }

  /// A .node without points has no first row.
  void take_columns_of_no_rows() {
    std::vector<std::uint32_t> columns = node_columns();
    const auto count = static_cast<std::uint32_t>(names_.size());
    if (!options_.columns.empty())
      columns = find_columns(options_.columns, source_.name, names_, count);
    preamble_.columns = column_labels(columns, names_);
    preamble_.layout = std::make_shared<ColumnLayout>(' ', count, columns, names_);
    preamble_.dimension = preamble_.layout->dimension;
  }

  std::vector<std::uint32_t> node_columns() const {
    std::vector<std::uint32_t> columns{1, 2};
    if (names_.size() > 3 && names_[3] == "z") columns.push_back(3);
    return columns;
  }

  /// The columns that names give by themselves: the known ones, else a series, beside which columns
  /// may number the points. Names that say nothing are refused.
  std::vector<std::uint32_t> columns_by_name(const std::vector<std::uint32_t>& all) const {
    std::vector<std::uint32_t> others = all;
    if (!options_.key.empty()) {
      const auto width = static_cast<std::uint32_t>(all.size());
      others = without(all, find_columns(options_.key, source_.name, names_, width));
    }
    const std::vector<std::string> beside_key = column_labels(others, names_);
    std::vector<std::uint32_t> known = find_known_columns(names_);
    // x, y, z and w are coordinates unless the fourth column holds words.
    const bool four = beside_key.size() == 4 && known.size() == 3 && beside_key[3].size() == 1 &&
                      are_series(beside_key) && begins_with_number(cell_of_row(others[3]));
    if (four) {
      say_of_columns(listed(others) + " are taken as coordinates");
      return others;
    }
    if (!known.empty()) {
      say_known(known, all);
      return known;
    }
    std::vector<std::uint32_t> numbering = find_numbering(names_), taken;
    std::set_difference(others.begin(), others.end(), numbering.begin(), numbering.end(),
                        std::back_inserter(taken));
    const std::vector<std::string> names = column_labels(taken, names_);
    if (taken.empty() && !others.empty())
      fail(source_, "the only columns, ", listed(others),
           ", number the points; --columns (in Python columns=) takes them all the same");
    if (taken.empty() || !(are_series(names) || all.size() == 1)) refuse_names();
    if (taken != others)
      say_of_columns(listed(taken) + " are taken as coordinates, not " +
                     listed(without(others, taken)));
    return taken;
  }

  static std::vector<std::uint32_t> without(const std::vector<std::uint32_t>& all,
                                            const std::vector<std::uint32_t>& some) {
    std::vector<std::uint32_t> rest;
    for (const std::uint32_t j : all)
      if (std::find(some.begin(), some.end(), j) == some.end()) rest.push_back(j);
    return rest;
  }

  std::string listed(const std::vector<std::uint32_t>& columns) const {
    std::string text;
    constexpr std::size_t most = 12;
    for (std::size_t i = 0; i < columns.size() && i < most; ++i)
      text += (i > 0 ? ", " : "") + quoted_text(names_[columns[i]]);
    return text + (columns.size() > most ? ", ..." : "");
  }

  /// The cell of the first row; empty where it has too few columns.
  std::string cell_of_row(std::uint32_t column) const {
    const std::vector<std::string> cells = columns_of_line(source_, row_, separator_);
    return column < cells.size() ? cells[column] : "";
  }

  /// One line where columns are left out or not in the order of the file.
  void say_known(const std::vector<std::uint32_t>& known,
                 const std::vector<std::uint32_t>& all) const {
    if (known == all) return;
    std::string text;
    for (std::size_t i = 0; i < known.size(); ++i)
      text += (i == 0                 ? ""
               : i + 1 < known.size() ? ", "
                                      : " and ") +
              printable_text(names_[known[i]]);
    if (known.size() == names_.size())
      return say_of_columns(text + " are taken as coordinates, in this order");
    // The column of a requested key does not count as missing.
    if (known.size() + (options_.key.empty() ? 0 : 1) >= names_.size()) return;
    std::vector<std::uint32_t> heights;
    for (const std::uint32_t j : without(all, known))
      if (known.size() == 2 && is_height_name(names_[j])) heights.push_back(j);
    say_of_columns(text + " of " + std::to_string(names_.size()) +
                   " columns are taken as coordinates" +
                   (heights.empty() ? "" : ", not " + listed(heights)));
  }

  /// "POINT (1 2)" and the like, in quotes or not.
  static bool is_geometry(std::string_view cell) {
    cell.remove_prefix(std::min(cell.find_first_not_of("\" "), cell.size()));
    for (const char* kind : {"POINT", "LINESTRING", "POLYGON", "MULTI", "GEOMETRYCOLLECTION"})
      if (cell.starts_with(kind)) return true;
    return false;
  }

  [[noreturn]] void refuse_names() const {
    std::string by_name, by_number;
    std::size_t chosen = 0;
    const std::vector<std::uint32_t> numbering = find_numbering(names_);
    const std::vector<std::string> cells = columns_of_line(source_, row_, separator_);
    for (std::uint32_t j = 0; j < names_.size() && j < cells.size() && chosen < 3; ++j) {
      const bool number = begins_with_number(cells[j]) &&
                          std::find(numbering.begin(), numbering.end(), j) == numbering.end();
      if (!number) continue;
      by_name += (chosen > 0 ? "," : "") + printable_text(names_[j]);
      by_number += (chosen++ > 0 ? "," : "") + std::to_string(j);
    }
    if (by_name.find_first_of(" \"'\t") != std::string::npos) by_name = "\"" + by_name + "\"";
    for (std::uint32_t j = 0; j < names_.size() && j < cells.size(); ++j)
      if (is_geometry(cells[j]))
        fail_at_line(source_, names_at_, "column ", quoted_text(names_[j]),
                     " holds geometries in WKT; export their x and y as columns (GDAL: -lco "
                     "GEOMETRY=AS_XY), or write the geometries alone into a .wkt");
    std::vector<std::uint32_t> all(names_.size());
    std::iota(all.begin(), all.end(), 0U);
    fail_at_line(source_, names_at_,
                 "the names of the columns are not known as coordinates: ", listed(all),
                 "; --columns takes some by name or by number from 0",
                 chosen == 0 ? "" : ", as --columns " + by_name + " or --columns " + by_number,
                 " (in Python columns=)");
  }

  std::vector<std::uint32_t> unnamed_columns(const std::vector<std::uint32_t>& all) const {
    const std::size_t width = all.size();
    const FileFormat* const format = format_named(format_);
    if (format == nullptr || format->space_first == nullptr || !format->space_first(width))
      return all;
    say_of_columns("the first three of " + std::to_string(width) +
                   " columns are taken as coordinates, as ." + format_ + " has them");
    return {0, 1, 2};
  }

  // ------------------------------------------------------------------------------- previews

  /// Calls see(cells) for the rows in the preview until it returns false; false then.
  template <class See>
  bool preview(const See& see) const {
    const char* const limit = row_.begin + preview_size();
    LineScanner lines(row_.begin, source_.data + source_.size);
    std::vector<std::string_view> cells;
    while (lines.next() && lines.begin() < limit) {
      if (!is_point_line(lines.begin(), lines.end())) continue;
      cells.clear();
      try {
        ColumnScanner scanner(lines.begin(), lines.end(), separator_);
        for (std::string_view cell; scanner.next(cell);) cells.push_back(cell);
      } catch (const LineFault&) {
        return true;  // which reading reports
      }
      if (!see(cells)) return false;
    }
    return true;
  }

  /// Commas are decimal marks where they can be nothing else: in columns that a semicolon, a tab,
  /// quotes or the number of names divides.
  void choose_decimal(const std::vector<std::uint32_t>& columns) {
    if (options_.decimal != 0) {
      preamble_.decimal = options_.decimal;
      return;
    }
    const auto is_near = [&](char c) {
      return std::memchr(row_.begin, c, preview_size()) != nullptr;
    };
    if (!is_near(',') || (separator_ == ' ' && names_.empty()) ||
        (separator_ == ',' && !is_near('"')))
      return;
    const bool points = preview([&](const std::vector<std::string_view>& cells) {
      return std::none_of(columns.begin(), columns.end(), [&](std::uint32_t c) {
        return c < cells.size() && has_decimal_comma(cells[c]);
      });
    });
    if (points) return;
    preamble_.decimal = ',';
    say("commas are read as decimal marks; --decimal . refuses them");
  }

  std::size_t preview_size() const {
    return std::min<std::size_t>(
        preview_bytes, static_cast<std::size_t>(source_.data + source_.size - row_.begin));
  }

  /// What rows without names may hold beside coordinates: colours, numbers of the rows, names that
  /// are numbers.
  void remark_on_unnamed() const {
    const std::uint32_t d = preamble_.dimension;
    if (!options_.columns.empty() || d < 3) return;
    const auto value = [&](std::string_view cell) {
      double number = -1;
      const char* p = skip_blanks(cell.data(), cell.data() + cell.size());
      return scan_number(p, cell.data() + cell.size(), number, preamble_.decimal) == Scan::ok
                 ? number
                 : -1.0;
    };
    std::size_t rows = 0;
    double start = 0;
    bool counts = true, coloured = d == 6 || d == 7, bytes_alone = true;
    bool numbers_columns = separator_ == ',' || separator_ == ';';  // as pandas names columns
    preview([&](const std::vector<std::string_view>& cells) {
      if (cells.size() < d) return true;  // separated in another way, or faulty
      const double first = value(cells[0]);
      if (rows == 0) start = first;
      for (std::uint32_t j = 0; rows == 0 && numbers_columns && j < d; ++j)
        numbers_columns = cells[j] == std::to_string(j);
      counts = counts && first == start + static_cast<double>(rows);
      for (std::uint32_t j = 0; j < d; ++j) {
        const double number = value(cells[j]);
        const bool byte = number >= 0 && number <= 255 && number == std::floor(number);
        if (j + 3 >= d) coloured = coloured && byte;
        if (j < 3) bytes_alone = bytes_alone && byte;
      }
      ++rows;
      return counts || coloured;
    });
    constexpr std::size_t enough = 4;  // rows that are not so by chance
    if (coloured && !bytes_alone && rows > 0)
      say("all " + std::to_string(d) +
          " columns are taken as coordinates; if the last three are "
          "colours, --columns 0:3 takes x, y and z");
    else if ((format_ == "xyz" || preamble_.kind == Preamble::count_line) && d > 3)
      say("all " + std::to_string(d) +
          " columns are taken as coordinates; --columns 0:3 takes x, y "
          "and z alone");
    else if (counts && rows >= enough && (start == 0 || start == 1))
      say("the first column numbers the rows and is taken as a coordinate; "
          "--columns 1:" +
          std::to_string(d) + " leaves it out");
    else if (numbers_columns && rows > 1)
      say("the first line, 0 to " + std::to_string(d - 1) +
          ", is taken as a point; remove it if it numbers the columns");
  }

  const Source& source_;
  const ReadOptions& options_;
  std::string format_;
  Preamble& preamble_;
  std::vector<std::string> wanted_;  ///< names asked for
  DataLine row_;                     ///< the first row, once the names are found
  std::vector<std::string> names_;   ///< of all columns; empty: none
  std::uint64_t names_at_ = 0;       ///< their line
  char separator_ = 0;               ///< of columns; first those of the names
  bool said_separator_ = false, quoted_names_ = false;
};

}  // namespace

void find_rows(const Source& source, const ReadOptions& options, const std::string& format,
               const DataLine& first, const DataLines& lines, Preamble& preamble) {
  RowFinder(source, options, format, preamble).find(first, lines);
}

}  // namespace cullhull::internal
