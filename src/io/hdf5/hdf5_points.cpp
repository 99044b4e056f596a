#include "io/hdf5/hdf5_points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "io/columns.hpp"
#include "io/file_formats.hpp"
#include "io/hdf5/library.hpp"
#include "io/records.hpp"

namespace cullhull::internal {

bool holds_hdf5(const std::string& file, std::string_view head) {
  const bool named = format_named("hdf5")->has_ending(extension_of(file));
  if (!named && !head.starts_with("\x89HDF\r\n\x1a\n")) return false;
  const Source source{display_name(file), nullptr, 0};
  if (file == "-")
    throw Error(ErrorCode::invalid_argument, "-: HDF5 is read from a file, not from a pipe");
  if (head.starts_with("CDF"))
    fail(source, "NetCDF's format before HDF5; nccopy -k nc4 OLD NEW makes what is read here");
  return true;
}

#if CULLHULL_HAVE_HDF5
namespace {

std::vector<std::string> between_commas(const std::string& text) {
  std::vector<std::string> words;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t comma = std::min(text.find(',', from), text.size());
    words.push_back(text.substr(from, comma - from));
    from = comma + 1;
  }
  return words;
}

/// How numbers of a file's type come into memory.
struct Numbers {
  hid_t memory = H5I_INVALID_HID;
  ScalarType scalar{};  ///< in memory, but for 64-bit integers, which become doubles
  bool integer64 = false, is_signed = false;
};

std::optional<Numbers> numbers_of(hid_t type) {
  const H5T_class_t kind = h5().H5Tget_class(type);
  const std::size_t size = h5().H5Tget_size(type);
  if (kind == H5T_FLOAT) {
    std::size_t sign, exponent_at, exponent, mantissa_at, mantissa;
    if (h5().H5Tget_fields(type, &sign, &exponent_at, &exponent, &mantissa_at, &mantissa) < 0)
      return std::nullopt;
    if (mantissa <= 23 && exponent <= 8)
      return Numbers{h5().number("H5T_NATIVE_FLOAT_g"), ScalarType::f32, false, false};
    if (mantissa <= 52 && exponent <= 11)
      return Numbers{h5().number("H5T_NATIVE_DOUBLE_g"), ScalarType::f64, false, false};
    return std::nullopt;
  }
  if (kind != H5T_INTEGER || size > 8) return std::nullopt;
  const bool is_signed = h5().H5Tget_sign(type) == H5T_SGN_2;
  if (size == 1)
    return is_signed ? Numbers{h5().number("H5T_NATIVE_INT8_g"), ScalarType::i8, false, true}
                     : Numbers{h5().number("H5T_NATIVE_UINT8_g"), ScalarType::u8, false, false};
  if (size == 2)
    return is_signed ? Numbers{h5().number("H5T_NATIVE_INT16_g"), ScalarType::i16, false, true}
                     : Numbers{h5().number("H5T_NATIVE_UINT16_g"), ScalarType::u16, false, false};
  if (size <= 4)
    return is_signed ? Numbers{h5().number("H5T_NATIVE_INT32_g"), ScalarType::i32, false, true}
                     : Numbers{h5().number("H5T_NATIVE_UINT32_g"), ScalarType::u32, false, false};
  return is_signed ? Numbers{h5().number("H5T_NATIVE_INT64_g"), ScalarType::f64, true, true}
                   : Numbers{h5().number("H5T_NATIVE_UINT64_g"), ScalarType::f64, true, false};
}

/// What a dataset is: nothing if it holds no points.
struct Shape {
  Numbers numbers;
  std::uint64_t count = 0;
  std::uint64_t width = 1;
  int axes = 0;
};

std::optional<Shape> shape_of(hid_t dataset) {
  const Handle type(h5().H5Dget_type(dataset), h5().H5Tclose),
      space(h5().H5Dget_space(dataset), h5().H5Sclose);
  if (!type || !space) return std::nullopt;
  const auto numbers = numbers_of(type.get());
  const int axes = h5().H5Sget_simple_extent_ndims(space.get());
  if (!numbers || (axes != 1 && axes != 2)) return std::nullopt;
  hsize_t extent[2] = {0, 1};
  h5().H5Sget_simple_extent_dims(space.get(), extent, nullptr);
  return Shape{*numbers, extent[0], extent[1], axes};
}

extern "C" herr_t list_dataset(hid_t root, const char* name, const H5O_info_t* info, void* out) {
  if (info->type != H5O_TYPE_DATASET) return 0;
  const Handle dataset(h5().H5Dopen2(root, name, H5P_DEFAULT), h5().H5Dclose);
  if (!dataset) return 0;
  const auto shape = shape_of(dataset.get());
  if (!shape) return 0;
  try {
    static_cast<std::vector<std::pair<std::string, Shape>>*>(out)->emplace_back(name, *shape);
  } catch (...) {
    return -1;
  }
  return 0;
}

std::string text_of(const Shape& shape) {
  return shape.axes == 2 ? fmt::format("({}, {})", shape.count, shape.width)
                         : fmt::format("({})", shape.count);
}

class OpenDataset {
 public:
  OpenDataset(const Handle& file, const std::string& path, const std::string& name) : path_(path) {
    // At least one chunk stays decompressed, so that no chunk is decompressed once per block.
    Handle access(h5().H5Pcreate(h5().number("H5P_CLS_DATASET_ACCESS_ID_g")), h5().H5Pclose);
    dataset_ = Handle(h5().H5Dopen2(file.get(), path.c_str(), H5P_DEFAULT), h5().H5Dclose);
    if (!dataset_) throw NoSuchDataset{};
    const auto shape = shape_of(dataset_.get());
    if (!shape)
      throw Error(ErrorCode::bad_file, name, ": dataset ", quoted_text(path),
                  " is no array (n, d) or (n) of numbers up to 64 bits");
    shape_ = *shape;
    find_layout();
    if (chunk_bytes_ > std::size_t{1} << 20) {
      h5().H5Pset_chunk_cache(access.get(), 521, chunk_bytes_, 1.0);
      dataset_ = Handle();  // the first to open it decides
      dataset_ = Handle(h5().H5Dopen2(file.get(), path.c_str(), access.get()), h5().H5Dclose);
      if (!dataset_) throw NoSuchDataset{};
    }
  }
  struct NoSuchDataset {};

