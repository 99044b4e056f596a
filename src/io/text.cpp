// .xyz .txt .csv: one point a line, numbers separated by blanks, commas or semicolons.
#include "io/lines.hpp"

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

namespace {

bool is_separator(char c) { return c == ',' || c == ';'; }

bool is_point_line(const char* p, const char* end) {
  p = skip_blanks(p, end);
  return p < end && !is_comment(p, end);
}

/// The fast path: true if the line holds exactly `dimension` numbers.
bool parse_row(const char* p, const char* end, std::uint32_t dimension, double* out) {
  char separator = 0;
  for (std::uint32_t j = 0; j < dimension; ++j) {
    p = skip_blanks(p, end);
    if (j > 0 && p < end && is_separator(*p)) {
      if (separator != 0 && *p != separator) return false;
      separator = *p;
      p = skip_blanks(p + 1, end);
    }
    if (p == end || scan_number(p, end, out[j]) != Scan::ok) return false;
    if (p < end && !is_blank(*p) && !is_separator(*p) && !is_comment(p, end)) return false;
  }
  p = skip_blanks(p, end);
  return p == end || is_comment(p, end);
}

/// The fields of a line, for the first lines and for messages.
struct Field {
  std::string_view text;
  Scan scan = Scan::not_a_number;
};

struct Fields {
  std::vector<Field> list;
  bool separators = false;  ///< at least one comma or semicolon
  bool mixed = false;       ///< both kinds

  bool all_numbers() const {
    for (const Field& f : list)
      if (f.scan != Scan::ok) return false;
    return !list.empty();
  }
  bool no_number() const {
    bool any = false;
    for (const Field& f : list) {
      if (f.scan != Scan::not_a_number) return false;
      any = any || !f.text.empty();
    }
    return any;
  }
};

Fields split(const char* p, const char* end) {
  Fields fields;
  char separator = 0;
  p = skip_blanks(p, end);
  while (p < end && !is_comment(p, end)) {
    const char* q = p;
    while (q < end && !is_blank(*q) && !is_separator(*q) && !is_comment(q, end)) ++q;
    Field field{{p, static_cast<std::size_t>(q - p)}};
    double value;
    const char* r = p;
    field.scan = scan_number(r, q, value);
    if (field.scan == Scan::ok && r != q) field.scan = Scan::not_a_number;
    fields.list.push_back(field);
    p = skip_blanks(q, end);
    if (p < end && is_separator(*p)) {
      fields.separators = true;
      fields.mixed = fields.mixed || (separator != 0 && *p != separator);
      separator = *p;
      p = skip_blanks(p + 1, end);
      if (p == end || is_comment(p, end)) fields.list.push_back({{p, 0}});
    }
  }
  return fields;
}

/// Why parse_row said no.
std::string explain(const char* p, const char* end, std::uint32_t dimension) {
  const Fields fields = split(p, end);
  if (fields.mixed) return "both ',' and ';' separate numbers; decimal commas are not read";
  for (std::size_t j = 0; j < fields.list.size(); ++j) {
    const Field& f = fields.list[j];
    if (f.text.empty()) return "column " + std::to_string(j + 1) + " is empty";
    if (f.scan == Scan::out_of_range) return quoted_text(f.text) + " exceeds the range of doubles";
    if (f.scan != Scan::ok) return quoted_text(f.text) + " is not a number";
  }
  return std::to_string(fields.list.size()) + " coordinates where the first point has " +
         std::to_string(dimension);
}

/// What precedes the points: nothing, a line of words, or Qhull's two lines.
struct Preamble {
  const char* body = nullptr;
  std::uint64_t lines = 0;
  std::uint32_t dimension = 0;
  bool qhull = false;
  std::uint64_t count = 0;       ///< what Qhull's header promises
  std::uint64_t count_line = 0;  ///< and where
};

struct DataLine {
  Fields fields;
  const char* begin = nullptr;
  const char* end = nullptr;
  std::uint64_t number = 0;
};

bool next_data_line(LineScanner& scanner, DataLine& line) {
  while (scanner.next()) {
    if (!is_point_line(scanner.begin(), scanner.end())) continue;
    line = {split(scanner.begin(), scanner.end()), scanner.begin(), scanner.end(),
            scanner.number()};
    return true;
  }
  return false;
}

bool single_integer(const Fields& fields, std::uint64_t& value) {
  return fields.list.size() == 1 && parse_unsigned(fields.list[0].text, value);
}

/// Qhull's format: the dimension, perhaps followed by words ("3 rbox 10 D3"); the number of points;
/// the points. Without words, "3" could be a point of R^1: then the third line must have 3 numbers.
bool find_qhull_header(const Source& source, const DataLine& first, LineScanner scanner,
                       Preamble& preamble) {
  const auto& list = first.fields.list;
  std::uint64_t dimension = 0;
  if (list.empty() || !parse_unsigned(list[0].text, dimension)) return false;
  if (list.size() > 1 && list[1].scan != Scan::not_a_number) return false;
  const bool words = list.size() > 1 && !list[1].text.empty() && !first.fields.separators;
  if (list.size() > 1 && !words) return false;

  DataLine second, third;
  std::uint64_t count = 0;
  if (!next_data_line(scanner, second) || !single_integer(second.fields, count)) return false;
  preamble = {scanner.rest(), second.number, static_cast<std::uint32_t>(dimension),
              true,           count,         second.number};
  const bool has_third = next_data_line(scanner, third);
  if (!words && (dimension < 2 || !has_third || third.fields.list.size() != dimension))
    return false;
  if (dimension == 0 || dimension > UINT32_MAX)
    fail_at_line(source, first.number, "dimension " + std::to_string(dimension));
  return true;
}

Preamble find_preamble(const Source& source, bool csv) {
  const char* start = source.data;
  const char* const end = source.data + source.size;
  if (source.size >= 3 && std::memcmp(start, "\xEF\xBB\xBF", 3) == 0) start += 3;
  LineScanner scanner(start, end);
  DataLine first;
  if (!next_data_line(scanner, first)) fail(source, "no points");
  Preamble preamble;
  if (find_qhull_header(source, first, scanner, preamble)) return preamble;
  preamble = {};
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
    fail_at_line(source, first.number, explain(first.begin, first.end, preamble.dimension));
  return preamble;
}

}  // namespace

