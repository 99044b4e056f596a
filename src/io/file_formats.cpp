#include "io/file_formats.hpp"

#include <algorithm>
#include <cstring>

#include "io/columns.hpp"
#include "io/formats/geometry_positions.hpp"
#include "io/packed/unpack.hpp"
#include "io/text/data_lines.hpp"
#include "io/text/text_scan.hpp"
#include "parallel/byte_order.hpp"

namespace cullhull::internal {
namespace {

// How a content without magic bytes is known.

bool begins_with_ply(const Source& s) {
  if (!std::string_view(s.data, s.size).starts_with("ply")) return false;
  const char* const end = s.data + s.size;
  const char* const p = skip_blanks(s.data + 3, end);
  return p < end && (*p == '\n' || p[-1] == '\r');
}

/// Binary STL has no magic number: its size follows from its number of triangles.
bool looks_like_binary_stl(const Source& s) {
  if (s.size < 84) return false;
  const auto triangles = load_little_endian<std::uint32_t>(s.data + 80);
  return s.size == 84 + std::uint64_t{50} * triangles;
}

bool begins_with_solid(const char* begin, const char* end) {
  return is_keyword(first_word(begin, end), "solid");
}

bool begins_with_off(const char* begin, const char* end) {
  const std::string_view word = first_word(begin, end);
  return word.substr(0, word.find_last_not_of("0123456789") + 1).ends_with("OFF");
}

bool begins_with_obj(const char* begin, const char* end) {
  return is_obj_keyword(first_word(begin, end));
}

bool begins_with_json(const char* begin, const char* end) {
  const std::string_view word = first_word(begin, end);
  return word.starts_with("{") || word.starts_with("[") || word.starts_with("\x1E{");
}

// Leica's .pts has x, y, z, perhaps an intensity, perhaps colours.
bool is_width_of_pts(std::size_t columns) { return columns == 4 || columns == 6 || columns == 7; }
bool is_beyond_space(std::size_t columns) { return columns > 3; }

using Reader = FileFormat::Reader;
using Encoding = FileFormat::Encoding;
using Shape = FileFormat::Shape;

// Rows of the table. `endings`: the first is the format's name.

FileFormat format_of(std::string_view endings, Reader reader, Encoding encoding) {
  FileFormat f;
  f.name = endings.substr(0, endings.find(' '));
  f.endings = endings;
  f.reader = reader;
  f.encoding = encoding;
  return f;
}

FileFormat of_records(std::string_view endings, decltype(FileFormat::records) records,
                      std::string_view magic, decltype(FileFormat::read) read = nullptr) {
  FileFormat f = format_of(endings, Reader::here, Encoding::bytes);
  f.read = read;
  f.records = records;
  f.magic = magic;
  f.axes = true;
  return f;
}

FileFormat of_text(std::string_view endings, decltype(FileFormat::read) read,
                   decltype(FileFormat::has_line) has_line) {
  FileFormat f = format_of(endings, Reader::here, Encoding::unicode);
  f.read = read;
  f.has_line = has_line;
  f.axes = true;
  return f;
}

FileFormat of_rows(std::string_view endings,
                   decltype(FileFormat::space_first) space_first = nullptr,
                   decltype(FileFormat::header) header = nullptr) {
  FileFormat f = format_of(endings, Reader::here, Encoding::unicode);
  f.rows = true;
  f.space_first = space_first;
  f.header = header;
  return f;
}

FileFormat of_others(std::string_view endings, Reader reader) {
  return format_of(endings, reader, Encoding::bytes);
}

std::vector<FileFormat> table() {
  using enum OutputKind;
  std::vector<FileFormat> all;
  const auto add = [&](FileFormat f, std::string_view help = {}, OutputKinds writes = {},
                       Shape shape = Shape::other) -> FileFormat& {
    f.help = help;
    f.writes = writes;
    f.shape = shape;
    all.push_back(f);
    return all.back();
  };
  const auto only_written = [](std::string_view name) {
    FileFormat f;
    f.name = name;
    return f;
  };
  add(of_records("npy", npy_records, "\x93NUMPY"),
      "  .npy             NumPy array with a row per point, C or Fortran order (memory-mapped)\n",
      {ids, points, made})
      .axes = false;
  FileFormat& ply = add(of_records("ply", ply_records, "", read_ply),
                        "  .ply             vertices, binary (memory-mapped) or ASCII\n",
                        {hull, triangulation, cells, points, made}, Shape::mesh);
  ply.encoding = Encoding::utf8;
  ply.has_bytes = begins_with_ply;
  add(of_text("obj", read_obj, begins_with_obj), "  .obj .off .stl   vertices\n",
      {hull, triangulation, cells, made}, Shape::mesh);
  add(of_text("off", read_off, begins_with_off), "", {hull, triangulation, cells, made},
      Shape::mesh);
  add(of_text("stl", read_stl, begins_with_solid), "", {hull, triangulation}, Shape::mesh)
      .has_bytes = looks_like_binary_stl;
  add(only_written("glb"), "", {hull, triangulation}, Shape::mesh);
  add(only_written("vtp"), "", {hull, triangulation, cells}, Shape::mesh);
  add(only_written("vtk"), "", {triangulation});
  add(of_records("las laz copc", las_records, "LASF"),
      "  .las .laz        LAS 1.0 to 1.4, all point formats, also compressed (LAZ, COPC); other\n"
      "                   fields (classification, intensity, gps_time, red, ...) are columns\n",
      {records})
      .chunks = las_chunks;
  add(of_records("pcd", pcd_records, "# .PCD", read_pcd),
      "  .pcd             fields x, y, z: ascii, binary (memory-mapped), binary_compressed\n");
  add(of_text("geojson geojsonl geojsons geojsonseq", read_geojson, begins_with_json),
      "  .geojson .wkt    the vertices of all geometries; a ring's closing position is not "
      "repeated\n",
      {hull, group_hulls, triangulation, cells, points, made}, Shape::map);
  add(of_text("wkt", read_wkt, looks_like_wkt), "", {hull, triangulation, cells, made}, Shape::map)
      .line_of = line_of_wkt_point;
  add(of_others("h5 hdf5 he5 nc nc4", Reader::container),
      "  .h5 .nc          dataset of an HDF5 or NetCDF-4 file: FILE.h5:/GROUP/NAME; or one "
      "dataset\n"
      "                   per coordinate: FILE.nc:x,y,z\n")
      .name = "hdf5";
  add(of_rows("csv"),
      "  .xyz .txt .csv   text with a point per line, separated by blanks, commas or semicolons;\n"
      "                   headers of column names, of Qhull and of cdd (rbox h) are recognised\n",
      {group_hulls, ids, points, made});
  add(only_written("json"),  // read by its content
      "  .json            GeoJSON, or rows of numbers: [[0, 0], [1, 0]]\n",
      {hull, group_hulls, triangulation, voronoi});
  add(of_rows("xyz"), "", {points, made});
  add(of_rows("txt"), "", {hull, ids, points, made});
  add(of_rows("text")).endings = {};  // what content alone shows to be rows
  add(of_rows("pts", is_width_of_pts),
      "  .pts .ptx        scans of Leica's; without records that have no return\n");
  add(of_text("ptx", read_ptx, nullptr));
  add(of_rows("node"), "  .node            points of Triangle and TetGen\n");
  add(of_rows("asc xyzrgb", is_beyond_space, find_cloud_compare_header),
      "  .asc .xyzrgb     CloudCompare's text: a first line //X Y Z R G B names the columns,\n"
      "                   which may be followed by the number of points\n");
  add(of_others("hullstate", Reader::container),
      "  .hullstate       partial result of 'cullhull hull --part' or '--partial'\n", {state})
      .magic =
      "\x93"
      "CULLHS\n";
  add(of_others("npz", Reader::container),
      "  .npz             one array of an archive: FILE.npz:NAME, or the only array\n", {state});
  add(of_records("raw", raw_records, ""),
      "  .raw             coordinates without a header: needs --dim D --type T; any other name\n"
      "                   also needs --input-format raw\n",
      {made})
      .axes = false;
  add(of_others("e57 parquet gpkg shp fgb gml kml", Reader::program)).name = {};
  add(of_others("zarr", Reader::package)).name = {};
  return all;
}

const FileFormat* format_with_ending(std::string_view extension) {
  for (const FileFormat& f : file_formats())
    if (f.has_ending(extension)) return &f;
  return nullptr;
}

bool is_named(const FileFormat& f) { return f.reader == Reader::here && !f.endings.empty(); }

/// `s`: behind a byte order mark.
std::string format_of_content(const Source& s) {
  const std::string_view all(s.data, s.size);
  for (const FileFormat& f : file_formats())
    if (is_named(f) && !f.magic.empty() && all.starts_with(f.magic)) return std::string(f.name);
  for (const FileFormat& f : file_formats())
    if (f.has_bytes != nullptr && f.has_bytes(s)) return std::string(f.name);
  if (std::memchr(s.data, 0, std::min<std::size_t>(s.size, 4096)) != nullptr)
    fail(s, "not a format known by its content; for raw numbers give dimension and scalar type");
  LineScanner lines(s.data, s.data + s.size);
  while (lines.next()) {
    const std::string_view word = first_word(lines.begin(), lines.end());
    if (word.empty() || is_comment(word.data(), lines.end())) continue;
    for (const FileFormat& f : file_formats())
      if (f.has_line != nullptr && f.has_line(lines.begin(), lines.end()))
        return std::string(f.name);
    break;
  }
  return "text";
}

/// The points of a file that is no text of rows.
PointData points_of(const Source& file, const FileFormat& format, const ReadOptions& options) {
  if (format.read != nullptr) return format.read(file, options);
  std::optional<RecordLayout> found = format.records(file, file.size, options);
  if (!found) found = format.chunks(file, file.size, reader_of(file), options);
  const RecordLayout layout = *std::move(found);
  return layout.decode({file.name, file.data + layout.offset, file.size - layout.offset}, 0,
                       layout.count);
}

/// Skips the byte order mark of UTF-8.
Source behind_byte_order_mark(const Source& s) {
  const bool marked = std::string_view(s.data, s.size).starts_with("\xEF\xBB\xBF");
  return marked ? Source{s.name, s.data + 3, s.size - 3} : s;
}

/// The text as the readers of the format take it; `converted` holds what was UTF-16.
Source decoded(const Source& file, const FileFormat& format, std::string& converted) {
  if (format.encoding == Encoding::bytes) return file;
  // Binary files of a format that has texts, too.
  if (format.has_bytes != nullptr && format.has_line != nullptr && format.has_bytes(file))
    return file;
  if (format.encoding == Encoding::unicode && is_utf16({file.data, file.size})) {
    converted = from_utf16({file.data, file.size});
    return {file.name, converted.data(), converted.size()};
  }
  return behind_byte_order_mark(file);
}

}  // namespace

bool FileFormat::has_ending(std::string_view extension) const {
  if (extension.empty()) return false;
  for (std::size_t from = 0, to = 0; from < endings.size(); from = to + 1) {
    to = std::min(endings.find(' ', from), endings.size());
    if (endings.substr(from, to - from) == extension) return true;
  }
  return false;
}

const std::vector<FileFormat>& file_formats() {
  static const std::vector<FileFormat> all = table();
  return all;
}

const FileFormat* format_named(std::string_view name) {
  for (const FileFormat& f : file_formats())
    if (!name.empty() && f.name == name) return &f;
  return nullptr;
}

std::vector<std::string_view> output_endings(OutputKinds kinds) {
  static const std::vector<std::string> dotted = [] {
    std::vector<std::string> all;
    for (const FileFormat& f : file_formats()) all.push_back("." + std::string(f.name));
    return all;
  }();
  std::vector<std::string_view> endings;
  for (std::size_t i = 0; i < dotted.size(); ++i)
    if (file_formats()[i].writes.meet(kinds)) endings.push_back(dotted[i]);
  return endings;
}

bool holds(std::string_view format, OutputKinds kinds) {
  const FileFormat* const f = format_named(format);
  return f != nullptr && f->writes.meet(kinds);
}

bool is_written(std::string_view format) {
  using enum OutputKind;
  return holds(format, {hull, group_hulls, triangulation, voronoi, cells, ids, points, made,
                        records, state});
}

bool is_mesh(std::string_view format) {
  const FileFormat* const f = format_named(format);
  return f != nullptr && f->shape == Shape::mesh;
}

bool is_map(std::string_view format) {
  const FileFormat* const f = format_named(format);
  return f != nullptr && f->shape == Shape::map;
}

bool has_known_extension(const std::string& path) {
  const FileFormat* const f = format_with_ending(extension_of(unpacked_name(path)));
  return f != nullptr && f->reader != Reader::package;
}

std::string help_on_formats() {
  std::string text;
  for (const FileFormat& f : file_formats()) text += f.help;
  return text;
}

std::string choose_format(const Source& source, const ReadOptions& options) {
  if (!options.format.empty()) {
    const FileFormat* const f = format_named(options.format);
    if (f != nullptr && is_named(*f)) return options.format;
    std::string known;
    for (const std::string& name : input_formats()) known += " " + name;
    throw Error(ErrorCode::invalid_argument, "unknown format ", quoted_text(options.format),
                "; expected", known);
  }
  const std::string extension = extension_of(unpacked_name(source.name));
  const FileFormat* const f = format_with_ending(extension);
  if (f != nullptr && f->reader == Reader::here) return std::string(f->name);
  if (f != nullptr && f->reader == Reader::program)
    fail(source, ".", extension,
         " is read by the program of the Python package: python3 -m cullhull instead of cullhull");
  if (f != nullptr && f->reader == Reader::package)
    fail(source, ".", extension, " is read by the Python package: cullhull.read(path)");
  if (options.raw_dimension != 0 || options.raw_scalar) return "raw";
  if (is_utf16({source.data, source.size})) {
    const std::string text = from_utf16({source.data, std::min<std::size_t>(source.size, 4096)});
    return format_of_content({source.name, text.data(), text.size()});
  }
  return format_of_content(source);
}

bool is_text(std::string_view format) {
  const FileFormat* const f = format_named(format);
  return f != nullptr && f->rows;
}

std::vector<std::string> column_names(const std::string& format) {
  const FileFormat* const f = format_named(format);
  return f != nullptr && f->axes ? std::vector<std::string>{"x", "y", "z"}
                                 : std::vector<std::string>();
}

std::optional<RecordLayout> layout_of(const std::string& format, const Source& head,
                                      std::uint64_t size, const ReadOptions& options) {
  const FileFormat* const f = format_named(format);
  return f != nullptr && f->records != nullptr ? f->records(head, size, options) : std::nullopt;
}

ReadAt reader_of(const Source& file) {
  return [&file](char* out, std::size_t size, std::uint64_t offset) {
    std::copy_n(file.data + offset, size, out);
  };
}

std::pair<std::size_t, std::size_t> chunks_with(const std::vector<RecordChunk>& chunks,
                                                std::uint64_t first, std::uint64_t count) {
  if (count == 0) return {0, 0};
  const auto from = std::partition_point(chunks.begin(), chunks.end(), [&](const RecordChunk& c) {
    return c.first + c.count <= first;
  });
  const auto to = std::partition_point(
      from, chunks.end(), [&](const RecordChunk& c) { return c.first < first + count; });
  return {from - chunks.begin(), to - chunks.begin()};
}

std::optional<RecordLayout> chunks_of(const std::string& format, const Source& head,
                                      std::uint64_t size, const ReadAt& read,
                                      const ReadOptions& options) {
  const FileFormat* const f = format_named(format);
  return f != nullptr && f->chunks != nullptr ? f->chunks(head, size, read, options) : std::nullopt;
}

PointData read_points(const Source& file, const ReadOptions& options) {
  if (file.size == 0) fail(file, "empty file");
  const std::string name = choose_format(behind_byte_order_mark(file), options);
  check_decimal(file, name, options);
  const FileFormat& format = *format_named(name);
  std::string converted;
  const Source source = decoded(file, format, converted);
  if (format.rows) {
    PointData data = read_text(source, options, name);
    if (!format.endings.empty()) data.format = name;
    return data;
  }
  PointData data = points_of(source, format, options);
  choose_columns(data, file.name, column_names(name), options);
  return data;
}

std::optional<std::uint64_t> line_in_file(const Source& file, std::uint64_t point) {
  const std::string name = choose_format(behind_byte_order_mark(file), {});
  const FileFormat& format = *format_named(name);
  std::string converted;
  const Source source = decoded(file, format, converted);
  if (source.size == 0) return std::nullopt;
  if (format.line_of != nullptr) return format.line_of(source, point);
  if (format.rows) return line_of_row(source, point, name);
  const PointLine at = points_of(source, format, {}).not_finite;
  return at.line > 0 && at.point == point ? std::optional(at.line) : std::nullopt;
}

}  // namespace cullhull::internal

namespace cullhull {

std::vector<std::string> input_formats() {
  std::vector<std::string> names;
  for (const internal::FileFormat& f : internal::file_formats())
    if (internal::is_named(f)) names.emplace_back(f.name);
  return names;
}

}  // namespace cullhull