  const Shape& shape() const { return shape_; }
  const std::string& path() const { return path_; }
  std::uint64_t chunk_points() const { return chunk_points_; }
  std::size_t number_bytes() const {
    return shape_.numbers.integer64 ? 8 : scalar_size(shape_.numbers.scalar);
  }

  /// Rows in the file's order, packed, as `memory` holds them.
  bool read(std::uint64_t first, std::uint64_t count, void* out) const {
    if (count == 0) return true;
    // Libhdf5 does not write the bytes of storage that does not exist.
    if (may_leave_gaps_) std::memset(out, 0, count * shape_.width * number_bytes());
    const hsize_t start[2] = {first, 0}, extent[2] = {count, shape_.width};
    const Handle space(h5().H5Dget_space(dataset_.get()), h5().H5Sclose);
    const Handle memory(h5().H5Screate_simple(shape_.axes, extent, nullptr), h5().H5Sclose);
    return space && memory &&
           h5().H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start, nullptr, extent, nullptr) >=
               0 &&
           h5().H5Dread(dataset_.get(), shape_.numbers.memory, memory.get(), space.get(),
                        H5P_DEFAULT, out) >= 0;
  }

  /// The first of these rows that was never written and has no fill value in its place.
  std::optional<std::uint64_t> first_gap(std::uint64_t first, std::uint64_t count) const {
    if (!may_leave_gaps_ || count == 0 || shape_.width == 0) return std::nullopt;
    H5D_space_status_t status = H5D_SPACE_STATUS_ALLOCATED;
    if (h5().H5Dget_space_status(dataset_.get(), &status) < 0) return first;
    if (status == H5D_SPACE_STATUS_ALLOCATED) return std::nullopt;
    if (status == H5D_SPACE_STATUS_NOT_ALLOCATED || chunk_width_ == 0) return first;
    // The status of compressed chunks is "part" even if no chunk is missing: each is queried.
    for (std::uint64_t row = first - first % chunk_points_; row < first + count;
         row += chunk_points_)
      for (std::uint64_t column = 0; column < shape_.width; column += chunk_width_) {
        const hsize_t corner[2] = {row, column};
        hsize_t bytes = 0;
        if (h5().H5Dget_chunk_storage_size(dataset_.get(), corner, &bytes) < 0 || bytes == 0)
          return std::max(row, first);
      }
    return std::nullopt;
  }

