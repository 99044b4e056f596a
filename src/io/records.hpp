// Formats of fixed-size records after a header, which can be read in pieces: headers of .npy files,
// and 64-bit integers as the doubles that equal them.
#pragma once

#include <cmath>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "cullhull/point_view.hpp"
#include "io/packed/archive.hpp"
#include "io/source.hpp"

namespace cullhull::internal {

/// The size of a pipe, which is unknown.
inline constexpr std::uint64_t unknown_size = std::numeric_limits<std::uint64_t>::max();

/// Reads from the memory that holds a whole file; `file` must outlive it.
ReadAt reader_of(const Source& file);

/// Records that are compressed together.
struct RecordChunk {
  std::uint64_t first = 0, count = 0;   ///< of points
  std::uint64_t offset = 0, bytes = 0;  ///< in the file
};

/// The chunks [first, second) that have some of `count` points from `first` on.
std::pair<std::size_t, std::size_t> chunks_with(const std::vector<RecordChunk>& chunks,
                                                std::uint64_t first, std::uint64_t count);

struct RecordLayout {
  std::string format;
  std::uint64_t offset = 0;  ///< of the first record in the file
  std::uint64_t count = 0;   ///< of points; unknown_size: to the end of the file
  std::uint64_t record_bytes = 0;
  /// The number of arrays of `count` records, one after the other; a point has a record in each.
  std::uint32_t columns = 1;
  bool ends_file = true;  ///< nothing follows the records
  /// Where records are compressed: all chunks, one after the other. decode() then takes the bytes
  /// of those that have some of the points.
  std::vector<RecordChunk> chunks;
  Placement placement;  ///< of the numbers in the file, by axis of what decode() makes
  Grid grid;            ///< as PointFile::grid()
  /// Makes points of `count` points' records (columns one after the other), the first of which has
  /// index `first` in the file; in place where possible.
  std::function<PointData(const Source& records, std::uint64_t first, std::uint64_t count)> decode;
};

/// From the beginning of a file of `size` bytes. Empty where points are not records of fixed size.
/// Throw what the readers throw.
std::optional<RecordLayout> npy_records(const Source& head, std::uint64_t size,
                                        const ReadOptions& options);
std::optional<RecordLayout> ply_records(const Source& head, std::uint64_t size,
                                        const ReadOptions& options);
std::optional<RecordLayout> las_records(const Source& head, std::uint64_t size,
                                        const ReadOptions& options);
std::optional<RecordLayout> pcd_records(const Source& head, std::uint64_t size,
                                        const ReadOptions& options);
std::optional<RecordLayout> raw_records(const Source& head, std::uint64_t size,
                                        const ReadOptions& options);

/// Of a file whose points are in chunks, such as LAZ; empty for others. `read`: of all its bytes.
std::optional<RecordLayout> las_chunks(const Source& head, std::uint64_t size, const ReadAt& read,
                                       const ReadOptions& options);

/// The format by options, name or content: "npy", ..., or "text".
std::string choose_format(const Source& head, const ReadOptions& options);

/// Whether the format has one point a line.
bool is_text(std::string_view format);
/// The layout of a format of records; nothing for other formats and files.
std::optional<RecordLayout> layout_of(const std::string& format, const Source& head,
                                      std::uint64_t size, const ReadOptions& options);
/// The same of a format of chunks.
std::optional<RecordLayout> chunks_of(const std::string& format, const Source& head,
                                      std::uint64_t size, const ReadAt& read,
                                      const ReadOptions& options);
/// The line, from 1, of a point of a text that is not compressed; nothing if it has none.
std::optional<std::uint64_t> line_in_file(const Source& file, std::uint64_t point);
/// The names of the columns that every file of the format has; empty for most formats.
std::vector<std::string> column_names(const std::string& format);
/// PointFile::columns() of points in all columns of their file; `format`: as PointFile::format().
std::vector<std::string> all_columns(const std::string& format, std::uint32_t dimension);

/// Whether the text begins with a byte order mark of UTF-16.
bool is_utf16(std::string_view text);
/// The same text in UTF-8, without the mark. Of a half character '?'.
std::string from_utf16(std::string_view text);
/// Throws Error{invalid_argument} if decimal commas are asked for in a format that has none.
void check_decimal(const Source& source, const std::string& format, const ReadOptions& options);

// 64-bit integers as the doubles that equal them.

/// The double of the same value, or false.
template <class T>
bool exact_double(T v, double& out) {
  out = static_cast<double>(v);
  // 2^63 and 2^64 are doubles that T cannot hold: converting them back would be undefined.
  const double limit = std::ldexp(1.0, std::numeric_limits<T>::digits);
  return out < limit && static_cast<T>(out) == v;
}

// The headers of .npy files.

/// NumPy's word for a scalar type, little-endian: "<f8".
std::string npy_descr(ScalarType type);

/// The header of an array in C order.
std::string npy_header(const char* descr, std::initializer_list<std::uint64_t> shape);

}  // namespace cullhull::internal
