// Opens a file of points: determines its format, and owns the memory.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <cstring>
#include <numeric>

#include "io/blocks/block_source.hpp"
#include "io/columns.hpp"
#include "io/coordinates.hpp"
#include "io/formats/geometry_positions.hpp"
#include "io/hdf5/hdf5_points.hpp"
#include "io/mapped_file.hpp"
#include "io/packed/unpack.hpp"
#include "io/records.hpp"
#include "io/skip_nan.hpp"
#include "io/source.hpp"
#include "io/text/text.hpp"
#include "io/text/text_scan.hpp"
#include "parallel/byte_order.hpp"
#include "parallel/memory/memory.hpp"
#include "parallel/memory/pages.hpp"

namespace cullhull {

struct PointFile::Impl {
  internal::MappedFile file;
  internal::RawArray<char> unpacked;  ///< decompressed contents
  std::size_t unpacked_bytes = 0;
  internal::PointData data;
  std::vector<double> weights;
  std::vector<std::uint64_t> rows;  ///< where points were left out
  std::uint64_t skipped = 0;
  bool placed = false;  ///< no longer the file's own numbers
  double seconds = 0;
  std::uint64_t budget = 0;  ///< of the options that the file was opened with

  /// What was mapped, read from a pipe or unpacked is returned to the system where the points are a
  /// copy then.
  void place(const ReadOptions& options) {
    internal::place(data, options);
    placed = !internal::stays(options.numbers) || data.placement.empty();
    if (data.in_place) return;
    const bool held = file.held() + unpacked_bytes > 0;
    file = internal::MappedFile();
    unpacked.release();
    unpacked_bytes = 0;
    if (held) internal::trim_pages(0);
  }
  /// The same after the file was opened.
  void place_later(const ReadOptions& options) {
    ReadOptions rest = options;
    rest.memory_budget = std::max<std::uint64_t>(1, budget - std::min(budget, held_bytes()));
    const internal::ReadLimit limit(file.source().name, rest);
    place(options);
  }
  std::uint64_t held_bytes() const {
    return file.held() + unpacked_bytes + data.storage.size() + data.colour_storage.size() +
           weights.size() * sizeof(double);
  }

