// Formats that are records of one size behind a header: read in pieces as well as whole.
#pragma once

#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <string>

#include "io/source.hpp"

namespace cullhull::internal {

/// Of a pipe nobody knows how many bytes will come.
inline constexpr std::uint64_t unknown_size = std::numeric_limits<std::uint64_t>::max();

struct RecordLayout {
  std::string format;
  std::uint64_t offset = 0;  ///< of the first record in the file
  std::uint64_t count = 0;   ///< of points; unknown_size: as many as there are
  std::uint64_t record_bytes = 0;
  /// So many arrays of `count` records, one after the other; a point has a record in each.
  std::uint32_t columns = 1;
  bool ends_file = true;  ///< nothing follows the records
  /// Makes points of `count` points' records (columns one after the other), of which the first is
  /// `first` in the file; in place where they can be.
  std::function<PointData(const Source& records, std::uint64_t first, std::uint64_t count)> decode;
};

/// From the beginning of a file of `size` bytes. Nothing where points are no records of one size.
/// They throw what the readers throw.
std::optional<RecordLayout> npy_records(const Source& head, std::uint64_t size,
                                        const ReadOptions& options);
std::optional<RecordLayout> ply_records(const Source& head, std::uint64_t size,
                                        const ReadOptions& options);
std::optional<RecordLayout> las_records(const Source& head, std::uint64_t size);
std::optional<RecordLayout> pcd_records(const Source& head, std::uint64_t size,
                                        const ReadOptions& options);
std::optional<RecordLayout> raw_records(const Source& head, std::uint64_t size,
                                        const ReadOptions& options);

/// The word for a format that options or name or content tell: "npy", ..., or "text".
std::string choose_format(const Source& head, const ReadOptions& options);

/// Whether such a format has a point a line.
bool is_text(const std::string& format);
/// The names of the columns that every file of a format has; none for most.
std::vector<std::string> column_names(const std::string& format);

}  // namespace cullhull::internal
