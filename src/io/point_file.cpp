// Opens a file of points: determines its format, and owns the memory.
#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <numeric>

#include "io/blocks/block_source.hpp"
#include "io/columns.hpp"
#include "io/coordinates.hpp"
#include "io/hdf5/hdf5_points.hpp"
#include "io/mapped_file.hpp"
#include "io/packed/unpack.hpp"
#include "io/records.hpp"
#include "io/skip_nan.hpp"
#include "io/source.hpp"
#include "io/text/text_scan.hpp"
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
                         " points have a NaN coordinate and are skipped");
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
std::optional<std::pair<std::uint64_t, std::uint64_t>> PointFile::first_not_finite()
    const noexcept {
  const internal::PointLine& at = impl_->data.not_finite;
  if (at.line == 0) return std::nullopt;
  return std::pair(at.point, at.line);
}
double PointFile::read_seconds() const noexcept { return impl_->seconds; }
std::uint64_t PointFile::held_bytes() const noexcept { return impl_->held_bytes(); }

}  // namespace cullhull

namespace cullhull::internal {

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

std::vector<std::string> all_columns(const std::string& format, std::uint32_t dimension) {
  // A header of a few bytes can claim billions, whose numbers nobody needs listed.
  constexpr std::uint32_t most = 65536;
  if (dimension > most) return {};
  std::vector<std::uint32_t> all(dimension);
  std::iota(all.begin(), all.end(), 0U);
  return column_labels(all, column_names(format.substr(0, format.find(' '))));
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

std::optional<RecordLayout> raw_records(const Source& head, std::uint64_t size,
                                        const ReadOptions& options) {
  if (options.raw_dimension == 0 || !options.raw_scalar)
    throw Error(ErrorCode::invalid_argument, head.name,
                ": raw input needs a dimension and a scalar type");
  RecordLayout layout;
  layout.format = "raw";
  layout.record_bytes = std::uint64_t{options.raw_dimension} * scalar_size(*options.raw_scalar);
  layout.count = size == unknown_size ? unknown_size : size / layout.record_bytes;
  if (size != unknown_size && size % layout.record_bytes != 0)
    fail_at_byte(head, layout.count * layout.record_bytes, "ends within a point: one takes ",
                 layout.record_bytes, " bytes");
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
    const internal::Source& source = file.source();
    if (source.size == 0 || internal::named_as_packed(source.name)) return std::nullopt;
    return internal::line_in_file(source, point);
  } catch (...) {
    return std::nullopt;
  }
}

}  // namespace cullhull
