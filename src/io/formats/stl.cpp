// .stl, ASCII (in small letters or capitals) and binary: the corners of the triangles in file
// order, three a triangle. STL has no shared vertices, so equal points are normal.
#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>

#include "cullhull/error.hpp"
#include "io/text/lines.hpp"
#include "io/write/mesh.hpp"
#include "parallel/byte_order.hpp"

namespace cullhull::internal {
namespace {

constexpr std::uint64_t header_bytes = 84, record_bytes = 50;

PointData read_binary(const Source& source, std::uint64_t triangles, const ReadOptions& options) {
  PointData data;
  data.format = "stl (binary)";
  data.storage = Buffer(triangles * 9 * sizeof(float));
  float* const out = data.storage.as<float>();
  for_each_chunk(triangles, std::uint64_t{1} << 16, resolve_threads(options.threads),
                 [&](std::uint64_t, std::uint64_t begin, std::uint64_t end) {
    check_stop(options);
    // A record: normal, three corners, two bytes of attributes.
    for (std::uint64_t t = begin; t < end; ++t) {
      std::memcpy(out + 9 * t, source.data + header_bytes + record_bytes * t + 12, 36);
      little_endian_items(out + 9 * t, 36, sizeof(float));
    }
  });
  data.view = PointView::row_major(static_cast<const float*>(out), 3 * triangles, 3);
  return data;
}

bool is_corner(const char* p, const char* end) { return is_keyword(first_word(p, end), "vertex"); }

void check_keyword(const char* p, const char* end) {
  static constexpr std::string_view known[] = {"",        "solid",    "facet",   "outer",
                                               "endloop", "endfacet", "endsolid"};
  const std::string_view word = first_word(p, end);
  if (std::none_of(std::begin(known), std::end(known),
                   [&](std::string_view one) { return is_keyword(word, one); }))
    throw LineFault{quoted_text(word) + " is no keyword of .stl"};
}

/// The first word of the last line that is not blank.
std::string_view last_keyword(const Source& source) {
  const char* end = source.data + source.size;
  while (end > source.data && (is_blank(end[-1]) || end[-1] == '\n')) --end;
  const char* begin = end;
  while (begin > source.data && begin[-1] != '\n') --begin;
  return first_word(begin, end);
}

PointData read_ascii(const Source& source, const ReadOptions& options) {
  const LineIndex index = index_lines(source, source.data, 0, options, is_corner);
  PointData data = parsed_points(index.points, 3, "stl (ASCII)");
  double* const out = data.storage.as<double>();
  parse_lines(
      source, index, options, is_corner,
      [&](std::uint64_t point, const char* p, const char* end) {
    p = skip_blanks(p, end) + std::string_view("vertex").size();
    p = skip_blanks(parse_coordinates(p, end, 3, out + 3 * point, "vertex"), end);
    if (p < end) throw LineFault{quoted_text(first_word(p, end)) + " after a vertex"};
      },
      check_keyword);
  if (!is_keyword(last_keyword(source), "endsolid"))
    fail_at_line(source, index.lines, "ends without 'endsolid'");
  if (index.points % 3 != 0)
    fail_at_line(source, index.lines, index.points,
                 " vertices are not a whole number of triangles");
  data.not_finite = line_of_not_finite(index, data.view, is_corner);
  return data;
}

}  // namespace

PointData read_stl(const Source& source, const ReadOptions& options) {
  std::uint32_t triangles = 0;
  std::uint64_t needed = 0;
  if (source.size >= header_bytes) {
    triangles = load_little_endian<std::uint32_t>(source.data + 80);
    needed = header_bytes + record_bytes * triangles;
    if (needed == source.size) return read_binary(source, triangles, options);
  }
  // Binary headers may begin with "solid", too, which is why the size was tested first.
  LineScanner lines(source.data, source.data + source.size);
  while (lines.next() && first_word(lines.begin(), lines.end()).empty()) {
  }
  const bool text = std::memchr(source.data, 0, std::min<std::size_t>(source.size, 512)) == nullptr;
  if (text && is_keyword(first_word(lines.begin(), lines.end()), "solid"))
    return read_ascii(source, options);
  if (source.size < header_bytes)
    fail_at_byte(source, source.size, "ends within the header of a binary STL");
  fail_at_byte(source, 80, "promises ", triangles, " triangles (", needed, " bytes) in a file of ",
               source.size);
}

void write_stl(OutputFile& out, const HullMesh& mesh) {
  // The largest double that rounds to a float.
  const double limit = 0x1.ffffffp127;
  for (const double c : mesh.coordinates)
    if (!(std::fabs(c) < limit))
      throw Error(ErrorCode::invalid_argument,
                  ".stl holds 32-bit floats, and a coordinate exceeds them; .ply holds doubles");
  if (mesh.triangles.empty())
    throw Error(ErrorCode::invalid_argument,
                ".stl holds triangles, and there are none; .json holds any");
  if (mesh.triangles.size() / 3 > std::numeric_limits<std::uint32_t>::max())
    throw Error(ErrorCode::invalid_argument, ".stl holds at most 2^32 - 1 triangles");
  std::string head = "convex hull, binary STL";
  head.resize(80, ' ');
  const auto count = static_cast<std::uint32_t>(mesh.triangles.size() / 3);
  out.write(head);
  write_little_endian(out, &count, 1);
  for (std::uint32_t t = 0; t < count; ++t) {
    const double* v[3];
    for (unsigned j = 0; j < 3; ++j) v[j] = &mesh.coordinates[3 * mesh.triangles[3 * t + j]];
    // Scaled by the largest difference, so that the cross product neither overflows nor underflows.
    double e[2][3], scale = 0;
    for (unsigned i = 0; i < 2; ++i)
      for (unsigned j = 0; j < 3; ++j) {
        e[i][j] = v[i + 1][j] - v[0][j];
        scale = std::max(scale, std::fabs(e[i][j]));
      }
    double normal[3];
    for (unsigned j = 0; j < 3; ++j) {
      const unsigned a = (j + 1) % 3, b = (j + 2) % 3;
      normal[j] = e[0][a] / scale * (e[1][b] / scale) - e[0][b] / scale * (e[1][a] / scale);
    }
    const double length = std::hypot(normal[0], normal[1], normal[2]);
    std::array<float, 12> values{};
    for (unsigned j = 0; j < 3; ++j)
      values[j] = length > 0 ? static_cast<float>(normal[j] / length) : 0.0F;
    for (unsigned i = 0; i < 9; ++i) values[3 + i] = static_cast<float>(v[i / 3][i % 3]);
    write_little_endian(out, values.data(), values.size());
    out.write({"\0\0", 2});
  }
}

}  // namespace cullhull::internal
