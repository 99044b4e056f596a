// The formats of files, each with how it is known, read and divided, and what is written in it. A
// new format is a row of the table in file_formats.cpp, and the source of its reader; nothing else
// lists formats.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "io/records.hpp"
#include "io/source.hpp"

namespace cullhull::internal {

struct DataLine;
struct Preamble;

/// What a file of results holds, by the function that writes it.
enum class OutputKind : std::uint8_t {
  hull,           ///< write_hull
  group_hulls,    ///< write_group_hulls
  triangulation,  ///< write_triangulation, write_alpha_shape
  voronoi,        ///< write_voronoi
  cells,          ///< write_cells
  ids,            ///< write_ids
  points,         ///< write_points
  made,           ///< PointsWriter
  records,        ///< write_las_records
  state,          ///< write_state
};

class OutputKinds {
 public:
  constexpr OutputKinds(std::initializer_list<OutputKind> kinds) {
    for (const OutputKind kind : kinds) bits_ |= 1U << static_cast<unsigned>(kind);
  }
  constexpr bool meet(OutputKinds other) const { return (bits_ & other.bits_) != 0; }

 private:
  unsigned bits_ = 0;
};

struct FileFormat {
  /// Who reads points of it: nobody; this library; it, but as what is in a container, or as a
  /// state; the program of the Python package; its function cullhull.read alone.
  enum class Reader : std::uint8_t { none, here, container, program, package };
  /// How its text is encoded: not at all; UTF-8, perhaps with a byte order mark; also UTF-16.
  enum class Encoding : std::uint8_t { bytes, utf8, unicode };
  /// mesh: polygons in space, for points of dimension 2 and 3. map: polygons in the plane, as
  /// programs for maps read them, for points of dimension 2.
  enum class Shape : std::uint8_t { other, mesh, map };

  /// "npy": the word of --input-format, and the extension under which it is written.
  std::string_view name{};
  std::string_view endings{};  ///< all extensions that it is read by, between blanks

  // Reading

  Reader reader = Reader::none;
  Encoding encoding = Encoding::bytes;
  /// Reads a file; null where `rows`, and where all its files are `records`.
  PointData (*read)(const Source& source, const ReadOptions& options) = nullptr;
  /// Its points as records of fixed size, which are read in blocks; empty for a file that has
  /// others.
  std::optional<RecordLayout> (*records)(const Source& head, std::uint64_t size,
                                         const ReadOptions& options) = nullptr;
  /// Its points in compressed chunks, which are read in blocks where the file can be read anywhere.
  std::optional<RecordLayout> (*chunks)(const Source& head, std::uint64_t size, const ReadAt& read,
                                        const ReadOptions& options) = nullptr;
  /// Whether it is a text with one point a line, which is read in blocks, too.
  bool rows = false;
  /// Whether its columns are called x, y and z.
  bool axes = false;

  // Known by its content if one of these applies, asked for in this order.
  std::string_view magic{};                                        ///< the first bytes
  bool (*has_bytes)(const Source& source) = nullptr;               ///< whether it begins so
  bool (*has_line)(const char* begin, const char* end) = nullptr;  ///< the first but for comments

  // Of rows
  /// Reads what is before the rows: false if there is no header of this format.
  bool (*header)(const Source& source, const ReadOptions& options, const DataLine& first,
                 Preamble& preamble) = nullptr;
  /// Whether of so many columns without names the first three are the coordinates.
  bool (*space_first)(std::size_t columns) = nullptr;
  /// The line of a point where it is not the number of its row.
  std::uint64_t (*line_of)(const Source& source, std::uint64_t point) = nullptr;

  // Writing

  OutputKinds writes{};
  Shape shape = Shape::other;

  /// Its lines in `cullhull help formats`, perhaps with those of rows below.
  std::string_view help{};

  bool has_ending(std::string_view extension) const;
};

/// The table. Messages list what is written in its order, help texts what is read.
const std::vector<FileFormat>& file_formats();

/// By its name; null if there is none.
const FileFormat* format_named(std::string_view name);

/// The extensions, with their dots, of the formats that hold one of these kinds.
std::vector<std::string_view> output_endings(OutputKinds kinds);
/// Whether results of one of these kinds are written in the format. `format`: a name.
bool holds(std::string_view format, OutputKinds kinds);
/// Whether anything is written in the format.
bool is_written(std::string_view format);
bool is_mesh(std::string_view format);
bool is_map(std::string_view format);

/// Whether a file of this name holds points in a format of the table, perhaps compressed.
bool has_known_extension(const std::string& path);

/// The lines of `cullhull help formats` about what this library reads.
std::string help_on_formats();

}  // namespace cullhull::internal
