// Wavefront .obj: the "v" lines are the points; all other lines are skipped.
#include <algorithm>
#include <array>
#include <atomic>

#include "io/text/lines.hpp"
#include "io/write/mesh.hpp"

namespace cullhull::internal {
namespace {

constexpr std::array<std::string_view, 48> keywords = {
    "v",      "vt",     "vn",         "vp",        "deg",      "bmat",  "step",   "cstype",
    "p",      "l",      "f",          "fo",        "curv",     "curv2", "surf",   "parm",
    "trim",   "hole",   "scrv",       "sp",        "end",      "con",   "g",      "s",
    "mg",     "o",      "bevel",      "c_interp",  "d_interp", "lod",   "maplib", "usemap",
    "usemtl", "mtllib", "shadow_obj", "trace_obj", "ctech",    "stech", "call",   "csh",
    "bsp",    "bzp",    "cdc",        "cdp",       "res",      "rad",   "group",  "#"};

bool is_vertex_line(const char* p, const char* end) {
  p = skip_blanks(p, end);
  return end - p >= 2 && *p == 'v' && is_blank(p[1]);
}

/// Whether the line before, in the same file, ends with a backslash.
bool continues_line(const Source& source, const char* line) {
  const char* p = line;
  if (p > source.data) --p;  // the newline
  if (p > source.data && p[-1] == '\r') --p;
  return p > source.data && p < line && p[-1] == '\\';
}

/// x y z, then perhaps a weight (1 number) or a colour (3), or both (4), which are skipped.
void parse_vertex(const char* p, const char* end, double* out) {
  p = skip_blanks(p, end) + 1;
  p = parse_coordinates(p, end, 3, out, "vertex");
  unsigned extra = 0;
  for (p = skip_blanks(p, end); p < end && *p != '#'; p = skip_blanks(p, end), ++extra) {
    double ignored;
    if (extra == 4) throw LineFault{"vertex has more than 7 numbers"};
    p = parse_coordinates(p, end, 1, &ignored, "vertex");
  }
}

}  // namespace

bool is_obj_keyword(std::string_view word) {
  return std::find(keywords.begin(), keywords.end(), word) != keywords.end();
}

PointData read_obj(const Source& source, const ReadOptions& options) {
  const LineIndex index = index_lines(source, source.data, 0, options, is_vertex_line);
  if (index.points == 0) fail(source, "no vertices ('v' lines)");
  PointData data = parsed_points(index.points, 3, "obj");
  double* const out = data.storage.as<double>();
  std::atomic<std::uint64_t> unknown{0};
  std::atomic<const char*> first_unknown{source.data + source.size};
  parse_lines(
      source, index, options, is_vertex_line,
      [&](std::uint64_t point, const char* p, const char* end) {
    if (continues_line(source, p)) throw LineFault{"a vertex cannot continue a line"};
    parse_vertex(p, end, out + 3 * point);
      },
      [&](const char* p, const char* end) {
    const std::string_view word = first_word(p, end);
    if (word.empty() || word[0] == '#' || is_obj_keyword(word) || continues_line(source, p)) return;
    unknown.fetch_add(1);
    const char* first = first_unknown.load();
    while (p < first && !first_unknown.compare_exchange_weak(first, p)) {
    }
  });
  if (unknown > 0) {
    LineScanner line(first_unknown, source.data + source.size);
    line.next();
    remark(source, options,
           "lines that no keyword of .obj begins are passed over: " + std::to_string(unknown) +
               ", the first is line " +
               std::to_string(1 + std::count(source.data, line.begin(), '\n')) + ", " +
               quoted_text(first_word(line.begin(), line.end())));
  }
  data.not_finite = line_of_not_finite(index, data.view, is_vertex_line);
  return data;
}

void write_obj(OutputFile& out, const HullMesh& mesh) {
  out.write_items(mesh.vertex_count(),
                  [&](std::string& text, std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t i = begin; i < end; ++i) {
      text += 'v';
      for (unsigned j = 0; j < 3; ++j) {
        text += ' ';
        append_number(text, mesh.coordinates[3 * i + j]);
      }
      text += '\n';
    }
  });
  out.write_items(mesh.polygons.size(),
                  [&](std::string& text, std::uint64_t begin, std::uint64_t end) {
    for (std::uint64_t f = begin; f < end; ++f) {
      text += 'f';
      for (std::uint64_t i = mesh.polygons.offsets[f]; i < mesh.polygons.offsets[f + 1]; ++i) {
        text += ' ';
        append_number(text, std::uint64_t{mesh.polygons.items[i]} + 1);
      }
      text += '\n';
    }
  });
}

}  // namespace cullhull::internal
