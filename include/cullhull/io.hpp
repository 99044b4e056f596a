// Reading points and writing hulls. docs/formats.md describes every format.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "cullhull/certify.hpp"
#include "cullhull/hull.hpp"
#include "cullhull/machine.hpp"
#include "cullhull/placement.hpp"
#include "cullhull/point_view.hpp"
#include "cullhull/stream.hpp"

#pragma GCC visibility push(default)
namespace cullhull {

/// What a point of a file that has a Placement is; other files' numbers are coordinates.
enum class Numbers {
  /// Coordinates in the world, as doubles: on a decimal grid (common_grid) the nearest ones, else
  /// number * scale + offset as laspy computes it.
  world,
  grid,  ///< integers on a common grid, exact, for computing; world coordinates without a grid
  file,  ///< the file's own numbers, in place
};

/// A choice that a reader made, or data it skipped, without having been asked to.
struct Remark {
  enum class Kind {
    columns,   ///< which columns of a text are the coordinates; ReadOptions::columns takes others
    left_out,  ///< bytes or text behind the points, faces that are cut short, lines of no keyword
  };
  Kind kind;
  std::string file;     ///< its name
  std::string message;  ///< a part of one line, without the name

  std::string line() const { return file + ": " + message; }
  operator std::string() const { return line(); }
};

struct ReadOptions {
  /// Force a format ("npy", "ply", "las", "pcd", "obj", "off", "stl", "xyz", "txt", "csv",
  /// "geojson", "wkt", "raw"); empty: by extension, then by content.
  std::string format;
  /// Needed for raw input only.
  std::uint32_t raw_dimension = 0;
  std::optional<ScalarType> raw_scalar;
  /// Which columns are the coordinates, in this order: names, numbers from 0 and ranges a:b (b
  /// excluded), separated by commas ("x,y,z", "0,2,5", "1:4"); a name may stand in double quotes.
  /// Empty: for a text whose first line names columns x, y (and z) these, else all columns. Names
  /// are those of a text's first line; mesh and scan formats have x, y, z. The other columns of a
  /// text may hold anything.
  std::string columns;
  /// A column of one more number a point, named as in `columns`; it is no coordinate unless
  /// `columns` names it, too (PointFile::weights). Of open_points alone, and not beside `key`.
  std::string weights;
  /// The column that holds the group of each point, named as in `columns`; it is no coordinate
  /// unless `columns` names it, too. BlockVisitor::keyed receives its values as they are written in
  /// the file.
  std::string key;
  /// Called for each remark, from any thread. A function of a std::string gets Remark::line().
  std::function<void(const Remark&)> remark;
  /// Compressed files (.gz, .zst, .npz) may unpack to at most this many bytes in memory; 0: half of
  /// what the process may use. Read in blocks (visit_blocks) they take no more memory than others.
  std::uint64_t memory_budget = 0;
  /// Read only part `part` (from 0) of `parts` nearly equal ones, if the format gives access to any
  /// point: .npy, .las, raw, binary .ply and .pcd, unless compressed, and HDF5. Other
  /// files are read whole (PointFile::in_parts). Of open_points alone.
  std::uint64_t part = 0, parts = 1;
  Numbers numbers = Numbers::world;
  /// For Numbers::grid: the grid, by common_grid of all inputs; without it the file's own. An empty
  /// one: coordinates in the world.
  std::optional<Grid> grid;
  /// Threads that parse text; 0 means all the machine offers.
  unsigned threads = 0;
  /// Checked while text is parsed.
  std::stop_token stop;
};

/// A point of a text and its line, from 1.
struct PointLine {
  std::uint64_t point = 0, line = 0;
};

/// Points of a file: mapped (binary) or parsed (text, meshes). Movable; `points()` views its
/// memory.
class PointFile {
 public:
  PointFile();
  PointFile(PointFile&&) noexcept;
  PointFile& operator=(PointFile&&) noexcept;
  ~PointFile();

