// .off (Geomview's Object File Format, ASCII), and what `qconvex o` prints.
#include "io/text/lines.hpp"
#include "io/write/mesh.hpp"

namespace cullhull::internal {
namespace {

bool is_data_line(const char* p, const char* end) {
  p = skip_blanks(p, end);
  return p < end && *p != '#';
}

struct OffHeader {
  std::uint64_t dimension = 3;
  bool extra = false;  ///< colours, normals or texture coordinates follow the coordinates
  std::uint64_t vertices = 0, faces = 0;
  const char* body = nullptr;
  std::uint64_t lines = 0;
};

std::vector<std::string_view> words_of(const char* p, const char* end) {
  std::vector<std::string_view> words;
  for (;;) {
    const std::string_view word = first_word(p, end);
    if (word.empty() || word[0] == '#') return words;
    words.push_back(word);
    p = word.data() + word.size();
  }
}

/// [ST][C][N][4][n]OFF; 4OFF's fourth coordinate is homogeneous and not supported. A number may
/// follow without a blank, as in the files of ModelNet: `rest` of the word.
bool parse_magic(const Source& source, std::uint64_t line, std::string_view word, OffHeader& h,
                 bool& dimension_follows, std::string_view& rest) {
  const std::size_t begin = word.find("OFF");
  if (begin == std::string_view::npos) return false;
  rest = word.substr(begin + 3);
  if (!rest.empty() && !is_digit(rest[0])) return false;
  word = word.substr(0, begin);
  h.extra = !word.empty();
  dimension_follows = word.ends_with("n");
  if (dimension_follows) word.remove_suffix(1);
  if (dimension_follows && word.empty()) h.extra = false;
  if (word.ends_with("4"))
    fail_at_line(source, line, "homogeneous coordinates (4OFF) are not supported");
  return word.empty() || word == "C" || word == "N" || word == "ST" || word == "CN" ||
         word == "STC" || word == "STN" || word == "STCN";
}

OffHeader parse_off_header(const Source& source) {
  LineScanner scanner(source.data, source.data + source.size);
  std::vector<std::string_view> words;
  const auto refill = [&] {
    while (words.empty()) {
      if (!scanner.next()) fail_at_line(source, scanner.number(), "ends within the OFF header");
      if (is_data_line(scanner.begin(), scanner.end()))
        words = words_of(scanner.begin(), scanner.end());
    }
  };
  const auto number = [&](const char* what) {
    refill();
    std::uint64_t value = 0;
    if (!parse_unsigned(words.front(), value))
      fail_at_line(source, scanner.number(), quoted_text(words.front()), " is not the number of ",
                   what);
    words.erase(words.begin());
    return value;
  };

  OffHeader h;
  refill();
  bool dimension_follows = false;
  std::string_view rest;
  if (parse_magic(source, scanner.number(), words.front(), h, dimension_follows, rest)) {
    words.front() = rest;
    if (rest.empty()) words.erase(words.begin());
    if (!words.empty() && words.front() == "BINARY")
      fail_at_line(source, scanner.number(), "binary OFF is not supported");
    if (dimension_follows) h.dimension = number("dimensions");
  } else if (is_digit(words.front()[0])) {
    h.dimension = number("dimensions");  // as qconvex writes it
  } else {
    fail_at_line(source, scanner.number(), quoted_text(words.front()),
                 " does not begin an OFF file");
  }
  if (h.dimension == 0 || h.dimension > source.size)
    fail_at_line(source, scanner.number(), "dimension ", h.dimension);
  h.vertices = number("vertices");
  h.faces = number("faces");
  if (!words.empty()) number("edges");  // unused, and sometimes left out
  if (!words.empty())
    fail_at_line(source, scanner.number(), quoted_text(words.front()), " after the counts");
  h.body = scanner.rest();
  h.lines = scanner.number();
  return h;
}

}  // namespace

PointData read_off(const Source& source, const ReadOptions& options) {
  const OffHeader h = parse_off_header(source);
  const auto d = static_cast<std::uint32_t>(h.dimension);
  const LineIndex index = index_lines(source, h.body, h.lines, options, is_data_line);
  std::uint64_t coordinates = 0;
  const std::uint64_t expected = h.vertices + h.faces;
  if (index.points < h.vertices)
    fail_at_line(source, h.lines, "promises ", h.vertices, " vertices, but ", index.points,
                 " lines follow");
  const auto ignore = [](const char*, const char*) {};
  if (!multiply(h.vertices, d, coordinates) || coordinates > source.size / 2 + 1)
    fail_at_line(source, h.lines, "promises more coordinates than the file can hold");
  PointData data = parsed_points(h.vertices, d, "off");
  double* const out = data.storage.as<double>();
  parse_lines(
      source, index, options, is_data_line,
      [&](std::uint64_t line, const char* p, const char* end) {
    if (line >= h.vertices) return;
    p = skip_blanks(parse_coordinates(p, end, d, out + line * d, "vertex"), end);
    if (!h.extra && p < end && *p != '#')
      throw LineFault{quoted_text(first_word(p, end)) + " after the " + std::to_string(d) +
                      " coordinates of a vertex"};
      },
      ignore);
  if (expected < h.vertices || index.points < expected)
    remark(source, options,
           "ends within its faces: " + std::to_string(index.points - h.vertices) + " of " +
               std::to_string(h.faces) + " are there; the points are complete");
  else if (index.points > expected)
    remark(source, options, "text after the last face is passed over");
  data.not_finite = line_of_not_finite(index, data.view, is_data_line);
  return data;
}

void write_off(OutputFile& out, const HullMesh& mesh) {
  std::string line = "OFF\n";
  append_number(line, std::uint64_t{mesh.vertex_count()});
  line += ' ';
  append_number(line, std::uint64_t{mesh.polygons.size()});
  line += ' ';
  append_number(line, mesh.edges);
  out.write(line += '\n');
  out.write_items(mesh.vertex_count(),
                  [&](std::string& text, std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = 3 * begin; i < 3 * end; ++i) {
      append_number(text, mesh.coordinates[i]);
      text += i % 3 < 2 ? ' ' : '\n';
    }
  });
  out.write_items(mesh.polygons.size(),
                  [&](std::string& text, std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t f = begin; f < end; ++f) {
      append_number(text, mesh.polygons.offsets[f + 1] - mesh.polygons.offsets[f]);
      for (std::uint64_t i = mesh.polygons.offsets[f]; i < mesh.polygons.offsets[f + 1]; ++i) {
        text += ' ';
        append_number(text, std::uint64_t{mesh.polygons.items[i]});
      }
      text += '\n';
    }
  });
}

}  // namespace cullhull::internal
