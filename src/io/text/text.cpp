// .xyz .txt .csv: one point a line, numbers separated by blanks, commas or semicolons.
#include "io/text/text.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "io/columns.hpp"
#include "io/text/lines.hpp"

namespace cullhull::internal {

const char* parse_coordinates(const char* p, const char* end, unsigned count, double* out,
                              const char* what) {
  for (unsigned j = 0; j < count; ++j) {
    p = skip_blanks(p, end);
    if (p == end)
      throw LineFault{count == 1 ? std::string(what) + " needs a number"
                                 : std::string(what) + " has " + std::to_string(j) +
                                       " coordinates, not " + std::to_string(count)};
    const std::string_view word = first_word(p, end);
    const Scan scan = scan_number(p, end, out[j]);
    if (scan == Scan::out_of_range)
      throw LineFault{quoted_text(word) + " exceeds the range of doubles"};
    if (scan != Scan::ok || (p < end && !is_blank(*p)))
      throw LineFault{quoted_text(word) + " is not a number"};
  }
  return p;
}

std::uint64_t first_not_finite(const PointView& view) {
  std::uint64_t row = 0;
  if (view.scalar == ScalarType::f64 && view.packed_rows()) {
    constexpr std::uint64_t block = 1024;  // rows
    const auto* const rows = reinterpret_cast<const double*>(view.data);
    while (row < view.count && !any_not_finite(rows + row * view.dimension,
                                               std::min(block, view.count - row) * view.dimension))
      row += std::min(block, view.count - row);
  }
  for (; row < view.count; ++row)
    for (std::uint32_t j = 0; j < view.dimension; ++j)
      if (!std::isfinite(view.at(row, j))) return row;
  return row;
}

namespace {

bool is_separator(char c, char decimal) { return c == ';' || (c == ',' && decimal != ','); }

/// The fast path: true if the line holds exactly the numbers of a point.
template <char Decimal>
bool parse_row(const char* p, const char* end, const Preamble& preamble, double* out) {
  constexpr char blank = ' ';
  const std::uint32_t dimension = preamble.dimension;
  char separator = preamble.separator;
  for (std::uint32_t j = 0; j < dimension; ++j) {
    p = skip_blanks(p, end);
    if (j > 0) {  // the same between all numbers: "1,5 2,5" would be four of them
      const char found = p < end && is_separator(*p, Decimal) ? *p : blank;
      if (separator == 0) separator = found;
      if (found != separator) return false;
      if (found != blank) p = skip_blanks(p + 1, end);
    }
    if (p == end || scan_number(p, end, out[j], Decimal) != Scan::ok) return false;
    if (p < end && !is_blank(*p) && !is_separator(*p, Decimal) && !is_comment(p, end)) return false;
  }
  p = skip_blanks(p, end);
  return p == end || is_comment(p, end);
}

}  // namespace

bool is_point_line(const char* p, const char* end) {
  p = skip_blanks(p, end);
  return p < end && !is_comment(p, end);
}

bool Fields::all_numbers() const {
  for (const Field& f : list)
    if (f.scan != Scan::ok) return false;
  return !list.empty();
}

bool Fields::any_number() const {
  return std::any_of(list.begin(), list.end(), [](const Field& f) { return f.scan == Scan::ok; });
}

Fields split_fields(const char* p, const char* end, char decimal) {
  Fields fields;
  char separator = 0;  // ' ' stands for blanks
  p = skip_blanks(p, end);
  while (p < end && !is_comment(p, end)) {
    const char* q = p;
    while (q < end && !is_blank(*q) && !is_separator(*q, decimal) && !is_comment(q, end)) ++q;
    Field field{{p, static_cast<std::size_t>(q - p)}};
    double value;
    const char* r = p;
    field.scan = scan_number(r, q, value, decimal);
    if (field.scan == Scan::ok && r != q) field.scan = Scan::not_a_number;
    fields.list.push_back(field);
    p = skip_blanks(q, end);
    if (p == end || is_comment(p, end)) break;
    const char found = is_separator(*p, decimal) ? *p : ' ';
    fields.mixed = fields.mixed || (separator != 0 && found != separator);
    separator = found;
    if (found == ' ') continue;
    fields.separators = true;
    p = skip_blanks(p + 1, end);
    if (p == end || is_comment(p, end)) fields.list.push_back({{p, 0}});
  }
  return fields;
}

const char* about_decimal_mark(char next, char decimal) {
  if (decimal == ',' && next == '.') return "; commas are the decimal marks here";
  return decimal != ',' && next == ','
             ? "; --decimal , reads decimal commas (in Python decimal=\",\")"
             : "";
}

std::string explain_row(const char* p, const char* end, const Preamble& preamble) {
  const char decimal = preamble.decimal;
  const Fields fields = split_fields(p, end, decimal);
  if (fields.mixed) {
    const std::string line(p, end);
    const bool commas = line.find(',') != std::string::npos && decimal != ',';
    const char* const other = commas && line.find(';') == std::string::npos ? "blanks" : "';'";
    return std::string(commas ? "both ',' and " : "both blanks and ") + other +
           " separate numbers" + about_decimal_mark(commas ? ',' : ' ', decimal);
  }
  for (std::size_t j = 0; j < fields.list.size(); ++j) {
    const Field& f = fields.list[j];
    if (f.text.empty()) return "column " + std::to_string(j + 1) + " is empty";
    if (f.scan == Scan::out_of_range) return quoted_text(f.text) + " exceeds the range of doubles";
    if (f.scan == Scan::ok) continue;
    const char* q = f.text.data();
    double ignored;
    const bool begins = scan_number(q, f.text.data() + f.text.size(), ignored, decimal) == Scan::ok;
    return quoted_text(f.text) + " is not a number" +
           (begins ? about_decimal_mark(*q, decimal) : "");
  }
  if (fields.list.size() == preamble.dimension)
    return std::string("other separators between the numbers than before") +
           about_decimal_mark(fields.separators ? ',' : ' ', decimal);
  return std::to_string(fields.list.size()) + " coordinates where the first point has " +
         std::to_string(preamble.dimension);
}

namespace {

/// Throws LineFault unless a row of cdd's is a point; returns where its coordinates begin. The 1
/// that marks a point may be any number but 0, as in Qhull: rbox adds its offset to it, too.
const char* skip_leading_one(const char* p, const char* end, const Preamble& preamble) {
  const std::uint64_t dimension = preamble.dimension;
  p = skip_blanks(p, end);
  const std::string_view word = first_word(p, end);
  double one = 0;
  const char* q = p;
  if (scan_number(q, end, one) != Scan::ok || q != word.data() + word.size())
    throw LineFault{quoted_text(word) + " is not a number"};
  if (one == 0) throw LineFault{"begins with 0, which is a ray: only points are read"};
  const std::size_t width = split_fields(p, end, preamble.decimal).list.size();
  if (width != dimension + 1)
    throw LineFault{std::to_string(width) + " numbers where the header promises " +
                    std::to_string(dimension + 1)};
  return q;
}

const char* format_name(Preamble::Kind kind) {
  if (kind == Preamble::node) return "node";
  return kind == Preamble::qhull ? "text (Qhull)" : kind == Preamble::cdd ? "text (cdd)" : "text";
}

}  // namespace

namespace {

/// Finds the line that is too short for its points, without allocating what the header promises.
[[noreturn]] void find_short_line(const Source& source, const LineIndex& index,
                                  const Preamble& preamble, const ReadOptions& options) {
  const std::uint32_t d = preamble.dimension;
  parse_lines(
      source, index, options, is_point_line,
      [&](std::uint64_t, const char* p, const char* end) {
    if (preamble.layout != nullptr)
      return preamble.layout->parse(p, end, std::vector<double>(d).data());
    if (preamble.kind == Preamble::cdd) p = skip_leading_one(p, end, preamble);
    if (split_fields(p, end, preamble.decimal).list.size() != d)
      throw LineFault{explain_row(p, end, preamble)};
      },
      [](const char*, const char*) {});
  fail(source, "too short for its points");
}

PointData parse_rows(const Source& source, const LineIndex& index, const Preamble& preamble,
                     const ReadOptions& options) {
  const std::uint32_t d = preamble.dimension;
  PointData data = parsed_points(index.points, d, format_name(preamble.kind));
  double* const out = data.storage.as<double>();
  const bool keyed = !options.key.empty() && preamble.layout != nullptr;
  std::vector<std::string_view> keys(keyed ? index.points : 0);
  std::atomic<bool> all_finite{true};
  const auto parse_one = preamble.decimal == ',' ? &parse_row<','> : &parse_row<'.'>;
  parse_lines(
      source, index, options, is_point_line,
      [&](std::uint64_t point, const char* p, const char* end) {
    double* const row = out + point * d;
    if (preamble.layout != nullptr) {
      preamble.layout->parse(p, end, row, keyed ? &keys[point] : nullptr);
    } else {
      if (preamble.kind == Preamble::cdd) p = skip_leading_one(p, end, preamble);
      if (!parse_one(p, end, preamble, row)) throw LineFault{explain_row(p, end, preamble)};
    }
      },
      [](const char*, const char*) {},
      [&](std::uint64_t begin, std::uint64_t end) {
    if (any_not_finite(out + begin * d, (end - begin) * d)) all_finite = false;
  });
  for (const std::string_view key : keys) data.keys.add(without_doubled_quotes(key));
  data.columns = preamble.columns;
  // Where a header gives the dimension, columns are chosen here.
  if (preamble.columns.empty()) choose_columns(data, source.name, {}, options);
  if (!all_finite) data.not_finite = line_of_not_finite(index, data.view, is_point_line);
  return data;
}

}  // namespace

PointData read_text(const Source& file, const ReadOptions& options, const std::string& format) {
  const Preamble preamble = find_preamble(file, options, format);
  const std::uint32_t d = preamble.dimension;
  const Source source{file.name, file.data, static_cast<std::size_t>(preamble.end - file.data)};
  const LineIndex index =
      index_lines(source, preamble.body, preamble.lines, options, is_point_line);
  if (preamble.kind != Preamble::none && index.points != preamble.count)
    fail_at_line(source, preamble.promised_at, "promises ", preamble.count, " points, but ",
                 index.points, " lines follow");
  // Every coordinate takes a character and, except for the file's last, a separator.
  std::uint64_t coordinates = 0;
  if (!multiply(index.points, d, coordinates) || coordinates > source.size / 2 + 1)
    find_short_line(source, index, preamble, options);
  return parse_rows(source, index, preamble, options);
}

std::optional<std::uint64_t> line_of_row(const Source& file, std::uint64_t row,
                                         const std::string& format) {
  ReadOptions options;
  options.columns = "0";  // any table has one, whatever its columns are called
  const Preamble preamble = find_preamble(file, options, format);
  LineScanner lines(preamble.body, preamble.end);
  while (lines.next())
    if (is_point_line(lines.begin(), lines.end()) && row-- == 0)
      return preamble.lines + lines.number();
  return std::nullopt;
}

PointData read_text_piece(const Source& piece, std::uint64_t lines_before, const Preamble& preamble,
                          const ReadOptions& options) {
  const LineIndex index = index_lines(piece, piece.data, lines_before, options, is_point_line);
  std::uint64_t coordinates = 0;
  if (!multiply(index.points, preamble.dimension, coordinates) || coordinates > piece.size / 2 + 1)
    find_short_line(piece, index, preamble, options);
  return parse_rows(piece, index, preamble, options);
}

}  // namespace cullhull::internal