 private:
  void find_layout() {
    const Handle made(h5().H5Dget_create_plist(dataset_.get()), h5().H5Pclose);
    if (!made) return;
    // As numbers: libhdf5 passes on what a damaged file says, which may be no value of the types.
    int time = H5D_FILL_TIME_IFSET, value = H5D_FILL_VALUE_DEFAULT;
    static_assert(sizeof(H5D_fill_time_t) == sizeof time &&
                  sizeof(H5D_fill_value_t) == sizeof value);
    h5().H5Pget_fill_time(made.get(), reinterpret_cast<H5D_fill_time_t*>(&time));
    h5().H5Pfill_value_defined(made.get(), reinterpret_cast<H5D_fill_value_t*>(&value));
    const bool filled = (time == H5D_FILL_TIME_ALLOC || time == H5D_FILL_TIME_IFSET) &&
                        (value == H5D_FILL_VALUE_DEFAULT || value == H5D_FILL_VALUE_USER_DEFINED);
    may_leave_gaps_ = !filled && h5().H5Pget_external_count(made.get()) <= 0;
    if (h5().H5Pget_layout(made.get()) != H5D_CHUNKED) return;
    hsize_t extent[2] = {1, 1};
    if (h5().H5Pget_chunk(made.get(), 2, extent) != shape_.axes) return;
    chunk_points_ = std::max<hsize_t>(1, extent[0]);
    chunk_width_ = std::max<hsize_t>(1, extent[1]);
    chunk_bytes_ = static_cast<std::size_t>(chunk_points_ * extent[1] * 8);
  }

  Handle dataset_;
  std::string path_;
  Shape shape_;
  std::uint64_t chunk_points_ = 1, chunk_width_ = 0;
  std::size_t chunk_bytes_ = 0;
  bool may_leave_gaps_ = false;  ///< what was never written has no fill value
};

/// 64-bit integers where they lie become the doubles that equal them. The first that none equals,
/// or `count`.
std::uint64_t widen(char* numbers, std::uint64_t count, bool is_signed) {
  for (std::uint64_t i = 0; i < count; ++i) {
    std::uint64_t bits;
    std::memcpy(&bits, numbers + 8 * i, 8);
    double value = 0;
    if (!(is_signed ? exact_double(static_cast<std::int64_t>(bits), value)
                    : exact_double(bits, value)))
      return i;
    std::memcpy(numbers + 8 * i, &value, 8);
  }
  return count;
}

}  // namespace

struct Hdf5Points::Impl {
  std::string file_name, name;
  Handle file;
  std::vector<OpenDataset> columns;  ///< one of (n, d), or some of (n)
  ScalarType scalar{};
  std::uint32_t dimension = 0;