PointData read_text(const Source& source, const ReadOptions& options, bool csv) {
  const Preamble preamble = find_preamble(source, csv);
  const std::uint32_t d = preamble.dimension;
  const LineIndex index =
      index_lines(source, preamble.body, preamble.lines, options, is_point_line);
  if (preamble.qhull && index.points != preamble.count)
    fail_at_line(source, preamble.count_line,
                 "promises " + std::to_string(preamble.count) + " points, but " +
                     std::to_string(index.points) + " lines follow");
  // Every coordinate takes a character and, but for the file's last, a separator.
  std::uint64_t coordinates = 0;
  if (!multiply(index.points, d, coordinates) || coordinates > source.size / 2 + 1) {
    // Some line is too short: find it without allocating for what it promises.
    parse_lines(
        source, index, options, is_point_line,
        [&](std::uint64_t, const char* p, const char* end) {
          if (split(p, end).list.size() != d) throw LineFault{explain(p, end, d)};
        },
        [](const char*, const char*) {});
    fail(source, "too short for its points");
  }
  PointData data = parsed_points(index.points, d, preamble.qhull ? "text (Qhull)" : "text");
  double* const out = data.storage.as<double>();
  parse_lines(
      source, index, options, is_point_line,
      [&](std::uint64_t point, const char* p, const char* end) {
        if (!parse_row(p, end, d, out + point * d)) throw LineFault{explain(p, end, d)};
      },
      [](const char*, const char*) {});
  return data;
}

}  // namespace cullhull::internal