  const PointView& points() const noexcept;
  /// Red, green and blue of every point (u8, dimension 3), where a PLY has them; else no points.
  const PointView& colours() const noexcept;
  /// Of the file's numbers, by axis of points().
  const Placement& placement() const noexcept;
  /// The numbers of ReadOptions::weights, one for each point of points(); empty if not asked for.
  const std::vector<double>& weights() const noexcept;
  /// The grid whose units the numbers of points() count; empty unless Numbers::grid was asked for.
  const Grid& grid() const noexcept;
  /// Converts a file's own numbers to grid units, or to world coordinates if there is no grid, as
  /// ReadOptions with Numbers::grid reads them. Call once.
  void to_grid(const ReadOptions& options);
  /// Converts grid units or a file's own numbers to world coordinates. Call once.
  void to_world();
  const std::string& format() const noexcept;  ///< "npy", "ply (binary little-endian)", ...
  bool mapped() const noexcept;                ///< true when read in place
  /// Whether points() is the part that ReadOptions::part names; else it is all of them.
  bool in_parts() const noexcept;
  std::uint64_t first() const noexcept;  ///< number, in the file, of the first of points()
  std::uint64_t total() const noexcept;  ///< points in the file
  /// Of a text with NaN or infinities the first such point.
  std::optional<PointLine> first_not_finite() const noexcept;
  double read_seconds() const noexcept;

  struct Impl;
  explicit PointFile(std::unique_ptr<Impl> impl);

 private:
  std::unique_ptr<Impl> impl_;
};

/// Opens `path` ("-": standard input; FILE.npz:NAME: an array in an archive; FILE.h5:/GROUP/NAME: a
/// dataset of an HDF5 or NetCDF-4 file). What is compressed by gzip or zstd is unpacked. Throws
/// Error{io} or Error{bad_file} with file and line or byte offset.
PointFile open_points(const std::string& path, const ReadOptions& options = {});

/// The line (from 1) of a point in an uncompressed text file, for messages; empty for other formats
/// and on read errors. Counts lines, so the time is that of reading the file.
std::optional<std::uint64_t> line_of_point(const std::string& path, std::uint64_t point) noexcept;

/// Moving points, frame after frame: an array (frames, n, d) in an .npy file, of which only one
/// frame is mapped at a time (so a sequence may exceed memory), or one file of points a frame.
class PointSequence {
 public:
  PointSequence();
  PointSequence(PointSequence&&) noexcept;
  PointSequence& operator=(PointSequence&&) noexcept;
  ~PointSequence();

  std::uint64_t frames() const noexcept;
  /// Makes the next frame the current one; false after the last. Invalidates the view of the frame
  /// before. Throws as open_points does.
  bool next();
  /// The current frame. Before next() it is empty.
  const PointView& points() const noexcept;
  /// Its index from 0, and the file it comes from.
  std::uint64_t index() const noexcept;
  const std::string& name() const noexcept;
  const std::string& format() const noexcept;
  const Grid& grid() const noexcept;  ///< as PointFile::grid(), the same for all frames
  /// As PointFile::placement(), of the current frame; before next() and of arrays it is empty.
  const Placement& placement() const noexcept;
  double read_seconds() const noexcept;  ///< of the current frame

  struct Impl;
  explicit PointSequence(std::unique_ptr<Impl> impl);