  /// Leaves out the points with a NaN, with their colours and weights. Call after place().
  void skip_nan(const std::string& name, const ReadOptions& options) {
    if (!options.skip_nan) return;
    const std::vector<std::uint64_t> out = internal::rows_with_nan(data.view);
    skipped = out.size();
    internal::remark({name, nullptr, 0}, options,
                     std::to_string(skipped) + " of " + std::to_string(data.view.count) +
                         " points have a NaN coordinate and are skipped",
                     Remark::Kind::skipped);
    if (out.empty()) return;
    rows = internal::other_rows(data.view.count, out);
    if (data.colours.count > 0)
      data.colours = internal::packed_rows(data.colours, rows, data.colour_storage);
    internal::Buffer kept;
    data.view = internal::packed_rows(data.view, rows, kept);
    data.storage = std::move(kept);
    data.in_place = false;
    for (std::size_t i = 0; !weights.empty() && i < rows.size(); ++i) weights[i] = weights[rows[i]];
    if (!weights.empty()) weights.resize(rows.size());
    if (std::binary_search(out.begin(), out.end(), data.not_finite.point)) data.not_finite = {};
    file = internal::MappedFile();
    unpacked = {};
  }
};

PointFile::PointFile() : impl_(std::make_unique<Impl>()) {}
PointFile::PointFile(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
PointFile::PointFile(PointFile&&) noexcept = default;
PointFile& PointFile::operator=(PointFile&&) noexcept = default;
PointFile::~PointFile() = default;

const PointView& PointFile::points() const noexcept { return impl_->data.view; }
const PointView& PointFile::colours() const noexcept { return impl_->data.colours; }
const Placement& PointFile::placement() const noexcept { return impl_->data.placement; }
const std::vector<double>& PointFile::weights() const noexcept { return impl_->weights; }
const Grid& PointFile::grid() const noexcept { return impl_->data.grid; }
void PointFile::to_grid(const ReadOptions& options) {
  ReadOptions placing = options;
  placing.numbers = Numbers::grid;
  impl_->place_later(placing);
}
void PointFile::to_world() {
  internal::PointData& data = impl_->data;
  if (impl_->placed && data.grid.empty()) return;
  if (!impl_->placed) return impl_->place_later({});
  auto* const numbers = data.storage.as<double>();
  for (std::uint64_t i = 0; i < data.view.count * data.view.dimension; ++i)
    numbers[i] = data.grid.to_world(numbers[i]);
  data.grid = {};
}
const std::string& PointFile::format() const noexcept { return impl_->data.format; }
std::vector<std::string> PointFile::columns() const {
  const internal::PointData& data = impl_->data;
  return data.columns.empty() ? internal::all_columns(data.format, data.view.dimension)
                              : data.columns;
}
bool PointFile::mapped() const noexcept { return impl_->data.in_place && impl_->file.mapped(); }
const std::vector<std::uint64_t>& PointFile::rows() const noexcept { return impl_->rows; }
std::uint64_t PointFile::skipped() const noexcept { return impl_->skipped; }
std::optional<PointLine> PointFile::first_not_finite() const noexcept {
  const PointLine& at = impl_->data.not_finite;
  return at.line > 0 ? std::optional(at) : std::nullopt;
}
double PointFile::read_seconds() const noexcept { return impl_->seconds; }
std::uint64_t PointFile::held_bytes() const noexcept { return impl_->held_bytes(); }

}  // namespace cullhull

namespace cullhull::internal {
namespace {

bool begins(const Source& s, std::string_view magic) {
  return s.size >= magic.size() && std::memcmp(s.data, magic.data(), magic.size()) == 0;
}

/// Binary STL has no magic number: its size follows from its number of triangles.
bool looks_like_binary_stl(const Source& s) {
  if (s.size < 84) return false;
  const auto triangles = load_little_endian<std::uint32_t>(s.data + 80);
  return s.size == 84 + std::uint64_t{50} * triangles;
}

/// Skips the byte order mark of UTF-8.
Source behind_byte_order_mark(const Source& s) {
  return begins(s, "\xEF\xBB\xBF") ? Source{s.name, s.data + 3, s.size - 3} : s;
}

/// Whether the first line is this one, with blanks after it perhaps.
bool begins_with_line(const Source& s, std::string_view line) {
  if (!begins(s, line)) return false;
  const char* const end = s.data + s.size;
  const char* const p = skip_blanks(s.data + line.size(), end);
  return p < end && (*p == '\n' || p[-1] == '\r');
}

std::string format_of_content(const Source& s) {
  if (begins(s, "\x93NUMPY")) return "npy";
  if (begins_with_line(s, "ply")) return "ply";
  if (begins(s, "LASF")) return "las";
  if (begins(s, "# .PCD")) return "pcd";
  if (looks_like_binary_stl(s)) return "stl";
  if (std::memchr(s.data, 0, std::min<std::size_t>(s.size, 4096)) != nullptr)
    fail(s, "not a format known by its content; for raw numbers give dimension and scalar type");
  LineScanner lines(s.data, s.data + s.size);
  while (lines.next()) {
    const std::string_view word = first_word(lines.begin(), lines.end());
    if (word.empty() || is_comment(word.data(), lines.end())) continue;
    if (is_keyword(word, "solid")) return "stl";
    if (word.substr(0, word.find_last_not_of("0123456789") + 1).ends_with("OFF")) return "off";
    if (is_obj_keyword(word)) return "obj";
    if (word.starts_with("{") || word.starts_with("[") || word.starts_with("\x1E{"))
      return "geojson";
    if (looks_like_wkt(lines.begin(), lines.end())) return "wkt";
    return "text";
  }
  return "text";
}

}  // namespace

std::string choose_format(const Source& source, const ReadOptions& options) {
  static constexpr std::string_view known[] = {"npy",  "ply",     "las", "pcd", "obj", "off",
                                               "stl",  "xyz",     "txt", "csv", "pts", "ptx",
                                               "node", "geojson", "wkt", "raw"};
  const auto is_known = [](const std::string& f) {
    return std::find(std::begin(known), std::end(known), f) != std::end(known);
  };
  if (!options.format.empty()) {
    if (!is_known(options.format))
      throw Error(ErrorCode::invalid_argument, "unknown format ", quoted_text(options.format),
                  "; expected npy ply las pcd obj off stl xyz txt csv pts ptx node geojson wkt "
                  "raw");
    return options.format;
  }
  const std::string extension = extension_of(unpacked_name(source.name));
  if (is_known(extension)) return extension;
  for (const char* sequence : {"geojsonl", "geojsons", "geojsonseq"})  // a text after the other
    if (extension == sequence) return "geojson";
  if (extension == "laz") return "las";  // whose error names a reader for it
  for (const char* other : {"e57", "parquet", "gpkg", "shp", "fgb", "gml", "kml"})
    if (extension == other)
      fail(
          source, ".", extension,
          " is read by the program of the Python package: python3 -m cullhull instead of cullhull");
  for (const char* other : {"zarr", "copc"})
    if (extension == other)
      fail(source, ".", extension, " is read by the Python package: cullhull.read(path)");
  if (options.raw_dimension != 0 || options.raw_scalar) return "raw";
  if (is_utf16({source.data, source.size})) {
    const std::string text = from_utf16({source.data, std::min<std::size_t>(source.size, 4096)});
    return format_of_content({source.name, text.data(), text.size()});
  }
  return format_of_content(source);
}

bool is_utf16(std::string_view text) {
  return text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF");
}

std::string from_utf16(std::string_view text) {
  const std::size_t low = text[0] == '\xFF' ? 0 : 1;  // of a pair of bytes
  const auto unit = [&](std::size_t i) {
    return static_cast<std::uint32_t>(static_cast<unsigned char>(text[i + 1 - low])) << 8 |
           static_cast<unsigned char>(text[i + low]);
  };
  std::string out;
  out.reserve(text.size() / 2);
  for (std::size_t i = 2; i + 1 < text.size(); i += 2) {
    std::uint32_t code = unit(i);
    if (code >= 0xD800 && code < 0xE000) {  // a surrogate: half a character
      const std::uint32_t next = i + 3 < text.size() ? unit(i + 2) : 0;
      const bool pair = code < 0xDC00 && next >= 0xDC00 && next < 0xE000;
      code = pair ? 0x10000 + ((code & 0x3FFU) << 10 | (next & 0x3FFU)) : '?';
      if (pair) i += 2;
    }
    const auto rest = [&](unsigned shift) {
      return static_cast<char>(0x80U | (code >> shift & 0x3FU));
    };
    if (code < 0x80) {
      out += static_cast<char>(code);
    } else if (code < 0x800) {
      out += {static_cast<char>(0xC0U | code >> 6), rest(0)};
    } else if (code < 0x10000) {
      out += {static_cast<char>(0xE0U | code >> 12), rest(6), rest(0)};
    } else {
      out += {static_cast<char>(0xF0U | code >> 18), rest(12), rest(6), rest(0)};
    }
  }
  return out;
}

void check_decimal(const Source& source, const std::string& format, const ReadOptions& options) {
  if (options.decimal != 0 && options.decimal != '.' && options.decimal != ',')
    throw Error(ErrorCode::invalid_argument, source.name, ": a decimal mark is '.' or ','");
  if (options.decimal == ',' && !is_text(format))
    throw Error(ErrorCode::invalid_argument, source.name,
                ": only texts of rows have decimal commas, not ", format);
}

std::vector<std::string> column_names(const std::string& format) {
  for (const char* named : {"ply", "las", "pcd", "obj", "off", "stl", "ptx", "geojson", "wkt"})
    if (format == named) return {"x", "y", "z"};
  return {};
}

std::vector<std::string> all_columns(const std::string& format, std::uint32_t dimension) {
  // A header of a few bytes can claim billions, whose numbers nobody needs listed.
  constexpr std::uint32_t most = 65536;
  if (dimension > most) return {};
  std::vector<std::uint32_t> all(dimension);
  std::iota(all.begin(), all.end(), 0U);
  return column_labels(all, column_names(format.substr(0, format.find(' '))));
}

namespace {

PointData read_format(const Source& file, const Source& text, const std::string& format,
                      const ReadOptions& options) {
  if (format == "npy") return read_npy(file, options);
  if (format == "raw") return read_raw(file, options);
  if (format == "las") return read_las(file, options);
  if (format == "pcd") return read_pcd(file, options);
  const Source& source = format == "stl" && looks_like_binary_stl(file) ? file : text;
  if (format == "ply") return read_ply(source, options);
  if (format == "obj") return read_obj(source, options);
  if (format == "off") return read_off(source, options);
  if (format == "geojson") return read_geojson(source, options);
  if (format == "wkt") return read_wkt(source, options);
  if (format == "ptx") return read_ptx(source, options);
  return read_stl(source, options);
}

}  // namespace

bool is_text(const std::string& format) {
  for (const char* text : {"text", "txt", "xyz", "csv", "pts", "node"})
    if (format == text) return true;
  return false;
}

PointData read_points(const Source& file, const ReadOptions& options) {
  if (file.size == 0) fail(file, "empty file");
  Source text = behind_byte_order_mark(file);
  const std::string format = choose_format(text, options);
  check_decimal(file, format, options);
  std::string converted;
  if (is_utf16({file.data, file.size}))
    for (const char* kind : {"obj", "off", "geojson", "wkt", "ptx", "stl"})
      if (is_text(format) || format == kind) {
        converted = from_utf16({file.data, file.size});
        text = {file.name, converted.data(), converted.size()};
        break;
      }
  if (is_text(format)) {
    PointData data = read_text(text, options, format);
    if (format != "text") data.format = format;
    return data;
  }
  PointData data = read_format(file, text, format, options);
  choose_columns(data, file.name, column_names(format), options);
  return data;
}

namespace {

/// The words of a column, which were read as keys, as numbers.
std::vector<double> numbers_of(const PointKeys& words, const std::string& name,
                               const std::string& column) {
  if (ReadLimit* const limit = ReadLimit::current(); limit != nullptr)
    limit->take(words.size() * sizeof(double));
  std::vector<double> numbers(words.size());
  for (std::size_t i = 0; i < words.size(); ++i) {
    const std::string_view word = words[i];
    const char* p = word.data();
    const char* const end = p + word.size();
    if (scan_number(p, end, numbers[i]) != Scan::ok || skip_blanks(p, end) != end)
      throw Error(ErrorCode::bad_file, name, ": column ", quoted_text(column), " of point ", i,
                  " is not a number: ", quoted_text(std::string(word)));
  }
  return numbers;
}

std::uint64_t raw_record(const Source& source, const ReadOptions& options) {
  if (options.raw_dimension == 0 || !options.raw_scalar)
    throw Error(ErrorCode::invalid_argument, source.name,
                ": raw input needs a dimension and a scalar type");
  return std::uint64_t{options.raw_dimension} * scalar_size(*options.raw_scalar);
}

void check_whole_records(const Source& source, std::uint64_t size, std::uint64_t record) {
  if (size % record != 0)
    fail_at_byte(source, size - size % record, "ends within a point: one takes ", record, " bytes");
}

PointData raw_points(const Source& source, std::uint64_t count, const ReadOptions& options) {
  PointData data;
  data.format = "raw";
  data.in_place = true;
  const auto size = static_cast<std::ptrdiff_t>(scalar_size(*options.raw_scalar));
  data.view = {reinterpret_cast<const std::byte*>(source.data),
               *options.raw_scalar,
               options.raw_dimension,
               count,
               size * static_cast<std::ptrdiff_t>(options.raw_dimension),
               size};
  return in_machine_order(std::move(data));
}

}  // namespace

PointData read_raw(const Source& source, const ReadOptions& options) {
  const std::uint64_t record = raw_record(source, options);
  check_whole_records(source, source.size, record);
  return raw_points(source, source.size / record, options);
}

std::optional<RecordLayout> raw_records(const Source& head, std::uint64_t size,
                                        const ReadOptions& options) {
  RecordLayout layout;
  layout.format = "raw";
  layout.record_bytes = raw_record(head, options);
  if (size != unknown_size) check_whole_records(head, size, layout.record_bytes);
  layout.count = size == unknown_size ? unknown_size : size / layout.record_bytes;
  layout.decode = [options](const Source& records, std::uint64_t, std::uint64_t count) {
    return raw_points(records, count, options);
  };
  return layout;
}

namespace {

/// Touches the pages of a view in place, row after row or axis after axis.
void prefault(const MappedFile& file, const PointView& view, const ReadOptions& options) {
  if (view.count == 0) return;
  const auto row = static_cast<std::uint64_t>(std::abs(view.point_stride));
  const auto step = static_cast<std::uint64_t>(std::abs(view.coordinate_stride));
  const bool axes = step > row;
  for (std::uint32_t j = 0; j < (axes ? view.dimension : 1); ++j)
    file.prefault(view.address(0, j), view.count * std::max<std::uint64_t>(row, 1), options);
}

}  // namespace
}  // namespace cullhull::internal

namespace cullhull {

PointFile open_points(const std::string& path, const ReadOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  auto impl = std::make_unique<PointFile::Impl>();
  const internal::InputName input = internal::split_input(path);
  ReadOptions reading = options;
  reading.memory_budget = impl->budget = internal::resolve_budget(options.memory_budget);
  internal::ReadLimit limit(internal::display_name(path), reading);
  impl->file = internal::MappedFile(input.file, reading);
  internal::Source source = impl->file.source();
  if (!options.weights.empty()) reading.key = options.weights;
  const auto take_weights = [&] {
    if (!options.weights.empty())
      impl->weights = internal::numbers_of(impl->data.keys, source.name, options.weights);
    impl->data.keys = {};
  };
  if (internal::holds_hdf5(input.file, {source.data, std::min<std::size_t>(source.size, 16)})) {
    impl->file = internal::MappedFile();
    limit.set_in_blocks(true);
    impl->data = internal::read_hdf5(input.file, input.member, reading);
    take_weights();
    impl->skip_nan(source.name, options);
    impl->seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    return PointFile(std::move(impl));
  }
  internal::unwrap(input, source, reading, impl->unpacked);
  const bool unpacked = impl->unpacked.data() != nullptr;
  if (unpacked) impl->unpacked_bytes = source.size;
  constexpr std::size_t head = std::size_t{1} << 20;
  limit.set_in_blocks(
      internal::comes_in_blocks({source.name, source.data, std::min(source.size, head)}, reading));
  impl->data = internal::read_points(source, reading);
  impl->file.check_size();
  take_weights();
  if (impl->data.in_place && !unpacked) internal::prefault(impl->file, impl->data.view, options);
  if (unpacked) impl->file = internal::MappedFile();
  impl->place(options);
  impl->skip_nan(source.name, options);
  impl->seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return PointFile(std::move(impl));
}

std::optional<std::uint64_t> line_of_point(const std::string& path, std::uint64_t point) noexcept {
  try {
    if (path == "-") return std::nullopt;  // it has been read
    const internal::MappedFile file(path);
    internal::Source source = internal::behind_byte_order_mark(file.source());
    std::string converted;
    if (internal::is_utf16({source.data, source.size})) {
      converted = internal::from_utf16({source.data, source.size});
      source = {source.name, converted.data(), converted.size()};
    }
    if (source.size == 0 || internal::unpacked_name(source.name) != source.name)
      return std::nullopt;
    const std::string format = internal::choose_format(source, {});
    if (format == "wkt") return internal::line_of_wkt_point(source, point);
    if (internal::is_text(format)) return internal::line_of_row(source, point, format);
    const PointLine at = internal::read_points(source, {}).not_finite;
    return at.line > 0 && at.point == point ? std::optional(at.line) : std::nullopt;
  } catch (...) {
    return std::nullopt;
  }
}

}  // namespace cullhull