  void open(const std::string& path, const std::string& datasets) {
    file = Handle(h5().H5Fopen(path.c_str(), read_only, H5P_DEFAULT), h5().H5Fclose);
    if (!file) fail({file_name, nullptr, 0}, "is no HDF5 file that can be opened", reason());
    name = file_name;
    if (datasets.empty()) return choose();
    name.append(1, ':').append(display_name(datasets));
    for (const std::string& one : between_commas(datasets)) add(one);
  }
  void add(const std::string& path) {
    try {
      columns.emplace_back(file, path, file_name);
    } catch (const OpenDataset::NoSuchDataset&) {
      refuse("no dataset " + quoted_text(path));
    }
  }
  std::vector<std::pair<std::string, Shape>> all_datasets() const {
    std::vector<std::pair<std::string, Shape>> list;
    if (h5().H5Ovisit(file.get(), H5_INDEX_NAME, H5_ITER_INC, list_dataset, &list) < 0)
      fail({file_name, nullptr, 0}, "its datasets cannot be listed", reason());
    return list;
  }
  void choose() {
    auto list = all_datasets();
    const auto has_rows = [](const auto& dataset) { return dataset.second.axes == 2; };
    if (std::count_if(list.begin(), list.end(), has_rows) == 1)
      std::iter_swap(list.begin(), std::find_if(list.begin(), list.end(), has_rows));
    else if (list.size() != 1)
      refuse("say which dataset, as FILE.h5:/NAME");
    add(list[0].first);
  }
  [[noreturn]] void refuse(const std::string& why) const {
    const auto list = all_datasets();
    std::string names;
    constexpr std::size_t most = 12;
    for (std::size_t i = 0; i < list.size() && i < most; ++i)
      names +=
          (i > 0 ? ", " : "") + quoted_text("/" + list[i].first) + " " + text_of(list[i].second);
    if (list.size() > most) names += ", ...";
    throw Error(ErrorCode::invalid_argument, file_name, ": ", why,
                "; of numbers, (n, d) or (n), there are ", (names.empty() ? "none" : names));
  }

  /// Columns agree in length; their common type.
  void agree() {
    const Shape& one = columns[0].shape();
    scalar = one.numbers.scalar;
    std::uint64_t width = columns.size() == 1 ? one.width : columns.size();
    for (const OpenDataset& column : columns) {
      const Shape& shape = column.shape();
      if (columns.size() > 1 && shape.axes != 1)
        fail({file_name, nullptr, 0}, "dataset ", quoted_text(column.path()), " of ",
             text_of(shape), " is no column among others");
      if (shape.count != one.count)
        fail({file_name, nullptr, 0}, "datasets ", quoted_text(columns[0].path()), " and ",
             quoted_text(column.path()), " have ", one.count, " and ", shape.count, " numbers");
      if (shape.numbers.scalar != scalar) scalar = ScalarType::f64;
    }
    constexpr std::uint64_t most = 1U << 20;  // coordinates; more is a damaged header
    if (width == 0 || width > most)
      fail({file_name, nullptr, 0}, "points of ", width, " coordinates");
    dimension = static_cast<std::uint32_t>(width);
  }

  void read_column(const OpenDataset& column, std::uint64_t first, std::uint64_t count, char* out,
                   std::uint64_t width) const {
    if (!column.read(first, count, out))
      fail({name, nullptr, 0}, "points from ", first, " on cannot be read", reason());
    if (const auto gap = column.first_gap(first, count))
      fail({file_name, nullptr, 0}, "dataset ", quoted_text(column.path()), ": point ", *gap,
           " was never written, and the dataset has no fill value");
    const Numbers& numbers = column.shape().numbers;
    if (!numbers.integer64) return;
    const std::uint64_t bad = widen(out, count * width, numbers.is_signed);
    if (bad < count * width)
      fail({name, nullptr, 0}, "value at index (", first + bad / width, ", ", bad % width,
           ") is a 64-bit integer that no double equals");
  }
};

Hdf5Points::Hdf5Points(const std::string& file, const std::string& datasets) {
  const Quiet call(file);
  auto impl = std::make_unique<Impl>();  // closed before the call is over, should it be refused
  impl->file_name = display_name(file);
  impl->open(file, datasets);
  impl->agree();
  impl_ = std::move(impl);
}