 private:
  std::unique_ptr<Impl> impl_;
};

/// Each of `paths` is a file, a folder (its files, without hidden ones) or a pattern with * ? [ ].
/// Where some files of a folder have the extension of a known format, the others are skipped, and
/// options.remark is told so; not if options.format names the format.
/// Files of folders and patterns are ordered by name, numbers in names by value (2 before 10). An
/// .npy array (frames, n, d) has to be the only path. Throws Error{io}, Error{bad_file}.
PointSequence open_sequence(const std::vector<std::string>& paths, const ReadOptions& options = {});

/// The files such paths stand for, in that order.
std::vector<std::string> sequence_files(const std::vector<std::string>& paths,
                                        const ReadOptions& options = {});

/// For a SIGBUS handler (async-signal-safe; the library installs none): the name of the open
/// PointFile whose mapping holds `address`, or nullptr. The kernel sends SIGBUS when a mapped file
/// shrinks under its reader. The name stays readable as long as the PointFile is open.
const char* describe_mapped_fault(const void* address) noexcept;

/// For a handler of SIGSEGV, SIGBUS, SIGFPE or SIGABRT (async-signal-safe): the name of the HDF5
/// file that libhdf5 is reading on this thread, or nullptr. Some damaged files crash it.
const char* describe_library_fault() noexcept;

struct JsonExtras {
  double read_seconds = 0;
  /// The times of all runs where there were several; the hull's statistics have the median run's.
  std::vector<double> compute_seconds_all;
  std::uint64_t peak_bytes = 0;
  /// Set when a certificate was asked for.
  std::optional<bool> certified;
};

/// The version of docs/cullhull.schema.json, which every document names in its member "schema". It
/// is increased when a member is removed or changes its meaning; members may be added without.
inline constexpr int json_schema_version = 2;

/// How a mesh file (.ply .obj .off) holds facets of more than three corners.
enum class Faces {
  polygons,   ///< as polygons
  triangles,  ///< as the hull's simplices, for programs that read no polygons
};

/// Writes `hull` in the format of the extension of `path` (.ply .obj .off .stl .glb .vtp .geojson
/// .wkt .json .txt) or in `format`: one of those words, or of qhull_formats(). The bytes depend on
/// points and hull alone, so .json holds the result and no times. The file appears whole or not at
/// all (written beside, then renamed); "-" and what is no regular file (a pipe, a device) are
/// written directly. Throws Error{invalid_argument} if the format cannot hold the hull's dimension,
/// Error{io} with the system's reason.
void write_hull(const std::string& path, const PointView& points, const Hull& hull,
                const std::string& format = "", Faces faces = Faces::polygons);
/// The same bytes from the points' state and its hull(). Formats that list every point are refused:
/// Error{invalid_argument}.
void write_hull(const std::string& path, const HullState& state, const Hull& hull,
                const std::string& format = "", Faces faces = Faces::polygons);

/// For a handler of SIGINT or SIGTERM (async-signal-safe): removes the temporary files of writers
/// that have not finished.
void remove_unfinished_files() noexcept;

/// The run's report as JSON, with the lists of write_hull(".json") if `with_lists`; the keys are
/// listed in docs/formats.md.
std::string hull_to_json(const PointView& points, const Hull& hull, const JsonExtras& extras,
                         bool with_lists);
std::string hull_to_json(const HullState& state, const Hull& hull, const JsonExtras& extras,
                         bool with_lists);
/// Reads what write_hull(".json") or hull_to_json with lists wrote, of this schema version or an
/// earlier one. Every size, offset and index is checked, so that the result can be handed to
/// certify(); its statistics are not in the file. `vertex_coordinates`, if given, takes the rows of
/// that key, in the order of `vertices`. Options used: stop, poll. `first_id`: the id of point 0 in
/// the file; the result counts from 0. Throws Error{bad_file}, Error{io} or Error{cancelled}.
Hull hull_from_json(const std::string& path, std::vector<double>* vertex_coordinates = nullptr,
                    const Options& options = {}, std::uint64_t first_id = 0);

/// certify() of the hull in such a file; its `vertex_coordinates`, which a Hull does not have, must
/// be those of the points. Points on a grid are compared with what the file has in the world.
/// `first_id`: the id of point 0 in the file. Throws what hull_from_json and certify throw.
Certificate certify_file(const PointView& points, const std::string& path,
                         const Options& options = {}, const Grid& grid = {},
                         std::uint64_t first_id = 0);

/// Throws Error{io} where a file of this name cannot be written; for a check before long work.
/// Does not change an existing file.
void check_writable(const std::string& path);

/// Reads what `cullhull-bench machine` wrote: an object with the members of MachineConstants. The
/// rates of link and device may be missing or null. Throws Error{bad_file} or Error{io}.
MachineConstants machine_from_json(const std::string& path);

/// Text as Qhull's `qconvex` prints it; `what` is one of qhull_formats(). docs/formats.md says what
/// each holds. Throws Error{invalid_argument} for other words, with the reason for words that only
/// Qhull has, and for G, m and FM of a hull that is neither 2D nor 3D.
std::string hull_to_qhull_text(const PointView& points, const Hull& hull, std::string_view what);
/// The same from a state; o, f, FF, Ft and FN list every point and are refused.
std::string hull_to_qhull_text(const HullState& state, const Hull& hull, std::string_view what);

/// The words hull_to_qhull_text knows.
const std::vector<std::string>& qhull_formats();

/// Throws the error hull_to_qhull_text would throw for this word, whatever the hull.
void check_qhull_format(std::string_view what);

/// Writes a text as write_hull writes its files: whole or not at all.
void write_text(const std::string& path, std::string_view text);

/// Point ids in the format of the extension of `path` or `format`: .npy (int64), .txt (one a line),
/// .csv (likewise, below the line "id"); "-" and what is no regular file get .npy. Throws
/// Error{invalid_argument} for another extension, Error{io}.
void write_ids(const std::string& path, const std::vector<std::uint64_t>& ids,
               const std::string& format = "");

/// Those of the points whose ids are given, in that order, likewise: .npy and .ply keep the scalar
/// type (.ply: 2D and 3D), .xyz, .txt and .csv are decimals that read back as the same numbers,
/// .csv below a line of column names. Throws as write_ids does.
void write_points(const std::string& path, const PointView& points,
                  const std::vector<std::uint64_t>& ids, const std::string& format = "");
/// Likewise the extreme points that a state holds.
void write_points(const std::string& path, const HullState& state, const std::string& format = "");

/// Those records of the LAS file `las` (any name that open_points takes one by) whose ids are
/// given, ascending, as a LAS file: every field of them, and its scale, offset, point format and
/// other records, are the input's bytes; the header's counts and box are theirs. Throws
/// Error{bad_file} unless `las` is LAS, Error{invalid_argument} for an id beyond its points or a
/// name but .las.
void write_las_records(const std::string& path, const std::string& las,
                       const std::vector<std::uint64_t>& ids);

/// (n) int64, or (n, d) arrays in NumPy's format.
void write_npy_ids(const std::string& path, const std::vector<std::uint64_t>& ids);
void write_npy_points(const std::string& path, const double* coordinates, std::uint64_t count,
                      std::uint32_t dimension, ScalarType type);

/// An array (count, dimension) written some points at a time; the file appears when the last one
/// has been written. Throws as the other writers do.
class NpyPointsWriter {
 public:
  NpyPointsWriter(const std::string& path, std::uint64_t count, std::uint32_t dimension,
                  ScalarType type);
  ~NpyPointsWriter();
  /// The next points: count x dimension doubles.
  void write(const double* coordinates, std::uint64_t count);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Points written some at a time, in the format of the extension of `path` (else .npy) or `format`:
/// .npy .ply .obj .off .raw .xyz .txt .csv, and .geojson .wkt as one multipoint. .ply .geojson .wkt
/// hold points of dimension 2 and 3, .obj of 3. .npy .ply .raw keep `type`, the others have decimals
/// that read back as the same numbers. The file appears when the last point has been written. Throws
/// Error{invalid_argument} for other names and dimensions, else as the other writers do.
class PointsWriter {
 public:
  PointsWriter(const std::string& path, std::uint64_t count, std::uint32_t dimension,
               ScalarType type, const std::string& format = "");
  ~PointsWriter();
  /// The next points: count x dimension doubles, which are rounded to `type`.
  void write(const double* coordinates, std::uint64_t count);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// An array (frames, count, dimension) written frame by frame; the file appears when the last one
/// has been written. Throws as the other writers do.
class NpySequenceWriter {
 public:
  NpySequenceWriter(const std::string& path, std::uint64_t frames, std::uint64_t count,
                    std::uint32_t dimension, ScalarType type);
  ~NpySequenceWriter();
  /// count x dimension doubles.
  void write(const double* coordinates);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace cullhull
#pragma GCC visibility pop