Hdf5Points::~Hdf5Points() {
  const std::string name = std::move(impl_->file_name);
  const Quiet call(name);
  impl_.reset();
}

const std::string& Hdf5Points::name() const { return impl_->name; }
std::uint64_t Hdf5Points::count() const { return impl_->columns[0].shape().count; }
std::uint32_t Hdf5Points::dimension() const { return impl_->dimension; }
ScalarType Hdf5Points::scalar() const { return impl_->scalar; }
std::uint64_t Hdf5Points::record_bytes() const {
  return std::uint64_t{impl_->dimension} * scalar_size(impl_->scalar);
}
std::uint64_t Hdf5Points::chunk_points() const { return impl_->columns[0].chunk_points(); }

PointData Hdf5Points::read(std::uint64_t first, std::uint64_t count, char* out) const {
  PointData data;
  data.format = "hdf5";
  data.in_place = true;
  const auto size = static_cast<std::ptrdiff_t>(scalar_size(impl_->scalar));
  const auto d = static_cast<std::ptrdiff_t>(impl_->dimension);
  const bool rows = impl_->columns.size() == 1;
  const auto* const base = reinterpret_cast<const std::byte*>(out);
  data.view = {
      base,  impl_->scalar,          impl_->dimension,
      count, rows ? size * d : size, rows ? size : size * static_cast<std::ptrdiff_t>(count)};
  const Quiet call(impl_->file_name);
  if (rows) {
    impl_->read_column(impl_->columns[0], first, count, out, impl_->dimension);
    return data;
  }
  for (const OpenDataset& column : impl_->columns) {
    const Numbers& numbers = column.shape().numbers;
    impl_->read_column(column, first, count, out, 1);
    if (numbers.scalar != impl_->scalar) {  // each becomes a double behind those not read yet
      const std::size_t from = scalar_size(numbers.scalar);
      PointView narrow{reinterpret_cast<const std::byte*>(out), numbers.scalar, 1, 1, 0, 0};
      for (std::uint64_t i = count; i-- > 0;) {
        narrow.data = reinterpret_cast<const std::byte*>(out + i * from);
        const double value = narrow.at(0, 0);
        std::memcpy(out + 8 * i, &value, 8);
      }
    }
    out += count * static_cast<std::uint64_t>(size);
  }
  return data;
}

#else

struct Hdf5Points::Impl {
  std::string name;
};
Hdf5Points::Hdf5Points(const std::string& file, const std::string&) {
  throw Error(ErrorCode::invalid_argument, display_name(file),
              ": this cullhull was built without libhdf5; from Python "
              "cullhull.read(path) reads it with h5py");
}
Hdf5Points::~Hdf5Points() = default;
const std::string& Hdf5Points::name() const { return impl_->name; }
std::uint64_t Hdf5Points::count() const { return 0; }
std::uint32_t Hdf5Points::dimension() const { return 0; }
ScalarType Hdf5Points::scalar() const { return {}; }
std::uint64_t Hdf5Points::record_bytes() const { return 0; }
std::uint64_t Hdf5Points::chunk_points() const { return 1; }
PointData Hdf5Points::read(std::uint64_t, std::uint64_t, char*) const { return {}; }

#endif

PointData read_hdf5(const std::string& file, const std::string& datasets,
                    const ReadOptions& options) {
  const Hdf5Points points(file, datasets);
  std::uint64_t bytes = 0;
  if (!multiply(points.count(), points.record_bytes(), bytes)) throw std::bad_alloc();
  Buffer memory(std::max<std::uint64_t>(bytes, 1));
  PointData data = points.read(0, points.count(), memory.as<char>());
  data.storage = std::move(memory);
  data.in_place = false;
  choose_columns(data, points.name(), {}, options);
  return data;
}

}  // namespace cullhull::internal

const char* cullhull::describe_library_fault() noexcept {
#if CULLHULL_HAVE_HDF5
  return internal::read_by_libhdf5();
#else
  return nullptr;
#endif
}
